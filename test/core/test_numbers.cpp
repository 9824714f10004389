// The limits in doc/reference.md: results are right within them, and warnings appear beyond.

#include "reconstructions.h"

namespace spherical_param::test {
namespace {

/// The topology must be sound.
Surface meshOf(const Positions& points, const Options& options = sphere()) {
  const Surface result = mesh(points, options);
  EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(result.vertexCount())));
  return result;
}

/// A sphere of radius 1 that touches the origin, without its points nearer than `gap` to it, and
/// there, on the sphere, rings of points: `turn` apart, each with its radius.
Positions sphereWith(const std::vector<double>& radii, int ring, double turn, double gap) {
  std::vector<Eigen::Vector3d> points;
  const Positions sphere = spiralSphere(150);
  for (const Eigen::Vector3d point : sphere.colwise())
    if ((point - Eigen::Vector3d::UnitZ()).norm() > gap)
      points.emplace_back(point - Eigen::Vector3d::UnitZ());
  for (std::size_t i = 0; i < radii.size(); ++i)
    for (int k = 0; k < ring; ++k) {
      const double r = radii[i];
      points.push_back(onCircle(turn * static_cast<double>(i) + 2.0 * kPi * k / ring, r,
                                -r * r / (1.0 + std::sqrt(1.0 - r * r))));
    }
  return positionsOf(points);
}

Positions sphereWithDisc(double radius, int count = 30) {
  std::vector<double> radii;
  for (int i = 0; i < count; ++i)
    radii.push_back(radius * std::sqrt((i + 0.5) / count));
  return sphereWith(radii, 1, 2.4, 0.03);
}

/// Rings of 7 points, each smaller than the last.
Positions sphereWithRings(double least) {
  std::vector<double> radii;
  for (double r = 0.15; r > least; r *= 0.45)
    radii.push_back(r);
  return horizontally(sphereWith(radii, 7, kPi / 7.0, 0.25), Eigen::Vector3d::Zero());
}

TEST(Numbers, PointsOfEqualCoordinatesAreDuplicates) {
  Positions points = sphereWithDisc(1e-12);
  points.row(2).array() += 1e7;
  // x and y are near 0, and as fine as ever; z is a multiple of 2^-29.
  EXPECT_EQ(meshOf(points).duplicates(), 0U);
  points.topRows(2).array() += 1e7;
  const Surface merged = meshOf(points);
  EXPECT_EQ(merged.duplicates(), 29U);
}

TEST(Numbers, AClusterAsLargeAsTheGapAroundItIsAPartOfTheSurface) {
  const Positions points = sphereWithDisc(0.1);
  const Surface result = meshOf(points);
  EXPECT_TRUE(result.self_intersections.empty());
  for (Eigen::Index t = 0; t < result.triangles.cols(); ++t) {
    Eigen::Matrix3d corners = points(Eigen::all, result.triangles.col(t));
    corners.row(2).array() += 1.0;
    EXPECT_GT(corners.determinant(), 0.0) << "triangle " << t << " does not face outward";
  }
}

TEST(Numbers, OfAClusterThatIsFarSmallerTheTopologyIsSoundAndFaultsAreReported) {
  for (const double radius : {1e-5, 1e-20}) {
    const Surface result = meshOf(sphereWithDisc(radius, 100), quick(sphere()));
    EXPECT_EQ(result.duplicates(), 0U) << radius;
    EXPECT_FALSE(result.self_intersections.empty()) << radius;
    EXPECT_FALSE(result.findings.empty()) << radius;
  }
}

TEST(Numbers, WhereDensityGrowsStepByStepTheMeshIsTrueDownTo1em5) {
  for (const double least : {1e-2, 1e-5})
    EXPECT_TRUE(meshOf(sphereWithRings(least)).self_intersections.empty()) << least;
}

TEST(Numbers, TheMeshIsThatOfAnyExtentDownToDenormalNumbers) {
  // 30 bits for each coordinate: they are all there at 2^-1040.
  const Positions points = (spiralSphere(60) * 0x1p30).array().round() * 0x1p-30;
  const Surface expected = meshOf(points);
  for (const int power : {332, 100, -100, -1000, -1040}) {
    const Positions scaled = points.unaryExpr([&](double x) { return std::ldexp(x, power); });
    const Surface result = surfaceOf(scaled, {}, bruteForceFactory(points));
    EXPECT_EQ(canonical(result.triangles), canonical(expected.triangles)) << power;
  }
  EXPECT_THROW(meshOf(points * 1.1e100), InvalidInput);
}

TEST(Numbers, ATubeIsMeshedTrulyTo45RadiiFromItsMiddle) {
  const Mesh tube = bentTube(90.0, 0.0, 8);
  const Surface result = meshOf(tube.points);
  EXPECT_EQ(canonical(result.triangles), canonical(tube.triangles));
  // Its ends are some units in the last place of 1 wide, as exp(-45 / sqrt(2)) = 1.5e-14 has it.
  double shortest = 1.0;
  for (const auto& triangle : result.triangles.colwise())
    shortest = std::min(shortest,
                        (result.sphere.col(triangle[0]) - result.sphere.col(triangle[1])).norm());
  EXPECT_LT(shortest, 1e-13);
  EXPECT_GT(shortest, 1e-16);
}

TEST(Numbers, ATubeThatIsTooLongForTheSphereIsReported) {
  const Mesh tube = bentTube(130.0, 0.0, 8);
  EXPECT_FALSE(meshOf(tube.points, quick(sphere())).findings.empty());
  // The faces of the graph need no sphere.
  EXPECT_EQ(canonical(meshOf(tube.points, {}).triangles), canonical(tube.triangles));
}

}  // namespace
}  // namespace spherical_param::test
