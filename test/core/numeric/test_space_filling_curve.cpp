#include "space_filling_curve.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

// Also in caps that are smaller than the cells of the curve.
TEST(SpaceFillingCurve, LastRoundGoesFromPointToNearPoint) {
  const std::vector<std::pair<Positions, double>> clouds{
      {randomSphere(2000, 2), std::sqrt(4.0 * kPi)},
      {randomSphere(50000, 2), std::sqrt(4.0 * kPi)},
      {cap(20000, 1e-6, {0.6, 0.0, 0.8}, 3), 2e-6},
      {cap(20000, 1e-12, {0.6, 0.0, 0.8}, 3), 2e-12}};
  for (const auto& [points, width] : clouds) {
    const std::vector<Index> order = insertionOrder(points);
    // The last round has 7 of 8 points; on average, one is less than two spacings from the one
    // before.
    double length = 0.0;
    for (std::size_t i = order.size() / 4; i < order.size(); ++i)
      length += (points.col(order[i]) - points.col(order[i - 1])).norm();
    const auto n = static_cast<double>(points.cols());
    EXPECT_LT(length, 2.0 * (width / std::sqrt(n)) * 0.75 * n);
  }
}

}  // namespace
}  // namespace spherical_param::test
