#include "map_shapes.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/self_intersection.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

/// A cigar whose map is twisted: triangles of a grid wind round it, and cut across each other.
SphereSurface twistedCigar() {
  return test::surfaceOver(4000, [](const Vector3d& u) {
    const Vector3d turned = test::rotationBy(10.0 * u.z(), Vector3d::UnitZ()) * u;
    return Vector3d(turned.x(), 0.15 * turned.y(), 2.0 * turned.z());
  });
}

std::size_t intersectionsOf(const ResampledMesh& mesh) {
  return findSelfIntersections(mesh.points, mesh.triangles).size();
}

TEST(Untangle, SlidesVerticesUntilNothingIntersectsAndKeepsAllElse) {
  const SphereSurface surface = twistedCigar();
  const ResampledMesh before = resampleSurface(surface, makeGridSphere(SphereGrid::Icosahedral, 8));
  const std::size_t pairs = intersectionsOf(before);
  ASSERT_GT(pairs, 0U);
  ResampledMesh mesh = before;
  const UntanglingReport report = untangle(surface, mesh, 1);
  EXPECT_EQ(report.before, pairs);
  EXPECT_EQ(report.after, 0U);
  EXPECT_EQ(intersectionsOf(mesh), 0U);
  EXPECT_GT(report.rounds, 0);
  EXPECT_EQ(report.flips, 0U);
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
  EXPECT_EQ(untangle(surface, other).moved, 0);
  EXPECT_EQ(other.points, mesh.points);
}

TEST(Untangle, FlipsEdgesAroundWhatSlidingLeaves) {
  const SphereSurface surface = twistedCigar();
  for (const int frequency : {3, 4}) {
    const ResampledMesh before =
        resampleSurface(surface, makeGridSphere(SphereGrid::Icosahedral, frequency));
    ResampledMesh mesh = before;
    const UntanglingReport report = untangle(surface, mesh, 1);
    EXPECT_GT(report.flips, 0U);
    EXPECT_EQ(report.after, 0U);
    EXPECT_EQ(intersectionsOf(mesh), 0U);
    EXPECT_EQ(surface.evaluate(mesh.directions).positions, mesh.points);
    EXPECT_TRUE(test::isSphereOverAll(mesh.triangles, static_cast<Index>(mesh.points.cols())));
    EXPECT_TRUE(test::isOneToOne(mesh.directions, mesh.triangles));
    // Triangles elsewhere stay: those that no flip changed.
    const auto old = test::canonical(before.triangles);
    const auto now = test::canonical(mesh.triangles);
    std::vector<std::array<Index, 3>> kept;
    std::set_intersection(old.begin(), old.end(), now.begin(), now.end(), std::back_inserter(kept));
    EXPECT_GE(kept.size() + 2 * report.flips, old.size());
    ResampledMesh other = before;
    untangle(surface, other, 3);
    EXPECT_EQ(other.triangles, mesh.triangles);
    // A mesh with an opening keeps its triangles, and the best that sliding found.
    ResampledMesh open = before;
    open.triangles = before.triangles.rightCols(before.triangles.cols() - 1);
    const Triangles triangles = open.triangles;
    const UntanglingReport of_open = untangle(surface, open);
    EXPECT_EQ(of_open.after, intersectionsOf(open));
    EXPECT_GT(of_open.after, 0U);
    EXPECT_LT(of_open.after, of_open.before);
    EXPECT_EQ(of_open.flips, 0U);
    EXPECT_EQ(open.triangles, triangles);
  }
}

}  // namespace
}  // namespace spherical_param
