#include "common/reconstruction_options.h"

#include "common/errors.h"
#include "common/numbers.h"
#include "common/text.h"

#ifdef _OPENMP
#include <omp.h>
#endif

#include <cstdint>
#include <limits>
#include <string>

namespace spherical_param::tools {

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

namespace {

/// Tells whether the exponent has a say.
bool hasExponent(const Options& options) {
  return !isIterative(options) && options.weights == EdgeWeights::Adaptive;
}

/// Tells whether the seed has a say.
bool hasSeed(const Options& options) {
  return !isIterative(options) || options.optimization == OptimizationMethod::Full;
}

/// The tolerance in force, none if convergence is not asked for.
std::optional<double> toleranceOf(const Options& options) {
  if (!options.tolerance && isIterative(options)) {
    return EmbeddingOptions().tolerance;
  }
  return options.tolerance;
}

/// Refuses options that would change nothing, because they belong to the method that was not
/// chosen.
void checkCombination(const CommandLine& command_line, const Options& options) {
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

Options parseOptions(const CommandLine& command_line) {
  Options options;
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

}  // namespace

std::vector<OptionInfo> reconstructionOptions() {
  return {
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
      {"strict", "",
       "end with exit code 1 if there is any warning; the files are made all the same"},
      {"threads", "N", "threads, 0: as many as there are processors (0)"},
  };
}

ReconstructionSettings parseReconstructionOptions(const CommandLine& command_line) {
  ReconstructionSettings settings;
  if (command_line.has("outliers")) {
    settings.outlier_sigma =
        parseReal("outliers", command_line.value("outliers", ""), {0.0, 1000.0, true});
  }
  if (command_line.has("outlier-method")) {
    settings.outlier_method =
        parseName("outlier-method", command_line.value("outlier-method", ""), outlier_names);
  }
  settings.options = parseOptions(command_line);
  settings.strict = command_line.has("strict");
  return settings;
}

void printReconstructionOptions(const ReconstructionSettings& settings, Console& console) {
  const Options& options = settings.options;
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
  if (settings.strict) {
    console.entry("strict", "warnings are a failure");
  }
  console.entry("threads", std::to_string(options.threads));
}

Json reconstructionOptionsToJson(const ReconstructionSettings& settings) {
  const Options& options = settings.options;
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
  json["strict"] = settings.strict;
  json["threads"] = options.threads;
  return json;
}

void requireNoWarnings(
    const ReconstructionSettings& settings,
    const std::vector<std::pair<std::string, std::vector<std::string>>>& warnings) {
  std::string cause;
  for (const auto& [input, of_input] : warnings) {
    if (of_input.empty()) {
      continue;
    }
    cause += (cause.empty() ? "" : " ") + inQuotes(input) + ":";
    if (of_input.size() > 1) {
      cause += " " + std::to_string(of_input.size()) + " warnings:";
    }
    for (const std::string& warning : of_input) {
      cause += " " + warning;
    }
  }
  if (settings.strict && !cause.empty()) {
    throw Failure(cause, "the files were written; look at them, or leave out -strict");
  }
}

bool isIterative(const Options& options) {
  return options.solver == EmbeddingMethod::Iterative;
}

}  // namespace spherical_param::tools
