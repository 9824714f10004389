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
#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using spherical_param::EdgeWeights;
using spherical_param::EmbeddingMethod;
using spherical_param::GraphMethod;
using spherical_param::Index;
using spherical_param::StopReason;
using spherical_param::TriangulationMethod;
using Reconstruction = pcl::SphericalParamReconstruction<pcl::PointXYZ>;
using Json = nlohmann::ordered_json;

const std::string tool_name = "pcl_spherical_param_reconstruction";
const std::string standard_output = "-";

const std::vector<OptionInfo> option_table = {
    {"graph", "NAME", "knn (the paper's) or delaunay (delaunay)"},
    {"k", "N", "neighbours of each point, 3 and up (25 for knn, 12 for delaunay)"},
    {"solver", "NAME", "iterative (the paper's) or multilevel (multilevel)"},
    {"weights", "NAME", "uniform, inverse or adaptive (adaptive)"},
    {"exponent", "X", "p of adaptive weights, multilevel: above 2 and up to 16 (3)"},
    {"tolerance", "X", "mean tangential Laplacian at convergence, 0 to 1 (off; iterative: 1e-8)"},
    {"lambda", "X", "damping of iterations and sweeps, above 0 and up to 1 (0.5)"},
    {"iterations", "N", "iterative: iterations at most (1600)"},
    {"stagnation", "N", "iterative: iterations over which stagnation is judged, 0: never (100)"},
    {"starts", "N", "multilevel: starts of the coarsest level, 1 to 100 (2)"},
    {"seed", "N", "multilevel: seed of the order in which nodes are taken (1)"},
    {"hull", "NAME", "qhull (the paper's) or incremental (incremental)"},
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

/// The values of an enumeration with the names that the user gives them.
template <typename Value>
using Names = std::vector<std::pair<std::string, Value>>;

const Names<GraphMethod> graph_names = {
    {"knn", GraphMethod::NearestNeighbors},
    {"delaunay", GraphMethod::LocalDelaunay},
};

const Names<EmbeddingMethod> solver_names = {
    {"iterative", EmbeddingMethod::Iterative},
    {"multilevel", EmbeddingMethod::Multilevel},
};

const Names<EdgeWeights> weight_names = {
    {"uniform", EdgeWeights::Uniform},
    {"inverse", EdgeWeights::InverseLength},
    {"adaptive", EdgeWeights::Adaptive},
};

const Names<TriangulationMethod> hull_names = {
    {"qhull", TriangulationMethod::Qhull},
    {"incremental", TriangulationMethod::Incremental},
};

template <typename Value>
Value parseName(const std::string& option, const std::string& text, const Names<Value>& names) {
  std::string known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].first == text) {
      return names[i].second;
    }
    known += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i].first;
  }
  throw UsageError("option -" + option + ": " + inQuotes(text) + " is unknown",
                   "give -" + option + " " + known);
}

template <typename Value>
std::string nameOf(Value value, const Names<Value>& names) {
  for (const auto& [name, known] : names) {
    if (known == value) {
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
  case StopReason::Unfinished:
    return "unfinished";
  }
  return "";
}

bool isIterative(const spherical_param::Options& options) {
  return options.solver == EmbeddingMethod::Iterative;
}

/// Tells whether the exponent has a say.
bool hasExponent(const spherical_param::Options& options) {
  return !isIterative(options) && options.weights == EdgeWeights::Adaptive;
}

/// The tolerance in force, none if convergence is not asked for.
std::optional<double> toleranceOf(const spherical_param::Options& options) {
  if (!options.tolerance && isIterative(options)) {
    return spherical_param::EmbeddingOptions().tolerance;
  }
  return options.tolerance;
}

/// Refuses options that would change nothing, because they belong to the method that was not
/// chosen.
void checkCombination(const CommandLine& command_line, const spherical_param::Options& options) {
  const auto refuse = [&command_line](const std::string& option, const std::string& other,
                                      const std::string& wanted) {
    if (command_line.has(option)) {
      throw UsageError("option -" + option + " does nothing with " + other,
                       "leave -" + option + " out, or give " + wanted);
    }
  };
  if (isIterative(options)) {
    for (const char* option : {"exponent", "starts", "seed"}) {
      refuse(option, "-solver iterative", "-solver multilevel");
    }
  } else {
    for (const char* option : {"iterations", "stagnation"}) {
      refuse(option, "-solver multilevel", "-solver iterative");
    }
  }
  if (options.weights != EdgeWeights::Adaptive) {
    refuse("exponent", "-weights " + nameOf(options.weights, weight_names), "-weights adaptive");
  }
}

spherical_param::Options parseOptions(const CommandLine& command_line) {
  spherical_param::Options options;
  const auto take = [&command_line](const std::string& name, auto& value, const auto& parse) {
    if (command_line.has(name)) {
      value = parse(name, command_line.value(name, ""));
    }
  };
  const auto integer = [](const IntegerRange& range) {
    return [range](const std::string& name, const std::string& text) {
      return static_cast<int>(parseInteger(name, text, range));
    };
  };
  const auto real = [](const RealRange& range) {
    return [range](const std::string& name, const std::string& text) {
      return parseReal(name, text, range);
    };
  };
  const auto one_of = [](const auto& names) {
    return [&names](const std::string& name, const std::string& text) {
      return parseName(name, text, names);
    };
  };
  take("graph", options.graph, one_of(graph_names));
  take("k", options.k, integer({3}));
  take("solver", options.solver, one_of(solver_names));
  take("weights", options.weights, one_of(weight_names));
  take("exponent", options.exponent, real({2.0, 16.0, false}));
  take("tolerance", options.tolerance, real({0.0, 1.0, true}));
  take("lambda", options.lambda, real({0.0, 1.0, false}));
  take("iterations", options.max_iterations, integer({0}));
  take("stagnation", options.stagnation_window, integer({0}));
  take("starts", options.starts, integer({1, 100}));
  take("seed", options.seed, [](const std::string& name, const std::string& text) {
    return static_cast<std::uint32_t>(
        parseInteger(name, text, {0, std::numeric_limits<std::uint32_t>::max()}));
  });
  take("hull", options.hull, one_of(hull_names));
  take("threads", options.threads, integer({0, 1024}));
  if (options.stagnation_window == 1) {
    throw UsageError("option -stagnation: a window of 1 has nothing to compare",
                     "give -stagnation 0 for never, or 2 and up");
  }
  checkCombination(command_line, options);
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
  const std::optional<double> tolerance = toleranceOf(options);
  console.entry("graph", nameOf(options.graph, graph_names));
  console.entry("k", std::to_string(neighborsToSearch(options)));
  console.entry("solver", nameOf(options.solver, solver_names));
  console.entry("weights", nameOf(options.weights, weight_names));
  if (hasExponent(options)) {
    console.entry("exponent", formatted(options.exponent, 6));
  }
  console.entry("tolerance", tolerance ? formatted(*tolerance, 6) : "off");
  console.entry("lambda", formatted(options.lambda, 6));
  if (isIterative(options)) {
    console.entry("iterations", std::to_string(options.max_iterations));
    console.entry("stagnation", options.stagnation_window == 0
                                    ? "never"
                                    : std::to_string(options.stagnation_window));
  } else {
    console.entry("starts", std::to_string(options.starts));
    console.entry("seed", std::to_string(options.seed));
  }
  console.entry("hull", nameOf(options.hull, hull_names));
  console.entry("threads", std::to_string(options.threads));
}

/// Neighbour lists take memory before anything else fails: an absurd k is told first.
void checkMemory(const Settings& settings, std::size_t points) {
  constexpr std::uint64_t entry_limit = std::uint64_t{1} << 31;
  const std::uint64_t neighbors = std::min(
      static_cast<std::uint64_t>(neighborsToSearch(settings.options)), std::uint64_t{points});
  if (neighbors * points > entry_limit) {
    throw Failure("option -k: " + std::to_string(neighbors) + " neighbours of each of " +
                      std::to_string(points) + " points do not fit into memory",
                  "leave -k out, its default will do");
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
  reconstruction.setGraphMethod(options.graph);
  reconstruction.setKSearch(neighborsToSearch(options));
  reconstruction.setSolver(options.solver);
  reconstruction.setWeights(options.weights);
  reconstruction.setExponent(options.exponent);
  if (options.tolerance) {
    reconstruction.setTolerance(*options.tolerance);
  }
  reconstruction.setLambda(options.lambda);
  reconstruction.setMaximumIterations(options.max_iterations);
  reconstruction.setStagnationWindow(options.stagnation_window);
  reconstruction.setStarts(options.starts);
  reconstruction.setSeed(options.seed);
  reconstruction.setTriangulationMethod(options.hull);
  reconstruction.setNumberOfThreads(static_cast<unsigned>(options.threads));
  std::string stage;
  std::string detail;
  reconstruction.setProgressCallback([&](const spherical_param::Progress& progress) {
    if (stage != progress.stage) {
      stage = progress.stage;
      detail.clear();
      console.begin(stage);
    }
    if (progress.residual > 0.0) {
      detail = (progress.iteration > 0 ? "iteration " + std::to_string(progress.iteration) + ", "
                                       : std::string()) +
               "residual " + formatted(progress.residual, 3);
    }
    if (progress.fraction < 1.0) {
      console.update(progress.fraction, detail);
    } else {
      // The last that the multilevel solver told may be the residual of a coarser level.
      console.end(isIterative(options) ? detail : "");
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
  const std::optional<double> tolerance = toleranceOf(options);
  // What has no say with the chosen method is null.
  const auto unless = [](bool idle, const Json& value) { return idle ? Json(nullptr) : value; };
  json["graph"] = nameOf(options.graph, graph_names);
  json["k"] = neighborsToSearch(options);
  json["solver"] = nameOf(options.solver, solver_names);
  json["weights"] = nameOf(options.weights, weight_names);
  json["exponent"] = unless(!hasExponent(options), options.exponent);
  json["tolerance"] = tolerance ? Json(*tolerance) : Json(nullptr);
  json["lambda"] = options.lambda;
  json["iterations"] = unless(!isIterative(options), options.max_iterations);
  json["stagnation"] = unless(!isIterative(options), options.stagnation_window);
  json["starts"] = unless(isIterative(options), options.starts);
  json["seed"] = unless(isIterative(options), options.seed);
  json["hull"] = nameOf(options.hull, hull_names);
  json["threads"] = options.threads;
  json["sphere"] = settings.sphere.empty() ? Json(nullptr) : Json(settings.sphere);
  json["json"] = settings.json;
  json["ascii"] = settings.encoding == Encoding::Ascii;
  json["quiet"] = settings.quiet;
  return json;
}

Json graphToJson(const Settings& settings, const Reconstruction& reconstruction) {
  const spherical_param::GraphReport& graph = reconstruction.getResult().graph;
  const pcl::Indices& cloud_indices = reconstruction.getVertexIndices();
  const auto index_of = [&cloud_indices](Index vertex) {
    return cloud_indices[static_cast<std::size_t>(vertex)];
  };
  Json json;
  json["method"] = nameOf(settings.options.graph, graph_names);
  json["edges"] = graph.edges;
  json["components"] = graph.components;
  json["bridges"] = Json::array();
  for (const spherical_param::Bridge& bridge : graph.bridges) {
    json["bridges"].push_back(
        {{"from", index_of(bridge.from)}, {"to", index_of(bridge.to)}, {"length", bridge.length}});
  }
  json["without_tangent_plane_count"] = graph.without_tangent_plane.size();
  json["without_tangent_plane"] = Json::array();
  for (const Index vertex : graph.without_tangent_plane) {
    json["without_tangent_plane"].push_back(index_of(vertex));
  }
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

/// Tells whether the solver held the centroid of the sphere, so that it did not collapse.
bool hasBarrier(const Settings& settings, const spherical_param::EmbeddingReport& embedding) {
  return !embedding.levels.empty() &&
         (embedding.added_barrier || settings.options.weights != EdgeWeights::Adaptive);
}

Json embeddingToJson(const Settings& settings, const Reconstruction& reconstruction) {
  const spherical_param::EmbeddingReport& embedding = reconstruction.getResult().embedding;
  const std::vector<spherical_param::LevelReport>& levels = embedding.levels;
  Json json;
  json["solver"] = nameOf(settings.options.solver, solver_names);
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
  json["graph"] = graphToJson(settings, reconstruction);
  json["embedding"] = embeddingToJson(settings, reconstruction);
  json["triangulation"] = {{"method", nameOf(settings.options.hull, hull_names)},
                           {"hull_vertices", result.triangulation.hull_vertices},
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

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

void printGraph(const Settings& settings, const spherical_param::GraphReport& graph,
                Console& console) {
  console.entry("graph edges",
                std::to_string(graph.edges) + " (" +
                    counted(static_cast<std::size_t>(graph.components), "component") + ", " +
                    counted(graph.bridges.size(), "bridge") + ")");
  if (settings.options.graph == GraphMethod::LocalDelaunay) {
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

/// Whether the embedding converged, and why it ended.
std::string convergence(const Settings& settings, const Reconstruction& reconstruction) {
  const spherical_param::EmbeddingReport& embedding = reconstruction.getResult().embedding;
  if (embedding.stop_reason == StopReason::Unfinished) {
    return "not asked for (-tolerance does)";
  }
  const std::string steps =
      embedding.levels.empty()
          ? counted(static_cast<std::size_t>(embedding.iterations), "iteration")
          : counted(static_cast<std::size_t>(embedding.levels.front().newton_iterations),
                    "Newton iteration");
  return yesOrNo(reconstruction.hasConverged()) + " (" + nameOf(embedding.stop_reason) + " after " +
         steps + (hasBarrier(settings, embedding) ? ", the pull of a barrier is left)" : ")");
}

void printVerdict(const Settings& settings, const PointData& data,
                  const Reconstruction& reconstruction, Console& console) {
  const spherical_param::Result& result = reconstruction.getResult();
  printHierarchy(result.embedding.levels, console);
  console.entry("points", std::to_string(data.points.size()));
  console.entry("used", std::to_string(result.vertexCount()) + " (" +
                            std::to_string(result.duplicates) + " duplicate, " +
                            std::to_string(reconstruction.getIgnoredPointCount()) + " not finite)");
  printGraph(settings, result.graph, console);
  if (!result.embedding.levels.empty()) {
    console.entry("starts tried",
                  std::to_string(result.embedding.starts) + " (" +
                      std::to_string(result.embedding.collapsed_starts) + " collapsed)" +
                      (hasBarrier(settings, result.embedding) ? ", with a barrier" : ""));
    console.entry("energy", formatted(result.embedding.energy, 6));
  }
  console.entry("residual", formatted(result.embedding.residual, 4));
  console.entry("converged", convergence(settings, reconstruction));
  console.entry("hull vertices",
                std::to_string(result.triangulation.hull_vertices) + " (" +
                    std::to_string(result.triangulation.reinserted) + " put back, " +
                    std::to_string(result.triangulation.coincident) + " coincident)");
  console.entry("triangles", std::to_string(result.triangles.cols()));
  console.entry("closed", yesOrNo(result.topology.closed));
  console.entry("manifold", yesOrNo(result.topology.manifold()));
  console.entry("oriented", yesOrNo(result.topology.oriented));
  console.entry("genus",
                result.topology.genus ? std::to_string(*result.topology.genus) : "undefined");
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
  printVerdict(settings, data, reconstruction, console);
  console.flush();
  for (const auto& file : files) {
    file->commit();
  }
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
