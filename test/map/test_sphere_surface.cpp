#include "spherical_param/map/sphere_surface.h"

#include "exact_predicates.h"
#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/sphere_triangulation.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

struct Map {
  Positions sphere;
  Triangles triangles;
};

Map triangulated(const Positions& sphere) {
  return {sphere, triangulateSphere(sphere).triangles};
}

Positions octahedron() {
  Positions corners(3, 6);
  corners << 1, -1, 0, 0, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 1, -1;
  return corners;
}

/// Vertices that crowd around a direction, as on a limb: their distances from it are evenly spread
/// over so many orders of magnitude.
Map crowded(Index n, double orders, const Vector3d& place) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), place.normalized());
  Positions sphere(3, n);
  for (Index i = 0; i < n; ++i) {
    const double radius = std::pow(10.0, -orders * uniform(random));
    const double angle = 2.0 * test::kPi * uniform(random);
    sphere.col(i) =
        (turn * Vector3d(radius * std::cos(angle), radius * std::sin(angle), 1.0)).normalized();
  }
  return triangulated(test::horizontally(sphere, octahedron()));
}

/// Slivers: a linear map of space turns cones into cones.
Map stretched(Index n, double factor) {
  Map map = triangulated(test::randomSphere(n, 6));
  for (Index i = 0; i < n; ++i) {
    map.sphere(0, i) *= factor;
    map.sphere.col(i).normalize();
  }
  return map;
}

int side(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return internal::orientation3d(Vector3d::Zero(), a, b, c);
}

/// All triangles whose cones hold a direction, by their definition.
std::vector<Index> bruteForceTriangles(const Map& map, const Vector3d& direction) {
  std::vector<Index> result;
  for (Index t = 0; t < map.triangles.cols(); ++t) {
    const Vector3d a = map.sphere.col(map.triangles(0, t));
    const Vector3d b = map.sphere.col(map.triangles(1, t));
    const Vector3d c = map.sphere.col(map.triangles(2, t));
    if (side(direction, a, b) >= 0 && side(direction, b, c) >= 0 && side(direction, c, a) >= 0)
      result.push_back(t);
  }
  return result;
}

/// A bumpy closed shape over the sphere.
Positions bumpy(const Positions& sphere) {
  Positions points = sphere;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    points.col(i) *= 2.0 + 0.3 * std::sin(3.0 * sphere(0, i)) * std::cos(2.0 * sphere(1, i));
  return points;
}

SphereSurface surfaceOf(const Map& map, SurfaceFit fit = SurfaceFit::Linear, int threads = 0) {
  return SphereSurface(bumpy(map.sphere), map.triangles, map.sphere, {fit, threads});
}

std::vector<Map> maps() {
  std::vector<Map> all;
  all.push_back(triangulated(test::randomSphere(300, 1)));
  all.push_back(triangulated(octahedron()));
  Positions tetrahedron(3, 4);
  tetrahedron << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  all.push_back(triangulated(tetrahedron.colwise().normalized()));
  Positions cube = test::cubeGrid(5).colwise() - Vector3d::Constant(0.5);
  cube.colwise().normalize();
  all.push_back(triangulated(cube));
  all.push_back(crowded(300, 12.0, Vector3d::UnitZ()));
  all.push_back(crowded(300, 7.0, Vector3d(1.0, 2.0, 3.0)));
  all.push_back(stretched(300, 1000.0));
  return all;
}

/// Random directions, those near the vertices, vertices, and middles of edges.
Positions directionsFor(const Map& map) {
  const Positions random = test::randomSphere(500, 9);
  const Index v = static_cast<Index>(map.sphere.cols());
  const Positions near = test::withNoise(map.sphere, 1e-8, 2);
  Positions middles(3, 3 * map.triangles.cols());
  for (Eigen::Index t = 0; t < map.triangles.cols(); ++t)
    for (Index k = 0; k < 3; ++k)
      middles.col(3 * t + k) =
          map.sphere.col(map.triangles(k, t)) + map.sphere.col(map.triangles((k + 1) % 3, t));
  Positions centers(3, map.triangles.cols());
  for (Eigen::Index t = 0; t < map.triangles.cols(); ++t)
    centers.col(t) = map.sphere.col(map.triangles(0, t)) + map.sphere.col(map.triangles(1, t)) +
                     map.sphere.col(map.triangles(2, t));
  Positions all(3, random.cols() + 2 * v + middles.cols() + centers.cols());
  all << random, near, map.sphere, middles, centers;
  return all;
}

TEST(SphereSurface, LocatesDirectionsAsBruteForceDoes) {
  for (const Map& map : maps()) {
    const SphereSurface surface = surfaceOf(map);
    const Positions directions = directionsFor(map);
    for (Eigen::Index i = 0; i < directions.cols(); ++i) {
      const std::vector<Index> expected = bruteForceTriangles(map, directions.col(i));
      ASSERT_FALSE(expected.empty());
      // The lowest of those that share an edge or a corner.
      ASSERT_EQ(surface.locate(directions.col(i)).triangle, expected.front());
    }
  }
}

TEST(SphereSurface, WeightsAreThoseOfTheDirectionInTheFlatTriangle) {
  for (const Map& map : maps()) {
    const SphereSurface surface = surfaceOf(map);
    const Positions directions = directionsFor(map);
    for (Eigen::Index i = 0; i < directions.cols(); ++i) {
      const SphereLocation location = surface.locate(directions.col(i));
      ASSERT_GE(location.weights.minCoeff(), 0.0);
      ASSERT_NEAR(location.weights.sum(), 1.0, 4e-16);
      Eigen::Matrix3d corners;
      for (Index k = 0; k < 3; ++k)
        corners.col(k) = map.sphere.col(map.triangles(k, location.triangle));
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
  const Map map = crowded(300, 12.0, Vector3d::UnitZ());
  const SphereSurface surface = surfaceOf(map);
  std::size_t tiny = 0;
  for (Index t = 0; t < map.triangles.cols(); ++t) {
    const Vector3d weights(0.5, 0.3, 0.2);
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

TEST(SphereSurface, LengthOfTheDirectionDoesNotMatter) {
  const Map map = triangulated(test::randomSphere(100, 1));
  const SphereSurface surface = surfaceOf(map);
  for (const Vector3d& direction : {Vector3d(0.3, -0.2, 0.7), Vector3d(-1.0, 0.0, 0.0)}) {
    const SphereLocation expected = surface.locate(direction);
    for (const double length : {1e-300, 1e-9, 3.0, 1e9, 1e300}) {
      const SphereLocation location = surface.locate(length * direction);
      EXPECT_EQ(location.triangle, expected.triangle);
      EXPECT_LT((location.weights - expected.weights).norm(), 1e-14);
    }
  }
}

TEST(SphereSurface, PassesThroughItsVertices) {
  for (const Map& map : maps()) {
    for (const SurfaceFit fit : {SurfaceFit::Linear, SurfaceFit::Smooth}) {
      const SphereSurface surface = surfaceOf(map, fit);
      const SurfaceSamples samples = surface.evaluate(map.sphere);
      EXPECT_EQ(samples.positions, surface.points());
    }
  }
}

TEST(SphereSurface, LinearFitIsTheMesh) {
  const Map map = triangulated(test::randomSphere(300, 1));
  const SphereSurface surface = surfaceOf(map);
  const SurfaceSamples samples = surface.evaluate(test::randomSphere(300, 2));
  for (Eigen::Index i = 0; i < samples.positions.cols(); ++i) {
    const SphereLocation& location = samples.locations[static_cast<std::size_t>(i)];
    Vector3d expected = Vector3d::Zero();
    for (Index k = 0; k < 3; ++k)
      expected +=
          location.weights[k] * surface.points().col(surface.triangles()(k, location.triangle));
    EXPECT_LT((samples.positions.col(i) - expected).norm(), 1e-14);
  }
}

TEST(SphereSurface, NormalsAreUnitVectorsOutward) {
  const Map map = triangulated(test::randomSphere(2000, 1));
  for (const SurfaceFit fit : {SurfaceFit::Linear, SurfaceFit::Smooth}) {
    const SphereSurface surface(map.sphere, map.triangles, map.sphere, {fit, 0});
    const Positions directions = test::randomSphere(1000, 2);
    const SurfaceSamples samples = surface.evaluate(directions);
    for (Eigen::Index i = 0; i < directions.cols(); ++i) {
      ASSERT_NEAR(samples.normals.col(i).norm(), 1.0, 1e-15);
      // Random points: some triangles are thin and stand a little askew.
      ASSERT_GT(samples.normals.col(i).dot(directions.col(i)), 0.95);
    }
  }
}

TEST(SphereSurface, OneDirectionGivesTheSameAsMany) {
  const Map map = triangulated(test::randomSphere(300, 1));
  const SphereSurface surface = surfaceOf(map, SurfaceFit::Smooth);
  const Positions directions = test::randomSphere(50, 2);
  const SurfaceSamples samples = surface.evaluate(directions);
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const SurfaceSample sample = surface.evaluate(Vector3d(directions.col(i)));
    EXPECT_EQ(sample.position, samples.positions.col(i));
    EXPECT_EQ(sample.normal, samples.normals.col(i));
    const SurfaceSample again = surface.evaluate(sample.location);
    EXPECT_EQ(sample.position, again.position);
    EXPECT_EQ(sample.normal, again.normal);
  }
}

TEST(SphereSurface, IsTheSameForAnyNumberOfThreads) {
  const Map map = triangulated(test::randomSphere(6000, 1));
  const Positions directions = test::randomSphere(6000, 2);
  const SphereSurface one = surfaceOf(map, SurfaceFit::Smooth, 1);
  const SurfaceSamples expected = one.evaluate(directions);
  for (const int threads : {2, 3}) {
    const SphereSurface surface = surfaceOf(map, SurfaceFit::Smooth, threads);
    const SurfaceSamples samples = surface.evaluate(directions);
    EXPECT_EQ(surface.area(), one.area());
    EXPECT_EQ(samples.positions, expected.positions);
    EXPECT_EQ(samples.normals, expected.normals);
    for (std::size_t i = 0; i < expected.locations.size(); ++i) {
      ASSERT_EQ(samples.locations[i].triangle, expected.locations[i].triangle);
      ASSERT_EQ(samples.locations[i].weights, expected.locations[i].weights);
    }
  }
}

TEST(SphereSurface, AreaIsThatOfTheMesh) {
  const Map map = triangulated(octahedron());
  const SphereSurface surface(map.sphere, map.triangles, map.sphere);
  EXPECT_NEAR(surface.area(), 4.0 * std::sqrt(3.0), 1e-14);
}

TEST(SphereSurface, CanBeMoved) {
  const Map map = triangulated(octahedron());
  SphereSurface surface = surfaceOf(map);
  const Vector3d expected = surface.evaluate(Vector3d(1.0, 2.0, 3.0)).position;
  SphereSurface other = std::move(surface);
  EXPECT_EQ(other.evaluate(Vector3d(1.0, 2.0, 3.0)).position, expected);
}

/// Distance from an ellipsoid, to first order.
double distanceFrom(const Vector3d& axes, const Vector3d& point) {
  const Vector3d scaled = point.cwiseQuotient(axes);
  return std::abs(scaled.squaredNorm() - 1.0) / (2.0 * scaled.cwiseQuotient(axes).norm());
}

struct Errors {
  double rms = 0.0;
  double max = 0.0;
  double rms_angle = 0.0;  ///< of the normals
};

/// How far the surface through n points of an ellipsoid is from it.
Errors errorsOnEllipsoid(const Positions& sphere, const Vector3d& axes, SurfaceFit fit) {
  const Map map = triangulated(sphere);
  const SphereSurface surface(axes.asDiagonal() * sphere, map.triangles, sphere, {fit, 0});
  const Positions directions = test::randomSphere(3000, 8);
  const SurfaceSamples samples = surface.evaluate(directions);
  Errors errors;
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const Vector3d point = samples.positions.col(i);
    const double error = distanceFrom(axes, point);
    const double cosine =
        samples.normals.col(i).dot(point.cwiseQuotient(axes).cwiseQuotient(axes).normalized());
    errors.rms += error * error;
    errors.max = std::max(errors.max, error);
    errors.rms_angle += 2.0 * (1.0 - std::min(1.0, cosine));
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(directions.cols()));
  errors.rms_angle = std::sqrt(errors.rms_angle / static_cast<double>(directions.cols()));
  return errors;
}

TEST(SphereSurface, SmoothFitIsFiveTimesCloserToASphereAndAnEllipsoid) {
  for (const Vector3d& axes : {Vector3d(1.0, 1.0, 1.0), Vector3d(3.0, 2.0, 1.0)})
    for (const bool is_regular : {true, false}) {
      const Positions sphere = is_regular ? test::spiralSphere(1000) : test::randomSphere(3000, 3);
      const Errors linear = errorsOnEllipsoid(sphere, axes, SurfaceFit::Linear);
      const Errors smooth = errorsOnEllipsoid(sphere, axes, SurfaceFit::Smooth);
      EXPECT_LT(5.0 * smooth.rms, linear.rms);
      EXPECT_LT(smooth.max, linear.max);
      // In a regular mesh the errors of the triangles' normals cancel around each vertex.
      if (!is_regular) {
        EXPECT_LT(smooth.rms_angle, 0.8 * linear.rms_angle);
      }
    }
}

TEST(SphereSurface, SmoothFitConvergesWithAHigherOrder) {
  // Four times the points halve the edges: the error of the triangles falls to a quarter.
  const Vector3d axes(1.5, 1.2, 1.0);
  double last_linear = 0.0;
  double last_smooth = 0.0;
  for (const Index n : {500, 2000, 8000}) {
    const double linear = errorsOnEllipsoid(test::spiralSphere(n), axes, SurfaceFit::Linear).rms;
    const double smooth = errorsOnEllipsoid(test::spiralSphere(n), axes, SurfaceFit::Smooth).rms;
    if (last_linear > 0.0) {
      EXPECT_NEAR(last_linear / linear, 4.0, 0.5);
      EXPECT_GT(last_smooth / smooth, 7.0);
    }
    last_linear = linear;
    last_smooth = smooth;
  }
}

TEST(SphereSurface, SmoothFitDoesNotBulgeAtSharpEdges) {
  for (const int m : {4, 9, 17}) {
    Positions points = test::cubeGrid(m).colwise() - Vector3d::Constant(0.5);
    const Map map = triangulated(points.colwise().normalized());
    const SphereSurface surface(points, map.triangles, map.sphere);
    const SurfaceSamples samples = surface.evaluate(test::randomSphere(5000, 8));
    const SurfaceSamples flat =
        SphereSurface(points, map.triangles, map.sphere, {SurfaceFit::Linear, 0})
            .evaluate(test::randomSphere(5000, 8));
    double most = 0.0;
    for (Eigen::Index i = 0; i < samples.positions.cols(); ++i)
      most = std::max(most, (samples.positions.col(i) - flat.positions.col(i)).norm());
  }
}

TEST(SphereSurface, SmoothFitHasNoGapsAtEdges) {
  for (const Map& map : maps()) {
    const SphereSurface surface = surfaceOf(map, SurfaceFit::Smooth);
    for (Index t = 0; t < map.triangles.cols(); ++t)
      for (Index k = 0; k < 3; ++k) {
        const Index a = map.triangles(k, t);
        const Index b = map.triangles((k + 1) % 3, t);
        // The other triangle of the edge.
        SphereLocation other{0, Vector3d::Zero()};
        for (Index s = 0; s < map.triangles.cols(); ++s)
          for (Index j = 0; j < 3; ++j)
            if (map.triangles(j, s) == b && map.triangles((j + 1) % 3, s) == a)
              other = {s, 0.7 * Vector3d::Unit(j) + 0.3 * Vector3d::Unit((j + 1) % 3)};
        const SphereLocation here{t, 0.3 * Vector3d::Unit(k) + 0.7 * Vector3d::Unit((k + 1) % 3)};
        const SurfaceSample here_sample = surface.evaluate(here);
        const SurfaceSample other_sample = surface.evaluate(other);
        ASSERT_LT((here_sample.position - other_sample.position).norm(), 1e-14);
        ASSERT_LT((here_sample.normal - other_sample.normal).norm(), 1e-12);
      }
  }
}

template <typename Call>
std::string messageOf(const Call& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(SphereSurface, RefusesAFlippedTriangleAndNamesTheRemedy) {
  Map map = triangulated(test::randomSphere(100, 1));
  const Index v = map.triangles(0, 17);
  map.sphere.col(v) = -map.sphere.col(v);
  const std::string message =
      messageOf([&] { SphereSurface(map.sphere, map.triangles, map.sphere); });
  EXPECT_NE(message.find("computeSphereMap()"), std::string::npos) << message;
  EXPECT_NE(message.find("triangle "), std::string::npos) << message;
}

TEST(SphereSurface, RefusesATriangleWithoutAreaOnTheSphere) {
  Map map = triangulated(octahedron());
  map.sphere.col(0) = map.sphere.col(2);
  EXPECT_THROW(SphereSurface(map.sphere, map.triangles, map.sphere), InvalidInput);
}

TEST(SphereSurface, RefusesAMapThatWindsTwice) {
  // Two poles with a ring of eight between them that goes round twice: no triangle is flipped.
  Positions sphere(3, 10);
  Triangles triangles(3, 16);
  for (Index i = 0; i < 8; ++i) {
    const double angle = 4.0 * test::kPi * i / 8;
    sphere.col(i) << std::cos(angle), std::sin(angle), 0.0;
    triangles.col(2 * i) << i, (i + 1) % 8, 8;
    triangles.col(2 * i + 1) << (i + 1) % 8, i, 9;
  }
  sphere.col(8) = Vector3d::UnitZ();
  sphere.col(9) = -Vector3d::UnitZ();
  sphere.colwise().normalize();
  const std::string message = messageOf([&] { SphereSurface(sphere, triangles, sphere); });
  EXPECT_NE(message.find("2 times"), std::string::npos) << message;
}

TEST(SphereSurface, RefusesBadInput) {
  const Map map = triangulated(test::randomSphere(100, 1));
  Positions bad = map.sphere;
  bad(1, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SphereSurface(bad, map.triangles, map.sphere), InvalidInput);
  EXPECT_THROW(SphereSurface(map.sphere, map.triangles, bad), InvalidInput);
  EXPECT_THROW(SphereSurface(map.sphere, map.triangles, 2.0 * map.sphere), InvalidInput);
  EXPECT_THROW(SphereSurface(map.sphere.leftCols(99), map.triangles, map.sphere), InvalidInput);
  const Triangles open = map.triangles.leftCols(100);
  EXPECT_THROW(SphereSurface(map.sphere, open, map.sphere), InvalidInput);
  EXPECT_THROW(SphereSurface(map.sphere, Triangles(3, 0), map.sphere), InvalidInput);
  EXPECT_THROW(SphereSurface(Positions(3, 0), Triangles(3, 0), Positions(3, 0)), InvalidInput);
  EXPECT_THROW(surfaceOf(map, SurfaceFit::Linear, -1), InvalidInput);
  EXPECT_THROW(surfaceOf(map, SurfaceFit::Linear, 1025), InvalidInput);
  const SphereSurface surface = surfaceOf(map);
  EXPECT_THROW(surface.locate(Vector3d::Zero()), InvalidInput);
  EXPECT_THROW(surface.locate(bad.col(3)), InvalidInput);
  EXPECT_THROW(surface.evaluate(bad), InvalidInput);
  EXPECT_THROW(
      surface.evaluate(SphereLocation{static_cast<Index>(map.triangles.cols()), Vector3d::UnitX()}),
      InvalidInput);
  EXPECT_EQ(surface.evaluate(Positions(3, 0)).positions.cols(), 0);
}

}  // namespace
}  // namespace spherical_param
