#include "mesh_intersections.h"

#include "helpers.h"
#include "optimization_cases.h"
#include "spherical_param/self_intersection.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

TEST(MeshIntersections, AreThoseOfItsTriangles) {
  for (const Case& of : roughCases()) {
    internal::EnergyMesh mesh = meshOf(of);
    EXPECT_EQ(internal::findIntersections(mesh), findSelfIntersections(of.points, of.triangles));
    // Other positions of the same points.
    const Positions moved = withNoise(of.points, 0.05, 8);
    mesh.setPoints(moved);
    EXPECT_EQ(internal::findIntersections(mesh), findSelfIntersections(moved, of.triangles));
  }
}

}  // namespace
}  // namespace spherical_param::test
