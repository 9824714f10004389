#include "spherical_param/result_fields.h"

#include "core/reconstructions.h"
#include "result_units.h"

#include <cstring>
#include <type_traits>

namespace spherical_param::test {
namespace {

/// Becomes any struct or class.
struct AnyClass {
  template <typename T, std::enable_if_t<std::is_class_v<T>, int> = 0>
  operator T() const {  // NOLINT(google-explicit-constructor): that is its purpose
    return {};
  }
};

/// Becomes any number, flag or enumerator.
struct AnyScalar {
  template <typename T, std::enable_if_t<std::is_scalar_v<T>, int> = 0>
  operator T() const;  // NOLINT(google-explicit-constructor)
};

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
template <typename Struct, typename... Fields>
auto takes(int) -> decltype(Struct{Fields{}...}, std::true_type{});
template <typename Struct, typename... Fields>
std::false_type takes(long);
#pragma GCC diagnostic pop

/// How many values a struct can be made of.
template <typename Struct, typename... Fields>
constexpr std::size_t countFields() {
  if constexpr (decltype(takes<Struct, Fields..., AnyClass>(0))::value)
    return countFields<Struct, Fields..., AnyClass>();
  else if constexpr (decltype(takes<Struct, Fields..., AnyScalar>(0))::value)
    return countFields<Struct, Fields..., AnyScalar>();
  else
    return sizeof...(Fields);
}

template <typename Struct>
void expectAllFieldsAreVisited() {
  std::vector<std::string> names;
  std::size_t stored = 0;
  visitFields(static_cast<const Struct*>(nullptr), [&](const ResultField& field, auto access) {
    using Got = std::invoke_result_t<decltype(access), Struct&>;
    stored += std::is_reference_v<Got> || std::is_pointer_v<Got> ? 1 : 0;
    names.emplace_back(field.name);
  });
  const char* of = describe(static_cast<const Struct*>(nullptr)).name;
  EXPECT_EQ(stored, countFields<Struct>()) << of;
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::unique(names.begin(), names.end()), names.end()) << of;
}

template <typename... Structs>
void expectAllFieldsAreVisitedOf() {
  (expectAllFieldsAreVisited<Structs>(), ...);
}

TEST(ResultFields, EveryFieldOfEveryStructIsVisited) {
  static_assert(countFields<StageTime>() == 2);
  expectAllFieldsAreVisitedOf<MeshTopology, MeshMeasures, StageTime, Finding, Opening, PartBridge,
                              SurfaceDiagnosis, ConsolidationReport, LevelReport, EmbeddingReport,
                              SmoothingReport, Surface, LeftOut, Result>();
}

TEST(ResultFields, EveryEnumeratorHasAName) {
  EXPECT_STREQ(nameOf(StopReason::IterationLimit), "iteration_limit");
  EXPECT_STREQ(nameOf(StopReason::Unfinished), namesOf(StopReason()).back());
}

/// Calls visit(name, number, power of the unit) for every number of a result that has a unit.
template <typename Struct, typename Visit>
void visitQuantities(Struct& result, const Visit& visit) {
  visitValues(result, [&](const ResultField& field, auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if (field.power == 0)
      return;
    if constexpr (std::is_same_v<Value, double>) {
      visit(field.name, value, field.power);
    } else if constexpr (std::is_base_of_v<Eigen::DenseBase<Value>, Value> &&
                         !std::is_same_v<Value, Triangles>) {
      for (Eigen::Index i = 0; i < value.size(); ++i)
        visit(field.name, value.data()[i], field.power);
    } else {
      FAIL() << field.name << " has a unit, but is no number";
    }
  });
}

/// A result on four nodes with one of each finding, all quantities of which are 1.
Surface onNodes() {
  Surface r;
  r.triangles = Triangles{{0, 0, 0, 1}, {1, 2, 3, 3}, {2, 3, 1, 2}};
  r.sphere = Positions{{0, 1, 2, 3}, {0, 1, 2, 3}, {0, 1, 2, 3}};
  r.points = Positions::Constant(3, 4, 1.0);
  r.smoothing.emplace();
  r.vertex_residuals = {0.0, 1.0, 2.0, 3.0};
  r.outliers = {0, 1};
  r.boundary = {{0, 1, 2}, {0, 3, 2}};
  r.openings.resize(1);
  r.openings[0].loop = {0, 1, 3};
  r.diagnosis.bridges.resize(1);
  r.diagnosis.bridges[0].vertices = {2, 3};
  visitQuantities(r, [](const char*, double& number, int) { number = 1.0; });
  return r;
}

/// Node i is vertex {2, 0, 3, 1}[i], and scaled by 2^-3.
OrderedPoints reorderedNodes() {
  OrderedPoints nodes;
  nodes.exponent = 3;
  nodes.vertex_of_node = {2, 0, 3, 1};
  nodes.vertex_of_input = {0, 1, 2, 3, 3};
  nodes.input_of_vertex = {0, 1, 2, 3};
  return nodes;
}

TEST(ResultFields, QuantitiesAreScaledByTheirPowersAndIndicesAreThoseOfVertices) {
  Surface result = onNodes();
  OrderedPoints nodes = reorderedNodes();
  toInput(nodes, result);
  std::size_t quantities = 0;
  visitQuantities(result, [&](const char* name, double number, int power) {
    EXPECT_EQ(number, std::ldexp(1.0, 3 * power)) << name;
    ++quantities;
  });
  // 21 of measures, 5 of smoothing, 12 of points, 7 and 5 of opening and bridge, 3 of steps.
  EXPECT_EQ(quantities, 53U);
  using Indices = std::vector<Index>;
  EXPECT_EQ(result.triangles, (Triangles{{2, 2, 2, 0}, {0, 3, 1, 1}, {3, 1, 0, 3}}));
  EXPECT_EQ(Eigen::RowVectorXd(result.sphere.row(0)), (Eigen::RowVectorXd{{1, 3, 0, 2}}));
  EXPECT_EQ(result.vertex_residuals, (std::vector<double>{1, 3, 0, 2}));
  EXPECT_EQ(result.outliers, (Indices{0, 2}));
  EXPECT_EQ(result.boundary, (std::vector<Indices>{{0, 3, 2}, {1, 3, 2}}));  // turned, not sorted
  EXPECT_EQ(result.openings[0].loop, (Indices{0, 1, 2}));
  EXPECT_EQ(result.diagnosis.bridges[0].vertices, (Indices{1, 3}));
  EXPECT_EQ(result.vertex_of_input, (Indices{0, 1, 2, 3, 3}));
  EXPECT_EQ(result.duplicates(), 1U);
}

}  // namespace
}  // namespace spherical_param::test
