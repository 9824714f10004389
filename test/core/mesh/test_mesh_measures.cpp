#include "spherical_param/mesh_measures.h"

#include "helpers.h"
#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

Mesh cornerTetrahedron() {
  Mesh mesh{Positions::Zero(3, 4), tetrahedron()};
  mesh.points.rightCols(3) = Eigen::Matrix3d::Identity();
  return mesh;
}

// Also far from the origin: 2^20 away, the points are rounded to 2^20 * 2^-53 = 1.2e-10; sums about
// the origin would lose the volume at (2^20)^3 * 2^-53 = 128.
TEST(MeshMeasures, ATetrahedronHasItsTextbookMeasuresWhereverItIs) {
  const Mesh mesh = cornerTetrahedron();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  // The integrals over the corner are 1/60 of x^2 and 1/120 of x y; about the centroid 1/96 less.
  const double square = 1.0 / 60.0 - 1.0 / 96.0;
  const double product = 1.0 / 120.0 - 1.0 / 96.0;
  const Eigen::Matrix3d inertia =
      Eigen::Matrix3d::Constant(-product) + (2.0 * square + product) * Eigen::Matrix3d::Identity();
  for (const auto& [shift, tolerance] :
       {std::pair(Eigen::Vector3d(3.0, -7.0, 11.0), 1e-13), {{0x1p20, 0x1p20, 0x1p20}, 1e-9}}) {
    const Positions points = (turn * mesh.points).colwise() + shift;
    const MeshMeasures measures = measureMesh(points, mesh.triangles);
    EXPECT_NEAR(measures.volume, 1.0 / 6.0, tolerance);
    EXPECT_NEAR(signedVolume(points, mesh.triangles), 1.0 / 6.0, tolerance);
    EXPECT_NEAR(measures.area, 1.5 + std::sqrt(3.0) / 2.0, tolerance);
    EXPECT_NEAR(surfaceArea(points, mesh.triangles), 1.5 + std::sqrt(3.0) / 2.0, tolerance);
    EXPECT_NEAR(measures.mean_edge_length, (1.0 + std::sqrt(2.0)) / 2.0, tolerance);
    const Eigen::Vector3d centroid = turn * Eigen::Vector3d::Constant(0.25) + shift;
    EXPECT_LT((measures.centroid - centroid).norm(), tolerance);
    EXPECT_LT((measures.inertia - turn * inertia * turn.transpose()).norm(), tolerance);
    EXPECT_EQ(measures.box_min, points.rowwise().minCoeff());
    EXPECT_EQ(measures.box_max, points.rowwise().maxCoeff());
  }
}

TEST(MeshMeasures, FlatMeshHasTheCentroidOfItsSurface) {
  // A triangle, seen from both sides.
  const Positions points = positionsOf({{0, 0, 0}, {3, 0, 0}, {0, 3, 0}});
  const MeshMeasures measures = measureMesh(points, Triangles{{0, 0}, {1, 2}, {2, 1}});
  EXPECT_EQ(measures.volume, 0.0);
  EXPECT_NEAR(measures.area, 9.0, 1e-14);
  EXPECT_LT((measures.centroid - Eigen::Vector3d(1.0, 1.0, 0.0)).norm(), 1e-15);
  EXPECT_LT(measures.inertia.norm(), 1e-14);
  EXPECT_EQ(measureMesh(Positions(3, 0), Triangles(3, 0)).mean_edge_length, 0.0);
}

TEST(AreaWeightedNormals, AreTheSumsOfTheTriangles) {
  const Mesh mesh = cornerTetrahedron();
  const Positions normals = areaWeightedNormals(mesh.points, mesh.triangles);
  // The three triangles at the origin have the normals -z, -y and -x; the fourth has (1, 1, 1).
  EXPECT_EQ(normals, positionsOf({{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
}

}  // namespace
}  // namespace spherical_param::test
