#include "spherical_param/map/sphere_map.h"

#include "helpers.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

struct Mesh {
  Positions points;
  Triangles triangles;
};

/// A triangulation of the unit sphere: the octahedron, each triangle cut in four so many times.
Mesh octasphere(int depth) {
  std::vector<Vector3d> points = {Vector3d::UnitX(),  Vector3d::UnitY(),  Vector3d::UnitZ(),
                                  -Vector3d::UnitX(), -Vector3d::UnitY(), -Vector3d::UnitZ()};
  std::vector<std::array<Index, 3>> triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                                                 {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (; depth > 0; --depth) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [at, is_new] =
          middles.insert({std::minmax(a, b), static_cast<Index>(points.size())});
      if (is_new)
        points.push_back((points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)])
                             .normalized());
      return at->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const Index ab = middle(a, b);
      const Index bc = middle(b, c);
      const Index ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = finer;
  }
  Mesh mesh{Positions(3, static_cast<Eigen::Index>(points.size())),
            Triangles(3, static_cast<Eigen::Index>(triangles.size()))};
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.points.col(static_cast<Eigen::Index>(i)) = points[i];
  for (std::size_t t = 0; t < triangles.size(); ++t)
    mesh.triangles.col(static_cast<Eigen::Index>(t)) << triangles[t][0], triangles[t][1],
        triangles[t][2];
  return mesh;
}

Positions randomPositions(Eigen::Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return Positions::NullaryExpr(3, n, [&](Eigen::Index, Eigen::Index) { return normal(random); });
}

bool areEqual(const DistortionStatistics& a, const DistortionStatistics& b) {
  return a.mean == b.mean && a.p95 == b.p95 && a.max == b.max;
}

bool areEqual(const MapDistortion& a, const MapDistortion& b) {
  return a.flipped_triangles == b.flipped_triangles &&
         a.degenerate_triangles == b.degenerate_triangles && areEqual(a.angle, b.angle) &&
         areEqual(a.area, b.area) && a.mean_angle_difference == b.mean_angle_difference &&
         a.stretch_efficiency == b.stretch_efficiency;
}

/// Area of a spherical triangle by its angles (A. Girard, 1629).
double sphericalArea(const std::array<Vector3d, 3>& corners) {
  double sum = -test::kPi;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d& a = corners[k];
    sum += std::acos(
        a.cross(corners[(k + 1) % 3]).normalized().dot(a.cross(corners[(k + 2) % 3]).normalized()));
  }
  return sum;
}

TEST(MapDistortion, SphereToItselfHasNone) {
  // So fine that the flat triangles have the areas of the spherical ones.
  const Mesh sphere = octasphere(6);
  const MapDistortion distortion =
      measureMapDistortion(7.0 * sphere.points, sphere.triangles, sphere.points);
  EXPECT_EQ(distortion.flipped_triangles, 0);
  EXPECT_EQ(distortion.degenerate_triangles, 0);
  for (const auto& [statistics, tolerance] :
       {std::pair(distortion.angle, 1e-10), std::pair(distortion.area, 1e-3)}) {
    EXPECT_NEAR(statistics.mean, 1.0, tolerance);
    EXPECT_NEAR(statistics.p95, 1.0, tolerance);
    EXPECT_NEAR(statistics.max, 1.0, tolerance);
  }
  EXPECT_NEAR(distortion.mean_angle_difference, 0.0, 1e-5);
  EXPECT_NEAR(distortion.stretch_efficiency, 1.0, 1e-10);
}

/// One triangle of a map, from the singular value decomposition of its linear map.
struct MappedTriangle {
  double weight;      ///< area in space
  double image;       ///< area on the sphere
  double angle;       ///< ratio of the singular values
  double stretch;     ///< mean of the inverse squares of the singular values
  double difference;  ///< sum over the corners of the differences of angles [rad]
  double flat_image;  ///< area of the flat image
};

MappedTriangle mappedTriangle(const std::array<std::array<Vector3d, 3>, 2>& corners) {
  std::array<Eigen::Matrix2d, 2> sides;
  std::array<double, 2> area{};
  for (std::size_t s = 0; s < 2; ++s) {
    const Vector3d u = corners[s][1] - corners[s][0];
    const Vector3d v = corners[s][2] - corners[s][0];
    const Vector3d x = u.normalized();
    const Vector3d y = u.cross(v).cross(u).normalized();
    sides[s] << x.dot(u), x.dot(v), y.dot(u), y.dot(v);
    area[s] = 0.5 * u.cross(v).norm();
  }
  const Eigen::Vector2d sigma =
      Eigen::JacobiSVD<Eigen::Matrix2d>(sides[1] * sides[0].inverse()).singularValues();
  double difference = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    std::array<double, 2> angle{};
    for (std::size_t s = 0; s < 2; ++s) {
      const Vector3d u = (corners[s][(k + 1) % 3] - corners[s][k]).normalized();
      const Vector3d v = (corners[s][(k + 2) % 3] - corners[s][k]).normalized();
      angle[s] = std::acos(u.dot(v));
    }
    difference += std::abs(angle[0] - angle[1]);
  }
  return {area[0],
          sphericalArea(corners[1]),
          sigma[0] / sigma[1],
          0.5 * (std::pow(sigma[0], -2) + std::pow(sigma[1], -2)),
          difference,
          area[1]};
}

TEST(MapDistortion, IsThatOfSingularValueDecompositions) {
  const Mesh sphere = octasphere(3);
  const Positions points = randomPositions(sphere.points.cols(), 1);
  const MapDistortion distortion = measureMapDistortion(points, sphere.triangles, sphere.points);
  std::vector<MappedTriangle> triangles;
  double in_space = 0.0;
  double on_sphere = 0.0;
  for (Eigen::Index t = 0; t < sphere.triangles.cols(); ++t) {
    std::array<std::array<Vector3d, 3>, 2> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index vertex = sphere.triangles(static_cast<Eigen::Index>(k), t);
      corners[0][k] = points.col(vertex);
      corners[1][k] = sphere.points.col(vertex);
    }
    triangles.push_back(mappedTriangle(corners));
    in_space += triangles.back().weight;
    on_sphere += triangles.back().flat_image;
  }
  double angle = 0.0;
  double area = 0.0;
  double stretch = 0.0;
  double difference = 0.0;
  for (const MappedTriangle& t : triangles) {
    const double ratio = t.image / (4.0 * test::kPi) / (t.weight / in_space);
    angle += t.weight / in_space * t.angle;
    area += t.weight / in_space * std::max(ratio, 1.0 / ratio);
    stretch += t.weight / in_space * t.stretch * on_sphere / in_space;
    difference += t.difference / (3.0 * static_cast<double>(triangles.size())) * 180.0 / test::kPi;
  }
  EXPECT_NEAR(distortion.angle.mean, angle, 1e-9 * angle);
  EXPECT_NEAR(distortion.area.mean, area, 1e-9 * area);
  EXPECT_NEAR(distortion.mean_angle_difference, difference, 1e-9 * difference);
  EXPECT_NEAR(distortion.stretch_efficiency, 1.0 / stretch, 1e-9 / stretch);
  // 5 % of the area are above the percentile, but for one triangle.
  double above = 0.0;
  double at_least = 0.0;
  double max = 0.0;
  for (const MappedTriangle& t : triangles) {
    above += t.angle > distortion.angle.p95 * (1.0 + 1e-9) ? t.weight / in_space : 0.0;
    at_least += t.angle > distortion.angle.p95 * (1.0 - 1e-9) ? t.weight / in_space : 0.0;
    max = std::max(max, t.angle);
  }
  EXPECT_LE(above, 0.05);
  EXPECT_GT(at_least, 0.05);
  EXPECT_NEAR(distortion.angle.max, max, 1e-9 * max);
}

TEST(MapDistortion, FlipsAreExact) {
  // The corners are in a plane through the center, or one unit in the last place beside it.
  const Vector3d a = Vector3d(0.1, 0.2, 0.7).normalized();
  const Vector3d b = Vector3d(0.3, -0.4, 0.2).normalized();
  Mesh mesh{randomPositions(3, 2), Triangles(3, 1)};
  mesh.triangles << 0, 1, 2;
  Positions sphere(3, 3);
  sphere << a, b, a;
  EXPECT_EQ(measureMapDistortion(mesh.points, mesh.triangles, sphere).flipped_triangles, 1);
  int kept = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double towards : {-2.0, 2.0}) {
      sphere.col(2) = a;
      sphere(axis, 2) = std::nextafter(a[axis], towards);
      // det(a, b, a + d e) = d e . (a x b).
      const bool is_kept = (sphere(axis, 2) - a[axis]) * a.cross(b)[axis] > 0.0;
      EXPECT_EQ(measureMapDistortion(mesh.points, mesh.triangles, sphere).flipped_triangles,
                is_kept ? 0 : 1);
      kept += is_kept ? 1 : 0;
    }
  EXPECT_EQ(kept, 3);
}

TEST(MapDistortion, TurnedOverSphereIsFlippedEverywhere) {
  const Mesh sphere = octasphere(2);
  const MapDistortion distortion =
      measureMapDistortion(sphere.points, sphere.triangles, -sphere.points);
  EXPECT_EQ(distortion.flipped_triangles, sphere.triangles.cols());
  EXPECT_EQ(distortion.area.max,
            measureMapDistortion(sphere.points, sphere.triangles, sphere.points).area.max);
}

TEST(MapDistortion, CollapsedImageIsHugeAndFinite) {
  const Mesh sphere = octasphere(2);
  Positions collapsed = sphere.points;
  collapsed.col(sphere.triangles(0, 0)) = collapsed.col(sphere.triangles(1, 0));
  const MapDistortion distortion = measureMapDistortion(sphere.points, sphere.triangles, collapsed);
  EXPECT_GE(distortion.flipped_triangles, 1);
  for (const DistortionStatistics& statistics : {distortion.angle, distortion.area}) {
    EXPECT_GT(statistics.max, 1e100);
    EXPECT_TRUE(std::isfinite(statistics.max));
    EXPECT_TRUE(std::isfinite(statistics.mean));
  }
  EXPECT_GE(distortion.stretch_efficiency, 0.0);
}

TEST(MapDistortion, TrianglesWithoutAreaInSpaceDoNotCount) {
  const Mesh sphere = octasphere(2);
  Positions points = sphere.points;
  const Eigen::Index a = sphere.triangles(0, 5);
  const Eigen::Index b = sphere.triangles(1, 5);
  points.col(sphere.triangles(2, 5)) = 0.3 * points.col(a) + 0.7 * points.col(b);
  const MapDistortion distortion = measureMapDistortion(points, sphere.triangles, sphere.points);
  EXPECT_EQ(distortion.degenerate_triangles, 1);
  EXPECT_LT(distortion.area.max, 1e3);

  const MapDistortion of_point =
      measureMapDistortion(Positions::Ones(3, points.cols()), sphere.triangles, sphere.points);
  EXPECT_EQ(of_point.degenerate_triangles, sphere.triangles.cols());
  EXPECT_EQ(of_point.area.mean, 0.0);
}

TEST(MapDistortion, DoesNotDependOnUnitOrFrame) {
  const Mesh sphere = octasphere(3);
  const Positions points = randomPositions(sphere.points.cols(), 3);
  const MapDistortion expected = measureMapDistortion(points, sphere.triangles, sphere.points);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.0, Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  for (const double unit : {1e-150, 1.0, 1e150}) {
    const MapDistortion distortion =
        measureMapDistortion(unit * turn * points, sphere.triangles, sphere.points);
    EXPECT_NEAR(distortion.angle.mean, expected.angle.mean, 1e-9 * expected.angle.mean);
    EXPECT_NEAR(distortion.area.p95, expected.area.p95, 1e-9 * expected.area.p95);
    EXPECT_EQ(distortion.degenerate_triangles, 0);
  }
}

TEST(MapDistortion, IsTheSameForAnyNumberOfThreads) {
  const Mesh sphere = octasphere(5);
  const Positions points = randomPositions(sphere.points.cols(), 4);
  const MapDistortion expected = measureMapDistortion(points, sphere.triangles, sphere.points, 1);
  for (const int threads : {2, 3})
    EXPECT_TRUE(
        areEqual(measureMapDistortion(points, sphere.triangles, sphere.points, threads), expected));
}

TEST(MapDistortion, RefusesInputThatDoesNotFit) {
  const Mesh sphere = octasphere(1);
  Triangles triangles = sphere.triangles;
  EXPECT_THROW(measureMapDistortion(sphere.points, triangles, sphere.points.leftCols(5)),
               InvalidInput);
  EXPECT_THROW(measureMapDistortion(sphere.points, triangles, sphere.points, -1), InvalidInput);
  Positions points = sphere.points;
  points(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(measureMapDistortion(points, triangles, sphere.points), InvalidInput);
  triangles(1, 2) = static_cast<Index>(sphere.points.cols());
  EXPECT_THROW(measureMapDistortion(sphere.points, triangles, sphere.points), InvalidInput);
  EXPECT_EQ(measureMapDistortion(sphere.points, Triangles(3, 0), sphere.points).area.mean, 0.0);
}

/// A sphere triangulation with other positions.
Mesh deformed(const Mesh& sphere, const Eigen::Matrix3d& map) {
  return {map * sphere.points, sphere.triangles};
}

/// Two apices and a ring of so many points between them.
Mesh doubleCone(Index ring) {
  Mesh mesh{Positions(3, ring + 2), Triangles(3, 2 * ring)};
  for (Index i = 0; i < ring; ++i) {
    const double angle = 2.0 * test::kPi * i / ring;
    mesh.points.col(i) << std::cos(angle), std::sin(angle), 0.0;
    const Index next = (i + 1) % ring;
    mesh.triangles.col(2 * i) << i, next, ring;
    mesh.triangles.col(2 * i + 1) << next, i, ring + 1;
  }
  mesh.points.col(ring) << 0.0, 0.0, 1.0;
  mesh.points.col(ring + 1) << 0.0, 0.0, -1.0;
  return mesh;
}

/// Flips by a determinant in long double; a flat triangle counts.
int flipsOf(const Positions& sphere, const Triangles& triangles) {
  int flips = 0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Matrix<long double, 3, 1> a = sphere.col(triangles(0, t)).cast<long double>();
    const Eigen::Matrix<long double, 3, 1> b = sphere.col(triangles(1, t)).cast<long double>();
    const Eigen::Matrix<long double, 3, 1> c = sphere.col(triangles(2, t)).cast<long double>();
    flips += a.dot((b - a).cross(c - a)) > 0.0L ? 0 : 1;
  }
  return flips;
}

void expectOneToOne(const SphereMap& map, const Mesh& mesh) {
  ASSERT_EQ(map.sphere.cols(), mesh.points.cols());
  for (Eigen::Index v = 0; v < map.sphere.cols(); ++v)
    ASSERT_NEAR(map.sphere.col(v).norm(), 1.0, 1e-14);
  EXPECT_EQ(flipsOf(map.sphere, mesh.triangles), 0);
  EXPECT_EQ(map.distortion.flipped_triangles, 0);
  // No triangle is flipped, and they cover the sphere once: the solid angles are its area.
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Vector3d a = map.sphere.col(mesh.triangles(0, t));
    const Vector3d b = map.sphere.col(mesh.triangles(1, t));
    const Vector3d c = map.sphere.col(mesh.triangles(2, t));
    // A. van Oosterom and J. Strackee, 1983.
    sum += 2.0 * std::atan2(a.dot((b - a).cross(c - a)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
  }
  EXPECT_NEAR(sum, 4.0 * test::kPi, 1e-9);
}

/// The radial projection of a shape that is seen from the origin.
Positions directions(const Positions& points) {
  return points.colwise().normalized();
}

TEST(SphereMap, SphereMapsToItself) {
  const Mesh sphere = octasphere(4);
  const SphereMap map = computeSphereMap(2.5 * sphere.points, sphere.triangles, sphere.points);
  expectOneToOne(map, sphere);
  EXPECT_LT(map.distortion.angle.mean, 1.01);
  EXPECT_LT(map.distortion.area.mean, 1.01);
  EXPECT_LT((map.sphere - sphere.points).colwise().norm().maxCoeff(), 0.05);
}

TEST(SphereMap, AreasOfAnEllipsoidAreKept) {
  const Mesh sphere = octasphere(4);
  const Mesh mesh = deformed(sphere, Vector3d(1.0, 1.0, 3.0).asDiagonal());
  const SphereMap map = computeSphereMap(mesh.points, mesh.triangles, directions(mesh.points));
  expectOneToOne(map, mesh);
  EXPECT_GT(map.before.area.mean, 1.5);
  EXPECT_LT(map.distortion.area.mean, 1.1);
  EXPECT_LT(map.distortion.angle.mean, 2.5);
}

TEST(SphereMap, WeightOfAreasTradesThemForAngles) {
  const test::Tube tube = test::bentTube(12.0, 0.0, 16);
  const Positions start = directions(tube.points.colwise() - Vector3d(6.0, 0.0, 0.0));
  double angle = 1.0;
  double area = std::numeric_limits<double>::infinity();
  for (const double weight : {0.0, 0.5, 0.9}) {
    SphereMapOptions options;
    options.area_weight = weight;
    const SphereMap map = computeSphereMap(tube.points, tube.triangles, start, options);
    EXPECT_EQ(map.distortion.flipped_triangles, 0);
    EXPECT_GT(map.distortion.angle.mean, angle);
    EXPECT_LT(map.distortion.area.mean, area);
    angle = map.distortion.angle.mean;
    area = map.distortion.area.mean;
  }
}

TEST(SphereMap, EndOfALimbKeepsItsArea) {
  // A tube bent to a half circle, 20 times as long as it is thick: a conformal map would shrink its
  // ends by e^20.
  const test::Tube tube = test::bentTube(40.0, test::kPi, 12);
  const Mesh mesh{tube.points, tube.triangles};
  const Positions start = test::randomSphere(static_cast<Index>(tube.points.cols()), 5);
  const SphereMap map = computeSphereMap(mesh.points, mesh.triangles, start);
  expectOneToOne(map, mesh);
  EXPECT_GT(map.before.flipped_triangles, 0);
  EXPECT_LT(map.distortion.area.mean, 2.5);
}

TEST(SphereMap, IsOneToOneForAnyPositions) {
  const Mesh sphere = octasphere(3);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Mesh mesh{randomPositions(sphere.points.cols(), seed), sphere.triangles};
    const Positions start = test::randomSphere(static_cast<Index>(mesh.points.cols()), seed);
    for (const int sweeps : {0, 1, 15}) {
      SphereMapOptions options;
      options.sweeps = sweeps;
      expectOneToOne(computeSphereMap(mesh.points, mesh.triangles, start, options), mesh);
    }
  }
}

TEST(SphereMap, IsOneToOneForAnyWeight) {
  const Mesh sphere = octasphere(3);
  Mesh mesh = sphere;
  mesh.points.row(0) = mesh.points.row(0).array().pow(3.0);
  for (const double weight : {0.0, 0.3, 1.0}) {
    SphereMapOptions options;
    options.area_weight = weight;
    expectOneToOne(computeSphereMap(mesh.points, mesh.triangles, sphere.points, options), mesh);
  }
}

TEST(SphereMap, SmallestMeshes) {
  Mesh tetrahedron{Positions(3, 4), Triangles(3, 4)};
  tetrahedron.points << 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  tetrahedron.triangles << 0, 0, 1, 2, 2, 1, 2, 0, 1, 3, 3, 3;
  const Positions start = directions(tetrahedron.points.colwise() - Vector3d::Constant(0.2));
  expectOneToOne(computeSphereMap(tetrahedron.points, tetrahedron.triangles, start), tetrahedron);
  const Mesh octahedron = octasphere(0);
  const SphereMap map =
      computeSphereMap(octahedron.points, octahedron.triangles, octahedron.points);
  expectOneToOne(map, octahedron);
  EXPECT_LT(map.distortion.angle.mean, 1.05);
  for (const Index ring : {3, 4, 5})
    expectOneToOne(computeSphereMap(doubleCone(ring).points, doubleCone(ring).triangles,
                                    directions(doubleCone(ring).points)),
                   doubleCone(ring));
}

TEST(SphereMap, VertexOfManyNeighbors) {
  const Mesh cone = doubleCone(1000);
  expectOneToOne(computeSphereMap(cone.points, cone.triangles, directions(cone.points)), cone);
}

TEST(SphereMap, Needle) {
  const Mesh sphere = octasphere(4);
  const Mesh mesh = deformed(sphere, Vector3d(1.0, 1.0, 60.0).asDiagonal());
  const SphereMap map = computeSphereMap(mesh.points, mesh.triangles, directions(mesh.points));
  expectOneToOne(map, mesh);
  EXPECT_LT(map.distortion.area.mean, 0.5 * map.before.area.mean);
}

TEST(SphereMap, TrianglesWithoutArea) {
  // Flat and with rows of collinear points: the octahedron, cut in four without rounding it off,
  // and then all of its upper half in the plane; and a solid that is crushed to a line.
  Mesh mesh = octasphere(3);
  const Positions start = mesh.points;
  for (Eigen::Index v = 0; v < mesh.points.cols(); ++v)
    mesh.points.col(v) /= mesh.points.col(v).lpNorm<1>();
  mesh.points.row(2) = mesh.points.row(2).cwiseMin(0.0);
  mesh.points.row(0) = (2.0 * mesh.points.row(0)).array().round() / 2.0;
  const SphereMap map = computeSphereMap(mesh.points, mesh.triangles, start);
  expectOneToOne(map, mesh);
  EXPECT_GT(map.distortion.degenerate_triangles, 0);
  mesh.points.topRows(2).setZero();
  expectOneToOne(computeSphereMap(mesh.points, mesh.triangles, start), mesh);
  mesh.points.setZero();
  expectOneToOne(computeSphereMap(mesh.points, mesh.triangles, start), mesh);
}

TEST(SphereMap, TinyClusterHasRoom) {
  Mesh mesh = octasphere(4);
  const Positions start = mesh.points;
  for (Eigen::Index v = 0; v < mesh.points.cols(); ++v)
    if (mesh.points(2, v) > 0.7)
      mesh.points.col(v) = Vector3d::UnitZ() + 1e-9 * (mesh.points.col(v) - Vector3d::UnitZ());
  expectOneToOne(computeSphereMap(mesh.points, mesh.triangles, start), mesh);
}

TEST(SphereMap, IsTheSameForAnyNumberOfThreads) {
  const Mesh sphere = octasphere(6);
  const Mesh mesh = deformed(sphere, Vector3d(1.0, 2.0, 4.0).asDiagonal());
  SphereMapOptions options;
  options.sweeps = 2;
  options.threads = 1;
  const SphereMap expected = computeSphereMap(mesh.points, mesh.triangles, sphere.points, options);
  for (const int threads : {2, 3}) {
    options.threads = threads;
    const SphereMap map = computeSphereMap(mesh.points, mesh.triangles, sphere.points, options);
    EXPECT_TRUE(map.sphere == expected.sphere);
    EXPECT_TRUE(areEqual(map.distortion, expected.distortion));
  }
}

TEST(SphereMap, TurnsWithItsStart) {
  const Mesh sphere = octasphere(4);
  Mesh mesh = deformed(sphere, Vector3d(1.0, 1.5, 2.5).asDiagonal());
  // Nothing is symmetric, so that rounding breaks no ties.
  mesh.points += 0.002 * randomPositions(mesh.points.cols(), 6);
  const SphereMap map = computeSphereMap(mesh.points, mesh.triangles, sphere.points);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.2, Vector3d(3.0, -1.0, 2.0).normalized()).toRotationMatrix();
  const SphereMap of_start = computeSphereMap(mesh.points, mesh.triangles, turn * sphere.points);
  EXPECT_LT((of_start.sphere - turn * map.sphere).cwiseAbs().maxCoeff(), 1e-12);
  // The frame and the unit of the mesh do not matter.
  const SphereMap of_mesh =
      computeSphereMap(1e6 * turn * mesh.points, mesh.triangles, sphere.points);
  // But its rounding does, as much as another order of the collapses of a few vertices.
  EXPECT_LT((of_mesh.sphere - map.sphere).cwiseAbs().maxCoeff(), 0.02);
}

TEST(SphereMap, LevelsEndAtATetrahedron) {
  const Mesh sphere = octasphere(4);
  const SphereMap map = computeSphereMap(sphere.points, sphere.triangles, sphere.points);
  ASSERT_FALSE(map.levels.empty());
  EXPECT_EQ(map.levels.front().vertices, static_cast<std::size_t>(sphere.points.cols()));
  EXPECT_EQ(map.levels.back().vertices, 4U);
  for (std::size_t l = 0; l < map.levels.size(); ++l) {
    EXPECT_LE(map.levels[l].sweeps, SphereMapOptions().sweeps);
    EXPECT_TRUE(std::isfinite(map.levels[l].energy));
    EXPECT_TRUE(l == 0 || map.levels[l].vertices < map.levels[l - 1].vertices);
  }
}

TEST(SphereMap, ProgressIsReportedAndCancels) {
  const Mesh sphere = octasphere(3);
  const auto run = [&](const std::function<bool(double)>& progress) {
    SphereMapOptions options;
    options.progress = test::reportingTo(progress).progress;
    computeSphereMap(sphere.points, sphere.triangles, sphere.points, options);
  };
  const std::vector<double> fractions = test::fractionsOf(run);
  EXPECT_TRUE(test::areFractions(fractions));
  EXPECT_EQ(fractions.back(), 1.0);
  EXPECT_THROW(run([](double fraction) { return fraction < 0.5; }), Cancelled);
}

TEST(SphereMap, RefusesBadInput) {
  const Mesh sphere = octasphere(2);
  const Positions& points = sphere.points;
  const Triangles& triangles = sphere.triangles;
  const auto refuses = [](const Positions& p, const Triangles& t, const Positions& start,
                          const SphereMapOptions& options = {}) {
    EXPECT_THROW(computeSphereMap(p, t, start, options), InvalidInput);
  };
  refuses(points, triangles.leftCols(triangles.cols() - 1), points);
  refuses(points, triangles, points.leftCols(7));
  refuses(points, triangles, 1.1 * points);
  refuses(points, triangles, Positions::Zero(3, points.cols()));
  Positions wrong = points;
  wrong(1, 1) = std::numeric_limits<double>::infinity();
  refuses(wrong, triangles, points);
  wrong = points;
  wrong(1, 1) = std::numeric_limits<double>::quiet_NaN();
  refuses(points, triangles, wrong);
  Triangles turned = triangles;
  std::swap(turned(0, 3), turned(1, 3));
  refuses(points, turned, points);
  Positions unused(3, points.cols() + 1);
  unused << points, Vector3d::UnitX();
  refuses(unused, triangles, unused);
  Triangles two(3, 2 * triangles.cols());
  two << triangles, (triangles.array() + static_cast<Index>(points.cols())).matrix();
  refuses(test::horizontally(points, points), two, test::horizontally(points, points));
  refuses(points.leftCols(3), Triangles(3, 0), points.leftCols(3));
  for (const double weight : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    SphereMapOptions options;
    options.area_weight = weight;
    refuses(points, triangles, points, options);
  }
  for (const int value : {-1, 1025}) {
    SphereMapOptions options;
    options.threads = value;
    refuses(points, triangles, points, options);
    options = {};
    options.sweeps = value;
    refuses(points, triangles, points, options);
  }
}

}  // namespace
}  // namespace spherical_param
