// The limits in doc/numbers.md: results are right within them, and warnings appear beyond.

#include "spherical_param/reconstruct.h"

#include "helpers.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace spherical_param {
namespace {

using test::bruteForceNeighbors;
using test::canonical;
using test::isSphereOverAll;
using test::spiralSphere;

Result meshOf(const Positions& points) {
  Options options;
  options.retries = 0;
  return reconstruct(points, bruteForceNeighbors(points, 24), options);
}

/// A sphere of radius 1 that touches the origin, and on it, there, a disc of more points.
Positions sphereWithDisc(double radius, const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
  const Positions sphere = spiralSphere(150);
  const Eigen::Vector3d touched(0.0, 0.0, 1.0);
  std::vector<Eigen::Vector3d> points;
  for (Eigen::Index i = 0; i < sphere.cols(); ++i)
    if ((sphere.col(i) - touched).norm() > 0.03)
      points.emplace_back(sphere.col(i) - touched);
  for (int i = 0; i < 30; ++i) {
    const double r = radius * std::sqrt((i + 0.5) / 30.0);
    const double angle = 2.4 * i;
    points.emplace_back(r * std::cos(angle), r * std::sin(angle),
                        -r * r / (1.0 + std::sqrt(1.0 - r * r)));
  }
  Positions result(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    result.col(static_cast<Eigen::Index>(i)) = points[i] + offset;
  return result;
}

TEST(Numbers, PointsOfEqualCoordinatesAreDuplicates) {
  const Positions points = sphereWithDisc(1e-12, Eigen::Vector3d(0.0, 0.0, 1e7));
  const Result result = meshOf(points);
  // x and y are near 0, and as fine as ever; z is a multiple of 2^-29.
  EXPECT_EQ(result.duplicates(), 0U);
  const Positions shifted = sphereWithDisc(1e-12, Eigen::Vector3d(1e7, 1e7, 1e7));
  const Result merged = meshOf(shifted);
  EXPECT_EQ(merged.duplicates(), 29U);
  EXPECT_TRUE(isSphereOverAll(merged.triangles, static_cast<Index>(merged.vertexCount())));
  EXPECT_NE(merged.warnings.front().find("repeat an earlier point"), std::string::npos);
}

TEST(Numbers, AClusterAsLargeAsTheGapAroundItIsAPartOfTheSurface) {
  const Positions points = sphereWithDisc(0.1);
  const Result result = meshOf(points);
  ASSERT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(points.cols())));
  EXPECT_TRUE(result.self_intersections.empty());
  const Eigen::Vector3d center(0.0, 0.0, -1.0);
  for (Eigen::Index t = 0; t < result.triangles.cols(); ++t) {
    const Eigen::Vector3d a = points.col(result.triangles(0, t)) - center;
    const Eigen::Vector3d b = points.col(result.triangles(1, t)) - center;
    const Eigen::Vector3d c = points.col(result.triangles(2, t)) - center;
    EXPECT_GT(a.dot(b.cross(c)), 0.0) << "triangle " << t << " does not face outward";
  }
}

TEST(Numbers, OfAClusterThatIsFarSmallerTheTopologyIsSoundAndTheRestIsSaid) {
  for (const double radius : {1e-5, 1e-20}) {
    const Positions points = sphereWithDisc(radius);
    const Result result = meshOf(points);
    EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(points.cols()))) << radius;
    EXPECT_EQ(result.duplicates(), 0U) << radius;
    EXPECT_EQ(result.triangulation.coincident, 0) << radius;
    EXPECT_FALSE(result.self_intersections.empty()) << radius;
    EXPECT_FALSE(result.warnings.empty()) << radius;
  }
}

/// Rings of 7 points around the origin, each smaller than the last, on a sphere of radius 1.
Positions ringsDownTo(double least) {
  std::vector<Eigen::Vector3d> points;
  const Positions sphere = spiralSphere(150);
  const Eigen::Vector3d touched(0.0, 0.0, 1.0);
  for (Eigen::Index i = 0; i < sphere.cols(); ++i)
    if ((sphere.col(i) - touched).norm() > 0.25)
      points.emplace_back(sphere.col(i) - touched);
  points.emplace_back(0.0, 0.0, 0.0);
  constexpr double shrinking = 0.45;
  double turn = 0.0;
  for (double r = 0.15; r > least; r *= shrinking, turn += 0.5)
    for (int i = 0; i < 7; ++i) {
      const double angle = 2.0 * test::kPi * (i + turn) / 7.0;
      points.emplace_back(r * std::cos(angle), r * std::sin(angle),
                          -r * r / (1.0 + std::sqrt(1.0 - r * r)));
    }
  Positions result(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    result.col(static_cast<Eigen::Index>(i)) = points[i];
  return result;
}

TEST(Numbers, WhereDensityGrowsStepByStepTheMeshIsTrueDownTo1em5) {
  for (const double least : {1e-2, 1e-5}) {
    const Positions points = ringsDownTo(least);
    const Result result = meshOf(points);
    EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(points.cols()))) << least;
    EXPECT_TRUE(result.self_intersections.empty()) << least;
  }
}

TEST(Numbers, TheMeshIsThatOfAnyExtentDownToDenormalNumbers) {
  // 30 bits for each coordinate: they are all there at 2^-1040.
  const Positions points = (spiralSphere(60) * 0x1p30).array().round() * 0x1p-30;
  const Result expected = meshOf(points);
  for (const int power : {332, 100, -100, -1000, -1040}) {
    const Positions scaled = points.unaryExpr([&](double x) { return std::ldexp(x, power); });
    const Result result = reconstruct(scaled, bruteForceNeighbors(points, 24));
    EXPECT_EQ(canonical(result.triangles), canonical(expected.triangles)) << power;
  }
  const Positions large = points * 1.1e100;
  EXPECT_THROW(meshOf(large), InvalidInput);
}

TEST(Numbers, ATubeIsMeshedTrulyTo45RadiiFromItsMiddle) {
  const test::Tube tube = test::bentTube(90.0, 0.0, 8);
  const Result result = meshOf(tube.points);
  EXPECT_EQ(canonical(result.triangles), canonical(tube.triangles));
  EXPECT_EQ(result.triangulation.coincident, 0);
  // Its ends are some units in the last place of 1 wide, as exp(-45 / sqrt(2)) = 1.5e-14 has it.
  double shortest = 1.0;
  for (Eigen::Index t = 0; t < result.triangles.cols(); ++t)
    shortest = std::min(shortest, (result.sphere.col(result.triangles(0, t)) -
                                   result.sphere.col(result.triangles(1, t)))
                                      .norm());
  EXPECT_LT(shortest, 1e-13);
  EXPECT_GT(shortest, 1e-16);
}

TEST(Numbers, WhereATubeIsTooLongForTheSphereThatIsSaid) {
  const test::Tube tube = test::bentTube(160.0, 0.0, 8);
  const Result result = meshOf(tube.points);
  EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(tube.points.cols())));
  EXPECT_GT(result.triangulation.coincident, 0);
  EXPECT_FALSE(result.warnings.empty());
}

}  // namespace
}  // namespace spherical_param
