#include "mesh_quality.h"
#include "tool_runner.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace spherical_param::benchmark;
using Eigen::Vector3d;
using nlohmann::json;
using spherical_param::Index;
using spherical_param::Positions;
using spherical_param::Triangles;

/// What differs from exact arithmetic on numbers around 1.
constexpr double kRounding = 1e-12;

Mesh meshOf(const std::vector<Vector3d>& points, const std::vector<std::array<Index, 3>>& faces) {
  Mesh mesh{Positions(3, static_cast<Eigen::Index>(points.size())),
            Triangles(3, static_cast<Eigen::Index>(faces.size()))};
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.points.col(static_cast<Eigen::Index>(i)) = points[i];
  for (std::size_t t = 0; t < faces.size(); ++t)
    mesh.triangles.col(static_cast<Eigen::Index>(t)) << faces[t][0], faces[t][1], faces[t][2];
  return mesh;
}

Mesh tetrahedron() {
  return meshOf({{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}},
                {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
}

/// Vertices +x, +y, -x, -y, +z, -z; triangles 0 to 3 are those at +z.
Mesh octahedron() {
  return meshOf(
      {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}});
}

/// [0, 1]^3. Vertex x + 2 y + 4 z; the first two triangles are those of z = 0.
Mesh cube() {
  std::vector<Vector3d> points;
  for (int i = 0; i < 8; ++i)
    points.emplace_back(i % 2, i / 2 % 2, i / 4);
  return meshOf(points, {{0, 2, 3},
                         {0, 3, 1},
                         {4, 5, 7},
                         {4, 7, 6},
                         {0, 1, 5},
                         {0, 5, 4},
                         {2, 6, 7},
                         {2, 7, 3},
                         {0, 4, 6},
                         {0, 6, 2},
                         {1, 3, 7},
                         {1, 7, 5}});
}

Mesh torus(int around, int across) {
  std::vector<Vector3d> points;
  std::vector<std::array<Index, 3>> faces;
  const double turn = 2.0 * std::acos(-1.0);
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double a = turn * i / around;
      const double b = turn * j / across;
      const double radius = 3.0 + std::cos(b);
      points.emplace_back(radius * std::cos(a), radius * std::sin(a), std::sin(b));
      const auto at = [&](int u, int v) { return u % around * across + v % across; };
      faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return meshOf(points, faces);
}

/// The octahedron with every triangle cut in four, `times` times, and all vertices on the sphere.
/// Corners are not shared.
Mesh roundedOctahedron(int times) {
  std::vector<std::array<Vector3d, 3>> corners;
  const Mesh coarse = octahedron();
  for (Eigen::Index t = 0; t < coarse.triangles.cols(); ++t)
    corners.push_back({coarse.points.col(coarse.triangles(0, t)),
                       coarse.points.col(coarse.triangles(1, t)),
                       coarse.points.col(coarse.triangles(2, t))});
  for (int i = 0; i < times; ++i) {
    std::vector<std::array<Vector3d, 3>> finer;
    for (const auto& [a, b, c] : corners) {
      const Vector3d ab = (a + b).normalized();
      const Vector3d bc = (b + c).normalized();
      const Vector3d ca = (c + a).normalized();
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    corners = finer;
  }
  std::vector<Vector3d> points;
  std::vector<std::array<Index, 3>> faces;
  for (const auto& triangle : corners) {
    const auto first = static_cast<Index>(points.size());
    points.insert(points.end(), triangle.begin(), triangle.end());
    faces.push_back({first, first + 1, first + 2});
  }
  return meshOf(points, faces);
}

/// The square [-1, 1]^2 of the plane z = 0.
Mesh square() {
  return meshOf({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
}

Mesh together(const Mesh& a, const Mesh& b) {
  Mesh both{Positions(3, a.points.cols() + b.points.cols()),
            Triangles(3, a.triangles.cols() + b.triangles.cols())};
  both.points << a.points, b.points;
  const Triangles shifted = b.triangles.array() + static_cast<Index>(a.points.cols());
  both.triangles << a.triangles, shifted;
  return both;
}

Mesh moved(Mesh mesh, const Vector3d& by) {
  mesh.points.colwise() += by;
  return mesh;
}

Mesh without(const Mesh& mesh, const std::vector<Eigen::Index>& triangles) {
  Mesh rest{mesh.points, Triangles(3, mesh.triangles.cols())};
  Eigen::Index end = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    if (std::find(triangles.begin(), triangles.end(), t) == triangles.end())
      rest.triangles.col(end++) = mesh.triangles.col(t);
  rest.triangles.conservativeResize(3, end);
  return rest;
}

Mesh turnedOver(Mesh mesh, Eigen::Index triangle) {
  std::swap(mesh.triangles(0, triangle), mesh.triangles(1, triangle));
  return mesh;
}

Mesh insideOut(Mesh mesh) {
  mesh.triangles.row(0).swap(mesh.triangles.row(1));
  return mesh;
}

// --- Connectivity --------------------------------------------------------------------------------

TEST(MeshQuality, PolyhedraAreSpheres) {
  struct Polyhedron {
    Mesh mesh;
    Count vertices;
    Count edges;
  };
  for (const Polyhedron& p : {Polyhedron{tetrahedron(), 4, 6}, Polyhedron{octahedron(), 6, 12},
                              Polyhedron{cube(), 8, 18}}) {
    const Connectivity found = measureConnectivity(p.mesh);
    EXPECT_EQ(found.vertices, p.vertices);
    EXPECT_EQ(found.edges, p.edges);
    EXPECT_EQ(found.triangles, p.mesh.triangles.cols());
    EXPECT_EQ(found.euler_characteristic, 2);
    EXPECT_EQ(found.components, 1);
    EXPECT_EQ(found.genus, Count{0});
    EXPECT_TRUE(found.closed && found.edgeManifold() && found.vertexManifold());
    EXPECT_TRUE(found.oriented && found.orientable && found.closedManifoldGenus0());
    EXPECT_EQ(found.boundary_edges + found.boundary_loops + found.unreferenced_vertices, 0);
    EXPECT_EQ(countRepeatedVertices(p.mesh), 0);
  }
}

TEST(MeshQuality, ATorusHasGenusOne) {
  const Connectivity found = measureConnectivity(torus(12, 7));
  EXPECT_EQ(found.genus, Count{1});
  EXPECT_EQ(found.euler_characteristic, 0);
  EXPECT_TRUE(found.closed && found.oriented);
  EXPECT_FALSE(found.closedManifoldGenus0());
}

TEST(MeshQuality, TwoSpheresAreNotOne) {
  const Connectivity found =
      measureConnectivity(together(octahedron(), moved(octahedron(), {5, 0, 0})));
  EXPECT_EQ(found.components, 2);
  EXPECT_EQ(found.genus, Count{0});
  EXPECT_EQ(found.euler_characteristic, 4);
  EXPECT_FALSE(found.closedManifoldGenus0());
}

TEST(MeshQuality, SpheresThatShareAVertexAreNoManifold) {
  Mesh mesh = together(octahedron(), moved(octahedron(), {2, 0, 0}));
  mesh.triangles = (mesh.triangles.array() == 8).select(0, mesh.triangles);
  const Connectivity found = measureConnectivity(mesh);
  EXPECT_EQ(found.nonmanifold_vertices, 1);
  EXPECT_EQ(found.unreferenced_vertices, 1);
  EXPECT_EQ(found.components, 1);
  EXPECT_TRUE(found.closed && found.edgeManifold());
  EXPECT_FALSE(found.vertexManifold());
  EXPECT_FALSE(found.genus);
}

TEST(MeshQuality, MissingTrianglesLeaveABoundary) {
  const Connectivity one = measureConnectivity(without(octahedron(), {0}));
  EXPECT_EQ(one.boundary_edges, 3);
  EXPECT_EQ(one.boundary_loops, 1);
  EXPECT_EQ(one.euler_characteristic, 1);
  EXPECT_FALSE(one.closed);
  EXPECT_FALSE(one.genus);
  EXPECT_TRUE(one.edgeManifold() && one.vertexManifold() && one.oriented);

  // Triangles 0 and 6 are opposite, 0 and 2 have one vertex in common.
  EXPECT_EQ(measureConnectivity(without(octahedron(), {0, 6})).boundary_loops, 2);
  const Connectivity touching = measureConnectivity(without(octahedron(), {0, 2}));
  EXPECT_EQ(touching.boundary_edges, 6);
  EXPECT_EQ(touching.boundary_loops, 1);
  EXPECT_EQ(touching.nonmanifold_vertices, 1);
}

TEST(MeshQuality, AThirdTriangleAtAnEdgeIsNoManifold) {
  const Connectivity found = measureConnectivity(meshOf(
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
  EXPECT_EQ(found.nonmanifold_edges, 1);
  EXPECT_EQ(found.boundary_edges, 6);
  EXPECT_FALSE(found.edgeManifold());
  EXPECT_FALSE(found.oriented);
}

TEST(MeshQuality, ATriangleTurnedOverIsNotOriented) {
  const Connectivity found = measureConnectivity(turnedOver(cube(), 5));
  EXPECT_FALSE(found.oriented);
  EXPECT_TRUE(found.orientable);
  EXPECT_TRUE(found.closedManifoldGenus0());
}

TEST(MeshQuality, OneSidedSurfacesAreNotOrientable) {
  const std::vector<Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                        {0, 0, 1}, {1, 1, 0}, {0, 1, 1}};
  const Connectivity moebius =
      measureConnectivity(meshOf(points, {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 0}, {4, 0, 1}}));
  EXPECT_FALSE(moebius.orientable);
  EXPECT_FALSE(moebius.oriented);
  EXPECT_EQ(moebius.boundary_loops, 1);
  EXPECT_EQ(moebius.euler_characteristic, 0);
  EXPECT_EQ(moebius.unreferenced_vertices, 1);

  // The projective plane: the icosahedron with opposite vertices identified.
  const Connectivity projective = measureConnectivity(meshOf(points, {{0, 1, 2},
                                                                      {0, 2, 3},
                                                                      {0, 3, 4},
                                                                      {0, 4, 5},
                                                                      {0, 5, 1},
                                                                      {1, 2, 4},
                                                                      {2, 3, 5},
                                                                      {3, 4, 1},
                                                                      {4, 5, 2},
                                                                      {5, 1, 3}}));
  EXPECT_TRUE(projective.closed && projective.edgeManifold() && projective.vertexManifold());
  EXPECT_EQ(projective.euler_characteristic, 1);
  EXPECT_FALSE(projective.orientable);
  EXPECT_FALSE(projective.genus);
  EXPECT_FALSE(projective.closedManifoldGenus0());
}

TEST(MeshQuality, VerticesAtOnePlaceStayApart) {
  // Eight triangles of three vertices each, at six places.
  const Mesh soup = roundedOctahedron(0);
  const Connectivity found = measureConnectivity(soup);
  EXPECT_EQ(found.components, 8);
  EXPECT_EQ(found.boundary_loops, 8);
  EXPECT_FALSE(found.closed);
  EXPECT_EQ(countRepeatedVertices(soup), 24 - 6);
}

TEST(MeshQuality, DegenerateTrianglesAreCountedAndLeftOut) {
  Mesh mesh = octahedron();
  mesh.triangles.conservativeResize(3, 9);
  mesh.triangles.col(8) << 1, 1, 2;
  const Connectivity found = measureConnectivity(mesh);
  EXPECT_EQ(found.degenerate_triangles, 1);
  EXPECT_EQ(found.triangles, 8);
  EXPECT_TRUE(found.closed);
  EXPECT_FALSE(found.closedManifoldGenus0());
}

// --- Cloud and edges -----------------------------------------------------------------------------

TEST(MeshQuality, PointsAreUsedWhereAVertexIsAtExactlyTheirPlace) {
  Mesh mesh = octahedron();
  mesh.points.col(4) << 0, 0, 0.1;
  Positions cloud(3, 9);
  const double none = std::numeric_limits<double>::quiet_NaN();
  cloud << mesh.points, Vector3d(0, 0, 0), Vector3d(none, 0, 0), Vector3d(1, 0, 0);
  // What a file in single precision makes of it.
  cloud(2, 4) = static_cast<double>(0.1F);
  CloudCoverage found = measureCloudCoverage(mesh, cloud);
  EXPECT_EQ(found.points, 8);
  EXPECT_EQ(found.points_used, 7);
  EXPECT_EQ(found.extra_vertices, 0);
  EXPECT_TRUE(isOverCloud(mesh, cloud));

  cloud(2, 4) = 0.1001;
  found = measureCloudCoverage(mesh, cloud);
  EXPECT_EQ(found.points_used, 6);
  EXPECT_EQ(found.extra_vertices, 1);
  EXPECT_FALSE(isOverCloud(mesh, cloud));

  // A vertex that no triangle uses does not use its point.
  found = measureCloudCoverage(without(mesh, {0, 1, 2, 3}), cloud);
  EXPECT_EQ(found.points_used, 6);
  EXPECT_EQ(found.extra_vertices, 0);
}

TEST(MeshQuality, AFlippedEdgeIsNotReproduced) {
  const Mesh truth = cube();
  Mesh mesh = truth;
  mesh.triangles.col(0) << 0, 2, 1;
  mesh.triangles.col(1) << 2, 3, 1;
  EdgeAgreement found = compareEdges(mesh, truth);
  EXPECT_DOUBLE_EQ(found.reproduced, 17.0 / 18.0);
  EXPECT_DOUBLE_EQ(found.precision, 17.0 / 18.0);

  // Places count, not numbers.
  mesh.points.rowwise().reverseInPlace();
  mesh.triangles = 7 - mesh.triangles.array();
  found = compareEdges(mesh, truth);
  EXPECT_DOUBLE_EQ(found.reproduced, 17.0 / 18.0);

  // Without the face, its diagonal is missing, too.
  found = compareEdges(without(mesh, {0, 1}), truth);
  EXPECT_DOUBLE_EQ(found.reproduced, 17.0 / 18.0);
  EXPECT_DOUBLE_EQ(found.precision, 1.0);
  EXPECT_DOUBLE_EQ(compareEdges(moved(mesh, {0.1, 0, 0}), truth).reproduced, 0.0);
}

// --- Triangles -----------------------------------------------------------------------------------

TEST(MeshQuality, LeastAnglesOfPolyhedra) {
  const TriangleShapes even = measureTriangleShapes(tetrahedron());
  EXPECT_NEAR(even.min_angle_mean, 60.0, 60.0 * kRounding);
  EXPECT_NEAR(even.min_angle_p05, 60.0, 60.0 * kRounding);
  EXPECT_EQ(even.share_below_10, 0.0);
  EXPECT_NEAR(measureTriangleShapes(cube()).min_angle_mean, 45.0, 45.0 * kRounding);
}

TEST(MeshQuality, NeedlesAreCounted) {
  // Isosceles triangles with angles of 45, 5 and 0.5 degrees at their base, and one that is flat.
  std::vector<Vector3d> points = {{-1, 0, 0}, {1, 0, 0}};
  std::vector<std::array<Index, 3>> faces;
  for (const double angle : {45.0, 5.0, 0.5, 0.0}) {
    points.emplace_back(0.0, std::tan(angle * std::acos(-1.0) / 180.0), 0.0);
    faces.push_back({0, 1, static_cast<Index>(points.size() - 1)});
  }
  const TriangleShapes found = measureTriangleShapes(meshOf(points, faces));
  EXPECT_NEAR(found.min_angle_mean, 50.5 / 4.0, 100.0 * kRounding);
  EXPECT_EQ(found.min_angle_p05, 0.0);
  EXPECT_DOUBLE_EQ(found.share_below_10, 0.75);
  EXPECT_DOUBLE_EQ(found.share_below_1, 0.5);
  EXPECT_EQ(found.zero_area_triangles, 1);
}

TEST(MeshQuality, VolumeAndAreaOfTheCube) {
  EXPECT_NEAR(signedVolume(cube(), {3, 2, 1}), 1.0, kRounding);
  EXPECT_NEAR(signedVolume(insideOut(cube()), {3, 2, 1}), -1.0, kRounding);
  EXPECT_NEAR(surfaceArea(cube()), 6.0, kRounding);
  EXPECT_NEAR(boundsOf(cube()).diagonal(), std::sqrt(3.0), kRounding);
}

TEST(MeshQuality, TheTipOfATetrahedronIntersectsTheFaceThatItPierces) {
  const Mesh large = meshOf({{-3, -3, 0}, {3, -3, 0}, {0, 3, 0}, {0, 0, -3}},
                            {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}});
  const Mesh small = meshOf({{-0.5, -0.5, 1}, {0.5, -0.5, 1}, {0, 0.5, 1}, {0, 0, -0.5}},
                            {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}});
  const SelfIntersectionCount found = countSelfIntersections(together(large, small));
  EXPECT_EQ(found.pairs, 3);
  EXPECT_EQ(found.triangles, 4);
  EXPECT_EQ(countSelfIntersections(together(large, moved(small, {0, 0, 1}))).pairs, 0);
}

// --- Distances -----------------------------------------------------------------------------------

TEST(MeshQuality, ACubeScaledAboutItsCentre) {
  const Vector3d center = boundsOf(cube()).center();
  Mesh larger = moved(cube(), -center);
  larger.points *= 1.01;
  larger = moved(larger, center);
  const auto found = measureDistances(larger, cube(), {5000, 1});
  ASSERT_TRUE(found);
  // Every point of the smaller cube is below a point of the larger one.
  EXPECT_NEAR(found->hausdorff.truth_to_mesh, 0.005, kRounding);
  EXPECT_NEAR(found->rms.truth_to_mesh, 0.005, kRounding);
  EXPECT_NEAR(found->hausdorff.mesh_to_truth, 0.005 * std::sqrt(3.0), kRounding);
  EXPECT_EQ(found->bothHausdorff(), found->hausdorff.mesh_to_truth);
  // The larger one has rims 0.005 wide around its faces. What they add to the mean square is an
  // integral; it raises the root by 1.6e-5, which some 100 samples tell to within 10 %.
  const double rims = 2.0 * 2.0 * std::pow(0.005, 3) / 3.0 / 1.01;
  EXPECT_NEAR(found->rms.mesh_to_truth, std::sqrt(0.005 * 0.005 + rims), 0.4 * 1.6e-5);
  EXPECT_NEAR(found->both_rms,
              std::sqrt(0.5 * (std::pow(found->rms.mesh_to_truth, 2) + 0.005 * 0.005)), kRounding);
  EXPECT_GT(found->both_mean, 0.005);
  EXPECT_LE(found->both_mean, found->both_rms);
}

TEST(MeshQuality, ShiftedAndTiltedSquares) {
  const auto shifted = measureDistances(moved(square(), {0, 0, 0.25}), square(), {1000, 1});
  ASSERT_TRUE(shifted);
  EXPECT_NEAR(shifted->bothHausdorff(), 0.25, kRounding);
  EXPECT_NEAR(shifted->both_rms, 0.25, kRounding);
  EXPECT_NEAR(shifted->both_mean, 0.25, kRounding);
  EXPECT_EQ(shifted->normal_deviation, 0.0);

  for (const double degrees : {20.0, 40.0}) {
    const double angle = degrees * std::acos(-1.0) / 180.0;
    Mesh tilted = square();
    tilted.points = Eigen::AngleAxisd(angle, Vector3d::UnitX()).toRotationMatrix() * tilted.points;
    for (const Mesh& mesh : {tilted, insideOut(tilted)}) {
      const auto found = measureDistances(mesh, square(), {1000, 1});
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->hausdorff.mesh_to_truth, std::sin(angle), kRounding);
      EXPECT_NEAR(found->normal_deviation, degrees, degrees * kRounding);
      EXPECT_EQ(found->normal_deviation_over_30, degrees > 30.0 ? 1.0 : 0.0);
    }
  }
}

/// By the foot of the point in the plane.
double distanceToTriangle(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                          const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a).normalized();
  const Vector3d foot = p - normal.dot(p - a) * normal;
  const auto left = [&](const Vector3d& u, const Vector3d& v) {
    return (v - u).cross(foot - u).dot(normal) >= 0.0;
  };
  if (left(a, b) && left(b, c) && left(c, a))
    return (p - foot).norm();
  const auto to_side = [&](const Vector3d& u, const Vector3d& v) {
    const double along = (p - u).dot(v - u) / (v - u).squaredNorm();
    return (p - u - std::clamp(along, 0.0, 1.0) * (v - u)).norm();
  };
  return std::min({to_side(a, b), to_side(b, c), to_side(c, a)});
}

TEST(MeshQuality, DistancesAreThoseOfBruteForce) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  std::vector<Vector3d> points;
  std::vector<std::array<Index, 3>> faces;
  for (Index t = 0; t < 200; ++t) {
    // Of all sizes, some of them needles, some without any area.
    const Vector3d a = point();
    const Vector3d b = a + std::pow(10.0, 1.5 * uniform(random) - 1.5) * point();
    const Vector3d c = t % 3 == 0   ? Vector3d(a + 0.5 * (b - a) + 1e-6 * point())
                       : t % 7 == 0 ? b
                                    : Vector3d(a + 0.3 * point());
    points.insert(points.end(), {a, b, c});
    faces.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const Mesh truth = meshOf(points, faces);
  for (int i = 0; i < 60; ++i) {
    // All samples of so small a triangle are at one place.
    const Vector3d p = 1.5 * point();
    constexpr double small = 1e-7;
    const Mesh probe =
        meshOf({p, p + small * Vector3d::UnitX(), p + small * Vector3d::UnitY()}, {{0, 1, 2}});
    const auto found = measureDistances(probe, truth, {1, 1});
    ASSERT_TRUE(found);
    double nearest = std::numeric_limits<double>::infinity();
    for (Index t = 0; t < 200; ++t)
      if (t % 3 == 0 || t % 7 != 0)
        nearest = std::min(nearest, distanceToTriangle(p, truth.points.col(3 * t),
                                                       truth.points.col(3 * t + 1),
                                                       truth.points.col(3 * t + 2)));
    EXPECT_NEAR(found->rms.mesh_to_truth, nearest, 2.0 * small);
  }
}

TEST(MeshQuality, SamplesDependOnTheSeedAlone) {
  const Mesh mesh = torus(20, 10);
  const Mesh truth = torus(40, 20);
  const auto first = measureDistances(mesh, truth, {1000, 1});
  const auto again = measureDistances(mesh, truth, {1000, 1});
  const auto other = measureDistances(mesh, truth, {1000, 2});
  ASSERT_TRUE(first && again && other);
  EXPECT_EQ(first->both_rms, again->both_rms);
  EXPECT_EQ(first->normal_deviation, again->normal_deviation);
  EXPECT_NE(first->both_rms, other->both_rms);
  // Samples that are spread evenly tell nearly the same.
  EXPECT_NEAR(first->both_rms, other->both_rms, 0.05 * first->both_rms);
}

TEST(MeshQuality, AMeshWithoutAreaHasNoDistances) {
  const Mesh line = meshOf({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}});
  EXPECT_FALSE(measureDistances(line, cube()));
  EXPECT_FALSE(measureDistances(cube(), line));
}

// --- Map to the sphere ---------------------------------------------------------------------------

TEST(MeshQuality, ASphereMappedToItselfIsNotDistorted) {
  const Mesh sphere = roundedOctahedron(3);
  for (const Mesh& mesh : {sphere, insideOut(sphere)}) {
    // Turned inside out, the triangles of the sphere are those of the mesh, too.
    const MapDistortion found = measureMapDistortion(mesh, sphere.points);
    EXPECT_NEAR(found.angle_mean, 1.0, kRounding);
    EXPECT_NEAR(found.angle_p95, 1.0, kRounding);
    EXPECT_NEAR(found.area_rms_log2, 0.0, kRounding);
    EXPECT_EQ(found.inverted_triangles, 0);
    EXPECT_EQ(found.collapsed_triangles, 0);
  }
  const MapDistortion mirrored = measureMapDistortion(sphere, -sphere.points);
  EXPECT_EQ(mirrored.inverted_triangles, sphere.triangles.cols());
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
  EXPECT_NEAR(found.angle_median, stretch, kRounding);
  EXPECT_NEAR(found.angle_p95, stretch, kRounding);
  EXPECT_NEAR(found.area_rms_log2,
              std::sqrt(4.0 * (large * of_large * of_large + small * of_small * of_small) / total),
              kRounding);
  EXPECT_NEAR(found.area_p05_log2, of_large, kRounding);
  EXPECT_NEAR(found.area_p95_log2, of_small, kRounding);
}

TEST(MeshQuality, AVertexMovedAcrossInvertsItsTriangles) {
  const Mesh mesh = octahedron();
  Positions sphere = mesh.points;
  sphere.col(4) = Vector3d(0.5, 0.5, -0.1);
  const MapDistortion found = measureMapDistortion(mesh, sphere);
  // +z is below the equator now, on which its neighbours lie.
  EXPECT_EQ(found.inverted_triangles, 4);
  EXPECT_EQ(found.collapsed_triangles, 0);
  EXPECT_EQ(measureMapDistortion(insideOut(mesh), sphere).inverted_triangles, 4);
}

TEST(MeshQuality, WhatFloatsCannotTellApartIsCollapsed) {
  const Mesh mesh = octahedron();
  for (const double height : {3e-8, 0.0, -3e-8}) {
    Positions sphere = mesh.points;
    sphere.col(4) = Vector3d(1.0, 0.0, height);
    const MapDistortion found = measureMapDistortion(mesh, sphere);
    EXPECT_EQ(found.collapsed_triangles, 4);
    EXPECT_EQ(found.inverted_triangles, 0);
    EXPECT_NEAR(found.angle_mean, 1.0, kRounding);
  }
  Positions sphere = mesh.points;
  sphere.col(4) = Vector3d(1.0, 0.0, -1e-6).normalized();
  EXPECT_EQ(measureMapDistortion(mesh, sphere).inverted_triangles, 4);
  // All at one place: no distortion can be told.
  sphere.colwise() = Vector3d::UnitX();
  const MapDistortion found = measureMapDistortion(mesh, sphere);
  EXPECT_EQ(found.collapsed_triangles, 8);
  EXPECT_EQ(found.angle_mean, 1.0);
}

// --- The tool ------------------------------------------------------------------------------------

std::string plyOf(const Mesh& mesh) {
  std::ostringstream text;
  text.precision(17);
  text << "ply\nformat ascii 1.0\nelement vertex " << mesh.points.cols()
       << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
       << mesh.triangles.cols() << "\nproperty list uchar int vertex_indices\nend_header\n"
       << mesh.points.transpose() << '\n';
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    text << "3 " << mesh.triangles.col(t).transpose() << '\n';
  return text.str();
}

class MeshQualityTool : public testing::Test {
protected:
  std::string write(const std::string& name, const std::string& content) {
    tool_test::writeFile(directory_.file(name), content);
    return name;
  }
  tool_test::RunResult run(const std::vector<std::string>& arguments) {
    tool_test::RunOptions options;
    options.directory = directory_.path();
    return tool_test::run(MESH_QUALITY_TOOL, arguments, options);
  }
  json reportOf(const std::vector<std::string>& arguments) {
    const tool_test::RunResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output, nullptr, false);
  }
  void expectFailure(const std::vector<std::string>& arguments, int exit_code) {
    const tool_test::RunResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.errors;
    EXPECT_EQ(result.errorLines().size(), 2U) << result.errors;
    EXPECT_EQ(result.output, "");
  }

private:
  tool_test::TemporaryDirectory directory_;
};

TEST_F(MeshQualityTool, TellsAllItWasAskedFor) {
  Mesh flat = octahedron();
  flat.points.row(2) *= 0.5;
  const std::string mesh = write("mesh.ply", plyOf(flat));
  const std::string truth = write("truth.ply", plyOf(octahedron()));
  json report = reportOf({mesh});
  EXPECT_EQ(report.value("genus", -1), 0);
  EXPECT_EQ(report.value("closed_manifold_genus0", false), true);
  EXPECT_EQ(report.value("self_intersecting_pairs", -1), 0);
  EXPECT_FALSE(report.contains("hausdorff_percent"));
  EXPECT_FALSE(report.contains("cloud_points"));
  EXPECT_FALSE(report.contains("map_inverted_percent"));

  report = reportOf({mesh, "--truth", truth, "-sphere=" + truth, "-samples", "1000"});
  EXPECT_EQ(report.value("outward", false), true);
  EXPECT_NEAR(report.value("volume_ratio", 0.0), 0.5, kRounding);
  EXPECT_NEAR(report.value("truth_diagonal", 0.0), std::sqrt(12.0), kRounding);
  // From the tip at height 1 to the one at 1/2.
  EXPECT_NEAR(report.value("hausdorff_truth_to_mesh_percent", 0.0), 50.0 / std::sqrt(12.0),
              100.0 * kRounding);
  EXPECT_EQ(report.value("cloud_points", 0), 6);
  EXPECT_NEAR(report.value("points_used_percent", 0.0), 100.0 * 4 / 6, 100.0 * kRounding);
  EXPECT_EQ(report.value("extra_vertices", 0), 2);
  EXPECT_NEAR(report.value("edges_reproduced_percent", 0.0), 100.0 * 4 / 12, 100.0 * kRounding);
  EXPECT_EQ(report.value("map_inverted_triangles", -1), 0);
  // The triangles become higher above their longest side.
  EXPECT_NEAR(report.value("map_angle_distortion_mean", 0.0), std::sqrt(1.5 / 0.75),
              100.0 * kRounding);
}

TEST_F(MeshQualityTool, EdgesAreNotComparedWithATruthOverOtherPoints) {
  const std::string mesh = write("mesh.ply", plyOf(octahedron()));
  const std::string truth = write("truth.ply", plyOf(roundedOctahedron(1)));
  const json report = reportOf({mesh, "-truth", truth, "-cloud", mesh, "-samples", "10"});
  EXPECT_EQ(report.value("points_used_percent", 0.0), 100.0);
  ASSERT_TRUE(report.contains("edges_reproduced_percent"));
  EXPECT_TRUE(report["edges_reproduced_percent"].is_null());
  EXPECT_TRUE(report["edge_precision_percent"].is_null());
}

TEST_F(MeshQualityTool, FailuresTellCauseAndRemedy) {
  const std::string content = plyOf(octahedron());
  const std::string mesh = write("mesh.ply", content);
  expectFailure({}, 2);
  expectFailure({mesh, "-samples", "0", "-truth", mesh}, 2);
  expectFailure({mesh, "-seed", "1"}, 2);
  expectFailure({"missing.ply"}, 1);
  expectFailure({write("cut.ply", content.substr(0, content.size() - 20))}, 1);
  Mesh wrong = octahedron();
  wrong.triangles(0, 0) = 6;
  expectFailure({write("wrong.ply", plyOf(wrong))}, 1);
  expectFailure({mesh, "-sphere", write("turned.ply", plyOf(turnedOver(octahedron(), 1)))}, 1);
  Mesh larger = octahedron();
  larger.points *= 2.0;
  expectFailure({mesh, "-sphere", write("larger.ply", plyOf(larger))}, 1);
}

}  // namespace
