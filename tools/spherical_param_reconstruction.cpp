// pcl_spherical_param_reconstruction: meshes the point cloud of a file.

#include "common/cloud_reconstruction.h"
#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/html_report.h"
#include "common/json_report.h"
#include "common/mesh_writer.h"
#include "common/names.h"
#include "common/output_file.h"
#include "common/output_options.h"
#include "common/reconstruction_options.h"
#include "common/report_page.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using spherical_param::EdgeWeights;
using spherical_param::GraphMethod;
using spherical_param::Index;
using spherical_param::OptimizationMethod;
using spherical_param::PartsMode;
using spherical_param::SmoothingMethod;
using spherical_param::StopReason;
using spherical_param::SurfaceKind;

const std::string tool_name = "pcl_spherical_param_reconstruction";

const std::vector<OptionInfo> option_table =
    joined({reconstructionOptions(),
            {{"sphere", "FILE", "write the points on the sphere with the same triangles"}},
            htmlReportOptions(),
            outputOptions()});

/// What each does, and the words after the tool's name.
const std::vector<std::pair<std::string, std::string>> example_table = {
    {"A mesh through all points of a scan", "scan.ply mesh.ply"},
    {"With its map to the sphere and a page to look at",
     "scan.ply mesh.ply -sphere sphere.ply -report report.html"},
    {"A failure, unless the scan is a closed surface and nothing else is wrong",
     "scan.ply mesh.ply -strict"},
    {"Of a noisy scan with outliers", "scan.ply mesh.ply -outliers auto -smoothing 5"},
};

std::string helpText() {
  return "Usage: " + tool_name +
         " input output [options]\n\n"
         "Meshes the points of an object without holes through it into a closed surface,\n"
         "or one with the openings of the scan.\n"
         "  input:  " +
         extensionsFor(FileUse::ReadCloud) + "\n  output: " + extensionsFor(FileUse::WriteMesh) +
         "\n\nOptions (-name value, --name value or --name=value; defaults in brackets):\n" +
         describeOptions(option_table) + "\n" + describeExamples(tool_name, example_table) +
         "\nExit code: 0 done (also with warnings), 1 failed (with -strict also warnings),\n"
         "2 wrong usage.\n";
}

/// What the user asked for.
struct Settings {
  std::string input;
  std::string output;
  FileFormat output_format = nullptr;
  std::string sphere;  ///< empty: not wanted
  FileFormat sphere_format = nullptr;
  std::string page;     ///< empty: not wanted
  std::string command;  ///< that does the same again
  OutputSettings report;
  ReconstructionSettings reconstruction;
};

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

/// In names of files, the number of the part.
const std::string number_mark = "%03d";

bool isNumbered(const std::string& name) {
  return name.find(number_mark) != std::string::npos;
}

/// The name of a file of a part; one without a mark is that of all parts.
std::string numbered(const std::string& name, std::size_t part) {
  const std::size_t mark = name.find(number_mark);
  if (mark == std::string::npos) {
    return name;
  }
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), "%03zu", part);
  return name.substr(0, mark) + number.data() + name.substr(mark + number_mark.size());
}

/// The settings of a part, with the names of its files.
Settings settingsOf(Settings settings, std::size_t part) {
  for (std::string* name : {&settings.output, &settings.sphere, &settings.page}) {
    *name = numbered(*name, part);
  }
  return settings;
}

/// \throw UsageError for names without the numbers that they need, or with some that they do not.
void checkNumbers(const Settings& settings) {
  const bool makes_parts = settings.reconstruction.parts == PartsMode::Each;
  if (isNumbered(settings.output) && !makes_parts) {
    throw UsageError(inQuotes(settings.output) + " is for several parts, but one mesh is made",
                     "give -parts each, or a name without " + number_mark);
  }
  const bool has_numbers = isNumbered(settings.output);
  for (const std::string& name : {settings.sphere, settings.page}) {
    if (makes_parts && !name.empty() && !(isNumbered(name) && has_numbers)) {
      throw UsageError(inQuotes(name) + " can show one part alone",
                       "give names with " + number_mark + " to it and to the output");
    }
  }
}

Settings parseSettings(const CommandLine& command_line) {
  Settings settings;
  std::tie(settings.input, settings.output) = inputAndOutput(command_line, tool_name);
  requireFormat(settings.input, FileUse::ReadCloud);
  settings.output_format = requireFormat(settings.output, FileUse::WriteMesh);
  settings.sphere = command_line.value("sphere", "");
  if (command_line.has("sphere")) {
    settings.sphere_format = requireFormat(settings.sphere, FileUse::WriteMesh);
  }
  settings.report = parseOutputOptions(command_line);
  settings.reconstruction = parseReconstructionOptions(command_line);
  settings.page = parseHtmlReport(command_line);
  checkNumbers(settings);
  if (!settings.page.empty()) {
    keepForHtmlReport(settings.reconstruction);
    settings.command = repeatedCommand(tool_name, command_line, option_table,
                                       {settings.input, settings.output}, settings.reconstruction);
  }
  return settings;
}

/// The files that will be written, the standard output not among them.
std::vector<std::string> outputsOf(const Settings& settings) {
  std::vector<std::string> outputs = {settings.output};
  if (!settings.sphere.empty()) {
    outputs.push_back(settings.sphere);
  }
  if (!settings.page.empty()) {
    outputs.push_back(settings.page);
  }
  addReport(settings.report, outputs);
  return outputs;
}

void printParameters(const Settings& settings, Console& console) {
  console.heading(tool_name + " " + SPHERICAL_PARAM_VERSION);
  console.entry("input", oneLine(settings.input));
  console.entry("output", oneLine(settings.output));
  if (!settings.sphere.empty()) {
    console.entry("sphere", oneLine(settings.sphere));
  }
  if (!settings.page.empty()) {
    console.entry("report", oneLine(settings.page));
  }
  if (!settings.report.json.empty()) {
    console.entry("json", oneLine(settings.report.json));
  }
  printReconstructionOptions(settings.reconstruction, console);
}

Json optionsToJson(const Settings& settings) {
  Json json = reconstructionOptionsToJson(settings.reconstruction);
  json["sphere"] = settings.sphere.empty() ? Json(nullptr) : Json(settings.sphere);
  json["report"] = settings.page.empty() ? Json(nullptr) : Json(settings.page);
  addToJson(settings.report, json);
  return json;
}

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

Json graphToJson(const Settings& settings, const CloudReconstruction& cloud) {
  const spherical_param::GraphReport& graph = cloud.result.graph;
  const auto index_of = [&cloud](Index vertex) {
    return cloud.point_of_vertex[static_cast<std::size_t>(vertex)];
  };
  Json json;
  json["method"] = optionText(settings.reconstruction.options, "graph");
  json["k"] = spherical_param::neighborsToSearch(settings.reconstruction.options.graph);
  json["edges"] = graph.edges;
  json["components"] = graph.components;
  json["bridges"] = Json::array();
  for (const spherical_param::Bridge& bridge : graph.bridges) {
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
double complexityOf(const std::vector<spherical_param::LevelReport>& levels,
                    std::size_t spherical_param::LevelReport::*size) {
  double sum = 0.0;
  for (const spherical_param::LevelReport& level : levels) {
    sum += static_cast<double>(level.*size);
  }
  return sum / static_cast<double>(levels.front().*size);
}

/// How many times fewer nodes a level has than the next finer one; the finest has no such ratio.
std::optional<double> coarseningRatio(const std::vector<spherical_param::LevelReport>& levels,
                                      std::size_t level) {
  if (level == 0) {
    return std::nullopt;
  }
  return static_cast<double>(levels[level - 1].nodes) / static_cast<double>(levels[level].nodes);
}

/// Whether a barrier held the centroid of the sphere, so that the embedding did not collapse.
bool hasBarrier(const Settings& settings, const spherical_param::EmbeddingReport& embedding) {
  return !embedding.levels.empty() &&
         (embedding.added_barrier ||
          settings.reconstruction.options.embedding.weights != EdgeWeights::Adaptive);
}

Json embeddingToJson(const Settings& settings, const CloudReconstruction& cloud) {
  const spherical_param::EmbeddingReport& embedding = cloud.result.embedding;
  const std::vector<spherical_param::LevelReport>& levels = embedding.levels;
  Json json;
  json["method"] = optionText(settings.reconstruction.options, "embedding");
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
  json["operator_complexity"] = complexityOf(levels, &spherical_param::LevelReport::edges);
  json["grid_complexity"] = complexityOf(levels, &spherical_param::LevelReport::nodes);
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

Json optimizationToJson(const Settings& settings,
                        const spherical_param::OptimizationReport& optimization) {
  Json json;
  json["method"] = optionText(settings.reconstruction.options, "optimization");
  json["energy"] = optimization.energy;
  json["rough"] = optimization.rough;
  json["noisy"] = optimization.noise_steps > 0;
  json["noise_steps"] = optimization.noise_steps;
  json["out_of_time"] = optimization.is_out_of_time;
  json["alignment"] = optimization.alignment;
  json["unevenness"] = optimization.unevenness;
  json["phases"] = Json::array();
  for (const spherical_param::OptimizationPhase& phase : optimization.phases) {
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

Json smoothingToJson(const Settings& settings, const spherical_param::SmoothingReport& smoothing) {
  if (settings.reconstruction.options.smoothing.steps == 0) {
    return nullptr;
  }
  return {{"steps", settings.reconstruction.options.smoothing.steps},
          {"method", nameOf(settings.reconstruction.options.smoothing.method, smoothing_names)},
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
  for (const spherical_param::Opening& opening : cloud.result.openings) {
    json.push_back({{"filled", opening.is_filled},
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
  const spherical_param::SurfaceDiagnosis& diagnosis = cloud.result.diagnosis;
  Json json;
  json["kind"] = nameOf(diagnosis.kind, surface_names);
  json["looks_closed_genus0"] = diagnosis.looksClosedGenus0();
  json["summary"] = diagnosis.summary;
  json["genus"] = diagnosis.genus ? Json(*diagnosis.genus) : Json(nullptr);
  json["outliers"] = Json::array();
  for (const Index point : cloud.result.outliers) {
    json["outliers"].push_back(cloud.meshed[static_cast<std::size_t>(point)]);
  }
  json["filled_holes"] = Json::array();
  for (const spherical_param::FilledHole& hole : diagnosis.filled_holes) {
    json["filled_holes"].push_back({{"cause", nameOf(hole.cause, surface_names)},
                                    {"location", toJson(hole.center)},
                                    {"size", hole.diameter},
                                    {"spacing", hole.spacing},
                                    {"triangles", hole.triangles},
                                    {"area", hole.area},
                                    {"boundary_length", hole.boundary_length},
                                    {"vertices", inputIndices(cloud, hole.vertices)},
                                    {"loops", loopsToJson(cloud, hole.loops)}});
  }
  json["handles"] = Json::array();
  for (const spherical_param::CollapsedHandle& handle : diagnosis.handles) {
    json["handles"].push_back({{"location", toJson(handle.center)},
                               {"size", handle.size},
                               {"edges", handle.edges},
                               {"vertices", inputIndices(cloud, handle.vertices)}});
  }
  json["bridges"] = Json::array();
  for (const spherical_param::PartBridge& bridge : diagnosis.bridges) {
    json["bridges"].push_back({{"location", toJson(bridge.center)},
                               {"size", bridge.gap},
                               {"spacing", bridge.spacing},
                               {"points", bridge.points},
                               {"other_points", bridge.other_points},
                               {"vertices", inputIndices(cloud, bridge.vertices)}});
  }
  return json;
}

Json measuresToJson(const spherical_param::MeshMeasures& measures) {
  Json json;
  json["volume"] = measures.volume;
  json["area"] = measures.area;
  json["mean_edge_length"] = measures.mean_edge_length;
  json["bounding_box"] = {{"min", toJson(measures.box_min)}, {"max", toJson(measures.box_max)}};
  json["centroid"] = toJson(measures.centroid);
  json["inertia"] = Json::array();
  for (Eigen::Index row = 0; row < 3; ++row) {
    json["inertia"].push_back(toJson(measures.inertia.row(row)));
  }
  return json;
}

Json outliersToJson(const Settings& settings, const std::optional<OutlierRemoval>& outliers) {
  if (!outliers) {
    return nullptr;
  }
  const std::optional<double>& sigma = settings.reconstruction.outliers->sigma;
  return {{"sigma", sigma ? Json(*sigma) : Json(nullptr)},
          {"threshold", outliers->threshold ? Json(*outliers->threshold) : Json(nullptr)},
          {"count", outliers->points.size()},
          {"indices", outliers->points}};
}

/// What was made of the cloud before it was meshed.
Json cloudToJson(const Settings& settings, const CloudReconstruction& cloud) {
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = settings.input;
  json["output"] = settings.output;
  json["options"] = optionsToJson(settings);
  json["points"] = cloud.data->points.size();
  json["ignored_points"] = cloud.ignored;
  json["outliers"] = outliersToJson(settings, cloud.outliers);
  json["left_out"] = cloud.parts ? Json(cloud.parts->left_out) : Json(nullptr);
  return json;
}

Json partToJson(const spherical_param::Part& part) {
  return {{"points", part.points.size()},
          {"box", {{"min", toJson(part.box_min)}, {"max", toJson(part.box_max)}}}};
}

/// Adds what was made of a cloud, or of a part of one.
void addMesh(const Settings& settings, const CloudReconstruction& cloud, Json& json) {
  const spherical_param::Result& result = cloud.result;
  json["duplicates"] = result.duplicates();
  json["vertices"] = result.vertexCount();
  json["triangles"] = result.triangles.cols();
  json["closed"] = result.topology.closed;
  json["manifold"] = result.topology.manifold();
  json["oriented"] = result.topology.oriented;
  json["components"] = result.topology.components;
  json["genus"] = result.topology.genus ? Json(*result.topology.genus) : Json(nullptr);
  json["self_intersections"] = cloud.result.self_intersections.size();
  json["self_intersecting_pairs"] = selfIntersectionsToJson(cloud);
  json["measures"] = measuresToJson(result.measures);
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
  json["graph"] = graphToJson(settings, cloud);
  json["embedding"] = embeddingToJson(settings, cloud);
  json["triangulation"] = {{"method", optionText(settings.reconstruction.options, "triangulation")},
                           {"hull_vertices", result.triangulation.hull_vertices},
                           {"reinserted", result.triangulation.reinserted},
                           {"coincident", result.triangulation.coincident},
                           {"hull_rejected", result.triangulation.hull_rejected}};
  json["optimization"] = optimizationToJson(settings, result.optimization);
  json["smoothing"] = smoothingToJson(settings, result.smoothing);
  json["stages"] = toJson(cloud.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
  json["warnings"] = warningsOf(cloud);
}

Json report(const Settings& settings, const CloudReconstruction& cloud) {
  Json json = cloudToJson(settings, cloud);
  json["parts"] = nullptr;
  if (cloud.parts) {
    json["parts"] = Json::array();
    for (const spherical_param::Part& part : cloud.parts->parts) {
      json["parts"].push_back(partToJson(part));
    }
  }
  addMesh(settings, cloud, json);
  return json;
}

/// The report on all parts, each with what report() says of one mesh.
Json reportOnParts(const Settings& settings, const PartsReconstruction& reconstruction) {
  const CloudReconstruction& cloud = reconstruction.cloud;
  Json json = cloudToJson(settings, cloud);
  json["parts"] = Json::array();
  for (std::size_t i = 0; i < reconstruction.parts.size(); ++i) {
    Json part = partToJson(cloud.parts->parts[i]);
    part["output"] = numbered(settings.output, i);
    addMesh(settings, reconstruction.parts[i], part);
    json["parts"].push_back(std::move(part));
  }
  json["stages"] = toJson(cloud.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
  json["warnings"] = warningsOf(reconstruction);
  return json;
}

void printGraph(const Settings& settings, const spherical_param::GraphReport& graph,
                Console& console) {
  console.entry("graph edges",
                std::to_string(graph.edges) + " (" +
                    counted(static_cast<std::size_t>(graph.components), "component") + ", " +
                    counted(graph.bridges.size(), "bridge") + ")");
  if (settings.reconstruction.options.graph.method == GraphMethod::LocalDelaunay) {
    console.entry("local Delaunay", std::to_string(graph.searched_again) + " searched again, " +
                                        std::to_string(graph.uncertified) + " uncertified, " +
                                        std::to_string(graph.weak) + " weak");
    console.entry("tangent plane",
                  "missing at " + counted(graph.without_tangent_plane.size(), "point"));
  }
}

/// Prints the levels as multigrid solvers print theirs.
void printHierarchy(const std::vector<spherical_param::LevelReport>& levels, Console& console) {
  if (levels.empty()) {
    return;
  }
  console.heading("");
  console.heading("  Number of levels:    " + std::to_string(levels.size()));
  console.heading("  Operator complexity: " +
                  formatted(complexityOf(levels, &spherical_param::LevelReport::edges), 3));
  console.heading("  Grid complexity:     " +
                  formatted(complexityOf(levels, &spherical_param::LevelReport::nodes), 3));
  console.heading("");
  const std::string head = "level      nodes      edges  ratio  sweeps  Newton     CG";
  console.heading("  " + head);
  console.heading("  " + std::string(head.size(), '-'));
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const spherical_param::LevelReport& level = levels[i];
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
void printPhases(const std::vector<spherical_param::OptimizationPhase>& phases, Console& console) {
  if (phases.empty()) {
    return;
  }
  const std::string head =
      "phase                  tried      moves       energy  self-int.  seconds";
  console.heading("  " + head);
  console.heading("  " + std::string(head.size(), '-'));
  for (const spherical_param::OptimizationPhase& phase : phases) {
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

/// How the mesh was optimised.
std::string optimized(const Settings& settings,
                      const spherical_param::OptimizationReport& optimization) {
  if (settings.reconstruction.options.optimization.method == OptimizationMethod::None) {
    return "no (-optimization none)";
  }
  return optionText(settings.reconstruction.options, "optimization") + ", energy " +
         formatted(optimization.energy, 6) +
         (optimization.noise_steps > 0
              ? ", noisy: on positions after " + std::to_string(optimization.noise_steps) +
                    " steps of smoothing"
              : "");
}

std::string listed(const Eigen::Vector3d& vector) {
  return formatted(vector.x(), 6) + " " + formatted(vector.y(), 6) + " " + formatted(vector.z(), 6);
}

/// What the library says about the cloud, after the label "looks like".
std::string appearance(const spherical_param::SurfaceDiagnosis& diagnosis) {
  const std::string beginning = "Looks like ";
  const bool begins = diagnosis.summary.compare(0, beginning.size(), beginning) == 0;
  return oneLine(begins ? diagnosis.summary.substr(beginning.size()) : diagnosis.summary);
}

void printOpenings(const spherical_param::Result& result, Console& console) {
  if (result.openings.empty()) {
    return;
  }
  const auto filled = static_cast<std::size_t>(
      std::count_if(result.openings.begin(), result.openings.end(),
                    [](const spherical_param::Opening& opening) { return opening.is_filled; }));
  console.entry("openings", std::to_string(result.openings.size() - filled) + " left open, " +
                                std::to_string(filled) + " filled");
  for (const std::vector<Index>& loop : result.boundary) {
    console.entry("boundary", counted(loop.size(), "edge"));
  }
}

void printSmoothing(const Settings& settings, const spherical_param::SmoothingReport& smoothing,
                    Console& console) {
  if (settings.reconstruction.options.smoothing.steps == 0) {
    return;
  }
  console.entry(
      "smoothed",
      counted(static_cast<std::size_t>(settings.reconstruction.options.smoothing.steps), "step") +
          ", points moved by " + formatted(smoothing.mean_displacement, 3) + " (mean), " +
          formatted(smoothing.max_displacement, 3) + " (max)");
  console.entry("", "volume " + formatted(smoothing.volume_before, 6) + " -> " +
                        formatted(smoothing.volume_after, 6) + ", " +
                        counted(smoothing.self_intersections, "self-intersection"));
}

/// Whether the embedding converged, and why it ended.
std::string convergence(const Settings& settings, const CloudReconstruction& cloud) {
  const spherical_param::EmbeddingReport& embedding = cloud.result.embedding;
  if (embedding.stop_reason == StopReason::Unfinished) {
    return "not asked for (-tolerance does)";
  }
  const std::string steps =
      embedding.levels.empty()
          ? counted(static_cast<std::size_t>(embedding.iterations), "iteration")
          : counted(static_cast<std::size_t>(embedding.levels.front().newton_iterations),
                    "Newton iteration");
  return yesOrNo(embedding.converged()) + " (" + nameOf(embedding.stop_reason, stop_reason_names) +
         " after " + steps +
         (hasBarrier(settings, embedding) ? ", the pull of a barrier is left)" : ")");
}

/// What was made of the cloud before it was meshed.
void printCloud(const CloudReconstruction& cloud, Console& console) {
  console.entry("points", std::to_string(cloud.data->points.size()));
  if (cloud.outliers) {
    console.entry("outliers", std::to_string(cloud.outliers->points.size()) + " left out");
  }
  if (cloud.parts) {
    console.entry("parts", std::to_string(cloud.parts->parts.size()) + ", " +
                               counted(cloud.parts->left_out.size(), "point") + " in none");
  }
}

void printTables(const CloudReconstruction& cloud, Console& console) {
  printHierarchy(cloud.result.embedding.levels, console);
  printPhases(cloud.result.optimization.phases, console);
}

void printMesh(const Settings& settings, const CloudReconstruction& cloud, Console& console) {
  const spherical_param::Result& result = cloud.result;
  console.entry("used", std::to_string(result.vertexCount()) + " (" +
                            std::to_string(result.duplicates()) + " duplicate, " +
                            std::to_string(cloud.ignored) + " not finite)");
  printGraph(settings, result.graph, console);
  if (!result.embedding.levels.empty()) {
    console.entry("starts tried",
                  std::to_string(result.embedding.starts) + " (" +
                      std::to_string(result.embedding.collapsed_starts) + " collapsed)" +
                      (hasBarrier(settings, result.embedding) ? ", with a barrier" : ""));
    console.entry("energy", formatted(result.embedding.energy, 6));
  }
  console.entry("residual", formatted(result.embedding.residual, 4));
  console.entry("converged", convergence(settings, cloud));
  console.entry("hull vertices",
                std::to_string(result.triangulation.hull_vertices) + " (" +
                    std::to_string(result.triangulation.reinserted) + " put back, " +
                    std::to_string(result.triangulation.coincident) + " coincident)");
  console.entry("triangles", std::to_string(result.triangles.cols()));
  console.entry("closed", yesOrNo(result.topology.closed));
  printOpenings(result, console);
  console.entry("manifold", yesOrNo(result.topology.manifold()));
  console.entry("oriented", yesOrNo(result.topology.oriented));
  console.entry("genus",
                result.topology.genus ? std::to_string(*result.topology.genus) : "undefined");
  console.entry("optimised", optimized(settings, result.optimization));
  console.entry("self-intersections", std::to_string(cloud.result.self_intersections.size()));
  printSmoothing(settings, result.smoothing, console);
  console.entry("looks like", appearance(result.diagnosis));
  console.entry("volume", formatted(result.measures.volume, 6));
  console.entry("area", formatted(result.measures.area, 6));
  console.entry("bounding box",
                listed(result.measures.box_min) + " to " + listed(result.measures.box_max));
  console.entry("centroid", listed(result.measures.centroid));
  for (const std::string& warning : warningsOf(cloud)) {
    console.entry("warning", oneLine(warning));
  }
}

void printVerdict(const Settings& settings, const CloudReconstruction& cloud, Console& console) {
  printTables(cloud, console);
  printCloud(cloud, console);
  printMesh(settings, cloud, console);
}

/// Prints what was made of each part, then of all.
void printParts(const Settings& settings, const PartsReconstruction& reconstruction,
                Console& console) {
  const CloudReconstruction& cloud = reconstruction.cloud;
  for (std::size_t i = 0; i < reconstruction.parts.size(); ++i) {
    const spherical_param::Part& part = cloud.parts->parts[i];
    console.heading("\n" + oneLine(numbered(settings.output, i)) + ", part " +
                    std::to_string(i + 1) + ":");
    printTables(reconstruction.parts[i], console);
    console.entry("points", std::to_string(part.points.size()) + " in " + listed(part.box_min) +
                                " to " + listed(part.box_max));
    printMesh(settings, reconstruction.parts[i], console);
  }
  console.heading("\n" + oneLine(settings.input) + ":");
  printCloud(cloud, console);
  for (const std::string& warning : warningsOf(reconstruction)) {
    console.entry("warning", oneLine(warning));
  }
}

/// Writes the mesh, the sphere and the page of a cloud, or of a part of one.
void writeFiles(const Settings& settings, CloudReconstruction& cloud, Console& console,
                std::vector<std::unique_ptr<OutputFile>>& files) {
  console.begin("write");
  // The mesh, and the sphere if it is wanted, are halves of one stage.
  const double fraction_of_file = settings.sphere.empty() ? 1.0 : 0.5;
  files.push_back(std::make_unique<OutputFile>(settings.output));
  writeMesh(*files.back(), meshOf(cloud), settings.output_format, settings.report.encoding,
            [&](double fraction) { console.update(fraction_of_file * fraction); });
  files.back()->finish();
  if (!settings.sphere.empty()) {
    files.push_back(std::make_unique<OutputFile>(settings.sphere));
    writeMesh(*files.back(), sphereOf(cloud, cloud.result.sphere), settings.sphere_format,
              settings.report.encoding,
              [&](double fraction) { console.update(0.5 + 0.5 * fraction); });
    files.back()->finish();
  }
  cloud.stages.push_back({"write", console.end("")});
  if (!settings.page.empty()) {
    console.begin("report");
    files.push_back(std::make_unique<OutputFile>(settings.page));
    writeHtmlReport(*files.back(), reportPage(),
                    {tool_name, settings.command, report(settings, cloud), &cloud,
                     settings.reconstruction.options.threads});
    files.back()->finish();
    cloud.stages.push_back({"report", console.end("")});
  }
}

/// Writes the surfaces of all parts to one file.
void writeJoined(const Settings& settings, PartsReconstruction& reconstruction, Console& console,
                 std::vector<std::unique_ptr<OutputFile>>& files) {
  const JoinedMesh joined(reconstruction.parts);
  console.begin("write");
  files.push_back(std::make_unique<OutputFile>(settings.output));
  writeMesh(*files.back(), joined.view(), settings.output_format, settings.report.encoding,
            [&](double fraction) { console.update(fraction); });
  files.back()->finish();
  reconstruction.cloud.stages.push_back({"write", console.end("")});
}

void runOnCloud(const Settings& settings, Console& console) {
  CloudReconstruction cloud;
  reconstructCloud(settings.input, settings.reconstruction, console, cloud);
  std::vector<std::unique_ptr<OutputFile>> files;
  writeFiles(settings, cloud, console, files);
  publish(
      settings.report, files, console, [&] { return report(settings, cloud); },
      [&] { printVerdict(settings, cloud, console); });
  requireNoWarnings(settings.reconstruction, {{settings.input, warningsOf(cloud)}});
}

void runOnParts(const Settings& settings, Console& console) {
  PartsReconstruction reconstruction;
  reconstructParts(settings.input, settings.reconstruction, console, reconstruction);
  std::vector<CloudReconstruction>& parts = reconstruction.parts;
  std::vector<std::unique_ptr<OutputFile>> files;
  console.heading("");
  if (isNumbered(settings.output)) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Settings of_part = settingsOf(settings, i);
      checkOutputs({settings.input}, outputsOf(of_part));
      writeFiles(of_part, parts[i], console, files);
    }
  } else {
    writeJoined(settings, reconstruction, console, files);
  }
  publish(
      settings.report, files, console, [&] { return reportOnParts(settings, reconstruction); },
      [&] { printParts(settings, reconstruction, console); });
  std::vector<std::pair<std::string, std::vector<std::string>>> warnings = {
      {settings.input, warningsOf(reconstruction)}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    warnings.emplace_back("part " + std::to_string(i + 1), warningsOf(parts[i]));
  }
  requireNoWarnings(settings.reconstruction, warnings);
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText())) {
    return;
  }
  const Settings settings = parseSettings(command_line);
  const bool makes_parts = settings.reconstruction.parts == PartsMode::Each;
  checkOutputs({settings.input}, outputsOf(makes_parts ? settingsOf(settings, 0) : settings));

  Console console(settings.report.printsText());
  printParameters(settings, console);
  if (makes_parts) {
    runOnParts(settings, console);
  } else {
    runOnCloud(settings, console);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
