#include "map_shapes.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

/// Expects that points keep the distances of Poisson disk sets: these reach 0.65 to 0.85 of disks
/// packed as densely as can be; random points have nearly 0. \param area for each of them
void expectEven(const Positions& points, double area) {
  const double best = std::sqrt(2.0 / std::sqrt(3.0) * area);
  const NeighborLists nearest = test::bruteForceNeighbors(points, 1);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const auto other = nearest.indices[static_cast<std::size_t>(i)];
    const double distance = (points.col(i) - points.col(other)).norm();
    EXPECT_GT(distance, 0.6 * best);
    EXPECT_LT(distance, 1.3 * best);
  }
}

TEST(SampleEvenly, PointsAreOnTheSurfaceAndKeepTheirDistance) {
  // Of many triangles, and of eight.
  for (const test::Mapped& mesh : {test::mapped(test::spiralSphere(1000)), test::octasphere(1)})
    for (const std::size_t count : {1U, 50U, 400U, 1500U}) {
      const SphereSurface surface = mesh.surface();
      const SurfacePoints samples = sampleEvenly(surface, count);
      ASSERT_EQ(samples.points.cols(), static_cast<Eigen::Index>(count));
      ASSERT_EQ(samples.locations.size(), count);
      EXPECT_NE(sampleEvenly(surface, count, 2).points, samples.points);
      if (count > 1)
        expectEven(samples.points, surface.area() / static_cast<double>(count));
      for (Eigen::Index i = 0; i < samples.points.cols(); ++i) {
        const Vector3d point = samples.points.col(i);
        EXPECT_LT((surface.evaluate(point).position - point).norm(), 1e-13);
        const SurfaceSample same = surface.evaluate(samples.locations[static_cast<std::size_t>(i)]);
        EXPECT_EQ(same.position, point);
        EXPECT_EQ(same.normal, samples.normals.col(i));
      }
    }
}

TEST(SampleEvenly, IsEvenInSpaceWhateverTheMap) {
  // A cigar, whose ends the map squeezes: as many points for each part as it has area.
  const SphereSurface surface = test::surfaceOver(2000, [](const Vector3d& u) {
    return Vector3d(u.x(), u.y(), 8.0 * u.z() * std::abs(u.z()));
  });
  const double count = 2000.0;
  const SurfacePoints samples = sampleEvenly(surface, 2000);
  for (const double z : {0.5, 2.0, 6.0}) {
    double area = 0.0;
    for (Eigen::Index t = 0; t < surface.triangles().cols(); ++t) {
      const Triangles triangle = surface.triangles().col(t);
      if (surface.points()(2, triangle.reshaped()).mean() > z)
        area += surfaceArea(surface.points(), triangle);
    }
    const double expected = area / surface.area() * count;
    const auto found = static_cast<double>((samples.points.row(2).array() > z).count());
    EXPECT_NEAR(found, expected, 0.05 * expected + 3.0);
  }
}

TEST(SampleEvenly, SheetsThatAreCloseDoNotPushEachOther) {
  // A plate that is far thinner than the distance of the points: as many on either side, and no
  // farther from each other on a side than they would be without the other.
  const SphereSurface surface = test::surfaceOver(
      2000, [](const Vector3d& u) { return Vector3d(u.x(), u.y(), 1e-3 * u.z()); });
  const SurfacePoints samples = sampleEvenly(surface, 400);
  Positions upper(3, 0);
  for (Eigen::Index i = 0; i < samples.points.cols(); ++i)
    if (samples.normals(2, i) > 0.0)
      upper = test::horizontally(upper, samples.points.col(i));
  EXPECT_NEAR(static_cast<double>(upper.cols()), 200.0, 10.0);
  expectEven(upper, surface.area() / 400.0);
}

}  // namespace
}  // namespace spherical_param
