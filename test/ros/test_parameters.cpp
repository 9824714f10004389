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

using Values = std::vector<std::pair<std::string, Value>>;

TEST(RosParameters, AreTheRowsOfTheTableAndThoseOfTheSettings) {
  const auto& rows = spherical_param::optionTable();
  ASSERT_EQ(parameters().size(), rows.size() + 4);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Parameter& parameter = parameters()[i];
    EXPECT_EQ(parameter.name, rows[i].name);
    // A parameter has one type: numbers beside names are texts, and any text may be given.
    const bool is_mixed = rows[i].is_point || (rows[i].is_number && !rows[i].choices.empty());
    EXPECT_EQ(parameter.choices, is_mixed ? std::vector<std::string>() : rows[i].choices);
    EXPECT_EQ(parameter.min, is_mixed           ? 0.0
                             : rows[i].optional ? kUnset
                                                : rows[i].min)
        << parameter.name;
    EXPECT_EQ(parameter.max, is_mixed ? 0.0 : rows[i].max) << parameter.name;
    EXPECT_NE(parameter.description.find(rangeOf(rows[i])), std::string::npos)
        << parameter.description;
    // No value in its range means that it is not set.
    EXPECT_TRUE(!rows[i].optional || rows[i].min > kUnset) << parameter.name;
  }
}

TEST(RosParameters, DefaultsAreThoseOfThePageAndEachChangesWhatItNamesOnly) {
  struct Case {
    std::string name;
    Value usual;
    Value other;
  };
  std::vector<Case> cases = {{"outliers", std::string("topology"), std::string("4.25")},
                             {"max_points", std::int64_t{5000000}, std::int64_t{1000}},
                             {"queue_depth", std::int64_t{1}, std::int64_t{4}},
                             {"cancel_running", true, false},
                             {"max_cancellations", std::int64_t{3}, std::int64_t{9}}};
  for (const spherical_param::OptionRow& row : spherical_param::optionTable()) {
    const Value usual = parameterOf({}, row.name);
    Value other = (row.min + row.max) / 2.0;
    if (!row.choices.empty())
      other = usual == Value(row.choices.back()) ? row.choices.front() : row.choices.back();
    else if (row.is_integer)
      other = static_cast<std::int64_t>(row.min) + 7;
    cases.push_back({row.name, usual, other});
  }
  for (const auto& [name, usual, other] : cases) {
    Settings settings;
    EXPECT_EQ(parameterOf(settings, name), usual) << name;
    setParameter(settings, name, other);
    for (const Parameter& parameter : parameters())
      EXPECT_EQ(parameterOf(settings, parameter.name),
                parameter.name == name ? other : parameter.default_value)
          << name << ", " << parameter.name;
  }
}

TEST(RosParameters, AnIntegerWillDoForANumberAndWhatIsSetCanBeUnset) {
  Settings settings;
  setParameter(settings, "damping", 1);
  EXPECT_EQ(settings.options.paper.damping, 1.0);
  for (const Value& number : {Value(4), Value(4.0), Value(std::string("4"))}) {
    setParameter(settings, "outliers", number);
    EXPECT_EQ(settings.options.outliers, spherical_param::OutlierMode::Deviation);
    EXPECT_EQ(settings.options.outlier_sigma, 4.0);
    setParameter(settings, "outliers", std::string("none"));
    EXPECT_EQ(settings.options.outliers, spherical_param::OutlierMode::None);
  }
  for (const Value& unset : {Value(std::int64_t{kUnset}), Value(-1.0)})
    for (const char* name : {"time_limit", "tolerance"}) {
      setParameter(settings, name, 1);
      setParameter(settings, name, unset);
      EXPECT_EQ(parameterOf(settings, name), parameterOf({}, name)) << name;
    }
}

TEST(RosParameters, WrongOnesAreRefusedWithCauseAndRemedy) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Values wrong = {{"method", std::string("ball")},
                        {"method", 1},
                        {"k", 12.0},
                        {"damping", true},
                        {"outliers", 1000.5},
                        {"outliers", false},
                        {"outliers", nan},
                        {"max_points", -1},
                        {"max_points", std::int64_t{1} << 40},
                        {"queue_depth", 0},
                        {"cancel_running", 1},
                        {"nonsense", 1}};
  for (const auto& [name, value] : wrong) {
    Settings settings;
    try {
      setParameter(settings, name, value);
      ADD_FAILURE() << name << " = " << textOf(value) << " is taken";
    } catch (const spherical_param::InvalidInput& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(name), std::string::npos) << message;
      EXPECT_NE(message.find("; "), std::string::npos) << message;
    }
    if (name != "nonsense") {
      EXPECT_EQ(parameterOf(settings, name), parameterOf({}, name));
    }
  }
}

}  // namespace
}  // namespace spherical_param_ros
