#include "space_filling_curve.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

TEST(SpaceFillingCurve, MortonOrderIsTheSameAtAnyScale) {
  // Whole numbers: no scale rounds them, and the least are denormal.
  Positions points = (1023.0 * randomCube(1000, 1)).array().round();
  const std::vector<Index> order = mortonOrder(points);
  for (const double scale :
       {std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::min(), 0x1p-300,
        0x1p300, 0x1p1000, 0x1p1014})
    EXPECT_EQ(mortonOrder(points * scale), order) << scale;
  // An axis along which nothing differs changes nothing, however far it is.
  points *= 1e-300;
  points.row(1).setZero();
  const std::vector<Index> flat = mortonOrder(points);
  points.row(1).setConstant(1e300);
  EXPECT_EQ(mortonOrder(points), flat);
}

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
