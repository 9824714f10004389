#include "ordered_points.h"

#include "helpers.h"
#include "space_filling_curve.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

/// Distinct points by a table, in the order that the curve has for them alone.
void expectDistinctPointsAlongTheCurve(const Positions& points) {
  const OrderedPoints ordered = orderPoints(points, 1);
  std::map<std::array<double, 3>, Index> vertex_at;  // zeros of both signs are equal
  std::vector<Index> input_of_vertex;
  std::vector<Index> vertex_of_input;
  for (Index i = 0; i < points.cols(); ++i) {
    const auto [entry, is_new] = vertex_at.try_emplace({points(0, i), points(1, i), points(2, i)},
                                                       static_cast<Index>(input_of_vertex.size()));
    if (is_new)
      input_of_vertex.push_back(i);
    vertex_of_input.push_back(entry->second);
  }
  EXPECT_EQ(ordered.vertex_of_input, vertex_of_input);
  EXPECT_EQ(ordered.input_of_vertex, input_of_vertex);
  const Positions vertices = points(Eigen::all, input_of_vertex);
  EXPECT_EQ(ordered.vertex_of_node, mortonOrder(vertices));
  EXPECT_EQ(points(Eigen::all, ordered.input_of_node),
            vertices(Eigen::all, ordered.vertex_of_node));
  // What is at a point is at its node, by one power of two.
  EXPECT_EQ(ordered.points(Eigen::all, nodesOfInput(ordered)) * std::ldexp(1.0, ordered.exponent),
            points);
}

/// Many points in one cell of the curve, which has 2^21 an axis: apart, and some of them twice.
Positions crowd() {
  const Positions points =
      pointsAt(1000, [](Index i) { return Eigen::Vector3d(1e-12 * (i * 7 % 900), 0.0, 1e-13); });
  return horizontally(points, Eigen::Vector3d(1.0, 1.0, 1.0), Eigen::Vector3d(0.0, 1.0, 0.5));
}

TEST(OrderedPoints, AreTheDistinctPointsAlongTheCurve) {
  for (const Index n : {1, 2, 100, 3000})
    expectDistinctPointsAlongTheCurve(7.0 * randomSphere(n, 1));
  expectDistinctPointsAlongTheCurve((3.0 * randomSphere(2000, 3)).array().round());
  expectDistinctPointsAlongTheCurve(randomSphere(4, 1).replicate(1, 500));
  expectDistinctPointsAlongTheCurve(crowd());
  EXPECT_EQ(orderPoints(crowd(), 1).input_of_node.size(), 902U);
  EXPECT_TRUE(orderPoints(Positions(3, 0), 1).input_of_node.empty());
}

}  // namespace
}  // namespace spherical_param::test
