#include "map_shapes.h"
#include "spherical_param/map/sphere_map.h"

#include <Eigen/SVD>

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using test::Mapped;

/// Of each triangle of a map, by the singular value decomposition of its linear map.
struct Measures {
  Eigen::ArrayXd in_space;    ///< area
  Eigen::ArrayXd flat;        ///< area of the flat image
  Eigen::ArrayXd covered;     ///< area of the spherical image
  Eigen::ArrayXd angle;       ///< ratio of the singular values
  Eigen::ArrayXd stretch;     ///< mean of the inverse squares of the singular values
  Eigen::ArrayXd difference;  ///< sum over the corners of the differences of angles [rad]
};

Measures measuresOf(const Mapped& mesh) {
  const Eigen::ArrayXd zero = Eigen::ArrayXd::Zero(mesh.triangles.cols());
  Measures of{zero, zero, zero, zero, zero, zero};
  for (Eigen::Index t = 0; t < zero.size(); ++t) {
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
    const Eigen::Array2d sigma =
        Eigen::JacobiSVD<Eigen::Matrix2d>(sides[1] * sides[0].inverse()).singularValues().array();
    of.in_space[t] = area[0];
    of.flat[t] = area[1];
    of.covered[t] = test::sphericalArea(mesh.sphere, mesh.triangles, t);
    of.angle[t] = sigma[0] / sigma[1];
    of.stretch[t] = sigma.square().inverse().mean();
    of.difference[t] = (angles[0] - angles[1]).cwiseAbs().sum();
  }
  return of;
}

void expectStatistics(const DistortionStatistics& found, const Eigen::ArrayXd& values,
                      const Eigen::ArrayXd& weights) {
  const double mean = (weights * values).sum();
  EXPECT_NEAR(found.mean, mean, 1e-9 * mean);
  EXPECT_NEAR(found.max, values.maxCoeff(), 1e-9 * values.maxCoeff());
  // 5 % of the area are above the percentile, but for one triangle.
  EXPECT_LE((values > found.p95 * (1.0 + 1e-9)).select(weights, 0.0).sum(), 0.05);
  EXPECT_GT((values > found.p95 * (1.0 - 1e-9)).select(weights, 0.0).sum(), 0.05);
}

TEST(MapDistortion, IsThatOfSingularValueDecompositionsInAnyUnitAndFrame) {
  Mapped mesh = test::octasphere(8);
  mesh.points = test::randomPositions(mesh.points.cols(), 1);
  const Measures of = measuresOf(mesh);
  const Eigen::ArrayXd weights = of.in_space / of.in_space.sum();
  const Eigen::ArrayXd ratios = of.covered / (4.0 * test::kPi) / weights;
  const double stretch = (weights * of.stretch).sum() * of.flat.sum() / of.in_space.sum();
  const double difference = of.difference.mean() / 3.0 * 180.0 / test::kPi;
  for (const double unit : {1e-150, 1.0, 1e150}) {
    const MapDistortion distortion = measureMapDistortion(
        unit * test::rotationBy(unit, {1.0, 2.0, 3.0}) * mesh.points, mesh.triangles, mesh.sphere);
    expectStatistics(distortion.angle, of.angle, weights);
    expectStatistics(distortion.area, ratios.max(ratios.inverse()), weights);
    EXPECT_NEAR(distortion.mean_angle_difference, difference, 1e-9 * difference);
    EXPECT_NEAR(distortion.stretch_efficiency, 1.0 / stretch, 1e-9 / stretch);
    EXPECT_EQ(distortion.flipped_triangles, 0);
    EXPECT_EQ(distortion.degenerate_triangles, 0);
  }
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
  for (int axis = 0; axis < 3; ++axis)
    for (const double towards : {-2.0, 2.0}) {
      Vector3d c = a;
      c[axis] = std::nextafter(a[axis], towards);
      // det(a, b, a + d e) = d e . (a x b).
      EXPECT_EQ(flips(c), (c[axis] - a[axis]) * a.cross(b)[axis] > 0.0 ? 0 : 1);
    }
}

}  // namespace
}  // namespace spherical_param
