#include "spherical_param_ros/parameters.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

namespace spherical_param_ros {
namespace {

/// The message of the refusal; empty if the value is taken.
std::string refusal(const std::string& name, const Value& value) {
  Settings settings;
  try {
    setParameter(settings, name, value);
  } catch (const ParameterError& error) {
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
  EXPECT_FALSE(settings.options.k);
  EXPECT_FALSE(settings.options.tolerance);
  EXPECT_FALSE(settings.outlier_sigma);
}

TEST(RosParameters, EachChangesWhatItNames) {
  const std::vector<std::pair<std::string, Value>> values = {
      {"graph", std::string("knn")},
      {"k", 20},
      {"solver", std::string("iterative")},
      {"weights", std::string("uniform")},
      {"exponent", 3.5},
      {"tolerance", 1e-9},
      {"lambda", 0.25},
      {"iterations", 100},
      {"stagnation", 7},
      {"starts", 3},
      {"seed", 9},
      {"hull", std::string("qhull")},
      {"optimize", std::string("flips")},
      {"attempts", 2},
      {"smooth", 5},
      {"outliers", 4.0},
      {"outlier_method", std::string("statistical")},
      {"threads", 2},
      {"max_points", 1000},
      {"queue_depth", 4},
      {"cancel_running", false},
      {"max_cancellations", 9},
  };
  // None is forgotten, neither there nor here.
  ASSERT_EQ(values.size(), parameters().size());
  for (const auto& [name, value] : values) {
    Settings settings;
    setParameter(settings, name, value);
    for (const ParameterInfo& info : parameters())
      EXPECT_EQ(parameterOf(settings, info.name), info.name == name ? value : info.default_value)
          << name << ", " << info.name;
  }
}

TEST(RosParameters, IntegersDoForNumbers) {
  Settings settings;
  setParameter(settings, "exponent", 4);
  EXPECT_EQ(settings.options.exponent, 4.0);
}

TEST(RosParameters, WrongOnesAreRefusedWithCauseAndRemedy) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, Value>> wrong = {
      {"graph", std::string("gabriel")},
      {"graph", 1},
      {"k", 2},
      {"k", -1},
      {"k", 1000000000},
      {"k", 12.0},
      {"exponent", 2.0},
      {"exponent", nan},
      {"tolerance", -0.5},
      {"tolerance", 1.5},
      {"tolerance", nan},
      {"lambda", 0.0},
      {"lambda", 1.01},
      {"iterations", -1},
      {"stagnation", 1},
      {"starts", 0},
      {"seed", -1},
      {"attempts", 101},
      {"smooth", 10001},
      {"outliers", 1000.5},
      {"threads", 1025},
      {"queue_depth", 0},
      {"cancel_running", 1},
      {"max_cancellations", -1},
      {"nonsense", 1},
  };
  for (const auto& [name, value] : wrong) {
    const std::string message = refusal(name, value);
    EXPECT_NE(message.find("'" + name + "'"), std::string::npos) << name << ": " << message;
    EXPECT_NE(message.find("; "), std::string::npos) << message;
  }
}

TEST(RosParameters, ListOfDynamicReconfigureNamesAll) {
  std::ifstream file(SPHERICAL_PARAM_SOURCE_DIR "/src/ros/ros1/cfg/SphericalParam.cfg");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::size_t count = 0;
  for (std::size_t at = text.find("gen.add("); at != std::string::npos;
       at = text.find("gen.add(", at + 1))
    ++count;
  EXPECT_EQ(count, parameters().size());
  for (const ParameterInfo& info : parameters())
    EXPECT_NE(text.find("gen.add('" + info.name + "'"), std::string::npos) << info.name;
}

}  // namespace
}  // namespace spherical_param_ros
