#include "spherical_param/sphere_map.h"

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

TEST(MapDistortion, SphereToItselfHasNone) {
  const Mesh sphere = octasphere(4);
  const MapDistortion distortion =
      measureMapDistortion(7.0 * sphere.points, sphere.triangles, sphere.points);
  EXPECT_EQ(distortion.flipped_triangles, 0);
  EXPECT_EQ(distortion.degenerate_triangles, 0);
  for (const DistortionStatistics& statistics : {distortion.angle, distortion.area}) {
    EXPECT_NEAR(statistics.mean, 1.0, 1e-10);
    EXPECT_NEAR(statistics.p95, 1.0, 1e-10);
    EXPECT_NEAR(statistics.max, 1.0, 1e-10);
  }
  EXPECT_NEAR(distortion.mean_angle_difference, 0.0, 1e-5);
  EXPECT_NEAR(distortion.stretch_efficiency, 1.0, 1e-10);
}

TEST(MapDistortion, IsThatOfSingularValueDecompositions) {
  const Mesh sphere = octasphere(3);
  const Positions points = randomPositions(sphere.points.cols(), 1);
  const MapDistortion distortion = measureMapDistortion(points, sphere.triangles, sphere.points);

  struct Triangle {
    double weight, image, angle, ratio, stretch, difference;
  };
  std::vector<Triangle> triangles;
  double in_space = 0.0;
  double on_sphere = 0.0;
  for (Eigen::Index t = 0; t < sphere.triangles.cols(); ++t) {
    std::array<std::array<Vector3d, 3>, 2> corners;
    std::array<Eigen::Matrix2d, 2> sides;
    std::array<double, 2> area{};
    for (std::size_t s = 0; s < 2; ++s) {
      for (std::size_t k = 0; k < 3; ++k)
        corners[s][k] = (s == 0 ? points : sphere.points)
                            .col(sphere.triangles(static_cast<Eigen::Index>(k), t));
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
    triangles.push_back({area[0], area[1], sigma[0] / sigma[1], 0.0,
                         0.5 * (std::pow(sigma[0], -2) + std::pow(sigma[1], -2)), difference});
    in_space += area[0];
    on_sphere += area[1];
  }
  double angle = 0.0;
  double area = 0.0;
  double stretch = 0.0;
  double difference = 0.0;
  for (Triangle& t : triangles) {
    const double ratio = t.image / on_sphere / (t.weight / in_space);
    t.ratio = std::max(ratio, 1.0 / ratio);
    angle += t.weight / in_space * t.angle;
    area += t.weight / in_space * t.ratio;
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
  for (const Triangle& t : triangles) {
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
  EXPECT_NEAR(distortion.area.max, 1.0, 1e-10);
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

TEST(MapDistortion, RefusesWhatDoesNotFit) {
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

}  // namespace
}  // namespace spherical_param
