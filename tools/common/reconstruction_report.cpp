#include "common/reconstruction_report.h"

#include "common/names.h"
#include "spherical_param/version.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

const Names<SurfaceKind> surface_names = {
    {"closed genus 0", SurfaceKind::ClosedGenus0},
    {"open", SurfaceKind::Open},
    {"handles", SurfaceKind::Handles},
    {"several parts", SurfaceKind::SeveralParts},
    {"unclear", SurfaceKind::Unclear},
};

const Names<StopReason> stop_reason_names = {
    {"converged", StopReason::Converged},   {"iteration limit", StopReason::IterationLimit},
    {"stagnated", StopReason::Stagnated},   {"collapsed", StopReason::Collapsed},
    {"unfinished", StopReason::Unfinished},
};

/// The numbers of vertices in the input.
std::vector<Index> inputIndices(const Surface& surface, const std::vector<Index>& vertices) {
  std::vector<Index> indices;
  indices.reserve(vertices.size());
  for (const Index vertex : vertices) {
    indices.push_back(surface.input_of_vertex[static_cast<std::size_t>(vertex)]);
  }
  return indices;
}

/// How many times fewer nodes a level has than the next finer one; the finest has no such ratio.
std::optional<double> coarseningRatio(const std::vector<LevelReport>& levels, std::size_t level) {
  if (level == 0) {
    return std::nullopt;
  }
  return static_cast<double>(levels[level - 1].nodes) / static_cast<double>(levels[level].nodes);
}

/// Whether a barrier held the centroid of the sphere, so that the embedding did not collapse.
bool hasBarrier(const ReconstructionSettings& settings, const EmbeddingReport& embedding) {
  return !embedding.levels.empty() &&
         (embedding.added_barrier || settings.options.embedding.weights != EdgeWeights::Adaptive);
}

Json embeddingToJson(const ReconstructionSettings& settings, const Surface& surface) {
  const EmbeddingReport& embedding = surface.embedding;
  const std::vector<LevelReport>& levels = embedding.levels;
  Json json;
  json["method"] = optionText(settings.options, "embedding");
  json["centroid_norm"] = embedding.centroid_norm;
  // The iteration knows neither levels nor energy.
  if (levels.empty()) {
    return json;
  }
  json["barrier"] = hasBarrier(settings, embedding);
  json["added_barrier"] = embedding.added_barrier;
  json["levels"] = Json::array();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::optional<double> ratio = coarseningRatio(levels, i);
    // Of coarser levels, the solver looks at the residual of those alone that it solves.
    const bool is_known = i == 0 || levels[i].newton_iterations > 0;
    json["levels"].push_back({{"nodes", levels[i].nodes},
                              {"edges", levels[i].edges},
                              {"coarsening_ratio", ratio ? Json(*ratio) : Json(nullptr)},
                              {"sweeps", levels[i].sweeps},
                              {"newton_iterations", levels[i].newton_iterations},
                              {"linear_iterations", levels[i].linear_iterations},
                              {"residual", is_known ? Json(levels[i].residual) : Json(nullptr)}});
  }
  return json;
}

/// The first pairs of triangles that intersect.
Json selfIntersectionsToJson(const Surface& surface) {
  constexpr std::size_t most_pairs = 1000;
  const auto& pairs = surface.self_intersections;
  Json json = Json::array();
  for (std::size_t i = 0; i < std::min(most_pairs, pairs.size()); ++i) {
    json.push_back({pairs[i][0], pairs[i][1]});
  }
  return json;
}

Json consolidationToJson(const ReconstructionSettings& settings,
                         const ConsolidationReport& consolidation) {
  if (settings.options.consolidation == ConsolidationMode::None) {
    return nullptr;
  }
  return {{"noise", consolidation.noise},
          {"merged", consolidation.merged},
          {"max_displacement", consolidation.max_displacement},
          {"mean_displacement", consolidation.mean_displacement},
          {"rms_displacement", consolidation.rms_displacement}};
}

Json smoothingToJson(const ReconstructionSettings& settings, const SmoothingReport& smoothing) {
  if (settings.options.smoothing == 0) {
    return nullptr;
  }
  return {{"steps", settings.options.smoothing},
          {"max_displacement", smoothing.max_displacement},
          {"mean_displacement", smoothing.mean_displacement},
          {"rms_displacement", smoothing.rms_displacement},
          {"volume_before", smoothing.volume_before},
          {"volume_after", smoothing.volume_after},
          {"self_intersections", smoothing.self_intersections}};
}

Json loopsToJson(const Surface& surface, const std::vector<std::vector<Index>>& loops) {
  Json json = Json::array();
  for (const std::vector<Index>& loop : loops) {
    json.push_back(inputIndices(surface, loop));
  }
  return json;
}

Json openingsToJson(const Surface& surface) {
  Json json = Json::array();
  for (const Opening& opening : surface.openings) {
    json.push_back({{"filled", opening.is_filled},
                    {"certainty", opening.certainty},
                    {"flat", opening.is_flat},
                    {"location", toJson(opening.center)},
                    {"size", opening.width},
                    {"spacing", opening.spacing},
                    {"area", opening.area},
                    {"boundary_length", opening.boundary_length},
                    {"edges", opening.loop.size()},
                    {"loop", inputIndices(surface, opening.loop)}});
  }
  return json;
}

Json diagnosisToJson(const Surface& surface) {
  const SurfaceDiagnosis& diagnosis = surface.diagnosis;
  Json json;
  json["kind"] = nameOf(diagnosis.kind, surface_names);
  json["looks_closed_genus0"] = diagnosis.looksClosedGenus0();
  json["genus"] = diagnosis.genus ? Json(*diagnosis.genus) : Json(nullptr);
  json["outliers"] = Json::array();
  for (const Index point : surface.outliers) {
    json["outliers"].push_back(point);
  }
  json["filled_holes"] = Json::array();
  for (const FilledHole& hole : diagnosis.filled_holes) {
    json["filled_holes"].push_back({{"cause", nameOf(hole.cause, surface_names)},
                                    {"location", toJson(hole.center)},
                                    {"size", hole.diameter},
                                    {"spacing", hole.spacing},
                                    {"triangles", hole.triangles},
                                    {"area", hole.area},
                                    {"boundary_length", hole.boundary_length},
                                    {"vertices", inputIndices(surface, hole.vertices)},
                                    {"loops", loopsToJson(surface, hole.loops)}});
  }
  json["handles"] = Json::array();
  for (const CollapsedHandle& handle : diagnosis.handles) {
    json["handles"].push_back({{"location", toJson(handle.center)},
                               {"size", handle.size},
                               {"edges", handle.edges},
                               {"vertices", inputIndices(surface, handle.vertices)}});
  }
  json["bridges"] = Json::array();
  for (const PartBridge& bridge : diagnosis.bridges) {
    json["bridges"].push_back({{"location", toJson(bridge.center)},
                               {"size", bridge.gap},
                               {"spacing", bridge.spacing},
                               {"points", bridge.points},
                               {"other_points", bridge.other_points},
                               {"vertices", inputIndices(surface, bridge.vertices)}});
  }
  return json;
}

Json measuresToJson(const Surface& result) {
  const MeshMeasures& measures = result.measures;
  const auto known = [&result](const Json& value) {
    return result.hasVolume() ? value : Json(nullptr);
  };
  Json json;
  json["volume"] = known(measures.volume);
  json["area"] = measures.area;
  json["mean_edge_length"] = measures.mean_edge_length;
  json["bounding_box"] = {{"min", toJson(measures.box_min)}, {"max", toJson(measures.box_max)}};
  json["centroid"] = known(toJson(measures.centroid));
  Json inertia = Json::array();
  for (Eigen::Index row = 0; row < 3; ++row) {
    inertia.push_back(toJson(measures.inertia.row(row)));
  }
  json["inertia"] = known(inertia);
  return json;
}

/// Prints the levels as multigrid solvers print theirs.
void printHierarchy(const std::vector<LevelReport>& levels, Console& console) {
  if (levels.empty()) {
    return;
  }
  console.heading("");
  console.heading("  Number of levels:    " + std::to_string(levels.size()));
  console.heading("");
  const std::string head = "level      nodes      edges  ratio  sweeps  Newton     CG";
  console.heading("  " + head);
  console.heading("  " + std::string(head.size(), '-'));
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const LevelReport& level = levels[i];
    const std::optional<double> ratio = coarseningRatio(levels, i);
    std::array<char, 128> line{};
    std::snprintf(line.data(), line.size(), "  %5zu %10zu %10zu %6s %7d %7d %6d", i, level.nodes,
                  level.edges, ratio ? formatted(*ratio, 3).c_str() : "", level.sweeps,
                  level.newton_iterations, level.linear_iterations);
    console.heading(line.data());
  }
  console.heading("");
}

}  // namespace

Json toJson(const std::vector<Finding>& findings) {
  Json json = Json::array();
  for (const Finding& finding : findings) {
    json.push_back({{"text", finding.text},
                    {"option", finding.option},
                    {"value", finding.value},
                    {"fault", finding.is_fault}});
  }
  return json;
}

Json cloudToJson(const CloudReconstruction& cloud) {
  const LeftOut& left_out = cloud.result.left_out;
  Json json;
  json["points"] = cloud.data->points.size();
  json["ignored_points"] = left_out.not_finite.size();
  json["outliers"] = left_out.outliers;
  json["left_out"] = left_out.other_parts;
  return json;
}

void addSurface(const ReconstructionSettings& settings, const Surface& result, Json& json) {
  json["verdict"] = result.verdict;
  json["usable"] = result.isUsable();
  json["findings"] = toJson(result.findings);
  json["duplicates"] = result.duplicates();
  json["vertices"] = result.vertexCount();
  json["triangles"] = result.triangles.cols();
  json["closed"] = result.topology.closed;
  json["manifold"] = result.topology.manifold();
  json["oriented"] = result.topology.oriented;
  json["components"] = result.topology.components;
  json["genus"] = result.topology.genus ? Json(*result.topology.genus) : Json(nullptr);
  json["self_intersections"] = result.self_intersections.size();
  json["intersecting_triangles"] = result.intersecting_triangles;
  json["self_intersecting_pairs"] = selfIntersectionsToJson(result);
  json["measures"] = measuresToJson(result);
  json["diagnosis"] = diagnosisToJson(result);
  json["openings"] = openingsToJson(result);
  json["boundary"] = loopsToJson(result, result.boundary);
  json["edges_outside_graph"] = result.diagnosis.edges_outside_graph;
  json["converged"] = result.embedding.converged();
  json["stop_reason"] = nameOf(result.embedding.stop_reason, stop_reason_names);
  json["iterations"] = result.embedding.iterations;
  json["fallback_start"] = result.embedding.fallback_start;
  json["residual"] = result.embedding.residual;
  json["residuals"] = result.embedding.residuals;
  json["consolidation"] = consolidationToJson(settings, result.consolidation);
  json["embedding"] = embeddingToJson(settings, result);
  json["smoothing"] = smoothingToJson(settings, result.smoothing);
}

void printTables(const Surface& surface, Console& console) {
  printHierarchy(surface.embedding.levels, console);
}

void printMeasures(const Surface& result, Console& console) {
  const auto listed = [](const Eigen::Vector3d& vector) {
    return formatted(vector.x(), 6) + " " + formatted(vector.y(), 6) + " " +
           formatted(vector.z(), 6);
  };
  const MeshMeasures& measures = result.measures;
  console.entry("mean edge", formatted(measures.mean_edge_length, 4));
  console.entry("area", formatted(measures.area, 6));
  console.entry("bounding box", listed(measures.box_min) + " to " + listed(measures.box_max));
  if (result.hasVolume()) {
    console.entry("volume", formatted(measures.volume, 6));
    console.entry("centroid", listed(measures.centroid));
  }
}

}  // namespace spherical_param::tools
