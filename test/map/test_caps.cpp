#include "caps.h"

#include "boundary_loops.h"
#include "indexed.h"
#include "map_shapes.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>

/// What the map makes of surfaces with openings, by the caps that close them.
namespace spherical_param {
namespace {

using Eigen::Vector3d;
using internal::columnCount;
using test::Mapped;

/// The least distance of a point from the loops of a mesh.
double distanceFromBoundary(const Mapped& mesh, const Vector3d& point) {
  double least = 1e300;
  for (const auto& loop : internal::boundaryLoops(mesh.triangles, columnCount(mesh.points)))
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vector3d a = mesh.points.col(loop[i]);
      const Vector3d b = mesh.points.col(loop[(i + 1) % loop.size()]);
      const double fraction = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      least = std::min(least, (a + fraction * (b - a) - point).norm());
    }
  return least;
}

TEST(Caps, TheMapOfAnOpenMeshIsOneToOneAndLeavesRoomForTheOpenings) {
  const Mapped open = test::openBumpy(1500);
  EXPECT_GT(open.caps.cols(), 0);
  const internal::CappedMesh capped = internal::capOpenings(open.points, open.triangles);
  Positions sphere(3, capped.points.cols());
  sphere << open.sphere, open.caps;
  EXPECT_TRUE(test::isOneToOne(sphere, capped.triangles));
  double covered = 0.0;
  for (Eigen::Index t = 0; t < open.triangles.cols(); ++t)
    covered += test::sphericalArea(open.sphere, open.triangles, t);
  // Three discs of radius 0.4 have an eighth of the sphere.
  EXPECT_NEAR(covered / (4.0 * test::kPi), 0.88, 0.04);
  EXPECT_NEAR(open.surface().coverage(), covered / (4.0 * test::kPi), 1e-9);
  EXPECT_EQ(test::bumpy(test::spiralSphere(100)).surface().coverage(), 1.0);
  const MapDistortion distortion = measureMapDistortion(open.points, open.triangles, open.sphere);
  EXPECT_LT(distortion.angle.mean, 1.3);
  EXPECT_LT(distortion.area.mean, 1.3);
}

TEST(Caps, ResamplingLeavesTheOpeningsOpen) {
  const Mapped open = test::openBumpy(3000);
  const SphereSurface surface = open.surface(SurfaceFit::Linear);
  const int frequency = gridFrequency(SphereGrid::Icosahedral, 4000, surface);
  const ResampledMesh mesh =
      resampleSurface(surface, makeGridSphere(SphereGrid::Icosahedral, frequency));
  EXPECT_NEAR(static_cast<double>(mesh.points.cols()), 4000.0, 300.0);
  const MeshTopology topology = checkTopology(mesh.triangles, columnCount(mesh.points));
  EXPECT_TRUE(topology.isOpenSurface());
  const auto loops = internal::boundaryLoops(mesh.triangles, columnCount(mesh.points));
  ASSERT_EQ(loops.size(), 3U);
  // Vertices of the boundary are on that of the surface.
  for (const std::vector<Index>& loop : loops)
    for (const Index v : loop)
      EXPECT_LT(distanceFromBoundary(open, mesh.points.col(v)), 1e-5);
  EXPECT_NEAR(surfaceArea(mesh.points, mesh.triangles), surface.area(), 0.01 * surface.area());
}

TEST(Caps, VerticesOfTheBoundaryDoNotSlide) {
  const Mapped open = test::openBumpy(600);
  const SphereSurface surface = open.surface(SurfaceFit::Linear);
  ResampledMesh mesh = resampleSurface(surface, makeGridSphere(SphereGrid::Icosahedral, 8));
  const auto loops = internal::boundaryLoops(mesh.triangles, columnCount(mesh.points));
  // One vertex through the opposite side.
  mesh.points.col(mesh.triangles(0, 0)) *= -1.5;
  const Positions before = mesh.points;
  EXPECT_GT(untangle(surface, mesh).before, 0U);
  for (const std::vector<Index>& loop : loops)
    for (const Index v : loop)
      EXPECT_EQ(mesh.points.col(v), before.col(v));
}

TEST(Caps, AMorphIsOpenWhereEitherSurfaceIs) {
  const Mapped closed = test::bumpy(test::spiralSphere(500));
  const Mapped open =
      test::withOpenings(test::bumpy(test::spiralSphere(700)), Vector3d(0.0, 0.0, 1.0), 0.5);
  const SphereSurface whole = closed.surface();
  const SphereSurface holed = open.surface();
  MorphOptions options;
  options.align = false;
  for (const MorphConnectivity connectivity :
       {MorphConnectivity::AllVertices, MorphConnectivity::Resampled})
    for (const bool opens : {false, true}) {
      options.connectivity = connectivity;
      options.samples = 2000;
      const MorphResult morph =
          morphSurfaces(opens ? holed : whole, opens ? whole : holed, options);
      const MeshTopology topology = checkTopology(morph.triangles, columnCount(morph.first));
      EXPECT_TRUE(topology.isOpenSurface());
      EXPECT_EQ(topology.euler_characteristic, 1);
      const Positions& of_open = opens ? morph.first : morph.second;
      EXPECT_NEAR(surfaceArea(of_open, morph.triangles), holed.area(),
                  connectivity == MorphConnectivity::AllVertices ? 1e-9 : 0.03 * holed.area());
      const std::vector<SphereLocation>& places = opens ? morph.first_places : morph.second_places;
      ASSERT_EQ(places.size(), columnCount(of_open));
      for (std::size_t i = 0; i < places.size(); ++i) {
        EXPECT_FALSE(holed.isCap(places[i].triangle));
        EXPECT_LT(
            (holed.evaluate(places[i]).position - of_open.col(static_cast<Eigen::Index>(i))).norm(),
            1e-9);
      }
    }
}

TEST(Caps, AMorphOfSurfacesThatShareNoDirectionIsEmpty) {
  const auto cap_around = [](const Vector3d& pole) {
    Mapped mesh = test::withOpenings(test::bumpy(test::spiralSphere(300)), -pole, 1.5);
    // As seen from a point of the opening: less than half of the sphere.
    for (Positions* of : {&mesh.sphere, &mesh.caps})
      *of = (of->colwise() + 0.6 * pole).colwise().normalized();
    return mesh.surface();
  };
  const SphereSurface upper = cap_around(Vector3d::UnitZ());
  const SphereSurface lower = cap_around(-Vector3d::UnitZ());
  MorphOptions options;
  options.align = false;
  options.samples = 500;
  for (const MorphConnectivity connectivity :
       {MorphConnectivity::AllVertices, MorphConnectivity::Resampled}) {
    options.connectivity = connectivity;
    const MorphResult morph = morphSurfaces(upper, lower, options);
    EXPECT_EQ(morph.triangles.cols(), 0);
    for (const Positions* positions : {&morph.first, &morph.second, &morph.sphere})
      EXPECT_EQ(positions->cols(), 0);
    EXPECT_TRUE(morph.first_places.empty() && morph.second_places.empty());
    EXPECT_TRUE(std::isfinite(morph.alignment_error));
    EXPECT_EQ(inBetween(morph, 0.5).cols(), 0);
  }
}

}  // namespace
}  // namespace spherical_param
