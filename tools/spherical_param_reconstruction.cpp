// pcl_spherical_param_reconstruction: meshes the point cloud of a file.

#include "common/cloud_reader.h"
#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/mesh_writer.h"
#include "common/numbers.h"
#include "common/output_file.h"
#include "common/point_data.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <Eigen/Geometry>

#include <nlohmann/json.hpp>

#include <sys/resource.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using spherical_param::EdgeWeights;
using spherical_param::Index;
using spherical_param::StopReason;
using Reconstruction = pcl::SphericalParamReconstruction<pcl::PointXYZ>;
using Json = nlohmann::ordered_json;

const std::string tool_name = "pcl_spherical_param_reconstruction";
const std::string standard_output = "-";

const std::vector<OptionInfo> option_table = {
    {"k", "N", "neighbours of each point, 3 and up (25)"},
    {"weights", "NAME", "uniform, inverse or adaptive (adaptive)"},
    {"iterations", "N", "iterations at most (1600)"},
    {"tolerance", "X", "mean tangential Laplacian at convergence, 0 to 1 (1e-8)"},
    {"lambda", "X", "damping of the iteration, above 0 and up to 1 (0.5)"},
    {"stagnation", "N", "iterations over which stagnation is judged, 0: never (100)"},
    {"threads", "N", "threads, 0: as many as there are processors (0)"},
    {"sphere", "FILE", "write the points on the sphere with the same triangles"},
    {"json", "FILE", "write a report, - for the standard output and nothing else there"},
    {"ascii", "", "write PLY, STL and VTK as text"},
    {"quiet", "", "print nothing"},
};

std::string helpText() {
  return "Usage: " + tool_name +
         " input output [options]\n\n"
         "Meshes the points of an object without holes through it into a closed surface.\n"
         "  input:  " +
         extensionsFor(FileUse::ReadCloud) + "\n  output: " + extensionsFor(FileUse::WriteMesh) +
         "\n\nOptions (-name value, --name value or --name=value; defaults in brackets):\n" +
         describeOptions(option_table) + "\nExit code: 0 done, 1 failed, 2 wrong usage.\n";
}

/// What the user asked for.
struct Settings {
  std::string input;
  std::string output;
  FileFormat output_format = FileFormat::Ply;
  std::string sphere;  ///< empty: not wanted
  FileFormat sphere_format = FileFormat::Ply;
  std::string json;  ///< empty: not wanted
  Encoding encoding = Encoding::Binary;
  bool quiet = false;
  spherical_param::Options options;

  bool jsonToStandardOutput() const { return json == standard_output; }
};

const std::vector<std::pair<std::string, EdgeWeights>> weight_names = {
    {"uniform", EdgeWeights::Uniform},
    {"inverse", EdgeWeights::InverseLength},
    {"adaptive", EdgeWeights::Adaptive},
};

EdgeWeights parseWeights(const std::string& name) {
  for (const auto& [known, weights] : weight_names) {
    if (known == name) {
      return weights;
    }
  }
  throw UsageError("option -weights: " + inQuotes(name) + " is unknown",
                   "give -weights uniform, inverse or adaptive");
}

std::string nameOf(EdgeWeights weights) {
  for (const auto& [name, known] : weight_names) {
    if (known == weights) {
      return name;
    }
  }
  return "";
}

std::string nameOf(StopReason reason) {
  switch (reason) {
  case StopReason::Converged:
    return "converged";
  case StopReason::IterationLimit:
    return "iteration limit";
  case StopReason::Stagnated:
    return "stagnated";
  case StopReason::Collapsed:
    return "collapsed";
  }
  return "";
}

spherical_param::Options parseOptions(const CommandLine& command_line) {
  spherical_param::Options options;
  const auto take_integer = [&command_line](const std::string& name, int& value,
                                            const IntegerRange& range) {
    if (command_line.has(name)) {
      value = static_cast<int>(parseInteger(name, command_line.value(name, ""), range));
    }
  };
  const auto take_real = [&command_line](const std::string& name, double& value,
                                         const RealRange& range) {
    if (command_line.has(name)) {
      value = parseReal(name, command_line.value(name, ""), range);
    }
  };
  take_integer("k", options.k, {3});
  take_integer("iterations", options.max_iterations, {0});
  take_integer("stagnation", options.stagnation_window, {0});
  take_integer("threads", options.threads, {0, 1024});
  take_real("tolerance", options.tolerance, {0.0, 1.0, true});
  take_real("lambda", options.lambda, {0.0, 1.0, false});
  if (options.stagnation_window == 1) {
    throw UsageError("option -stagnation: a window of 1 has nothing to compare",
                     "give -stagnation 0 for never, or 2 and up");
  }
  if (command_line.has("weights")) {
    options.weights = parseWeights(command_line.value("weights", ""));
  }
#ifdef _OPENMP
  options.threads = options.threads == 0 ? omp_get_max_threads() : options.threads;
#else
  options.threads = 1;
#endif
  return options;
}

/// Which of two files is the input: the first, unless its format can only be written and that of
/// the second only be read. Where both are possible, nothing is guessed, as the output is lost.
bool isSwapped(const std::string& first, const std::string& second) {
  const std::optional<FileFormat> output = formatOf(first);
  const std::optional<FileFormat> input = formatOf(second);
  return output && input && !isUsable(*output, FileUse::ReadCloud) &&
         isUsable(*output, FileUse::WriteMesh) && isUsable(*input, FileUse::ReadCloud) &&
         !isUsable(*input, FileUse::WriteMesh);
}

Settings parseSettings(const CommandLine& command_line) {
  std::vector<std::string> files = command_line.others();
  if (files.size() != 2) {
    throw UsageError(files.empty()       ? "there is no input file"
                     : files.size() == 1 ? "there is no output file"
                                         : "there is one file too many: " + inQuotes(files[2]),
                     "run '" + tool_name + " input output [options]', -h shows the options");
  }
  if (isSwapped(files[0], files[1])) {
    std::swap(files[0], files[1]);
  }

  Settings settings;
  settings.input = files[0];
  settings.output = files[1];
  requireFormat(settings.input, FileUse::ReadCloud);
  settings.output_format = requireFormat(settings.output, FileUse::WriteMesh);
  settings.sphere = command_line.value("sphere", "");
  if (command_line.has("sphere")) {
    settings.sphere_format = requireFormat(settings.sphere, FileUse::WriteMesh);
  }
  settings.json = command_line.value("json", "");
  if (command_line.has("json") && settings.json.empty()) {
    throw UsageError("option -json: the name of the file is empty", "give a file, or - ");
  }
  settings.encoding = command_line.has("ascii") ? Encoding::Ascii : Encoding::Binary;
  settings.quiet = command_line.has("quiet");
  settings.options = parseOptions(command_line);
  return settings;
}

/// The files that will be written, the standard output not among them.
std::vector<std::string> outputsOf(const Settings& settings) {
  std::vector<std::string> outputs = {settings.output};
  if (!settings.sphere.empty()) {
    outputs.push_back(settings.sphere);
  }
  if (!settings.json.empty() && !settings.jsonToStandardOutput()) {
    outputs.push_back(settings.json);
  }
  return outputs;
}

/// Looks for what would fail or do harm only after the work.
void checkOutputs(const Settings& settings) {
  std::vector<std::string> files = {settings.input};
  for (const std::string& output : outputsOf(settings)) {
    for (const std::string& file : files) {
      if (isSameFile(file, output)) {
        throw UsageError(inQuotes(output) + " would overwrite " + inQuotes(file),
                         "give every file a name of its own");
      }
    }
    files.push_back(output);
  }
  for (const std::string& output : outputsOf(settings)) {
    checkOutputPath(output);
  }
}

void printParameters(const Settings& settings, Console& console) {
  const spherical_param::Options& options = settings.options;
  console.heading(tool_name + " " + SPHERICAL_PARAM_VERSION);
  console.entry("input", oneLine(settings.input));
  console.entry("output", oneLine(settings.output));
  if (!settings.sphere.empty()) {
    console.entry("sphere", oneLine(settings.sphere));
  }
  if (!settings.json.empty()) {
    console.entry("json", oneLine(settings.json));
  }
  console.entry("k", std::to_string(options.k));
  console.entry("weights", nameOf(options.weights));
  console.entry("iterations", std::to_string(options.max_iterations));
  console.entry("tolerance", formatted(options.tolerance, 6));
  console.entry("lambda", formatted(options.lambda, 6));
  console.entry("stagnation", options.stagnation_window == 0
                                  ? "never"
                                  : std::to_string(options.stagnation_window));
  console.entry("threads", std::to_string(options.threads));
}

/// Neighbour lists take memory before anything else fails: an absurd k is told first.
void checkMemory(const Settings& settings, std::size_t points) {
  constexpr std::uint64_t entry_limit = std::uint64_t{1} << 31;
  const std::uint64_t neighbors =
      std::min(static_cast<std::uint64_t>(settings.options.k), std::uint64_t{points});
  if (neighbors * points > entry_limit) {
    throw Failure("option -k: " + std::to_string(neighbors) + " neighbours of each of " +
                      std::to_string(points) + " points do not fit into memory",
                  "give a smaller -k, 25 is usual");
  }
}

/// Runs the library, with its stages on the console.
void reconstruct(const Settings& settings, const PointData& data, Reconstruction& reconstruction,
                 Console& console) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->reserve(data.points.size());
  for (const Point& point : data.points) {
    cloud->emplace_back(point[0], point[1], point[2]);
  }
  cloud->is_dense = false;

  const spherical_param::Options& options = settings.options;
  reconstruction.setKSearch(options.k);
  reconstruction.setWeights(options.weights);
  reconstruction.setLambda(options.lambda);
  reconstruction.setMaximumIterations(options.max_iterations);
  reconstruction.setTolerance(options.tolerance);
  reconstruction.setStagnationWindow(options.stagnation_window);
  reconstruction.setNumberOfThreads(static_cast<unsigned>(options.threads));
  std::string stage;
  std::string detail;
  reconstruction.setProgressCallback([&](const spherical_param::Progress& progress) {
    if (stage != progress.stage) {
      stage = progress.stage;
      detail.clear();
      console.begin(stage);
    }
    if (progress.iteration > 0) {
      detail = "iteration " + std::to_string(progress.iteration) + ", residual " +
               formatted(progress.residual, 3);
    }
    if (progress.fraction < 1.0) {
      console.update(progress.fraction, detail);
    } else {
      console.end(detail);
    }
    return true;
  });

  reconstruction.setInputCloud(cloud);
  std::vector<pcl::Vertices> polygons;
  reconstruction.reconstruct(polygons);
  const std::string& message = reconstruction.getErrorMessage();
  if (!message.empty()) {
    // The messages of the library are "cause; remedy", the remedy optional.
    const std::size_t remedy = message.find("; ");
    const std::string cause = message.substr(0, remedy);
    throw Failure("cannot mesh " + inQuotes(settings.input) + ": " + cause,
                  remedy == std::string::npos ? "check that the file holds the cloud you mean"
                                              : message.substr(remedy + 2));
  }
  if (reconstruction.getResult().triangles.cols() == 0) {
    throw Failure("cannot mesh " + inQuotes(settings.input) + ": there is no result",
                  "this should not happen: please report it");
  }
}

std::vector<std::array<std::int32_t, 3>> trianglesOf(const spherical_param::Result& result) {
  std::vector<std::array<std::int32_t, 3>> triangles;
  triangles.reserve(static_cast<std::size_t>(result.triangles.cols()));
  for (Eigen::Index t = 0; t < result.triangles.cols(); ++t) {
    triangles.push_back({result.triangles(0, t), result.triangles(1, t), result.triangles(2, t)});
  }
  return triangles;
}

/// The vertices on the sphere. They keep their colours, but not the normals of the input, which
/// mean nothing there.
TriangleMesh sphereOf(const spherical_param::Result& result, const TriangleMesh& mesh) {
  TriangleMesh sphere = mesh;
  sphere.vertices.normals.clear();
  for (std::size_t v = 0; v < sphere.vertices.points.size(); ++v) {
    const Eigen::Vector3f direction = result.sphere.col(static_cast<Eigen::Index>(v)).cast<float>();
    sphere.vertices.points[v] = {direction.x(), direction.y(), direction.z()};
  }
  return sphere;
}

/// Length of the diagonal of the bounding box of the finite points.
double diagonalOf(const std::vector<Point>& points) {
  Eigen::AlignedBox3d box;
  for (const Point& point : points) {
    const Eigen::Vector3d position = Eigen::Vector3f(point.data()).cast<double>();
    if (position.allFinite()) {
      box.extend(position);
    }
  }
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

std::vector<std::string> warningsOf(const PointData& data, const Reconstruction& reconstruction) {
  std::vector<std::string> warnings;
  // Single precision alone changes a cloud near its origin by less than a tenth of that.
  constexpr double harmless_rounding = 1e-6;
  if (data.rounding > harmless_rounding * diagonalOf(data.points)) {
    warnings.push_back("Coordinates were rounded to single precision, by up to " +
                       formatted(data.rounding, 3) +
                       ": points may have moved or merged; subtract a common offset first.");
  }
  const std::size_t ignored = reconstruction.getIgnoredPointCount();
  if (ignored > 0) {
    warnings.push_back(std::to_string(ignored) + " points were left out, because their coordinates "
                                                 "are not finite numbers in single precision.");
  }
  const std::vector<std::string>& further = reconstruction.getResult().warnings;
  warnings.insert(warnings.end(), further.begin(), further.end());
  return warnings;
}

std::uint64_t peakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

Json optionsToJson(const Settings& settings) {
  const spherical_param::Options& options = settings.options;
  Json json;
  json["k"] = options.k;
  json["weights"] = nameOf(options.weights);
  json["iterations"] = options.max_iterations;
  json["tolerance"] = options.tolerance;
  json["lambda"] = options.lambda;
  json["stagnation"] = options.stagnation_window;
  json["threads"] = options.threads;
  json["sphere"] = settings.sphere.empty() ? Json(nullptr) : Json(settings.sphere);
  json["json"] = settings.json;
  json["ascii"] = settings.encoding == Encoding::Ascii;
  json["quiet"] = settings.quiet;
  return json;
}

Json graphToJson(const Reconstruction& reconstruction) {
  const spherical_param::GraphReport& graph = reconstruction.getResult().graph;
  const pcl::Indices& cloud_indices = reconstruction.getVertexIndices();
  Json json;
  json["edges"] = graph.edges;
  json["components"] = graph.components;
  json["bridges"] = Json::array();
  for (const spherical_param::Bridge& bridge : graph.bridges) {
    json["bridges"].push_back({{"from", cloud_indices[static_cast<std::size_t>(bridge.from)]},
                               {"to", cloud_indices[static_cast<std::size_t>(bridge.to)]},
                               {"length", bridge.length}});
  }
  return json;
}

std::string report(const Settings& settings, const PointData& data,
                   const Reconstruction& reconstruction,
                   const std::vector<spherical_param::StageTime>& stages) {
  const spherical_param::Result& result = reconstruction.getResult();
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = settings.input;
  json["output"] = settings.output;
  json["options"] = optionsToJson(settings);
  json["points"] = data.points.size();
  json["ignored_points"] = reconstruction.getIgnoredPointCount();
  json["duplicates"] = result.duplicates;
  json["vertices"] = result.vertexCount();
  json["triangles"] = result.triangles.cols();
  json["closed"] = result.topology.closed;
  json["manifold"] = result.topology.manifold();
  json["oriented"] = result.topology.oriented;
  json["components"] = result.topology.components;
  json["genus"] = result.topology.genus ? Json(*result.topology.genus) : Json(nullptr);
  json["volume"] = result.volume;
  json["area"] = result.area;
  json["edges_outside_graph"] = result.edges_outside_graph;
  json["converged"] = reconstruction.hasConverged();
  json["stop_reason"] = nameOf(result.embedding.stop_reason);
  json["iterations"] = result.embedding.iterations;
  json["fallback_start"] = result.embedding.fallback_start;
  json["residual"] = result.embedding.residual;
  json["residuals"] = result.embedding.residuals;
  json["graph"] = graphToJson(reconstruction);
  json["triangulation"] = {{"hull_vertices", result.triangulation.hull_vertices},
                           {"reinserted", result.triangulation.reinserted},
                           {"coincident", result.triangulation.coincident},
                           {"hull_rejected", result.triangulation.hull_rejected}};
  json["stages"] = Json::array();
  for (const spherical_param::StageTime& stage : stages) {
    json["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
  }
  json["peak_memory_bytes"] = peakMemory();
  json["warnings"] = warningsOf(data, reconstruction);
  // File names need not be UTF-8, JSON must be.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string yesOrNo(bool value) {
  return value ? "yes" : "no";
}

void printVerdict(const PointData& data, const Reconstruction& reconstruction, Console& console) {
  const spherical_param::Result& result = reconstruction.getResult();
  console.entry("points", std::to_string(data.points.size()));
  console.entry("used", std::to_string(result.vertexCount()) + " (" +
                            std::to_string(result.duplicates) + " duplicate, " +
                            std::to_string(reconstruction.getIgnoredPointCount()) + " not finite)");
  console.entry("triangles", std::to_string(result.triangles.cols()));
  console.entry("closed", yesOrNo(result.topology.closed));
  console.entry("manifold", yesOrNo(result.topology.manifold()));
  console.entry("oriented", yesOrNo(result.topology.oriented));
  console.entry("genus",
                result.topology.genus ? std::to_string(*result.topology.genus) : "undefined");
  console.entry("residual", formatted(result.embedding.residual, 4));
  console.entry("converged", yesOrNo(reconstruction.hasConverged()) + " (" +
                                 nameOf(result.embedding.stop_reason) + " after " +
                                 std::to_string(result.embedding.iterations) + " iterations)");
  for (const std::string& warning : warningsOf(data, reconstruction)) {
    console.entry("warning", oneLine(warning));
  }
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText())) {
    return;
  }
  const Settings settings = parseSettings(command_line);
  checkOutputs(settings);

  Console console(!settings.quiet && !settings.jsonToStandardOutput());
  printParameters(settings, console);
  console.begin("read");
  const PointData data = readCloud(settings.input);
  std::vector<spherical_param::StageTime> stages;
  stages.push_back({"read", console.end(std::to_string(data.points.size()) + " points")});

  checkMemory(settings, data.points.size());
  Reconstruction reconstruction;
  reconstruct(settings, data, reconstruction, console);
  const spherical_param::Result& result = reconstruction.getResult();
  stages.insert(stages.end(), result.stages.begin(), result.stages.end());

  console.begin("write");
  // Only points that are vertices are written, so that every vertex of the file is used.
  const TriangleMesh mesh = {selectPoints(data, reconstruction.getVertexIndices()),
                             trianglesOf(result)};
  std::vector<std::unique_ptr<OutputFile>> files;
  files.push_back(std::make_unique<OutputFile>(settings.output));
  writeMesh(*files.back(), mesh, settings.output_format, settings.encoding);
  if (!settings.sphere.empty()) {
    files.push_back(std::make_unique<OutputFile>(settings.sphere));
    writeMesh(*files.back(), sphereOf(result, mesh), settings.sphere_format, settings.encoding);
  }
  for (const auto& file : files) {
    file->finish();
  }
  stages.push_back({"write", console.end("")});

  // Nothing gets its name before everything is stored, the report included.
  if (!settings.json.empty()) {
    const std::string text = report(settings, data, reconstruction, stages);
    if (settings.jsonToStandardOutput()) {
      printAll(text);
    } else {
      files.push_back(std::make_unique<OutputFile>(settings.json));
      files.back()->write(text);
      files.back()->finish();
    }
  }
  printVerdict(data, reconstruction, console);
  console.flush();
  for (const auto& file : files) {
    file->commit();
  }
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
