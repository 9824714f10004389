#include "spherical_param/mesh_measures.h"

#include "helpers.h"
#include "sphere_triangulation.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "triangle_lists.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace spherical_param {
namespace {

struct Mesh {
  Positions points;
  Triangles triangles;
};

/// The box [0, a] x [0, b] x [0, c].
Mesh box(double a, double b, double c) {
  Mesh mesh{Positions(3, 8), test::trianglesOf({{0, 2, 1},
                                                {1, 2, 3},
                                                {4, 5, 6},
                                                {5, 7, 6},
                                                {0, 1, 4},
                                                {1, 5, 4},
                                                {2, 6, 3},
                                                {3, 6, 7},
                                                {0, 4, 2},
                                                {2, 4, 6},
                                                {1, 3, 5},
                                                {3, 7, 5}})};
  for (Index i = 0; i < 8; ++i)
    mesh.points.col(i) << (i % 2) * a, (i / 2 % 2) * b, (i / 4) * c;
  return mesh;
}

Mesh cornerTetrahedron() {
  Mesh mesh{Positions::Zero(3, 4), test::trianglesOf({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})};
  mesh.points.rightCols(3) = Eigen::Matrix3d::Identity();
  return mesh;
}

/// A unit sphere of n points.
Mesh sphere(Index n) {
  const Positions points = test::spiralSphere(n);
  return {points, triangulateSphere(points)};
}

/// A body without any symmetry: an ellipsoid that is pulled to one side.
Mesh lopsided() {
  Mesh mesh = sphere(300);
  for (Eigen::Index i = 0; i < mesh.points.cols(); ++i) {
    const Eigen::Vector3d p = mesh.points.col(i);
    mesh.points.col(i) << 1.0 * p.x() + 0.3 * p.y() * p.y(), 0.7 * p.y() + 0.2 * p.x() * p.z(),
        0.5 * p.z() + 0.1 * p.x();
  }
  return mesh;
}

TEST(MeshMeasures, BoxHasItsTextbookMeasures) {
  const double a = 2.0;
  const double b = 3.0;
  const double c = 5.0;
  const Mesh mesh = box(a, b, c);
  const MeshMeasures measures = measureMesh(mesh.points, mesh.triangles);
  EXPECT_NEAR(measures.volume, a * b * c, 1e-13);
  EXPECT_NEAR(measures.area, 2.0 * (a * b + b * c + c * a), 1e-13);
  EXPECT_EQ(measures.box_min, Eigen::Vector3d::Zero());
  EXPECT_EQ(measures.box_max, Eigen::Vector3d(a, b, c));
  EXPECT_LT((measures.centroid - Eigen::Vector3d(a, b, c) / 2.0).norm(), 1e-14);
  const Eigen::Vector3d moments =
      a * b * c / 12.0 * Eigen::Vector3d(b * b + c * c, c * c + a * a, a * a + b * b);
  EXPECT_LT((measures.inertia - Eigen::Matrix3d(moments.asDiagonal())).norm(), 1e-12);
  // 4 edges of each length, and the diagonals of 6 faces.
  const double lengths =
      4.0 * (a + b + c) + 2.0 * (std::hypot(a, b) + std::hypot(b, c) + std::hypot(c, a));
  EXPECT_NEAR(measures.mean_edge_length, lengths / 18.0, 1e-14);
}

TEST(MeshMeasures, TetrahedronHasProductsOfInertia) {
  const Mesh mesh = cornerTetrahedron();
  const MeshMeasures measures = measureMesh(mesh.points, mesh.triangles);
  EXPECT_NEAR(measures.volume, 1.0 / 6.0, 1e-16);
  EXPECT_NEAR(measures.area, 1.5 + std::sqrt(3.0) / 2.0, 1e-15);
  EXPECT_LT((measures.centroid - Eigen::Vector3d::Constant(0.25)).norm(), 1e-15);
  // The integrals over the corner are 1/60 of x^2 and 1/120 of x y; about the centroid 1/96 less.
  const double square = 1.0 / 60.0 - 1.0 / 96.0;
  const double product = 1.0 / 120.0 - 1.0 / 96.0;
  const Eigen::Matrix3d expected =
      Eigen::Matrix3d::Constant(-product) + (2.0 * square + product) * Eigen::Matrix3d::Identity();
  EXPECT_LT((measures.inertia - expected).norm(), 1e-16);
}

TEST(MeshMeasures, InscribedEllipsoidHasNearlyItsMeasures) {
  const Eigen::Vector3d axes(1.0, 0.7, 0.5);
  const double volume = 4.0 / 3.0 * test::kPi * axes.prod();
  const Eigen::Vector3d squares = axes.cwiseAbs2();
  const Eigen::Vector3d moments =
      volume / 5.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares);
  const Mesh mesh = sphere(40000);
  const MeshMeasures measures = measureMesh(axes.asDiagonal() * mesh.points, mesh.triangles);
  // A flat triangle is about the square of its side, 4 pi / n, below the sphere of radius 1.
  EXPECT_GT(volume, measures.volume);
  EXPECT_NEAR(measures.volume, volume, 4.0 * test::kPi / 40000 * volume);
  EXPECT_LT((Eigen::Matrix3d(moments.asDiagonal()) - measures.inertia).norm(),
            8.0 * test::kPi / 40000 * moments.norm());
  EXPECT_LT(measures.centroid.norm(), 1e-6);
}

TEST(MeshMeasures, MotionMovesTheCentroidAndTurnsTheInertia) {
  const Mesh mesh = lopsided();
  const MeshMeasures still = measureMesh(mesh.points, mesh.triangles);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(3.0, -7.0, 11.0);
  const Positions moved = (turn * mesh.points).colwise() + shift;
  const MeshMeasures measures = measureMesh(moved, mesh.triangles);
  EXPECT_NEAR(measures.volume, still.volume, 1e-13);
  EXPECT_NEAR(measures.area, still.area, 1e-13);
  EXPECT_NEAR(measures.mean_edge_length, still.mean_edge_length, 1e-14);
  EXPECT_LT((measures.centroid - (turn * still.centroid + shift)).norm(), 1e-13);
  EXPECT_LT((measures.inertia - turn * still.inertia * turn.transpose()).norm(), 1e-13);
  EXPECT_EQ(measures.box_min, moved.rowwise().minCoeff());
  EXPECT_EQ(measures.box_max, moved.rowwise().maxCoeff());
}

TEST(MeshMeasures, ScaleRaisesEachMeasureToItsPower) {
  const Mesh mesh = lopsided();
  const MeshMeasures one = measureMesh(mesh.points, mesh.triangles);
  // Powers of two scale exactly.
  for (const double scale : {0x1p-20, 0x1p30}) {
    const MeshMeasures measures = measureMesh(scale * mesh.points, mesh.triangles);
    EXPECT_EQ(measures.volume, std::pow(scale, 3) * one.volume);
    EXPECT_EQ(measures.area, std::pow(scale, 2) * one.area);
    EXPECT_EQ(measures.mean_edge_length, scale * one.mean_edge_length);
    EXPECT_EQ(measures.centroid, scale * one.centroid);
    EXPECT_EQ(measures.inertia, std::pow(scale, 5) * one.inertia);
  }
}

TEST(MeshMeasures, FarOriginCostsNoMoreDigitsThanThePointsLose) {
  const Mesh mesh = lopsided();
  const MeshMeasures near = measureMesh(mesh.points, mesh.triangles);
  const Eigen::Vector3d shift = Eigen::Vector3d::Constant(0x1p20);
  const MeshMeasures far = measureMesh(mesh.points.colwise() + shift, mesh.triangles);
  // The points themselves are rounded to 2^20 * 2^-53 = 1.2e-10; sums about the origin would lose
  // the volume at (2^20)^3 * 2^-53 = 128.
  EXPECT_NEAR(far.volume, near.volume, 1e-8);
  EXPECT_LT((far.centroid - shift - near.centroid).norm(), 1e-8);
  EXPECT_LT((far.inertia - near.inertia).norm(), 1e-8);
}

TEST(MeshMeasures, TurnedInsideOutVolumeAndInertiaChangeSign) {
  const Mesh mesh = lopsided();
  Triangles turned = mesh.triangles;
  flipOrientation(turned);
  const MeshMeasures outward = measureMesh(mesh.points, mesh.triangles);
  const MeshMeasures inward = measureMesh(mesh.points, turned);
  EXPECT_NEAR(inward.volume, -outward.volume, 1e-15);
  EXPECT_LT((inward.centroid - outward.centroid).norm(), 1e-15);
  EXPECT_LT((inward.inertia + outward.inertia).norm(), 1e-15);
}

TEST(MeshMeasures, FlatMeshHasTheCentroidOfItsSurface) {
  // A triangle, seen from both sides.
  Positions points = Positions::Zero(3, 3);
  points.col(1) << 3.0, 0.0, 0.0;
  points.col(2) << 0.0, 3.0, 0.0;
  const MeshMeasures measures = measureMesh(points, test::trianglesOf({{0, 1, 2}, {0, 2, 1}}));
  EXPECT_EQ(measures.volume, 0.0);
  EXPECT_NEAR(measures.area, 9.0, 1e-14);
  EXPECT_LT((measures.centroid - Eigen::Vector3d(1.0, 1.0, 0.0)).norm(), 1e-15);
  EXPECT_LT(measures.inertia.norm(), 1e-14);
  EXPECT_EQ(measureMesh(Positions(3, 0), Triangles(3, 0)).mean_edge_length, 0.0);
}

TEST(MeshMeasures, BadInputIsInvalidInput) {
  EXPECT_THROW(measureMesh(Positions(3, 0), Triangles(3, 0), -1), InvalidInput);
  EXPECT_THROW(measureMesh(Positions(3, 0), Triangles(3, 0), 1025), InvalidInput);
  const Mesh mesh = cornerTetrahedron();
  EXPECT_THROW(measureMesh(mesh.points.leftCols(3), mesh.triangles), InvalidInput);
  EXPECT_THROW(measureMesh(mesh.points, test::trianglesOf({{0, 1, -1}})), InvalidInput);
  EXPECT_THROW(areaWeightedNormals(mesh.points.leftCols(3), mesh.triangles), InvalidInput);
}

TEST(AreaWeightedNormals, AreTheSumsOfTheTriangles) {
  const Mesh mesh = cornerTetrahedron();
  const Positions normals = areaWeightedNormals(mesh.points, mesh.triangles);
  // The three triangles at the origin have the normals -z, -y and -x; the fourth has (1, 1, 1).
  EXPECT_EQ(Eigen::Vector3d(normals.col(0)), Eigen::Vector3d(-1.0, -1.0, -1.0));
  EXPECT_EQ(Eigen::Vector3d(normals.col(1)), Eigen::Vector3d(1.0, 0.0, 0.0));
  EXPECT_EQ(Eigen::Vector3d(normals.col(2)), Eigen::Vector3d(0.0, 1.0, 0.0));
  EXPECT_EQ(Eigen::Vector3d(normals.col(3)), Eigen::Vector3d(0.0, 0.0, 1.0));
}

}  // namespace
}  // namespace spherical_param
