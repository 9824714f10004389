#include "python/reports.h"

#include "python/arrays.h"
#include "python/names.h"

#include <algorithm>

namespace spherical_param::python {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

template <typename Items, typename Convert>
py::list listOf(const Items& items, const Convert& convert) {
  py::list list;
  for (const auto& item : items)
    list.append(convert(item));
  return list;
}

/// What was not asked for is empty in the core.
template <typename Value>
py::object orNone(const std::vector<Value>& values) {
  return values.empty() ? py::object(py::none()) : py::object(toArray(values));
}

py::object orNone(const Positions& points) {
  return points.cols() == 0 ? py::object(py::none()) : py::object(toArray(points));
}

py::object toObject(const EmbeddingHistory& history) {
  if (history.frames.empty())
    return py::none();
  return py::dict("vertices"_a = toArray(history.vertices),
                  "frames"_a = listOf(history.frames, [](const HistoryFrame& frame) {
                    return py::dict("level"_a = frame.level, "nodes"_a = frame.nodes,
                                    "step"_a = nameOf(frame.step), "iteration"_a = frame.iteration,
                                    "residual"_a =
                                        frame.residual ? py::cast(*frame.residual) : py::none(),
                                    "sphere"_a = toArray(frame.sphere));
                  }));
}

py::dict toDict(const MeshTopology& topology) {
  return py::dict("vertices"_a = topology.vertices, "edges"_a = topology.edges,
                  "triangles"_a = topology.triangles, "closed"_a = topology.closed,
                  "manifold"_a = topology.manifold(), "oriented"_a = topology.oriented,
                  "components"_a = topology.components,
                  "euler_characteristic"_a = topology.euler_characteristic,
                  "genus"_a = topology.genus ? py::cast(*topology.genus) : py::none());
}

/// \param has_volume else what the mesh encloses is meaningless.
py::dict toDict(const MeshMeasures& measures, bool has_volume) {
  const auto known = [has_volume](const py::object& value) {
    return has_volume ? value : py::none();
  };
  return py::dict("volume"_a = known(py::float_(measures.volume)), "area"_a = measures.area,
                  "mean_edge_length"_a = measures.mean_edge_length,
                  "box_min"_a = toArray(measures.box_min), "box_max"_a = toArray(measures.box_max),
                  "centroid"_a = known(toArray(measures.centroid)),
                  "inertia"_a = known(toArray(measures.inertia)));
}

py::dict toDict(const Bridge& bridge) {
  return py::dict("start"_a = bridge.from, "end"_a = bridge.to, "length"_a = bridge.length);
}

py::dict toDict(const SurfaceDiagnosis& diagnosis) {
  const py::list filled_holes = listOf(diagnosis.filled_holes, [](const FilledHole& hole) {
    return py::dict("cause"_a = nameOf(hole.cause), "triangles"_a = hole.triangles,
                    "area"_a = hole.area, "boundary_length"_a = hole.boundary_length,
                    "diameter"_a = hole.diameter, "spacing"_a = hole.spacing,
                    "center"_a = toArray(hole.center), "vertices"_a = toArray(hole.vertices),
                    "loops"_a = listOf(
                        hole.loops, [](const std::vector<Index>& loop) { return toArray(loop); }));
  });
  const py::list handles = listOf(diagnosis.handles, [](const CollapsedHandle& handle) {
    return py::dict("edges"_a = handle.edges, "size"_a = handle.size,
                    "center"_a = toArray(handle.center), "vertices"_a = toArray(handle.vertices));
  });
  const py::list bridges = listOf(diagnosis.bridges, [](const PartBridge& bridge) {
    return py::dict("points"_a = bridge.points, "other_points"_a = bridge.other_points,
                    "gap"_a = bridge.gap, "spacing"_a = bridge.spacing,
                    "center"_a = toArray(bridge.center), "vertices"_a = toArray(bridge.vertices));
  });
  return py::dict("kind"_a = nameOf(diagnosis.kind),
                  "genus"_a = diagnosis.genus ? py::cast(*diagnosis.genus) : py::none(),
                  "looks_closed_genus0"_a = diagnosis.looksClosedGenus0(),
                  "openings"_a = diagnosis.openings(), "boundaries"_a = diagnosis.boundaries,
                  "is_one_sided"_a = diagnosis.is_one_sided, "filled_holes"_a = filled_holes,
                  "handles"_a = handles, "bridges"_a = bridges,
                  "edges_outside_graph"_a = diagnosis.edges_outside_graph,
                  "triangle_marks"_a = orNone(diagnosis.triangle_marks));
}

py::dict toDict(const Opening& opening) {
  return py::dict("loop"_a = toArray(opening.loop), "boundary_length"_a = opening.boundary_length,
                  "area"_a = opening.area, "spacing"_a = opening.spacing, "width"_a = opening.width,
                  "center"_a = toArray(opening.center), "certainty"_a = opening.certainty,
                  "is_flat"_a = opening.is_flat, "is_filled"_a = opening.is_filled);
}

py::dict toDict(const GraphReport& graph) {
  return py::dict("edges"_a = graph.edges, "components"_a = graph.components,
                  "bridges"_a =
                      listOf(graph.bridges, [](const Bridge& bridge) { return toDict(bridge); }),
                  "without_tangent_plane"_a = toArray(graph.without_tangent_plane),
                  "searched_again"_a = graph.searched_again, "uncertified"_a = graph.uncertified,
                  "weak"_a = graph.weak);
}

py::dict toDict(const EmbeddingReport& embedding) {
  const py::list levels = listOf(embedding.levels, [](const LevelReport& level) {
    return py::dict("nodes"_a = level.nodes, "edges"_a = level.edges, "sweeps"_a = level.sweeps,
                    "newton_iterations"_a = level.newton_iterations,
                    "linear_iterations"_a = level.linear_iterations, "residual"_a = level.residual);
  });
  return py::dict("stop_reason"_a = nameOf(embedding.stop_reason),
                  "iterations"_a = embedding.iterations, "residual"_a = embedding.residual,
                  "residuals"_a = toArray(embedding.residuals),
                  "centroid_norm"_a = embedding.centroid_norm,
                  "fallback_start"_a = embedding.fallback_start, "levels"_a = levels,
                  "starts"_a = embedding.starts, "collapsed_starts"_a = embedding.collapsed_starts,
                  "added_barrier"_a = embedding.added_barrier, "energy"_a = embedding.energy);
}

py::dict toDict(const TriangulationReport& triangulation) {
  return py::dict(
      "hull_vertices"_a = triangulation.hull_vertices, "reinserted"_a = triangulation.reinserted,
      "coincident"_a = triangulation.coincident, "hull_rejected"_a = triangulation.hull_rejected);
}

py::dict toDict(const OptimizationReport& optimization) {
  const py::list phases = listOf(optimization.phases, [](const OptimizationPhase& phase) {
    return py::dict("name"_a = phase.name, "tried"_a = phase.tried, "moves"_a = phase.moves,
                    "energy_before"_a = phase.energy_before, "energy"_a = phase.energy,
                    "self_intersections"_a =
                        phase.self_intersections ? py::cast(*phase.self_intersections) : py::none(),
                    "seconds"_a = phase.seconds);
  });
  return py::dict("phases"_a = phases, "energy"_a = optimization.energy,
                  "rough"_a = optimization.rough, "noise_steps"_a = optimization.noise_steps,
                  "is_out_of_time"_a = optimization.is_out_of_time,
                  "smoothed_self_intersections"_a = optimization.smoothed_self_intersections,
                  "alignment"_a = optimization.alignment, "unevenness"_a = optimization.unevenness);
}

py::dict toDict(const SmoothingReport& smoothing) {
  return py::dict("max_displacement"_a = smoothing.max_displacement,
                  "mean_displacement"_a = smoothing.mean_displacement,
                  "rms_displacement"_a = smoothing.rms_displacement,
                  "volume_before"_a = smoothing.volume_before,
                  "volume_after"_a = smoothing.volume_after,
                  "self_intersections"_a = smoothing.self_intersections);
}

py::dict toDict(const DistortionStatistics& statistics) {
  return py::dict("mean"_a = statistics.mean, "p95"_a = statistics.p95, "max"_a = statistics.max);
}

}  // namespace

py::dict toDict(const Surface& result, const FinitePoints& finite) {
  const std::vector<Index>& input_of_kept = finite.rows;
  std::vector<Index> vertex_of_input(finite.given, -1);
  for (std::size_t i = 0; i < input_of_kept.size(); ++i)
    vertex_of_input[static_cast<std::size_t>(input_of_kept[i])] = result.vertex_of_input[i];
  std::vector<Index> outliers;
  for (const Index point : result.outliers)
    outliers.push_back(input_of_kept[static_cast<std::size_t>(point)]);
  std::vector<Index> input_of_vertex(result.input_of_vertex.size());
  std::transform(result.input_of_vertex.begin(), result.input_of_vertex.end(),
                 input_of_vertex.begin(),
                 [&](Index kept) { return input_of_kept[static_cast<std::size_t>(kept)]; });
  py::dict dict("triangles"_a = toArray(result.triangles), "sphere"_a = toArray(result.sphere),
                "vertex_of_input"_a = toArray(vertex_of_input),
                "input_of_vertex"_a = toArray(input_of_vertex), "outliers"_a = toArray(outliers),
                "duplicates"_a = result.duplicates(), "ignored"_a = finite.ignored,
                "self_intersections"_a = toArray(result.self_intersections),
                "smoothed"_a = orNone(result.smoothed),
                "consolidated"_a = orNone(result.consolidated));
  dict["boundary"] =
      listOf(result.boundary, [](const std::vector<Index>& loop) { return toArray(loop); });
  dict["openings"] =
      listOf(result.openings, [](const Opening& opening) { return toDict(opening); });
  dict["topology"] = toDict(result.topology);
  dict["measures"] = toDict(result.measures, result.hasVolume());
  dict["diagnosis"] = toDict(result.diagnosis);
  const ConsolidationReport& consolidation = result.consolidation;
  dict["consolidation"] =
      py::dict("noise"_a = consolidation.noise, "merged"_a = consolidation.merged,
               "max_displacement"_a = consolidation.max_displacement,
               "mean_displacement"_a = consolidation.mean_displacement,
               "rms_displacement"_a = consolidation.rms_displacement);
  dict["graph"] = toDict(result.graph);
  dict["embedding"] = toDict(result.embedding);
  dict["triangulation"] = toDict(result.triangulation);
  dict["optimization"] = toDict(result.optimization);
  dict["smoothing"] = toDict(result.smoothing);
  py::dict stages;
  for (const StageTime& stage : result.stages)
    stages[py::str(stage.name)] = stage.seconds;
  dict["stages"] = stages;
  dict["history"] = toObject(result.history);
  dict["vertex_residuals"] = orNone(result.vertex_residuals);
  dict["intersecting_triangles"] = result.intersecting_triangles;
  dict["usable"] = result.isUsable();
  dict["verdict"] = result.verdict;
  dict["findings"] = listOf(result.findings, [](const Finding& finding) {
    return py::dict("text"_a = finding.text, "option"_a = finding.option, "value"_a = finding.value,
                    "is_fault"_a = finding.is_fault);
  });
  return dict;
}

py::dict toDict(const MapDistortion& distortion) {
  return py::dict("flipped_triangles"_a = distortion.flipped_triangles,
                  "degenerate_triangles"_a = distortion.degenerate_triangles,
                  "angle"_a = toDict(distortion.angle), "area"_a = toDict(distortion.area),
                  "mean_angle_difference"_a = distortion.mean_angle_difference,
                  "stretch_efficiency"_a = distortion.stretch_efficiency);
}

py::dict toDict(const SphereMap& map) {
  return py::dict("sphere"_a = toArray(map.sphere), "caps"_a = toArray(map.caps),
                  "distortion"_a = toDict(map.distortion), "before"_a = toDict(map.before),
                  "levels"_a = listOf(map.levels, [](const SphereMapLevel& level) {
                    return py::dict("vertices"_a = level.vertices, "sweeps"_a = level.sweeps,
                                    "energy"_a = level.energy);
                  }));
}

}  // namespace spherical_param::python
