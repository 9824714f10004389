#include "result_units.h"

#include "reconstructions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace spherical_param {
namespace {

/// Calls visit(name, number, power of the unit) for every number of a result that has a unit.
template <typename Visit>
void visitQuantities(Surface& r, const Visit& visit) {
  const auto visit_all = [&](const char* name, auto& values, int power) {
    for (Eigen::Index i = 0; i < values.size(); ++i)
      visit(name, values.data()[i], power);
  };
  visit("volume", r.measures.volume, 3);
  visit("area", r.measures.area, 2);
  visit("edge length", r.measures.mean_edge_length, 1);
  visit_all("box", r.measures.box_min, 1);
  visit_all("box", r.measures.box_max, 1);
  visit_all("centroid", r.measures.centroid, 1);
  visit_all("inertia", r.measures.inertia, 5);
  visit_all("smoothed", r.smoothed, 1);
  visit("max displacement", r.smoothing.max_displacement, 1);
  visit("mean displacement", r.smoothing.mean_displacement, 1);
  visit("rms displacement", r.smoothing.rms_displacement, 1);
  visit("volume before", r.smoothing.volume_before, 3);
  visit("volume after", r.smoothing.volume_after, 3);
  for (Opening& opening : r.openings) {
    visit("opening area", opening.area, 2);
    visit("opening boundary", opening.boundary_length, 1);
    visit("opening width", opening.width, 1);
    visit("opening spacing", opening.spacing, 1);
    visit_all("opening center", opening.center, 1);
  }
  for (CollapsedHandle& handle : r.diagnosis.handles) {
    visit("handle size", handle.size, 1);
    visit_all("handle center", handle.center, 1);
  }
  for (PartBridge& bridge : r.diagnosis.bridges) {
    visit("gap", bridge.gap, 1);
    visit("gap spacing", bridge.spacing, 1);
    visit_all("gap center", bridge.center, 1);
  }
}

/// A result on four nodes with one of each finding.
Surface onNodes() {
  Surface r;
  r.triangles = Triangles{{0, 0, 0, 1}, {1, 2, 3, 3}, {2, 3, 1, 2}};
  r.sphere = Positions{{0, 1, 2, 3}, {0, 1, 2, 3}, {0, 1, 2, 3}};
  r.smoothed = Positions::Constant(3, 4, 1.0);
  r.vertex_residuals = {0.0, 1.0, 2.0, 3.0};
  r.history.vertices = {3, 0};
  r.outliers = {0, 1};
  r.openings.resize(1);
  r.openings[0].loop = {0, 1, 2};
  r.openings[0].triangles = {1, 3};
  r.diagnosis.handles.resize(1);
  r.diagnosis.handles[0].vertices = {1, 3};
  r.diagnosis.bridges.resize(1);
  r.diagnosis.bridges[0].vertices = {2, 3};
  return r;
}

/// Node i is vertex {2, 0, 3, 1}[i], and scaled by 2^-3.
internal::OrderedPoints reorderedNodes() {
  internal::OrderedPoints nodes;
  nodes.exponent = 3;
  nodes.vertex_of_node = {2, 0, 3, 1};
  nodes.distinct.vertex_of_input = {0, 1, 2, 3, 3};
  nodes.distinct.input_of_vertex = {0, 1, 2, 3};
  return nodes;
}

TEST(ResultUnits, EveryQuantityIsScaledByItsPowerOfTheUnit) {
  Surface result = onNodes();
  visitQuantities(result, [](const char*, double& number, int) { number = 1.0; });
  internal::OrderedPoints nodes = reorderedNodes();
  internal::toInput(nodes, result);
  visitQuantities(result, [](const char* name, double number, int power) {
    EXPECT_EQ(number, std::ldexp(1.0, 3 * power)) << name;
  });
}

TEST(ResultUnits, EveryIndexBecomesThatOfItsVertex) {
  Surface result = onNodes();
  internal::OrderedPoints nodes = reorderedNodes();
  internal::toInput(nodes, result);
  using Indices = std::vector<Index>;
  EXPECT_EQ(result.triangles, (Triangles{{2, 2, 2, 0}, {0, 3, 1, 1}, {3, 1, 0, 3}}));
  EXPECT_EQ(Eigen::RowVectorXd(result.sphere.row(0)), (Eigen::RowVectorXd{{1, 3, 0, 2}}));
  EXPECT_EQ(result.vertex_residuals, (std::vector<double>{1, 3, 0, 2}));
  EXPECT_EQ(result.history.vertices, (Indices{1, 2}));
  EXPECT_EQ(result.outliers, (Indices{0, 2}));
  EXPECT_EQ(result.openings[0].loop, (Indices{0, 3, 2}));  // turned, not sorted
  EXPECT_EQ(result.openings[0].triangles, (Indices{1, 3}));
  EXPECT_EQ(result.diagnosis.handles[0].vertices, (Indices{0, 1}));
  EXPECT_EQ(result.diagnosis.bridges[0].vertices, (Indices{1, 3}));
  EXPECT_EQ(result.vertex_of_input, (Indices{0, 1, 2, 3, 3}));
  EXPECT_EQ(result.duplicates(), 1U);
}

void expectScaled(Surface& result, Surface& scaled, double scale) {
  std::vector<double> expected;
  visitQuantities(result, [&](const char*, double number, int power) {
    expected.push_back(number * std::pow(scale, power));
  });
  std::size_t i = 0;
  visitQuantities(scaled, [&](const char* name, double number, int power) {
    const double size = std::max(std::abs(expected.at(i)), std::pow(scale, power));
    EXPECT_NEAR(number, expected.at(i++), 1e-9 * size) << name;
  });
  EXPECT_EQ(i, expected.size());
}

TEST(ResultUnits, ResultOfAScaledCloudIsTheScaledResult) {
  // Open at one end, so that there is an opening to measure.
  const Positions points = test::withNoise(test::spiralSphere(500), 0.003, 8).rightCols(400);
  Options options;
  options.smoothing = 2;
  Surface result = test::mesh(points, options);
  ASSERT_EQ(result.openings.size(), 1U);
  for (const double scale : {4.0, std::ldexp(1.0, -70), 1000.0, 1e50}) {
    SCOPED_TRACE(scale);
    Surface scaled = test::mesh(scale * points, options);
    expectScaled(result, scaled, scale);
    EXPECT_EQ(scaled.verdict, result.verdict);
    // Other factors round the coordinates, but no decision is so close.
    EXPECT_EQ(test::canonical(scaled.triangles), test::canonical(result.triangles));
    if (scale == 4.0 || scale < 1.0) {
      EXPECT_EQ(scaled.triangles, result.triangles);
      EXPECT_EQ(scaled.sphere, result.sphere);
    }
  }
}

}  // namespace
}  // namespace spherical_param
