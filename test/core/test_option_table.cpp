#include "spherical_param/option_table.h"

#include "helpers.h"
#include "spherical_param/errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace spherical_param {
namespace {

OptionValue numberOf(const OptionRow& row, double number) {
  return row.is_integer ? OptionValue(static_cast<std::int64_t>(number)) : OptionValue(number);
}

/// Values at the ends of the range, or all choices.
std::vector<OptionValue> goodValues(const OptionRow& row) {
  std::vector<OptionValue> values(row.choices.begin(), row.choices.end());
  if (row.choices.empty()) {
    const double infinity = std::numeric_limits<double>::infinity();
    const double min = row.min_excluded ? std::nextafter(row.min, infinity) : row.min;
    values = {numberOf(row, min), numberOf(row, row.max)};
  }
  if (row.optional)
    values.emplace_back();
  return values;
}

/// Values out of range or of another kind.
std::vector<OptionValue> badValues(const OptionRow& row) {
  if (!row.choices.empty())
    return {std::string("no choice"), std::int64_t{0}, 0.5, OptionValue()};
  std::vector<OptionValue> values{std::string("three"), numberOf(row, row.min - 1.0),
                                  numberOf(row, row.max + 1.0),
                                  std::numeric_limits<double>::quiet_NaN()};
  if (row.min_excluded)
    values.push_back(numberOf(row, row.min));
  if (row.is_integer)
    values.emplace_back(row.min + 0.5);
  if (!row.optional)
    values.emplace_back();
  return values;
}

template <typename Call>
void expectRefusal(const Call& call, const std::string& name) {
  try {
    call();
    ADD_FAILURE() << name << " was not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
  }
}

TEST(OptionTable, DefaultsAreInRange) {
  for (const OptionRow& row : optionTable()) {
    Options options;
    EXPECT_NO_THROW(setOption(options, row.name, row.get(options))) << row.name;
  }
  EXPECT_NO_THROW(checkOptions({}));
}

TEST(OptionTable, NamesAndFieldsOccurOnce) {
  std::set<std::string> names;
  std::set<std::string> fields;
  for (const OptionRow& row : optionTable()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(fields.insert(row.field).second) << row.field;
    EXPECT_EQ(&findOption(row.name), &row);
    EXPECT_FALSE(row.help.empty());
    EXPECT_FALSE(rangeOf(row).empty());
    for (const auto& [other, value] : row.used_with)
      EXPECT_NO_THROW(findOption(other)) << row.name;
  }
}

TEST(OptionTable, AValueThatIsSetIsReadBackAndChangesNoOtherOption) {
  for (const OptionRow& row : optionTable())
    for (const OptionValue& value : goodValues(row)) {
      Options options;
      setOption(options, row.name, value);
      EXPECT_EQ(row.get(options), value) << row.name << " = " << textOf(value);
      EXPECT_NO_THROW(checkOptions(options)) << row.name << " = " << textOf(value);
      for (const OptionRow& other : optionTable())
        if (other.name != row.name) {
          EXPECT_EQ(other.get(options), other.get(Options())) << row.name << " " << other.name;
        }
    }
}

TEST(OptionTable, AnIntegerWillDoForANumber) {
  Options options;
  setOption(options, "exponent", std::int64_t{4});
  EXPECT_EQ(options.embedding.exponent, 4.0);
}

TEST(OptionTable, BadValuesAreRefusedByName) {
  for (const OptionRow& row : optionTable())
    for (const OptionValue& value : badValues(row)) {
      Options options;
      expectRefusal([&] { setOption(options, row.name, value); }, row.name);
      EXPECT_EQ(row.get(options), row.get(Options())) << row.name;
    }
  Options options;
  expectRefusal([&] { setOption(options, "solver", std::string("iterative")); }, "solver");
  expectRefusal([] { findOption("solver"); }, "solver");
}

TEST(OptionTable, NestedOptionsAreCheckedWithoutRunningAStage) {
  const auto refuses = [](const std::string& name, const auto& change) {
    Options options;
    change(options);
    expectRefusal([&] { checkOptions(options); }, name);
    // reconstruct() checks them before the points.
    expectRefusal([&] { reconstruct(Positions(3, 0), options); }, name);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuses("k", [](Options& o) { o.graph.k = 2; });
  refuses("graph", [](Options& o) { o.graph.method = static_cast<GraphMethod>(2); });
  refuses("agreement", [](Options& o) { o.graph.agreement = static_cast<StarAgreement>(-1); });
  refuses("damping", [](Options& o) { o.embedding.damping = 0.0; });
  refuses("tolerance", [=](Options& o) { o.embedding.tolerance = nan; });
  refuses("exponent", [](Options& o) { o.embedding.exponent = 2.0; });
  refuses("exponent", [](Options& o) {
    o.embedding.method = EmbeddingMethod::Iterative;
    o.embedding.exponent = 4.0;
  });
  refuses("max_iterations", [](Options& o) { o.embedding.max_iterations = -1; });
  refuses("stagnation_window", [](Options& o) { o.embedding.stagnation_window = -1; });
  refuses("starts", [](Options& o) { o.embedding.starts = 101; });
  refuses("weights", [](Options& o) { o.embedding.weights = static_cast<EdgeWeights>(3); });
  refuses("history_vertices", [](Options& o) { o.embedding.history.vertices = -1; });
  refuses("history_frames", [](Options& o) { o.embedding.history.frames = 1; });
  refuses("triangulation",
          [](Options& o) { o.triangulation.method = static_cast<TriangulationMethod>(2); });
  refuses("optimization",
          [](Options& o) { o.optimization.method = static_cast<OptimizationMethod>(3); });
  refuses("smoothing", [](Options& o) { o.smoothing.steps = 10001; });
  refuses("smoothing", [](Options& o) { o.smoothing.method = static_cast<SmoothingMethod>(2); });
  refuses("retries", [](Options& o) { o.retries = -1; });
  refuses("retries", [](Options& o) { o.retries = 100; });
  refuses("threads", [](Options& o) { o.threads = 1025; });
}

TEST(OptionTable, ExtremesOfEveryOptionAreMeshed) {
  const Positions points = test::randomSphere(200, 7);
  for (const OptionRow& row : optionTable())
    for (const OptionValue& value : goodValues(row)) {
      Options options;
      setOption(options, row.name, value);
      const Result result = reconstruct(points, options);
      EXPECT_TRUE(test::isSphereOverAll(result.triangles, 200))
          << row.name << " = " << textOf(value);
    }
}

}  // namespace
}  // namespace spherical_param
