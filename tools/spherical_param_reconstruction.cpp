// pcl_spherical_param_reconstruction: meshes the point cloud of a file.

#include "common/cloud_reader.h"
#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/mesh_writer.h"
#include "common/numbers.h"
#include "common/outlier_removal.h"
#include "common/output_file.h"
#include "common/peak_memory.h"
#include "common/point_data.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <Eigen/Geometry>

#include <nlohmann/json.hpp>

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
using spherical_param::OptimizationMethod;
using spherical_param::SmoothingMethod;
using spherical_param::StopReason;
using spherical_param::SurfaceKind;
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
    {"seed", "N", "seed of all that is random: multilevel, optimize full (1)"},
    {"hull", "NAME", "qhull (the paper's) or incremental (incremental)"},
    {"optimize", "NAME", "of the mesh on the points: none, flips or full (full)"},
    {"attempts", "N", "whole runs at most while the mesh intersects itself, 1 to 100 (4)"},
    {"smooth", "N", "smooth the points that are written, steps, up to 10000; keeps normals (0)"},
    {"outliers", "SIGMA", "leave out points so many deviations off the others, up to 1000 (off)"},
    {"outlier-method", "NAME", "with outliers: paper or statistical (paper)"},
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
  std::optional<double> outlier_sigma;  ///< none: outliers are not looked for
  OutlierMethod outlier_method = OutlierMethod::Paper;
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

const Names<OptimizationMethod> optimization_names = {
    {"none", OptimizationMethod::None},
    {"flips", OptimizationMethod::Flips},
    {"full", OptimizationMethod::Full},
};

const Names<OutlierMethod> outlier_names = {
    {"paper", OutlierMethod::Paper},
    {"statistical", OutlierMethod::Statistical},
};

const Names<SmoothingMethod> smoothing_names = {
    {"umbrella", SmoothingMethod::Umbrella},
    {"taubin", SmoothingMethod::Taubin},
    {"biharmonic", SmoothingMethod::Biharmonic},
};

const Names<SurfaceKind> surface_names = {
    {"closed genus 0", SurfaceKind::ClosedGenus0},
    {"open", SurfaceKind::Open},
    {"handles", SurfaceKind::Handles},
    {"several parts", SurfaceKind::SeveralParts},
    {"unclear", SurfaceKind::Unclear},
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

/// Tells whether the seed has a say.
bool hasSeed(const spherical_param::Options& options) {
  return !isIterative(options) || options.optimization == OptimizationMethod::Full;
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
    for (const char* option : {"exponent", "starts"}) {
      refuse(option, "-solver iterative", "-solver multilevel");
    }
    if (!hasSeed(options)) {
      refuse("seed",
             "-solver iterative and -optimize " + nameOf(options.optimization, optimization_names),
             "-optimize full");
    }
  } else {
    for (const char* option : {"iterations", "stagnation"}) {
      refuse(option, "-solver multilevel", "-solver iterative");
    }
  }
  if (options.weights != EdgeWeights::Adaptive) {
    refuse("exponent", "-weights " + nameOf(options.weights, weight_names), "-weights adaptive");
  }
  if (command_line.has("outlier-method") && !command_line.has("outliers")) {
    throw UsageError("option -outlier-method does nothing without -outliers",
                     "leave -outlier-method out, or give -outliers 4");
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
  take("optimize", options.optimization, one_of(optimization_names));
  take("attempts", options.attempts, integer({1, 100}));
  take("smooth", options.smoothing_steps, integer({0, 10000}));
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
  if (command_line.has("outliers")) {
    settings.outlier_sigma =
        parseReal("outliers", command_line.value("outliers", ""), {0.0, 1000.0, true});
  }
  if (command_line.has("outlier-method")) {
    settings.outlier_method =
        parseName("outlier-method", command_line.value("outlier-method", ""), outlier_names);
  }
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
  }
  if (hasSeed(options)) {
    console.entry("seed", std::to_string(options.seed));
  }
  console.entry("hull", nameOf(options.hull, hull_names));
  console.entry("optimize", nameOf(options.optimization, optimization_names));
  console.entry("attempts", "up to " + std::to_string(options.attempts));
  if (options.smoothing_steps > 0) {
    console.entry("smooth", std::to_string(options.smoothing_steps));
  }
  if (settings.outlier_sigma) {
    console.entry("outliers", formatted(*settings.outlier_sigma, 6) + " (" +
                                  nameOf(settings.outlier_method, outlier_names) + ")");
  }
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

/// Looks for outliers.
OutlierRemoval removeOutliers(const Settings& settings, const PointData& data) {
  OutlierRemoval removal = findOutlierPoints(data.points, settings.outlier_method,
                                             *settings.outlier_sigma, settings.options.threads);
  // Without outliers, the library itself says what the points lack.
  if (removal.kept_positions < 4 && !removal.indices.empty()) {
    throw Failure("option -outliers: " + std::to_string(removal.indices.size()) + " of " +
                      std::to_string(data.points.size()) +
                      " points are outliers, and the rest cannot be meshed",
                  "give -outliers a larger number");
  }
  return removal;
}

/// The stages and their shares of the time for a million points, in hundredths.
std::vector<std::pair<std::string, double>> stagesOf(const Settings& settings) {
  std::vector<std::pair<std::string, double>> stages = {{"read", 1.0}};
  if (settings.outlier_sigma) {
    stages.emplace_back("outliers", 20.0);
  }
  stages.insert(stages.end(), {{"neighbors", 19.0},
                               {"graph", 18.0},
                               {"embedding", 18.0},
                               {"triangulation", 3.0},
                               {"optimization", 36.0}});
  if (settings.options.smoothing_steps > 0) {
    stages.emplace_back("smoothing", 10.0);
  }
  stages.insert(stages.end(), {{"check", 3.0}, {"write", 2.0}});
  return stages;
}

/// Runs the library on the points that are no outliers, with its stages on the console.
void reconstruct(const Settings& settings, const PointData& data,
                 const std::optional<OutlierRemoval>& outliers, Reconstruction& reconstruction,
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
  reconstruction.setOptimization(options.optimization);
  reconstruction.setAttempts(options.attempts);
  reconstruction.setSmoothingSteps(options.smoothing_steps);
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
  if (outliers) {
    // All indices are still those of the file.
    reconstruction.setIndices(pcl::IndicesPtr(new pcl::Indices(outliers->kept)));
  }
  reconstruction.reconstruct();
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

/// The mesh that is written. Only points that are vertices are, so that every vertex of the file is
/// used.
MeshView meshOf(const PointData& data, const Reconstruction& reconstruction) {
  const spherical_param::Result& result = reconstruction.getResult();
  MeshView mesh(data, reconstruction.getVertexIndices(), result.triangles);
  if (result.smoothed.cols() > 0) {
    mesh.moveTo(result.smoothed);
  }
  return mesh;
}

/// The vertices on the sphere. They keep their colours, but not the normals of the input, which
/// mean nothing there.
MeshView sphereOf(const PointData& data, const Reconstruction& reconstruction) {
  const spherical_param::Result& result = reconstruction.getResult();
  MeshView sphere(data, reconstruction.getVertexIndices(), result.triangles);
  sphere.leaveOutNormals();
  sphere.moveTo(result.sphere);
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
  json["seed"] = unless(!hasSeed(options), options.seed);
  json["hull"] = nameOf(options.hull, hull_names);
  json["optimize"] = nameOf(options.optimization, optimization_names);
  json["attempts"] = options.attempts;
  json["smooth"] = options.smoothing_steps;
  json["outliers"] = settings.outlier_sigma ? Json(*settings.outlier_sigma) : Json(nullptr);
  json["outlier_method"] =
      unless(!settings.outlier_sigma, nameOf(settings.outlier_method, outlier_names));
  json["threads"] = options.threads;
  json["sphere"] = settings.sphere.empty() ? Json(nullptr) : Json(settings.sphere);
  json["json"] = settings.json;
  json["ascii"] = settings.encoding == Encoding::Ascii;
  json["quiet"] = settings.quiet;
  return json;
}

/// The indices of vertices in the input.
std::vector<int> inputIndices(const Reconstruction& reconstruction,
                              const std::vector<Index>& vertices) {
  std::vector<int> indices;
  indices.reserve(vertices.size());
  for (const Index vertex : vertices) {
    indices.push_back(reconstruction.getVertexIndices()[static_cast<std::size_t>(vertex)]);
  }
  return indices;
}

Json toJson(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
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
  json["without_tangent_plane"] = inputIndices(reconstruction, graph.without_tangent_plane);
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

/// The first pairs of triangles that intersect.
Json selfIntersectionsToJson(const Reconstruction& reconstruction) {
  constexpr std::size_t most_pairs = 1000;
  const auto& pairs = reconstruction.getSelfIntersections();
  Json json = Json::array();
  for (std::size_t i = 0; i < std::min(most_pairs, pairs.size()); ++i) {
    json.push_back({pairs[i][0], pairs[i][1]});
  }
  return json;
}

Json optimizationToJson(const Settings& settings,
                        const spherical_param::OptimizationReport& optimization) {
  Json json;
  json["method"] = nameOf(settings.options.optimization, optimization_names);
  json["energy"] = optimization.energy;
  json["rough"] = optimization.rough;
  json["noisy"] = optimization.noise_steps > 0;
  json["noise_steps"] = optimization.noise_steps;
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

Json attemptsToJson(const std::vector<spherical_param::AttemptReport>& attempts) {
  Json json = Json::array();
  for (const spherical_param::AttemptReport& attempt : attempts) {
    json.push_back({{"description", attempt.description},
                    {"self_intersections", attempt.self_intersections},
                    {"energy", attempt.energy},
                    {"seconds", attempt.seconds},
                    {"chosen", attempt.chosen}});
  }
  return json;
}

Json smoothingToJson(const Settings& settings, const spherical_param::SmoothingReport& smoothing) {
  if (settings.options.smoothing_steps == 0) {
    return nullptr;
  }
  return {{"steps", settings.options.smoothing_steps},
          {"method", nameOf(spherical_param::SmoothingOptions().method, smoothing_names)},
          {"max_displacement", smoothing.max_displacement},
          {"mean_displacement", smoothing.mean_displacement},
          {"rms_displacement", smoothing.rms_displacement},
          {"volume_before", smoothing.volume_before},
          {"volume_after", smoothing.volume_after},
          {"self_intersections", smoothing.self_intersections}};
}

Json diagnosisToJson(const Reconstruction& reconstruction) {
  const spherical_param::SurfaceDiagnosis& diagnosis = reconstruction.getDiagnosis();
  Json json;
  json["kind"] = nameOf(diagnosis.kind, surface_names);
  json["looks_closed_genus0"] = diagnosis.looksClosedGenus0();
  json["summary"] = diagnosis.summary;
  json["lids"] = Json::array();
  for (const spherical_param::Lid& lid : diagnosis.lids) {
    json["lids"].push_back({{"cause", nameOf(lid.cause, surface_names)},
                            {"location", toJson(lid.center)},
                            {"size", lid.diameter},
                            {"spacing", lid.spacing},
                            {"triangles", lid.triangles},
                            {"area", lid.area},
                            {"boundary_length", lid.boundary_length},
                            {"vertices", inputIndices(reconstruction, lid.vertices)}});
  }
  json["handles"] = Json::array();
  for (const spherical_param::CollapsedHandle& handle : diagnosis.handles) {
    json["handles"].push_back({{"location", toJson(handle.center)},
                               {"size", handle.size},
                               {"edges", handle.edges},
                               {"vertices", inputIndices(reconstruction, handle.vertices)}});
  }
  json["bridges"] = Json::array();
  for (const spherical_param::PartBridge& bridge : diagnosis.bridges) {
    json["bridges"].push_back({{"location", toJson(bridge.center)},
                               {"size", bridge.gap},
                               {"spacing", bridge.spacing},
                               {"points", bridge.points},
                               {"other_points", bridge.other_points},
                               {"vertices", inputIndices(reconstruction, bridge.vertices)}});
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
  return {{"method", nameOf(settings.outlier_method, outlier_names)},
          {"sigma", *settings.outlier_sigma},
          {"threshold", outliers->threshold ? Json(*outliers->threshold) : Json(nullptr)},
          {"count", outliers->indices.size()},
          {"indices", outliers->indices}};
}

std::string report(const Settings& settings, const PointData& data,
                   const std::optional<OutlierRemoval>& outliers,
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
  json["outliers"] = outliersToJson(settings, outliers);
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
  json["self_intersections"] = reconstruction.getSelfIntersections().size();
  json["self_intersecting_pairs"] = selfIntersectionsToJson(reconstruction);
  json["measures"] = measuresToJson(result.measures);
  json["diagnosis"] = diagnosisToJson(reconstruction);
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
  json["optimization"] = optimizationToJson(settings, result.optimization);
  json["attempts"] = attemptsToJson(result.attempts);
  json["smoothing"] = smoothingToJson(settings, result.smoothing);
  json["stages"] = Json::array();
  for (const spherical_param::StageTime& stage : stages) {
    json["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
  }
  const std::optional<std::uint64_t> peak_memory = peakMemory();
  json["peak_memory_bytes"] = peak_memory ? Json(*peak_memory) : Json(nullptr);
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

/// Prints the phases of the optimisation, in the style of the levels.
void printPhases(const std::vector<spherical_param::OptimizationPhase>& phases, Console& console) {
  if (phases.empty()) {
    return;
  }
  const std::string head = "phase          tried      moves       energy  self-int.  seconds";
  console.heading("  " + head);
  console.heading("  " + std::string(head.size(), '-'));
  for (const spherical_param::OptimizationPhase& phase : phases) {
    const std::string self_intersections =
        phase.self_intersections ? std::to_string(*phase.self_intersections) : "";
    std::array<char, 128> line{};
    std::snprintf(line.data(), line.size(), "  %-9s %10zu %10zu %12s %10s %8.3f",
                  phase.name.c_str(), phase.tried, phase.moves, formatted(phase.energy, 6).c_str(),
                  self_intersections.c_str(), phase.seconds);
    console.heading(line.data());
  }
  console.heading("");
}

/// How the mesh was optimised.
std::string optimized(const Settings& settings,
                      const spherical_param::OptimizationReport& optimization) {
  if (settings.options.optimization == OptimizationMethod::None) {
    return "no (-optimize none)";
  }
  return nameOf(settings.options.optimization, optimization_names) + ", energy " +
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

void printAttempts(const std::vector<spherical_param::AttemptReport>& attempts, Console& console) {
  // Of one alone the other lines tell all.
  for (std::size_t i = 0; attempts.size() > 1 && i < attempts.size(); ++i) {
    console.entry("attempt " + std::to_string(i + 1),
                  oneLine(attempts[i].description) + ": " +
                      counted(attempts[i].self_intersections, "self-intersection") + ", energy " +
                      formatted(attempts[i].energy, 6) + (attempts[i].chosen ? ", chosen" : ""));
  }
}

void printSmoothing(const Settings& settings, const spherical_param::SmoothingReport& smoothing,
                    Console& console) {
  if (settings.options.smoothing_steps == 0) {
    return;
  }
  console.entry("smoothed",
                counted(static_cast<std::size_t>(settings.options.smoothing_steps), "step") +
                    ", points moved by " + formatted(smoothing.mean_displacement, 3) + " (mean), " +
                    formatted(smoothing.max_displacement, 3) + " (max)");
  console.entry("", "volume " + formatted(smoothing.volume_before, 6) + " -> " +
                        formatted(smoothing.volume_after, 6) + ", " +
                        counted(smoothing.self_intersections, "self-intersection"));
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
                  const std::optional<OutlierRemoval>& outliers,
                  const Reconstruction& reconstruction, Console& console) {
  const spherical_param::Result& result = reconstruction.getResult();
  printHierarchy(result.embedding.levels, console);
  printPhases(result.optimization.phases, console);
  console.entry("points", std::to_string(data.points.size()));
  if (outliers) {
    console.entry("outliers", std::to_string(outliers->indices.size()) + " left out");
  }
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
  printAttempts(result.attempts, console);
  console.entry("optimised", optimized(settings, result.optimization));
  console.entry("self-intersections", std::to_string(reconstruction.getSelfIntersections().size()));
  printSmoothing(settings, result.smoothing, console);
  console.entry("looks like", appearance(result.diagnosis));
  console.entry("volume", formatted(result.measures.volume, 6));
  console.entry("area", formatted(result.measures.area, 6));
  console.entry("bounding box",
                listed(result.measures.box_min) + " to " + listed(result.measures.box_max));
  console.entry("centroid", listed(result.measures.centroid));
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
  console.plan(stagesOf(settings));
  console.begin("read");
  const PointData data =
      readCloud(settings.input, [&console](double share) { console.update(share, ""); });
  std::vector<spherical_param::StageTime> stages;
  stages.push_back({"read", console.end(std::to_string(data.points.size()) + " points")});

  checkMemory(settings, data.points.size());
  std::optional<OutlierRemoval> outliers;
  if (settings.outlier_sigma) {
    console.begin("outliers");
    outliers = removeOutliers(settings, data);
    stages.push_back(
        {"outliers", console.end(counted(outliers->indices.size(), "point") + " left out")});
  }
  Reconstruction reconstruction;
  reconstruct(settings, data, outliers, reconstruction, console);
  const spherical_param::Result& result = reconstruction.getResult();
  stages.insert(stages.end(), result.stages.begin(), result.stages.end());

  console.begin("write");
  // The mesh, and the sphere if it is wanted, are halves of one stage.
  const double share_of_file = settings.sphere.empty() ? 1.0 : 0.5;
  std::vector<std::unique_ptr<OutputFile>> files;
  files.push_back(std::make_unique<OutputFile>(settings.output));
  writeMesh(*files.back(), meshOf(data, reconstruction), settings.output_format, settings.encoding,
            [&](double share) { console.update(share_of_file * share, ""); });
  if (!settings.sphere.empty()) {
    files.push_back(std::make_unique<OutputFile>(settings.sphere));
    writeMesh(*files.back(), sphereOf(data, reconstruction), settings.sphere_format,
              settings.encoding, [&](double share) { console.update(0.5 + 0.5 * share, ""); });
  }
  for (const auto& file : files) {
    file->finish();
  }
  stages.push_back({"write", console.end("")});

  // Nothing gets its name before everything is stored, the report included.
  if (!settings.json.empty()) {
    const std::string text = report(settings, data, outliers, reconstruction, stages);
    if (settings.jsonToStandardOutput()) {
      printAll(text);
    } else {
      files.push_back(std::make_unique<OutputFile>(settings.json));
      files.back()->write(text);
      files.back()->finish();
    }
  }
  printVerdict(settings, data, outliers, reconstruction, console);
  console.flush();
  for (const auto& file : files) {
    file->commit();
  }
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
