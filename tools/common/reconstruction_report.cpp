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

const Names<SmoothingMethod> smoothing_names = {
    {"umbrella", SmoothingMethod::Umbrella},
    {"biharmonic", SmoothingMethod::Biharmonic},
};

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
std::vector<Index> inputIndices(const CloudReconstruction& cloud,
                                const std::vector<Index>& vertices) {
  std::vector<Index> indices;
  indices.reserve(vertices.size());
  for (const Index vertex : vertices) {
    indices.push_back(cloud.point_of_vertex[static_cast<std::size_t>(vertex)]);
  }
  return indices;
}

Json graphToJson(const ReconstructionSettings& settings, const CloudReconstruction& cloud) {
  const GraphReport& graph = cloud.result.graph;
  const auto index_of = [&cloud](Index vertex) {
    return cloud.point_of_vertex[static_cast<std::size_t>(vertex)];
  };
  Json json;
  json["method"] = optionText(settings.options, "graph");
  json["k"] = neighborsToSearch(settings.options.graph);
  json["edges"] = graph.edges;
  json["components"] = graph.components;
  json["bridges"] = Json::array();
  for (const Bridge& bridge : graph.bridges) {
    json["bridges"].push_back(
        {{"from", index_of(bridge.from)}, {"to", index_of(bridge.to)}, {"length", bridge.length}});
  }
  json["without_tangent_plane_count"] = graph.without_tangent_plane.size();
  json["without_tangent_plane"] = inputIndices(cloud, graph.without_tangent_plane);
  json["searched_again"] = graph.searched_again;
  json["uncertified"] = graph.uncertified;
  json["weak"] = graph.weak;
  return json;
}

/// Nodes or edges of all levels over those of the finest.
double complexityOf(const std::vector<LevelReport>& levels, std::size_t LevelReport::*size) {
  double sum = 0.0;
  for (const LevelReport& level : levels) {
    sum += static_cast<double>(level.*size);
  }
  return sum / static_cast<double>(levels.front().*size);
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

Json embeddingToJson(const ReconstructionSettings& settings, const CloudReconstruction& cloud) {
  const EmbeddingReport& embedding = cloud.result.embedding;
  const std::vector<LevelReport>& levels = embedding.levels;
  Json json;
  json["method"] = optionText(settings.options, "embedding");
  json["centroid_norm"] = embedding.centroid_norm;
  // The iteration knows neither levels nor energy.
  if (levels.empty()) {
    return json;
  }
  json["starts"] = embedding.starts;
  json["collapsed_starts"] = embedding.collapsed_starts;
  json["barrier"] = hasBarrier(settings, embedding);
  json["added_barrier"] = embedding.added_barrier;
  json["energy"] = embedding.energy;
  json["operator_complexity"] = complexityOf(levels, &LevelReport::edges);
  json["grid_complexity"] = complexityOf(levels, &LevelReport::nodes);
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
Json selfIntersectionsToJson(const CloudReconstruction& cloud) {
  constexpr std::size_t most_pairs = 1000;
  const auto& pairs = cloud.result.self_intersections;
  Json json = Json::array();
  for (std::size_t i = 0; i < std::min(most_pairs, pairs.size()); ++i) {
    json.push_back({pairs[i][0], pairs[i][1]});
  }
  return json;
}

Json optimizationToJson(const ReconstructionSettings& settings,
                        const OptimizationReport& optimization) {
  Json json;
  json["method"] = optionText(settings.options, "optimization");
  json["energy"] = optimization.energy;
  json["rough"] = optimization.rough;
  json["noisy"] = optimization.noise_steps > 0;
  json["noise_steps"] = optimization.noise_steps;
  json["out_of_time"] = optimization.is_out_of_time;
  json["alignment"] = optimization.alignment;
  json["unevenness"] = optimization.unevenness;
  json["phases"] = Json::array();
  for (const OptimizationPhase& phase : optimization.phases) {
    const auto& self_intersections = phase.self_intersections;
    json["phases"].push_back(
        {{"name", phase.name},
         {"tried", phase.tried},
         {"moves", phase.moves},
         {"energy_before", phase.energy_before},
         {"energy", phase.energy},
         {"self_intersections", self_intersections ? Json(*self_intersections) : Json(nullptr)},
         {"seconds", phase.seconds}});
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
          {"method", nameOf(settings.options.smoothing.method, smoothing_names)},
          {"max_displacement", smoothing.max_displacement},
          {"mean_displacement", smoothing.mean_displacement},
          {"rms_displacement", smoothing.rms_displacement},
          {"volume_before", smoothing.volume_before},
          {"volume_after", smoothing.volume_after},
          {"self_intersections", smoothing.self_intersections}};
}

Json loopsToJson(const CloudReconstruction& cloud, const std::vector<std::vector<Index>>& loops) {
  Json json = Json::array();
  for (const std::vector<Index>& loop : loops) {
    json.push_back(inputIndices(cloud, loop));
  }
  return json;
}

Json openingsToJson(const CloudReconstruction& cloud) {
  Json json = Json::array();
  for (const Opening& opening : cloud.result.openings) {
    json.push_back({{"filled", opening.is_filled},
                    {"triangles", opening.triangles.size()},
                    {"certainty", opening.certainty},
                    {"flat", opening.is_flat},
                    {"location", toJson(opening.center)},
                    {"size", opening.width},
                    {"spacing", opening.spacing},
                    {"area", opening.area},
                    {"boundary_length", opening.boundary_length},
                    {"edges", opening.loop.size()},
                    {"loop", inputIndices(cloud, opening.loop)}});
  }
  return json;
}

Json diagnosisToJson(const CloudReconstruction& cloud) {
  const SurfaceDiagnosis& diagnosis = cloud.result.diagnosis;
  Json json;
  json["kind"] = nameOf(diagnosis.kind, surface_names);
  json["looks_closed_genus0"] = diagnosis.looksClosedGenus0();
  json["genus"] = diagnosis.genus ? Json(*diagnosis.genus) : Json(nullptr);
  json["outliers"] = Json::array();
  for (const Index point : cloud.result.outliers) {
    json["outliers"].push_back(cloud.meshed[static_cast<std::size_t>(point)]);
  }
  json["handles"] = Json::array();
  for (const CollapsedHandle& handle : diagnosis.handles) {
    json["handles"].push_back({{"location", toJson(handle.center)},
                               {"size", handle.size},
                               {"edges", handle.edges},
                               {"vertices", inputIndices(cloud, handle.vertices)}});
  }
  json["bridges"] = Json::array();
  for (const PartBridge& bridge : diagnosis.bridges) {
    json["bridges"].push_back({{"location", toJson(bridge.center)},
                               {"size", bridge.gap},
                               {"spacing", bridge.spacing},
                               {"points", bridge.points},
                               {"other_points", bridge.other_points},
                               {"vertices", inputIndices(cloud, bridge.vertices)}});
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

Json outliersToJson(const ReconstructionSettings& settings,
                    const std::optional<OutlierRemoval>& outliers) {
  if (!outliers) {
    return nullptr;
  }
  const std::optional<double>& sigma = settings.outliers->sigma;
  return {{"sigma", sigma ? Json(*sigma) : Json(nullptr)},
          {"threshold", outliers->threshold ? Json(*outliers->threshold) : Json(nullptr)},
          {"count", outliers->points.size()},
          {"indices", outliers->points}};
}

/// Prints the levels as multigrid solvers print theirs.
void printHierarchy(const std::vector<LevelReport>& levels, Console& console) {
  if (levels.empty()) {
    return;
  }
  console.heading("");
  console.heading("  Number of levels:    " + std::to_string(levels.size()));
  console.heading("  Operator complexity: " +
                  formatted(complexityOf(levels, &LevelReport::edges), 3));
  console.heading("  Grid complexity:     " +
                  formatted(complexityOf(levels, &LevelReport::nodes), 3));
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

/// Prints the phases of the optimisation, in the style of the levels.
void printPhases(const std::vector<OptimizationPhase>& phases, Console& console) {
  if (phases.empty()) {
    return;
  }
  const std::string head =
      "phase                  tried      moves       energy  self-int.  seconds";
  console.heading("  " + head);
  console.heading("  " + std::string(head.size(), '-'));
  for (const OptimizationPhase& phase : phases) {
    const std::string self_intersections =
        phase.self_intersections ? std::to_string(*phase.self_intersections) : "";
    std::array<char, 128> line{};
    std::snprintf(line.data(), line.size(), "  %-17s %10zu %10zu %12s %10s %8.3f",
                  phase.name.c_str(), phase.tried, phase.moves, formatted(phase.energy, 6).c_str(),
                  self_intersections.c_str(), phase.seconds);
    console.heading(line.data());
  }
  console.heading("");
}

}  // namespace

Json toJson(const Part& part) {
  return {{"points", part.points.size()},
          {"box", {{"min", toJson(part.box_min)}, {"max", toJson(part.box_max)}}}};
}

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

Json cloudToJson(const ReconstructionSettings& settings, const CloudReconstruction& cloud) {
  Json json;
  json["points"] = cloud.data->points.size();
  json["ignored_points"] = cloud.ignored;
  json["outliers"] = outliersToJson(settings, cloud.outliers);
  json["left_out"] = cloud.parts ? Json(cloud.parts->left_out) : Json(nullptr);
  return json;
}

void addMesh(const ReconstructionSettings& settings, const CloudReconstruction& cloud, Json& json) {
  const Surface& result = cloud.result;
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
  json["self_intersections"] = cloud.result.self_intersections.size();
  json["intersecting_triangles"] = result.intersecting_triangles;
  json["self_intersecting_pairs"] = selfIntersectionsToJson(cloud);
  json["measures"] = measuresToJson(result);
  json["diagnosis"] = diagnosisToJson(cloud);
  json["openings"] = openingsToJson(cloud);
  json["boundary"] = loopsToJson(cloud, result.boundary);
  json["edges_outside_graph"] = result.diagnosis.edges_outside_graph;
  json["converged"] = result.embedding.converged();
  json["stop_reason"] = nameOf(result.embedding.stop_reason, stop_reason_names);
  json["iterations"] = result.embedding.iterations;
  json["fallback_start"] = result.embedding.fallback_start;
  json["residual"] = result.embedding.residual;
  json["residuals"] = result.embedding.residuals;
  json["consolidation"] = consolidationToJson(settings, result.consolidation);
  json["graph"] = graphToJson(settings, cloud);
  json["embedding"] = embeddingToJson(settings, cloud);
  json["triangulation"] = {{"method", optionText(settings.options, "triangulation")},
                           {"hull_vertices", result.triangulation.hull_vertices},
                           {"reinserted", result.triangulation.reinserted},
                           {"coincident", result.triangulation.coincident},
                           {"hull_rejected", result.triangulation.hull_rejected}};
  json["optimization"] = optimizationToJson(settings, result.optimization);
  json["smoothing"] = smoothingToJson(settings, result.smoothing);
  json["stages"] = toJson(cloud.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
}

void printTables(const CloudReconstruction& cloud, Console& console) {
  printHierarchy(cloud.result.embedding.levels, console);
  printPhases(cloud.result.optimization.phases, console);
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
