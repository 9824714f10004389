#include "spherical_param_ros/parameters.h"

#include "spherical_param/errors.h"
#include "spherical_param/option_table.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param_ros {
namespace {

/// The message of the refusal; empty if there is none.
std::string refusal(const std::string& name, const Value& value) {
  Settings settings;
  try {
    setParameter(settings, name, value);
  } catch (const spherical_param::InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(RosParameters, DefaultsAreThoseOfTheLibrary) {
  Settings settings;
  for (const ParameterInfo& info : parameters()) {
    EXPECT_EQ(parameterOf(settings, info.name), info.default_value) << info.name;
    setParameter(settings, info.name, info.default_value);
    EXPECT_EQ(parameterOf(settings, info.name), info.default_value) << info.name;
    EXPECT_FALSE(info.description.empty());
  }
  EXPECT_FALSE(settings.options.graph.k);
  EXPECT_FALSE(settings.options.embedding.tolerance);
  EXPECT_FALSE(settings.outliers);
}

TEST(RosParameters, EveryOptionOfTheCoreIsOne) {
  const auto& rows = spherical_param::optionTable();
  ASSERT_GE(parameters().size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ParameterInfo& info = parameters()[i];
    EXPECT_EQ(info.name, rows[i].name);
    EXPECT_EQ(info.choices, rows[i].choices);
    EXPECT_NE(info.description.find(rangeOf(rows[i])), std::string::npos) << info.description;
    // No value in its range means that it is not set.
    EXPECT_TRUE(!rows[i].optional || rows[i].min > kUnset) << info.name;
  }
}

TEST(RosParameters, EachChangesWhatItNames) {
  const std::vector<std::pair<std::string, Value>> values = {
      {"graph", std::string("knn")},
      {"k", 20},
      {"embedding", std::string("iterative")},
      {"weights", std::string("uniform")},
      {"exponent", 3.5},
      {"damping", 0.25},
      {"tolerance", 1e-9},
      {"max_iterations", 100},
      {"stagnation_window", 7},
      {"starts", 3},
      {"history_vertices", 10},
      {"history_frames", 5},
      {"triangulation", std::string("qhull")},
      {"optimization", std::string("flips")},
      {"smoothing", 5},
      {"retries", 2},
      {"seed", 9},
      {"threads", 2},
      {"outliers", 4.0},
      {"max_points", 1000},
      {"queue_depth", 4},
      {"cancel_running", false},
      {"max_cancellations", 9},
  };
  for (const auto& [name, value] : values) {
    Settings settings;
    setParameter(settings, name, value);
    for (const ParameterInfo& info : parameters())
      EXPECT_EQ(parameterOf(settings, info.name), info.name == name ? value : info.default_value)
          << name << ", " << info.name;
  }
}

TEST(RosParameters, AnIntegerWillDoForANumber) {
  Settings settings;
  setParameter(settings, "exponent", 4);
  EXPECT_EQ(settings.options.embedding.exponent, 4.0);
}

TEST(RosParameters, WrongOnesAreRefusedWithCauseAndRemedy) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, Value>> wrong = {
      {"graph", std::string("gabriel")},
      {"graph", 1},
      {"k", 2},
      {"k", -2},
      {"k", 12.0},
      {"exponent", 2.0},
      {"exponent", nan},
      {"tolerance", -0.5},
      {"tolerance", 1.5},
      {"tolerance", nan},
      {"damping", 0.0},
      {"damping", 1.01},
      {"damping", true},
      {"max_iterations", -1},
      {"starts", 0},
      {"seed", -1},
      {"retries", 100},
      {"smoothing", 10001},
      {"outliers", 1000.5},
      {"outliers", nan},
      {"outliers", std::string("many")},
      {"threads", 1025},
      {"threads", std::string("many")},
      {"max_points", std::int64_t{1} << 40},
      {"queue_depth", 0},
      {"cancel_running", 1},
      {"max_cancellations", -1},
      {"nonsense", 1},
  };
  for (const auto& [name, value] : wrong) {
    const std::string message = refusal(name, value);
    EXPECT_NE(message.find(name), std::string::npos) << name << ": " << message;
    EXPECT_NE(message.find("; "), std::string::npos) << message;
  }
}

TEST(RosParameters, MinusOneUnsetsWhatIsOptional) {
  Settings settings;
  for (const char* name : {"k", "tolerance", "outliers"}) {
    setParameter(settings, name, name == std::string("k") ? 3 : 1);
    setParameter(settings, name, kUnset);
    EXPECT_EQ(refusal(name, -1.0), "");
  }
  EXPECT_FALSE(settings.options.graph.k);
  EXPECT_FALSE(settings.options.embedding.tolerance);
  EXPECT_FALSE(settings.outliers);
}

}  // namespace
}  // namespace spherical_param_ros
