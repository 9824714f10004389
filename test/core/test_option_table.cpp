#include "spherical_param/option_table.h"

#include "reconstructions.h"

#include <ostream>

namespace spherical_param {

void PrintTo(const OptionRow& row, std::ostream* stream) {
  *stream << row.name;
}

namespace {

OptionValue numberOf(const OptionRow& row, double number) {
  return row.is_integer ? OptionValue(static_cast<std::int64_t>(number)) : OptionValue(number);
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

/// By checkOptions(), and by reconstruct() before it looks at the points.
void expectRefusal(const Options& options, const std::string& name) {
  expectRefusal([&] { checkOptions(options); }, name);
  expectRefusal([&] { reconstruct(Positions(3, 0), options); }, name);
}

TEST(OptionTable, NamesAndFieldsOccurOnceAndDefaultsAreInRange) {
  EXPECT_NO_THROW(checkOptions({}));
  std::set<std::string> names;
  std::set<std::string> fields;
  for (const OptionRow& row : optionTable()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(fields.insert(row.field).second) << row.field;
    EXPECT_EQ(&findOption(row.name), &row);
    EXPECT_FALSE(row.help.empty() || rangeOf(row).empty());
    for (const auto& [other, values] : row.used_with)
      for (const std::string& value : values) {
        Options with;
        EXPECT_NO_THROW(setOption(with, other, value)) << row.name;
      }
    Options options;
    EXPECT_NO_THROW(setOption(options, row.name, row.get(options))) << row.name;
  }
  Options options;
  setOption(options, "damping", std::int64_t{1});  // an integer will do for a number
  EXPECT_EQ(options.paper.damping, 1.0);
  expectRefusal([] { findOption("solver"); }, "solver");
}

class EveryOption : public testing::TestWithParam<OptionRow> {};
INSTANTIATE_TEST_SUITE_P(OptionTable, EveryOption, testing::ValuesIn(optionTable()),
                         [](const auto& of) { return of.param.name; });

TEST_P(EveryOption, ExtremeIsReadBackChangesNoOtherAndIsMeshed) {
  const OptionRow& row = GetParam();
  std::vector<OptionValue> good(row.choices.begin(), row.choices.end());
  if (row.is_number) {
    const double min = row.min_excluded ? std::nextafter(row.min, row.max) : row.min;
    good.insert(good.end(), {numberOf(row, min), numberOf(row, row.max)});
  }
  if (row.optional)
    good.emplace_back();
  for (const OptionValue& value : good) {
    SCOPED_TRACE(textOf(value));
    Options options;
    setOption(options, row.name, value);
    EXPECT_EQ(row.get(options), value);
    EXPECT_NO_THROW(checkOptions(options));
    for (const OptionRow& other : optionTable())
      if (other.name != row.name) {
        EXPECT_EQ(other.get(options), other.get({})) << other.name;
      }
    // Four points are no part, and of four one may deviate.
    for (const Index n : {row.name == "parts" || row.name == "outliers" ? 60 : 4, 150})
      EXPECT_EQ(
          test::isSphereOverAll(test::surfaceOf(test::randomSphere(n, 7), options).triangles, n),
          options.view != ViewMode::Up);  // from above it is no sphere
  }
}

TEST_P(EveryOption, OutOfRangeOrOfAnotherKindIsRefusedByName) {
  const OptionRow& row = GetParam();
  std::vector<OptionValue> bad;
  if (row.is_number)
    bad = {numberOf(row, row.min - 1.0), numberOf(row, row.max + 1.0)};
  if (row.is_number && !row.is_integer)
    bad.emplace_back(std::numeric_limits<double>::quiet_NaN());
  if (row.min_excluded)
    bad.push_back(numberOf(row, row.min));
  for (const OptionValue& value : bad)
    if (row.name != "seed") {  // which has the range of its type
      Options options;
      row.set(options, value);
      expectRefusal(options, row.name);
    }
  bad.emplace_back("three");
  if (!row.is_number || row.is_integer)
    bad.emplace_back(3.5);
  if (!row.is_number)
    bad.emplace_back(std::int64_t{0});
  if (!row.optional)
    bad.emplace_back();
  for (const OptionValue& value : bad) {
    Options options;
    expectRefusal([&] { setOption(options, row.name, value); }, row.name);
    EXPECT_EQ(row.get(options), row.get({}));
  }
}

TEST(OptionTable, OutliersAreNamesOrTheNumberOfDeviations) {
  EXPECT_EQ(rangeOf(findOption("outliers")), "topology, none, auto or a number from 0 to 1000");
  Options options;
  setOption(options, "outliers", std::int64_t{3});
  EXPECT_EQ(options.outliers, OutlierMode::Deviation);
  EXPECT_EQ(options.outlier_sigma, 3.0);
  setOption(options, "outliers", "auto");
  EXPECT_EQ(options.outliers, OutlierMode::Auto);
}

TEST(OptionTable, EnumerationsAreChecked) {
  const auto refuses = [](const std::string& name, const auto& change) {
    Options options;
    change(options);
    expectRefusal(options, name);
  };
  for (const int past : {-1, 4}) {
    refuses("outliers", [=](Options& o) { o.outliers = static_cast<OutlierMode>(past); });
    refuses("parts", [=](Options& o) { o.parts = static_cast<PartsMode>(past); });
    refuses("method", [=](Options& o) { o.method = static_cast<Method>(past); });
    refuses("weights", [=](Options& o) { o.paper.weights = static_cast<EdgeWeights>(past); });
  }
}

}  // namespace
}  // namespace spherical_param
