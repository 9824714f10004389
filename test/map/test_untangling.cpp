#include "map_shapes.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/self_intersection.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

TEST(Untangle, SlidesVerticesUntilNothingIntersectsAndKeepsAllElse) {
  // A cigar whose map is twisted: triangles of a grid wind round it, and cut across each other.
  const SphereSurface surface = test::mappedOver(test::spiralSphere(4000), [](const Vector3d& u) {
                                  const Vector3d turned =
                                      test::rotationBy(10.0 * u.z(), Vector3d::UnitZ()) * u;
                                  return Vector3d(turned.x(), 0.15 * turned.y(), 2.0 * turned.z());
                                }).surface();
  // The last is too coarse for all of it: the best that was found is kept.
  for (const int frequency : {8, 4}) {
    const ResampledMesh before =
        resampleSurface(surface, makeGridSphere(SphereGrid::Icosahedral, frequency));
    const std::size_t pairs = findSelfIntersections(before.points, before.triangles).size();
    ASSERT_GT(pairs, 0U);
    ResampledMesh mesh = before;
    const UntanglingReport report = untangle(surface, mesh, 1);
    EXPECT_EQ(report.before, pairs);
    EXPECT_EQ(report.after, findSelfIntersections(mesh.points, mesh.triangles).size());
    EXPECT_LT(report.after, pairs);
    EXPECT_EQ(report.after == 0, frequency == 8);
    EXPECT_GT(report.rounds, 0);
    EXPECT_EQ(mesh.triangles, before.triangles);
    EXPECT_TRUE(test::isOneToOne(mesh.directions, mesh.triangles));
    const SurfaceSamples samples = surface.evaluate(mesh.directions);
    EXPECT_EQ(samples.positions, mesh.points);
    EXPECT_EQ(samples.normals, mesh.normals);
    Index moved = 0;
    for (Eigen::Index i = 0; i < mesh.points.cols(); ++i)
      moved += mesh.directions.col(i) != before.directions.col(i) ? 1 : 0;
    EXPECT_EQ(moved, report.moved);
    ResampledMesh other = before;
    untangle(surface, other, 3);
    EXPECT_EQ(other.points, mesh.points);
    // A mesh without intersections stays as it is.
    if (report.after == 0) {
      EXPECT_EQ(untangle(surface, other).moved, 0);
      EXPECT_EQ(other.points, mesh.points);
    }
  }
}

}  // namespace
}  // namespace spherical_param
