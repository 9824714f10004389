#include "map_shapes.h"
#include "spherical_param/map/sphere_map.h"

#include <Eigen/SVD>

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using test::Mapped;

/// One triangle of a map, from the singular value decomposition of its linear map.
struct Triangle {
  double weight;      ///< area in space
  double flat;        ///< area of the flat image
  double covered;     ///< area of the spherical image
  double angle;       ///< ratio of the singular values
  double stretch;     ///< mean of the inverse squares of the singular values
  double difference;  ///< sum over the corners of the differences of angles [rad]
};

Triangle triangleOf(const Mapped& mesh, Eigen::Index t) {
  std::array<Eigen::Matrix2d, 2> sides;
  std::array<double, 2> area{};
  std::array<Vector3d, 2> angles;
  for (std::size_t s = 0; s < 2; ++s) {
    const auto corner = [&](Eigen::Index k) -> Vector3d {
      return (s == 0 ? mesh.points : mesh.sphere).col(mesh.triangles(k % 3, t));
    };
    const Vector3d u = corner(1) - corner(0);
    const Vector3d v = corner(2) - corner(0);
    const Vector3d x = u.normalized();
    const Vector3d y = u.cross(v).cross(u).normalized();
    sides[s] << x.dot(u), x.dot(v), y.dot(u), y.dot(v);
    area[s] = 0.5 * u.cross(v).norm();
    for (Eigen::Index k = 0; k < 3; ++k)
      angles[s][k] = std::acos(
          (corner(k + 1) - corner(k)).normalized().dot((corner(k + 2) - corner(k)).normalized()));
  }
  const Eigen::Vector2d sigma =
      Eigen::JacobiSVD<Eigen::Matrix2d>(sides[1] * sides[0].inverse()).singularValues();
  return {area[0],
          area[1],
          test::sphericalArea(mesh.sphere, mesh.triangles, t),
          sigma[0] / sigma[1],
          0.5 * (std::pow(sigma[0], -2) + std::pow(sigma[1], -2)),
          (angles[0] - angles[1]).cwiseAbs().sum()};
}

void expectStatistics(const DistortionStatistics& found, const std::vector<double>& values,
                      const std::vector<double>& weights) {
  double mean = 0.0;
  double above = 0.0;
  double at_least = 0.0;
  for (std::size_t t = 0; t < values.size(); ++t) {
    mean += weights[t] * values[t];
    above += values[t] > found.p95 * (1.0 + 1e-9) ? weights[t] : 0.0;
    at_least += values[t] > found.p95 * (1.0 - 1e-9) ? weights[t] : 0.0;
  }
  const double max = *std::max_element(values.begin(), values.end());
  EXPECT_NEAR(found.mean, mean, 1e-9 * mean);
  EXPECT_NEAR(found.max, max, 1e-9 * max);
  // 5 % of the area are above the percentile, but for one triangle.
  EXPECT_LE(above, 0.05);
  EXPECT_GT(at_least, 0.05);
}

TEST(MapDistortion, IsThatOfSingularValueDecompositionsInAnyUnitAndFrame) {
  Mapped mesh = test::octasphere(8);
  mesh.points = test::randomPositions(mesh.points.cols(), 1);
  std::vector<Triangle> triangles;
  double in_space = 0.0;
  double flat = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    triangles.push_back(triangleOf(mesh, t));
    in_space += triangles.back().weight;
    flat += triangles.back().flat;
  }
  std::vector<double> weights, angles, areas;
  double stretch = 0.0;
  double difference = 0.0;
  for (const Triangle& t : triangles) {
    weights.push_back(t.weight / in_space);
    angles.push_back(t.angle);
    const double ratio = t.covered / (4.0 * test::kPi) / weights.back();
    areas.push_back(std::max(ratio, 1.0 / ratio));
    stretch += weights.back() * t.stretch * flat / in_space;
    difference += t.difference / (3.0 * static_cast<double>(triangles.size())) * 180.0 / test::kPi;
  }
  for (const double unit : {1e-150, 1.0, 1e150}) {
    const MapDistortion distortion = measureMapDistortion(
        unit * test::rotationBy(unit, {1.0, 2.0, 3.0}) * mesh.points, mesh.triangles, mesh.sphere);
    expectStatistics(distortion.angle, angles, weights);
    expectStatistics(distortion.area, areas, weights);
    EXPECT_NEAR(distortion.mean_angle_difference, difference, 1e-9 * difference);
    EXPECT_NEAR(distortion.stretch_efficiency, 1.0 / stretch, 1e-9 / stretch);
    EXPECT_EQ(distortion.flipped_triangles, 0);
    EXPECT_EQ(distortion.degenerate_triangles, 0);
  }
}

TEST(MapDistortion, FlipsAreExact) {
  // The corners are in a plane through the center, or one unit in the last place beside it.
  const Vector3d a = Vector3d(0.1, 0.2, 0.7).normalized();
  const Vector3d b = Vector3d(0.3, -0.4, 0.2).normalized();
  const Triangles triangle = Eigen::Matrix<Index, 3, 1>(0, 1, 2);
  const auto flips = [&](const Vector3d& c) {
    Positions sphere(3, 3);
    sphere << a, b, c;
    return measureMapDistortion(test::randomPositions(3, 2), triangle, sphere).flipped_triangles;
  };
  EXPECT_EQ(flips(a), 1);
  int kept = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double towards : {-2.0, 2.0}) {
      Vector3d c = a;
      c[axis] = std::nextafter(a[axis], towards);
      // det(a, b, a + d e) = d e . (a x b).
      const bool is_kept = (c[axis] - a[axis]) * a.cross(b)[axis] > 0.0;
      EXPECT_EQ(flips(c), is_kept ? 0 : 1);
      kept += is_kept ? 1 : 0;
    }
  EXPECT_EQ(kept, 3);
}

TEST(MapDistortion, ATurnedOverSphereHasItsAreasAndOnlyFlips) {
  const Mapped mesh = test::octasphere(4);
  const MapDistortion turned = measureMapDistortion(mesh.points, mesh.triangles, -mesh.sphere);
  EXPECT_EQ(turned.flipped_triangles, mesh.triangles.cols());
  EXPECT_EQ(turned.area.max,
            measureMapDistortion(mesh.points, mesh.triangles, mesh.sphere).area.max);
}

TEST(MapDistortion, TrianglesWithoutAreaAreUnboundedOnTheSphereAndDoNotCountInSpace) {
  const Mapped mesh = test::octasphere(4);
  const auto a = mesh.triangles(0, 5);
  const auto b = mesh.triangles(1, 5);
  Positions flat = mesh.sphere;
  flat.col(a) = flat.col(b);
  const MapDistortion collapsed = measureMapDistortion(mesh.points, mesh.triangles, flat);
  EXPECT_GE(collapsed.flipped_triangles, 1);
  for (const DistortionStatistics& statistics : {collapsed.angle, collapsed.area}) {
    EXPECT_GT(statistics.max, 1e100);
    EXPECT_TRUE(std::isfinite(statistics.max) && std::isfinite(statistics.mean));
  }
  EXPECT_GE(collapsed.stretch_efficiency, 0.0);

  flat = mesh.points;
  flat.col(mesh.triangles(2, 5)) = 0.3 * flat.col(a) + 0.7 * flat.col(b);
  const MapDistortion crushed = measureMapDistortion(flat, mesh.triangles, mesh.sphere);
  EXPECT_EQ(crushed.degenerate_triangles, 1);
  EXPECT_LT(crushed.area.max, 1e3);

  const MapDistortion of_point =
      measureMapDistortion(Positions::Ones(3, mesh.points.cols()), mesh.triangles, mesh.sphere);
  EXPECT_EQ(of_point.degenerate_triangles, mesh.triangles.cols());
  EXPECT_EQ(of_point.area.mean, 0.0);
  EXPECT_EQ(measureMapDistortion(mesh.points, Triangles(3, 0), mesh.sphere).area.mean, 0.0);
}

}  // namespace
}  // namespace spherical_param
