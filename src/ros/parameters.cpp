#include "spherical_param_ros/parameters.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <sstream>
#include <utility>

namespace spherical_param_ros {
namespace {

using spherical_param::EdgeWeights;
using spherical_param::EmbeddingMethod;
using spherical_param::GraphMethod;
using spherical_param::OptimizationMethod;
using spherical_param::TriangulationMethod;

/// A parameter and its place in the settings. The checks are done when `set` is called.
struct Parameter {
  ParameterInfo info;
  std::function<void(Settings&, const Value&)> set;
  std::function<Value(const Settings&)> get;
};

/// Larger lists of neighbours do nothing but take all memory.
constexpr int max_k = 1000;
constexpr int max_int = std::numeric_limits<int>::max();

const char* typeName(const Value& value) {
  constexpr const char* names[] = {"a truth value", "an integer", "a number", "a string"};
  return names[value.index()];
}

[[noreturn]] void refuse(const ParameterInfo& info, const Value& value, const std::string& wanted) {
  throw ParameterError("parameter '" + info.name + "' is " + textOf(value) + "; set it to " +
                       wanted);
}

/// What a number may be, in words.
std::string rangeOf(const ParameterInfo& info, const std::string& further) {
  std::ostringstream text;
  text << further << "a number from " << info.min << " to " << info.max;
  return text.str();
}

/// The value in the type of the parameter. \throw ParameterError
Value converted(const ParameterInfo& info, const Value& value) {
  if (std::holds_alternative<double>(info.default_value) && std::holds_alternative<int>(value))
    return static_cast<double>(std::get<int>(value));
  if (value.index() != info.default_value.index())
    throw ParameterError("parameter '" + info.name + "' is " + textOf(value) + ", " +
                         typeName(value) + "; set it to " + typeName(info.default_value) +
                         " such as " + textOf(info.default_value));
  return value;
}

/// A parameter of a fixed number of names.
template <typename Enum, typename Field>
Parameter choice(const std::string& name, const std::string& description,
                 std::vector<std::pair<std::string, Enum>> names, Field field) {
  Parameter parameter;
  const auto name_of = [names](Enum wanted) {
    for (const auto& entry : names)
      if (entry.second == wanted)
        return entry.first;
    return std::string();
  };
  Settings defaults;
  parameter.info = {name, description, Value(name_of(field(defaults))), 0.0, 0.0, {}};
  for (const auto& entry : names)
    parameter.info.choices.push_back(entry.first);
  parameter.get = [field, name_of](const Settings& settings) {
    Settings copy = settings;
    return Value(name_of(field(copy)));
  };
  parameter.set = [field, names, info = parameter.info](Settings& settings, const Value& value) {
    const auto wanted = std::get<std::string>(value);
    for (const auto& entry : names) {
      if (entry.first == wanted) {
        field(settings) = entry.second;
        return;
      }
    }
    std::string list;
    for (const auto& entry : names)
      list += (list.empty() ? "" : ", ") + entry.first;
    refuse(info, value, "one of " + list);
  };
  return parameter;
}

/// A parameter that is an integer in a range.
template <typename Field>
Parameter integer(const std::string& name, const std::string& description, int min, int max,
                  Field field) {
  Parameter parameter;
  Settings defaults;
  parameter.info = {name,        description, Value(static_cast<int>(field(defaults))),
                    double(min), double(max), {}};
  parameter.get = [field](const Settings& settings) {
    Settings copy = settings;
    return Value(static_cast<int>(field(copy)));
  };
  parameter.set = [field, min, max, info = parameter.info](Settings& settings, const Value& value) {
    const int number = std::get<int>(value);
    if (number < min || number > max)
      refuse(info, value,
             "an integer from " + std::to_string(min) +
                 (max == max_int ? " up" : " to " + std::to_string(max)));
    using Type = std::decay_t<decltype(field(settings))>;
    field(settings) = static_cast<Type>(number);
  };
  return parameter;
}

/// A parameter that is a number in a range.
template <typename Field>
Parameter real(const std::string& name, const std::string& description, double min, bool with_min,
               double max, Field field) {
  Parameter parameter;
  Settings defaults;
  parameter.info = {name, description, Value(field(defaults)), min, max, {}};
  parameter.get = [field](const Settings& settings) {
    Settings copy = settings;
    return Value(field(copy));
  };
  parameter.set = [field, min, with_min, max, info = parameter.info](Settings& settings,
                                                                     const Value& value) {
    const auto number = std::get<double>(value);
    if (!(number >= min) || !(number <= max) || (!with_min && number == min))
      refuse(info, value, rangeOf(info, with_min ? "" : "more than the least of "));
    field(settings) = number;
  };
  return parameter;
}

/// A parameter that is off at -1, or else a number of at least 0.
template <typename Field>
Parameter optionalReal(const std::string& name, const std::string& description, double max,
                       Field field) {
  Parameter parameter;
  parameter.info = {name, description, Value(-1.0), -1.0, max, {}};
  parameter.get = [field](const Settings& settings) {
    Settings copy = settings;
    return Value(field(copy).value_or(-1.0));
  };
  parameter.set = [field, max, info = parameter.info](Settings& settings, const Value& value) {
    const auto number = std::get<double>(value);
    if (number == -1.0) {
      field(settings).reset();
      return;
    }
    if (!(number >= 0.0) || !(number <= max)) {
      std::ostringstream wanted;
      wanted << "a number from 0 to " << max << ", or -1 for off";
      refuse(info, value, wanted.str());
    }
    field(settings) = number;
  };
  return parameter;
}

template <typename Field>
Parameter truth(const std::string& name, const std::string& description, Field field) {
  Parameter parameter;
  Settings defaults;
  parameter.info = {name, description, Value(bool(field(defaults))), 0.0, 0.0, {}};
  parameter.get = [field](const Settings& settings) {
    Settings copy = settings;
    return Value(bool(field(copy)));
  };
  parameter.set = [field](Settings& settings, const Value& value) {
    field(settings) = std::get<bool>(value);
  };
  return parameter;
}

Parameter neighbors() {
  Parameter parameter;
  parameter.info = {
      "k",           "Neighbours of each point, 3 and up; 0: 25 for knn, 12 for delaunay",
      Value(0),      0.0,
      double(max_k), {}};
  parameter.get = [](const Settings& settings) { return Value(settings.options.k.value_or(0)); };
  parameter.set = [info = parameter.info](Settings& settings, const Value& value) {
    const int number = std::get<int>(value);
    if (number == 0) {
      settings.options.k.reset();
      return;
    }
    if (number < 3 || number > max_k)
      refuse(info, value,
             "an integer from 3 to " + std::to_string(max_k) + ", or 0 for the default");
    settings.options.k = number;
  };
  return parameter;
}

Parameter stagnation() {
  Parameter parameter =
      integer("stagnation",
              "Iterative solver: iterations over which stagnation is judged, 2 and up; 0: never", 0,
              max_int, [](Settings& s) -> int& { return s.options.stagnation_window; });
  parameter.set = [set = parameter.set, info = parameter.info](Settings& settings,
                                                               const Value& value) {
    if (std::get<int>(value) == 1)
      refuse(info, value, "2 and up, or 0 for never: a window of 1 has nothing to compare");
    set(settings, value);
  };
  return parameter;
}

std::vector<Parameter> makeParameters() {
  std::vector<Parameter> all;
  all.push_back(choice<GraphMethod>(
      "graph", "How points become neighbours: delaunay, or knn (the paper's)",
      {{"delaunay", GraphMethod::LocalDelaunay}, {"knn", GraphMethod::NearestNeighbors}},
      [](Settings& s) -> GraphMethod& { return s.options.graph; }));
  all.push_back(neighbors());
  all.push_back(choice<EmbeddingMethod>(
      "solver", "How the graph is embedded: multilevel, or iterative (the paper's)",
      {{"multilevel", EmbeddingMethod::Multilevel}, {"iterative", EmbeddingMethod::Iterative}},
      [](Settings& s) -> EmbeddingMethod& { return s.options.solver; }));
  all.push_back(choice<EdgeWeights>("weights", "Weights of the Laplacian",
                                    {{"adaptive", EdgeWeights::Adaptive},
                                     {"uniform", EdgeWeights::Uniform},
                                     {"inverse", EdgeWeights::InverseLength}},
                                    [](Settings& s) -> EdgeWeights& { return s.options.weights; }));
  all.push_back(real("exponent", "p of adaptive weights, multilevel solver: above 2, to 16", 2.0,
                     false, 16.0, [](Settings& s) -> double& { return s.options.exponent; }));
  all.push_back(optionalReal(
      "tolerance", "Mean tangential Laplacian at convergence; -1: off (iterative: 1e-8)", 1.0,
      [](Settings& s) -> std::optional<double>& { return s.options.tolerance; }));
  all.push_back(real("lambda", "Damping of iterations and sweeps, above 0, to 1", 0.0, false, 1.0,
                     [](Settings& s) -> double& { return s.options.lambda; }));
  all.push_back(integer("iterations", "Iterative solver: iterations at most", 0, max_int,
                        [](Settings& s) -> int& { return s.options.max_iterations; }));
  all.push_back(stagnation());
  all.push_back(integer("starts", "Multilevel solver: starts of the coarsest level", 1, 100,
                        [](Settings& s) -> int& { return s.options.starts; }));
  all.push_back(integer("seed", "Seed of all that is random", 0, max_int,
                        [](Settings& s) -> std::uint32_t& { return s.options.seed; }));
  all.push_back(choice<TriangulationMethod>(
      "hull", "How the sphere is triangulated: incremental, or qhull (the paper's)",
      {{"incremental", TriangulationMethod::Incremental}, {"qhull", TriangulationMethod::Qhull}},
      [](Settings& s) -> TriangulationMethod& { return s.options.hull; }));
  all.push_back(choice<OptimizationMethod>(
      "optimize", "Optimisation of the mesh on the points: full, flips or none",
      {{"full", OptimizationMethod::Full},
       {"flips", OptimizationMethod::Flips},
       {"none", OptimizationMethod::None}},
      [](Settings& s) -> OptimizationMethod& { return s.options.optimization; }));
  all.push_back(integer("attempts", "Whole runs at most while the mesh intersects itself", 1, 100,
                        [](Settings& s) -> int& { return s.options.attempts; }));
  all.push_back(integer("smooth", "Steps of smoothing of the points that are published", 0, 10000,
                        [](Settings& s) -> int& { return s.options.smoothing_steps; }));
  all.push_back(
      optionalReal("outliers", "Leave out points so many deviations off the others; -1: off",
                   1000.0, [](Settings& s) -> std::optional<double>& { return s.outlier_sigma; }));
  all.push_back(choice<OutlierMethod>(
      "outlier_method", "How outliers are found: paper or statistical",
      {{"paper", OutlierMethod::Paper}, {"statistical", OutlierMethod::Statistical}},
      [](Settings& s) -> OutlierMethod& { return s.outlier_method; }));
  all.push_back(integer("threads", "Threads; 0: as many as there are processors", 0, 1024,
                        [](Settings& s) -> int& { return s.options.threads; }));
  all.push_back(integer("max_points", "Larger clouds are refused; 0: none is", 0, max_int,
                        [](Settings& s) -> std::size_t& { return s.max_points; }));
  all.push_back(integer("queue_depth", "Clouds that wait, at most; the oldest is dropped", 1, 1000,
                        [](Settings& s) -> std::size_t& { return s.queue_depth; }));
  all.push_back(truth("cancel_running", "A newer cloud cancels the one that is being meshed",
                      [](Settings& s) -> bool& { return s.cancel_running; }));
  all.push_back(integer("max_cancellations",
                        "So many in a row, at most; the next cloud is meshed to its end", 0, 1000,
                        [](Settings& s) -> int& { return s.max_cancellations; }));
  return all;
}

const std::vector<Parameter>& table() {
  static const std::vector<Parameter> all = makeParameters();
  return all;
}

const Parameter& find(const std::string& name) {
  std::string names;
  for (const Parameter& parameter : table()) {
    if (parameter.info.name == name)
      return parameter;
    names += (names.empty() ? "" : ", ") + parameter.info.name;
  }
  throw ParameterError("there is no parameter '" + name + "'; there are " + names);
}

}  // namespace

const std::vector<ParameterInfo>& parameters() {
  static const std::vector<ParameterInfo> all = [] {
    std::vector<ParameterInfo> infos;
    for (const Parameter& parameter : table())
      infos.push_back(parameter.info);
    return infos;
  }();
  return all;
}

void setParameter(Settings& settings, const std::string& name, const Value& value) {
  const Parameter& parameter = find(name);
  parameter.set(settings, converted(parameter.info, value));
}

Value parameterOf(const Settings& settings, const std::string& name) {
  return find(name).get(settings);
}

std::string textOf(const Value& value) {
  std::ostringstream text;
  if (const auto* truth_value = std::get_if<bool>(&value))
    text << (*truth_value ? "true" : "false");
  else if (const auto* number = std::get_if<int>(&value))
    text << *number;
  else if (const auto* real_number = std::get_if<double>(&value))
    text << *real_number;
  else
    text << "'" << std::get<std::string>(value) << "'";
  return text.str();
}

}  // namespace spherical_param_ros
