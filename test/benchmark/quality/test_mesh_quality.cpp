#include "mesh_quality.h"
#include "ply_file.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::benchmark;
using Eigen::Vector3d;
using spherical_param::Index;
using spherical_param::Positions;
using spherical_param::Triangles;

/// What differs from exact arithmetic on numbers around 1.
constexpr double kRounding = 1e-12;

/// Three corners for each triangle.
Mesh meshOf(const std::vector<Vector3d>& points, const std::vector<Index>& corners) {
  Mesh mesh{Positions(3, static_cast<Eigen::Index>(points.size())),
            Eigen::Map<const Triangles>(corners.data(), 3,
                                        static_cast<Eigen::Index>(corners.size() / 3))};
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.points.col(static_cast<Eigen::Index>(i)) = points[i];
  return mesh;
}

/// Vertices +x, +y, -x, -y, +z, -z; triangles 0 to 3 are those at +z.
Mesh octahedron() {
  return meshOf({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5});
}

/// [0, 1]^3. Vertex x + 2 y + 4 z; the first two triangles are those of z = 0.
Mesh cube() {
  std::vector<Vector3d> points;
  for (int i = 0; i < 8; ++i)
    points.emplace_back(i % 2, i / 2 % 2, i / 4);
  return meshOf(points, {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                         2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5});
}

/// The connectivity of a torus on seven vertices (Moebius 1861), all of them at one place.
Mesh torus() {
  std::vector<Index> corners;
  for (Index i = 0; i < 7; ++i)
    for (const Index corner : {i, i + 1, i + 3, i, i + 3, i + 2})
      corners.push_back(corner % 7);
  return meshOf(std::vector<Vector3d>(7, Vector3d::Zero()), corners);
}

Mesh together(const Mesh& a, const Mesh& b) {
  Mesh both{Positions(3, a.points.cols() + b.points.cols()),
            Triangles(3, a.triangles.cols() + b.triangles.cols())};
  both.points << a.points, b.points;
  const Triangles shifted = b.triangles.array() + static_cast<Index>(a.points.cols());
  both.triangles << a.triangles, shifted;
  return both;
}

/// Without its first triangles.
Mesh without(Mesh mesh, Eigen::Index count) {
  mesh.triangles = mesh.triangles.rightCols(mesh.triangles.cols() - count).eval();
  return mesh;
}

Mesh insideOut(Mesh mesh) {
  mesh.triangles.row(0).swap(mesh.triangles.row(1));
  return mesh;
}

TEST(MeshQuality, PolyhedraAloneAreSpheresWhicheverWayTheirTrianglesRun) {
  EXPECT_TRUE(isClosedManifoldGenus0(octahedron()));
  Mesh mesh = cube();
  std::swap(mesh.triangles(0, 5), mesh.triangles(1, 5));
  EXPECT_TRUE(isClosedManifoldGenus0(mesh));

  const Mesh two = together(octahedron(), octahedron());
  // Two octahedra that share two vertices have the Euler characteristic of a sphere.
  Mesh touching = two;
  touching.triangles =
      (two.triangles.array() >= 10).select(two.triangles.array() - 6, two.triangles);
  Mesh third_at_edge = octahedron();
  third_at_edge.triangles.conservativeResize(3, 9);
  third_at_edge.triangles.col(8) << 0, 1, 2;
  Mesh degenerate = third_at_edge;
  degenerate.triangles.col(8) << 1, 1, 2;
  // The icosahedron with opposite vertices identified.
  const Mesh projective_plane = meshOf(
      std::vector<Vector3d>(6, Vector3d::Zero()),
      {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 1, 1, 2, 4, 2, 3, 5, 3, 4, 1, 4, 5, 2, 5, 1, 3});
  const std::vector<Mesh> others{torus(),       two,        without(octahedron(), 1), touching,
                                 third_at_edge, degenerate, projective_plane};
  for (std::size_t i = 0; i < others.size(); ++i)
    EXPECT_FALSE(isClosedManifoldGenus0(others[i])) << "mesh " << i;
}

TEST(MeshQuality, PointsAreUsedIfAVertexIsExactlyThere) {
  Mesh mesh = octahedron();
  mesh.points.col(4) << 0, 0, 0.1;
  Positions cloud(3, 8);
  const double none = std::numeric_limits<double>::quiet_NaN();
  cloud << mesh.points, Vector3d(0, 0, 0), Vector3d(none, 0, 0);
  // What a file in single precision makes of it.
  cloud(2, 4) = static_cast<double>(0.1F);
  EXPECT_DOUBLE_EQ(pointsUsedPercent(mesh, cloud), 100.0 * 6 / 7);
  cloud(2, 4) = 0.1001;
  EXPECT_DOUBLE_EQ(pointsUsedPercent(mesh, cloud), 100.0 * 5 / 7);
  // A vertex without triangles does not use its point.
  EXPECT_DOUBLE_EQ(pointsUsedPercent(without(octahedron(), 4), octahedron().points), 100.0 * 5 / 6);
}

TEST(MeshQuality, AFlippedEdgeIsNotReproduced) {
  const Mesh truth = cube();
  Mesh mesh = truth;
  mesh.triangles.col(0) << 0, 2, 1;
  mesh.triangles.col(1) << 2, 3, 1;
  // Positions are compared, not indices.
  mesh.points.rowwise().reverseInPlace();
  mesh.triangles = 7 - mesh.triangles.array();
  EXPECT_DOUBLE_EQ(edgesReproducedPercent(mesh, truth, truth.points).value(), 100.0 * 17 / 18);
  mesh.points.row(0).array() += 0.1;
  EXPECT_DOUBLE_EQ(edgesReproducedPercent(mesh, truth, truth.points).value(), 0.0);
  EXPECT_FALSE(edgesReproducedPercent(mesh, truth, mesh.points));
}

TEST(MeshQuality, SmallestAnglesOfIsoscelesTriangles) {
  std::vector<Vector3d> points = {{-1, 0, 0}, {1, 0, 0}};
  std::vector<Index> corners;
  for (const double angle : {45.0, 5.0, 0.5, 0.0}) {
    points.emplace_back(0.0, std::tan(angle * std::acos(-1.0) / 180.0), 0.0);
    corners.insert(corners.end(), {0, 1, static_cast<Index>(points.size() - 1)});
  }
  const TriangleShapes found = measureTriangleShapes(meshOf(points, corners));
  EXPECT_NEAR(found.min_angle_mean, 50.5 / 4.0, 100.0 * kRounding);
  EXPECT_DOUBLE_EQ(found.below_10_percent, 75.0);
}

TEST(MeshQuality, DistancesOfShiftedAndTiltedSquares) {
  const Mesh square = meshOf({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {0, 1, 2, 0, 2, 3});
  const double percent = 100.0 / std::sqrt(8.0);
  Mesh shifted = square;
  shifted.points.row(2).array() += 0.25;
  const auto found = measureDistances(shifted, square, 1000);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->hausdorff, 0.25 * percent, 100.0 * kRounding);
  EXPECT_NEAR(found->rms, 0.25 * percent, 100.0 * kRounding);
  EXPECT_EQ(found->normal_deviation, 0.0);

  const double angle = 40.0 * std::acos(-1.0) / 180.0;
  Mesh tilted = square;
  tilted.points = Eigen::AngleAxisd(angle, Vector3d::UnitX()).toRotationMatrix() * tilted.points;
  for (const Mesh& mesh : {tilted, insideOut(tilted)}) {
    const auto turned = measureDistances(mesh, square, 1000);
    ASSERT_TRUE(turned);
    EXPECT_NEAR(turned->hausdorff, std::sin(angle) * percent, 100.0 * kRounding);
    EXPECT_NEAR(turned->normal_deviation, 40.0, 100.0 * kRounding);
  }
}

/// By the foot of the point in the plane, or on the nearest side.
double distanceToTriangle(const Vector3d& p, const std::array<Vector3d, 3>& corners) {
  const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  const double height = normal.dot(p - corners[0]);
  double nearest = std::abs(height);
  double to_sides = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d side = corners[(k + 1) % 3] - corners[k];
    const Vector3d from_corner = p - corners[k];
    const double along = std::clamp(from_corner.dot(side) / side.squaredNorm(), 0.0, 1.0);
    to_sides = std::min(to_sides, (from_corner - along * side).norm());
    if (side.cross(from_corner - height * normal).dot(normal) < 0.0)
      nearest = std::numeric_limits<double>::infinity();
  }
  return std::min(nearest, to_sides);
}

TEST(MeshQuality, NearestPointsAreThoseOfBruteForce) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  std::vector<Vector3d> points;
  std::vector<Index> corners;
  for (Index t = 0; t < 200; ++t) {
    // Of all sizes, some of them thin, some without any area.
    const Vector3d a = point();
    const Vector3d b = a + std::pow(10.0, 1.5 * uniform(random) - 1.5) * point();
    const Vector3d c = t % 3 == 0   ? Vector3d(a + 0.5 * (b - a) + 1e-6 * point())
                       : t % 7 == 0 ? b
                                    : Vector3d(a + 0.3 * point());
    points.insert(points.end(), {a, b, c});
    corners.insert(corners.end(), {3 * t, 3 * t + 1, 3 * t + 2});
  }
  const Positions queries = 1.5 * Positions::Random(3, 60);
  const std::vector<double> found = distancesTo(meshOf(points, corners), queries);
  for (std::size_t i = 0; i < found.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < corners.size() / 3; ++t)
      if (t % 3 == 0 || t % 7 != 0)
        nearest = std::min(
            nearest, distanceToTriangle(queries.col(static_cast<Eigen::Index>(i)),
                                        {points[3 * t], points[3 * t + 1], points[3 * t + 2]}));
    // The thin triangles are ill-conditioned by 1e-6.
    EXPECT_NEAR(found[i], nearest, 1e-9);
  }
}

TEST(MeshQuality, AMeshWithoutAreaHasNoDistances) {
  const Mesh line = meshOf({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {0, 1, 2});
  EXPECT_FALSE(measureDistances(line, cube(), 10));
  EXPECT_FALSE(measureDistances(cube(), line, 10));
}

TEST(MeshQuality, DistortionOfAStretchedOctahedron) {
  Mesh mesh = octahedron();
  const Positions sphere = mesh.points;
  mesh.points(2, 4) = 2.0;
  // The triangles at +z are stretched by sqrt(3) across their side of length sqrt(2), the others
  // are as they were.
  const double stretch = std::sqrt(3.0);
  const double large = 0.5 * std::sqrt(2.0) * std::sqrt(4.5);
  const double small = 0.5 * std::sqrt(2.0) * std::sqrt(1.5);
  const double total = 4.0 * (large + small);
  const double of_large = std::log2(total / 8.0 / large);
  const double of_small = std::log2(total / 8.0 / small);
  const MapDistortion found = measureMapDistortion(mesh, sphere);
  EXPECT_NEAR(found.angle_mean, 4.0 * (large * stretch + small) / total, kRounding);
  EXPECT_NEAR(found.angle_p95, stretch, kRounding);
  EXPECT_NEAR(found.area_rms_log2,
              std::sqrt(4.0 * (large * of_large * of_large + small * of_small * of_small) / total),
              kRounding);
}

TEST(MeshQuality, AVertexMovedAcrossInvertsItsTrianglesUnlessRoundingCouldHave) {
  const Mesh mesh = octahedron();
  // Where +z is moved to; its neighbours lie on the equator.
  for (const double height : {-0.1, 3e-8, 0.0, -3e-8}) {
    Positions sphere = mesh.points;
    sphere.col(4) = Vector3d(1.0, height == -0.1 ? 1.0 : 0.0, height);
    for (const Mesh& one : {mesh, insideOut(mesh)}) {
      const MapDistortion found = measureMapDistortion(one, sphere);
      EXPECT_EQ(found.inverted_triangles, height == -0.1 ? 4 : 0) << height;
      EXPECT_EQ(found.collapsed_triangles, height == -0.1 ? 0 : 4) << height;
    }
  }
}

TEST(MeshQuality, AFileHoldsTheMeshThatWasWritten) {
  const std::string path = testing::TempDir() + "mesh_quality.ply";
  writePly(path, cube());
  const Mesh read = readPly(path);
  EXPECT_EQ(read.points, cube().points);
  EXPECT_EQ(read.triangles, cube().triangles);
  Mesh wrong = cube();
  wrong.triangles(0, 0) = 8;
  writePly(path, wrong);
  EXPECT_THROW(readPly(path), std::runtime_error);
  std::remove(path.c_str());
  EXPECT_THROW(readPly(path), std::runtime_error);
}

}  // namespace
