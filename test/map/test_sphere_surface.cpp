#include "spherical_param/map/sphere_surface.h"

#include "map_shapes.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using test::Mapped;

constexpr SurfaceFit kFits[] = {SurfaceFit::Linear, SurfaceFit::Smooth};

/// Vertices that crowd around a direction, as on a limb: their distances from it are evenly spread
/// over so many orders of magnitude.
Positions crowded(Index n, double orders, const Vector3d& place) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), place);
  const Positions sphere = test::pointsAt(n, [&](Index) {
    const double radius = std::pow(10.0, -orders * uniform(random));
    const double angle = 2.0 * test::kPi * uniform(random);
    return (turn * test::onCircle(angle, radius, 1.0)).normalized();
  });
  return test::horizontally(sphere, test::octasphere(1).sphere);
}

/// Maps of all kinds, under a bumpy shape.
std::vector<Mapped> maps() {
  std::vector<Mapped> all;
  for (const Positions& sphere :
       {test::randomSphere(200, 1), test::octasphere(1).sphere, test::regularTetrahedron(),
        test::cubeDirections(5), crowded(200, 12.0, Vector3d::UnitZ()),
        crowded(200, 7.0, {1.0, 2.0, 3.0})})
    all.push_back(test::bumpy(sphere));
  // Slivers: a linear map of space turns cones into cones.
  all.push_back(transformed(test::bumpy(test::randomSphere(200, 6)),
                            Vector3d(1000.0, 1.0, 1.0).asDiagonal()));
  return all;
}

/// Random directions, those near the vertices, vertices, middles of edges and of triangles.
Positions directionsFor(const Mapped& map) {
  const Eigen::Index m = map.triangles.cols();
  Positions middles(3, 4 * m);
  for (Eigen::Index t = 0; t < m; ++t) {
    middles.col(3 * m + t).setZero();
    for (Index k = 0; k < 3; ++k) {
      const Vector3d corner = map.sphere.col(map.triangles(k, t));
      middles.col(3 * t + k) = corner + map.sphere.col(map.triangles((k + 1) % 3, t));
      middles.col(3 * m + t) += corner;
    }
  }
  return test::horizontally(test::randomSphere(300, 9), test::withNoise(map.sphere, 1e-8, 2),
                            map.sphere, middles);
}

/// The lowest of the triangles whose cones hold a direction, by their definition.
Index bruteForceTriangle(const Mapped& map, const Vector3d& direction) {
  for (Index t = 0; t < map.triangles.cols(); ++t) {
    bool is_inside = true;
    for (Index k = 0; k < 3 && is_inside; ++k)
      is_inside =
          internal::orientation3d(Vector3d::Zero(), direction, map.sphere.col(map.triangles(k, t)),
                                  map.sphere.col(map.triangles((k + 1) % 3, t))) >= 0;
    if (is_inside)
      return t;
  }
  return -1;
}

TEST(SphereSurface, LocatesDirectionsAsBruteForceDoes) {
  for (const Mapped& map : maps()) {
    const SphereSurface surface = map.surface();
    const Positions directions = directionsFor(map);
    for (Eigen::Index i = 0; i < directions.cols(); ++i) {
      const SphereLocation location = surface.locate(directions.col(i));
      // The lowest of those that share an edge or a corner.
      ASSERT_EQ(location.triangle, bruteForceTriangle(map, directions.col(i)));
      ASSERT_GE(location.weights.minCoeff(), 0.0);
      ASSERT_NEAR(location.weights.sum(), 1.0, 4e-16);
      const Eigen::Matrix3d corners = map.sphere(Eigen::all, map.triangles.col(location.triangle));
      const double longest = std::max({(corners.col(0) - corners.col(1)).squaredNorm(),
                                       (corners.col(1) - corners.col(2)).squaredNorm(),
                                       (corners.col(2) - corners.col(0)).squaredNorm()});
      const double volume = corners.col(0).dot(
          (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)));
      // Rounding of coordinates up to 1, which counts more in slivers and in planes that pass near
      // the centre.
      ASSERT_LT(((corners * location.weights).normalized() - directions.col(i).normalized()).norm(),
                2e-15 * std::max(1.0, longest / volume));
    }
  }
}

TEST(SphereSurface, WeightsAreAccurateInTinyTriangles) {
  // The tiny triangles lie at the pole, where coordinates keep all their digits.
  const Mapped map = test::mapped(crowded(300, 12.0, Vector3d::UnitZ()));
  const SphereSurface surface = map.surface();
  const Vector3d weights(0.5, 0.3, 0.2);
  std::size_t tiny = 0;
  for (Index t = 0; t < map.triangles.cols(); ++t) {
    Vector3d direction = Vector3d::Zero();
    double size = 0.0;
    for (Index k = 0; k < 3; ++k) {
      const Vector3d corner = map.sphere.col(map.triangles(k, t));
      direction += weights[k] * corner;
      size = std::max(size, corner.z() < 0.0 ? 1.0 : corner.head<2>().norm());
    }
    if (size > 1e-8)
      continue;
    ++tiny;
    const SphereLocation location = surface.locate(direction);
    // Long slivers, whose sides differ by 100 and more: what rounds their places weighs as much.
    EXPECT_EQ(location.triangle, t);
    EXPECT_LT((location.weights - weights).norm(), 1e-9);
  }
  EXPECT_GT(tiny, 100U);
}

TEST(SphereSurface, PassesThroughItsVerticesWithoutGapsAtEdges) {
  for (const Mapped& map : maps())
    for (const SurfaceFit fit : kFits) {
      const SphereSurface surface = map.surface(fit);
      EXPECT_EQ(surface.evaluate(map.sphere).positions, map.points);
      for (Index t = 0; t < map.triangles.cols(); ++t)
        for (Index k = 0; k < 3; ++k) {
          const Index a = map.triangles(k, t);
          const Index b = map.triangles((k + 1) % 3, t);
          // The same place in the other triangle of the edge.
          SphereLocation other{-1, Vector3d::Zero()};
          for (Index s = 0; s < map.triangles.cols(); ++s)
            for (Index j = 0; j < 3; ++j)
              if (map.triangles(j, s) == b && map.triangles((j + 1) % 3, s) == a)
                other = {s, 0.7 * Vector3d::Unit(j) + 0.3 * Vector3d::Unit((j + 1) % 3)};
          const SurfaceSample here = surface.evaluate(
              SphereLocation{t, 0.3 * Vector3d::Unit(k) + 0.7 * Vector3d::Unit((k + 1) % 3)});
          const SurfaceSample there = surface.evaluate(other);
          ASSERT_LT((here.position - there.position).norm(), 1e-14);
          ASSERT_LT((here.normal - there.normal).norm(), 1e-12);
        }
    }
}

TEST(SphereSurface, NormalsAreUnitVectorsOutward) {
  const Mapped map = test::mapped(test::randomSphere(2000, 1));
  const Positions directions = test::randomSphere(500, 2);
  for (const SurfaceFit fit : kFits) {
    const Positions normals = map.surface(fit).evaluate(directions).normals;
    EXPECT_LT((normals.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-15);
    // Random points: some triangles are thin and stand a little askew.
    EXPECT_GT(normals.cwiseProduct(directions).colwise().sum().minCoeff(), 0.95);
  }
}

TEST(SphereSurface, OneDirectionGivesTheSameAsManyAlsoWhenMoved) {
  const Positions directions = test::randomSphere(50, 2);
  SphereSurface original = test::bumpy(test::randomSphere(300, 1)).surface(SurfaceFit::Smooth);
  const SurfaceSamples samples = original.evaluate(directions);
  const SphereSurface surface = std::move(original);
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const SurfaceSample sample = surface.evaluate(Vector3d(directions.col(i)));
    for (const SurfaceSample& same : {sample, surface.evaluate(sample.location)}) {
      EXPECT_EQ(same.position, samples.positions.col(i));
      EXPECT_EQ(same.normal, samples.normals.col(i));
    }
    // The length does not matter.
    for (const double length : {1e-300, 3.0, 1e300})
      EXPECT_LT((surface.evaluate(Vector3d(length * directions.col(i))).position - sample.position)
                    .norm(),
                1e-12);
  }
  EXPECT_EQ(surface.evaluate(Positions(3, 0)).positions.cols(), 0);
  // Coordinates that are too small for products count as zero.
  EXPECT_EQ(surface.locate({1.0, -1e-170, 1e-170}).triangle,
            surface.locate({1.0, 0.0, 0.0}).triangle);
}

struct Errors {
  double rms = 0.0;
  double max = 0.0;
  double rms_angle = 0.0;  ///< of the normals
};

/// How far the surface through points of an ellipsoid is from it, to first order.
Errors errorsOnEllipsoid(const Positions& sphere, const Vector3d& axes, SurfaceFit fit) {
  const SurfaceSamples samples =
      test::mappedOver(sphere, [&](const Vector3d& u) { return axes.cwiseProduct(u); })
          .surface(fit)
          .evaluate(test::randomSphere(1000, 8));
  const Positions scaled = axes.cwiseInverse().asDiagonal() * samples.positions;
  const Positions normals = axes.cwiseInverse().asDiagonal() * scaled;
  const Eigen::ArrayXXd errors =
      (scaled.colwise().squaredNorm().array() - 1.0) / (2.0 * normals.colwise().norm().array());
  const Positions turned = samples.normals - normals.colwise().normalized();
  return {std::sqrt(errors.square().mean()), errors.abs().maxCoeff(),
          std::sqrt(turned.colwise().squaredNorm().mean())};
}

TEST(SphereSurface, SmoothFitIsFiveTimesCloserToASphereAndAnEllipsoid) {
  for (const Vector3d& axes : {Vector3d(1.0, 1.0, 1.0), Vector3d(3.0, 2.0, 1.0)})
    for (const bool is_regular : {true, false}) {
      const Positions sphere = is_regular ? test::spiralSphere(1000) : test::randomSphere(2000, 3);
      const Errors linear = errorsOnEllipsoid(sphere, axes, SurfaceFit::Linear);
      const Errors smooth = errorsOnEllipsoid(sphere, axes, SurfaceFit::Smooth);
      EXPECT_LT(5.0 * smooth.rms, linear.rms);
      EXPECT_LT(smooth.max, linear.max);
      // In a regular mesh the errors of the triangles' normals cancel around each vertex.
      EXPECT_TRUE(is_regular || smooth.rms_angle < 0.8 * linear.rms_angle);
    }
}

TEST(SphereSurface, SmoothFitDoesNotBulgeAtSharpEdges) {
  for (const int m : {4, 9}) {
    Mapped cube = test::mapped(test::cubeDirections(m));
    cube.points = test::cubeGrid(m).array() - 0.5;
    const Positions directions = test::randomSphere(2000, 8);
    const Positions change = cube.surface(SurfaceFit::Smooth).evaluate(directions).positions -
                             cube.surface(SurfaceFit::Linear).evaluate(directions).positions;
    EXPECT_LT(change.colwise().norm().maxCoeff(), 0.05 / (m - 1)) << m;
  }
}

TEST(SphereSurface, AMapThatWindsTwiceIsRefused) {
  // A ring of eight that goes round twice: no triangle is flipped.
  Mapped twice = test::doubleCone(8);
  for (Index i = 0; i < 8; ++i)
    twice.sphere.col(i) << std::cos(test::kPi * i / 2.0), std::sin(test::kPi * i / 2.0), 0.0;
  const std::string refusal = test::refusalOf([&] { twice.surface(); });
  EXPECT_NE(refusal.find("2 times"), std::string::npos) << refusal;
}

}  // namespace
}  // namespace spherical_param
