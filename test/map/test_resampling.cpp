#include "spherical_param/map/resampling.h"

#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/sphere_triangulation.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

/// A bumpy shape over random directions.
SphereSurface bumpySurface(Index n, SurfaceFit fit = SurfaceFit::Smooth, int threads = 0) {
  const Positions sphere = test::randomSphere(n, 1);
  Positions points = sphere;
  for (Index i = 0; i < n; ++i)
    points.col(i) *= 2.0 + 0.3 * std::sin(3.0 * sphere(0, i)) * std::cos(2.0 * sphere(1, i));
  return SphereSurface(points, triangulateSphere(sphere).triangles, sphere, {fit, threads});
}

/// A surface over directions, by a function of them.
template <typename Place>
SphereSurface surfaceOver(Index n, const Place& place, int threads = 0) {
  const Positions sphere = test::spiralSphere(n);
  Positions points(3, n);
  for (Index i = 0; i < n; ++i)
    points.col(i) = place(Vector3d(sphere.col(i)));
  return SphereSurface(points, triangulateSphere(sphere).triangles, sphere,
                       {SurfaceFit::Linear, threads});
}

double areaOnSphere(const GridSphere& grid, Eigen::Index t) {
  const Vector3d a = grid.directions.col(grid.triangles(0, t));
  const Vector3d b = grid.directions.col(grid.triangles(1, t));
  const Vector3d c = grid.directions.col(grid.triangles(2, t));
  return 2.0 * std::atan2(a.dot(b.cross(c)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
}

constexpr SphereGrid kGrids[] = {SphereGrid::Icosahedral, SphereGrid::Octahedral};

TEST(GridSphere, IsAClosedMeshThatCoversTheSphereOnce) {
  for (const SphereGrid kind : kGrids)
    for (const int frequency : {1, 2, 3, 4, 7, 12}) {
      const GridSphere grid = makeGridSphere(kind, frequency);
      EXPECT_EQ(grid.frequency, frequency);
      ASSERT_EQ(static_cast<std::size_t>(grid.directions.cols()), gridVertices(kind, frequency));
      EXPECT_TRUE(
          test::isSphereOverAll(grid.triangles, static_cast<Index>(grid.directions.cols())));
      double sum = 0.0;
      for (Eigen::Index t = 0; t < grid.triangles.cols(); ++t) {
        EXPECT_GT(areaOnSphere(grid, t), 0.0);
        sum += areaOnSphere(grid, t);
      }
      EXPECT_NEAR(sum, 4.0 * test::kPi, 1e-11);
      for (Eigen::Index i = 0; i < grid.directions.cols(); ++i)
        EXPECT_NEAR(grid.directions.col(i).norm(), 1.0, 1e-15);
    }
}

TEST(GridSphere, TrianglesOfTheGeodesicOneHaveSimilarAreas) {
  const GridSphere grid = makeGridSphere(SphereGrid::Icosahedral, 16);
  double least = 10.0;
  double most = 0.0;
  for (Eigen::Index t = 0; t < grid.triangles.cols(); ++t) {
    least = std::min(least, areaOnSphere(grid, t));
    most = std::max(most, areaOnSphere(grid, t));
  }
  EXPECT_LT(most / least, 1.25);
}

TEST(GridSphere, HasTheSymmetryOfItsSolid) {
  // A third of a turn about (1, 1, 1) moves the axes in a circle, and half a turn two of them.
  for (const SphereGrid kind : kGrids) {
    const GridSphere grid = makeGridSphere(kind, 5);
    Eigen::Matrix3d third = Eigen::Matrix3d::Zero();
    third(0, 1) = third(1, 2) = third(2, 0) = 1.0;
    const Eigen::Matrix3d half = Vector3d(-1.0, -1.0, 1.0).asDiagonal();
    for (const Eigen::Matrix3d& turn : {third, half})
      for (Eigen::Index i = 0; i < grid.directions.cols(); ++i) {
        const Vector3d turned = turn * grid.directions.col(i);
        EXPECT_LT((grid.directions.colwise() - turned).colwise().norm().minCoeff(), 1e-14);
      }
  }
}

TEST(GridSphere, TrianglesOfTheOctahedralOneStayInTheirOctant) {
  const GridSphere grid = makeGridSphere(SphereGrid::Octahedral, 6);
  for (Eigen::Index t = 0; t < grid.triangles.cols(); ++t)
    for (Index axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (Index k = 0; k < 3; ++k)
        values.push_back(grid.directions(axis, grid.triangles(k, t)));
      EXPECT_GE(*std::min_element(values.begin(), values.end()) *
                    *std::max_element(values.begin(), values.end()),
                0.0);
    }
}

TEST(GridSphere, FrequencyIsTheOneWhoseVerticesAreNearest) {
  for (const SphereGrid kind : kGrids)
    for (std::size_t n = 0; n < 3000; n += 7) {
      const int f = gridFrequency(kind, n);
      const auto distance = [&](int frequency) {
        return std::abs(static_cast<double>(gridVertices(kind, frequency)) -
                        static_cast<double>(n));
      };
      EXPECT_LE(distance(f), distance(f + 1));
      if (f > 1) {
        EXPECT_LE(distance(f), distance(f - 1));
      }
    }
  EXPECT_EQ(gridFrequency(SphereGrid::Icosahedral, 163842), 128);
  EXPECT_EQ(gridFrequency(SphereGrid::Octahedral, 0), 1);
  EXPECT_NO_THROW(
      gridVertices(SphereGrid::Octahedral,
                   gridFrequency(SphereGrid::Octahedral, std::numeric_limits<std::size_t>::max())));
}

TEST(GridSphere, RefusesAFrequencyOutOfRange) {
  for (const SphereGrid kind : kGrids)
    for (const int frequency :
         {0, -1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max(),
          gridFrequency(kind, std::size_t{1} << 29) + 1}) {
      EXPECT_THROW(gridVertices(kind, frequency), InvalidInput);
      EXPECT_THROW(makeGridSphere(kind, frequency), InvalidInput);
    }
}

TEST(ResampleSurface, HasTheSurfaceAtEachDirection) {
  const SphereSurface surface = bumpySurface(500);
  for (const SphereGrid kind : kGrids) {
    const GridSphere grid = makeGridSphere(kind, 9);
    const ResampledMesh mesh = resampleSurface(surface, grid);
    EXPECT_EQ(mesh.directions, grid.directions);
    EXPECT_EQ(mesh.triangles, grid.triangles);
    for (Eigen::Index i = 0; i < mesh.points.cols(); ++i) {
      const SurfaceSample sample = surface.evaluate(Vector3d(grid.directions.col(i)));
      EXPECT_EQ(mesh.points.col(i), sample.position);
      EXPECT_EQ(mesh.normals.col(i), sample.normal);
    }
    EXPECT_GT(test::volumeOf(mesh.points, mesh.triangles), 0.0);
  }
}

TEST(ResampleSurface, IsAMapThatCanBeResampledAgain) {
  const ResampledMesh mesh =
      resampleSurface(bumpySurface(500), makeGridSphere(SphereGrid::Icosahedral, 6));
  const SphereSurface again(mesh.points, mesh.triangles, mesh.directions);
  EXPECT_EQ(again.evaluate(mesh.directions).positions, mesh.points);
}

TEST(GeometryImage, IsLaidOutAsTheOctahedralChart) {
  const int side = 9;
  const Positions directions = geometryImageDirections(side);
  const auto at = [&](int row, int column) {
    return Vector3d(directions.col(row * side + column));
  };
  EXPECT_EQ(at(4, 4), Vector3d::UnitZ());
  for (const auto& [row, column] : {std::pair(0, 0), {0, 8}, {8, 0}, {8, 8}})
    EXPECT_EQ(at(row, column), -Vector3d::UnitZ());
  EXPECT_EQ(at(4, 8), Vector3d::UnitX());
  EXPECT_EQ(at(4, 0), -Vector3d::UnitX());
  EXPECT_EQ(at(0, 4), Vector3d::UnitY());
  EXPECT_EQ(at(8, 4), -Vector3d::UnitY());
  // Upwards to the right of the middle.
  EXPECT_GT(at(3, 5).minCoeff(), 0.0);
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      // The octahedron, above and below.
      const double x = (column - 4) / 4.0;
      const double y = (4 - row) / 4.0;
      const Vector3d on_octahedron = at(row, column) / at(row, column).lpNorm<1>();
      EXPECT_NEAR(on_octahedron.z(), 1.0 - std::abs(x) - std::abs(y), 1e-15);
      if (on_octahedron.z() >= 0.0) {
        EXPECT_NEAR(on_octahedron.x(), x, 1e-15);
        EXPECT_NEAR(on_octahedron.y(), y, 1e-15);
      } else {
        EXPECT_NEAR(std::abs(on_octahedron.x()), 1.0 - std::abs(y), 1e-15);
        EXPECT_GE(on_octahedron.x() * x, 0.0);
        EXPECT_GE(on_octahedron.y() * y, 0.0);
      }
    }
}

TEST(GeometryImage, PairsOnTheBorderAreTheSameDirectionBitByBit) {
  for (const int side : {3, 5, 9, 33}) {
    const Positions directions = geometryImageDirections(side);
    const int last = side - 1;
    const auto at = [&](int row, int column) {
      return Vector3d(directions.col(row * side + column));
    };
    for (int i = 0; i < side; ++i) {
      EXPECT_EQ(at(0, i), at(0, last - i));
      EXPECT_EQ(at(last, i), at(last, last - i));
      EXPECT_EQ(at(i, 0), at(last - i, 0));
      EXPECT_EQ(at(i, last), at(last - i, last));
    }
    std::set<std::vector<double>> different;
    for (Eigen::Index i = 0; i < directions.cols(); ++i)
      different.insert({directions(0, i), directions(1, i), directions(2, i)});
    EXPECT_EQ(different.size(), static_cast<std::size_t>(last * last + 2));
  }
}

TEST(GeometryImage, ItsMeshIsTheResampledSurfaceBitByBit) {
  const SphereSurface surface = bumpySurface(500);
  for (const int side : {3, 5, 21}) {
    const GeometryImage image = makeGeometryImage(surface, side);
    EXPECT_EQ(image.side, side);
    const ResampledMesh mesh = meshOfGeometryImage(image);
    const GridSphere grid = makeGridSphere(SphereGrid::Octahedral, side / 2);
    const ResampledMesh expected = resampleSurface(surface, grid);
    EXPECT_EQ(mesh.points, expected.points);
    EXPECT_EQ(mesh.directions, grid.directions);
    EXPECT_EQ(mesh.triangles, grid.triangles);
    EXPECT_TRUE(test::isSphereOverAll(mesh.triangles, static_cast<Index>(mesh.points.cols())));
    for (Eigen::Index i = 0; side > 20 && i < mesh.points.cols(); ++i)
      EXPECT_GT(mesh.normals.col(i).dot(expected.normals.col(i)), 0.9);
  }
}

TEST(GeometryImage, PixelsThatDifferOnTheBorderAreAveraged) {
  GeometryImage image = makeGeometryImage(bumpySurface(500), 5);
  const ResampledMesh before = meshOfGeometryImage(image);
  image.positions.col(1) += Vector3d(2.0, 0.0, 0.0);          // (0, 1), the same as (0, 3)
  image.positions.col(4) += Vector3d(0.0, 4.0, 0.0);          // one of the corners
  image.positions.col(4 * 5 + 4) -= Vector3d(0.0, 0.0, 4.0);  // another
  const ResampledMesh after = meshOfGeometryImage(image);
  Positions change = after.points - before.points;
  Positions expected = Positions::Zero(3, change.cols());
  expected.col(0) << 0.0, 1.0, -1.0;
  expected.col(1) << 1.0, 0.0, 0.0;
  EXPECT_LT((change - expected).norm(), 1e-14);
}

TEST(GeometryImage, RefusesBadInput) {
  const SphereSurface surface = bumpySurface(100);
  for (const int side : {-3, 0, 1, 2, 4, 16386, 16387}) {
    EXPECT_THROW(geometryImageDirections(side), InvalidInput);
    EXPECT_THROW(makeGeometryImage(surface, side), InvalidInput);
    EXPECT_THROW(meshOfGeometryImage({side, Positions(3, 9)}), InvalidInput);
  }
  GeometryImage image = makeGeometryImage(surface, 5);
  image.positions(1, 7) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(meshOfGeometryImage(image), InvalidInput);
  EXPECT_THROW(meshOfGeometryImage({5, Positions::Zero(3, 24)}), InvalidInput);
}

/// A long body with a groove along it, and a map that is twisted, so that the edges of a grid run
/// askew to the groove.
SphereSurface groovedBody() {
  return surfaceOver(20000, [](const Vector3d& u) {
    const double angle = std::remainder(std::atan2(u.y(), u.x()) + 4.0 * u.z(), 2.0 * test::kPi);
    const double radius = std::hypot(u.x(), u.y()) * (1.0 - 0.9 * std::exp(-16.0 * angle * angle));
    return Vector3d(radius * std::cos(angle), radius * std::sin(angle), 6.0 * u.z());
  });
}

TEST(RemoveIntersections, FlipsEdgesUntilNoTrianglesIntersect) {
  ResampledMesh mesh = resampleSurface(groovedBody(), makeGridSphere(SphereGrid::Icosahedral, 16));
  const ResampledMesh before = mesh;
  const IntersectionRemoval result = removeIntersections(mesh);
  EXPECT_EQ(result.found, findSelfIntersections(before.points, before.triangles).size());
  EXPECT_GT(result.found, 0U);
  EXPECT_GT(result.flips, 0U);
  EXPECT_EQ(result.left, 0U);
  EXPECT_EQ(result.left, findSelfIntersections(mesh.points, mesh.triangles).size());
  EXPECT_EQ(mesh.points, before.points);
  EXPECT_EQ(mesh.directions, before.directions);
  EXPECT_TRUE(test::isSphereOverAll(mesh.triangles, static_cast<Index>(mesh.points.cols())));
  // Still a map that is one to one.
  EXPECT_NO_THROW(SphereSurface(mesh.points, mesh.triangles, mesh.directions));
}

TEST(RemoveIntersections, LeavesAMeshWithoutThemAsItIs) {
  ResampledMesh mesh =
      resampleSurface(bumpySurface(500), makeGridSphere(SphereGrid::Octahedral, 8));
  const Triangles before = mesh.triangles;
  const IntersectionRemoval result = removeIntersections(mesh);
  EXPECT_EQ(result.found, 0U);
  EXPECT_EQ(result.flips, 0U);
  EXPECT_EQ(mesh.triangles, before);
}

TEST(RemoveIntersections, IsTheSameForAnyNumberOfThreads) {
  const ResampledMesh mesh =
      resampleSurface(groovedBody(), makeGridSphere(SphereGrid::Icosahedral, 16));
  ResampledMesh expected = mesh;
  removeIntersections(expected, 1);
  for (const int threads : {2, 3}) {
    ResampledMesh found = mesh;
    removeIntersections(found, threads);
    EXPECT_EQ(found.triangles, expected.triangles);
  }
}

TEST(RemoveIntersections, RefusesBadInput) {
  const ResampledMesh mesh =
      resampleSurface(bumpySurface(100), makeGridSphere(SphereGrid::Octahedral, 2));
  ResampledMesh bad = mesh;
  EXPECT_THROW(removeIntersections(bad, -1), InvalidInput);
  bad.directions = mesh.directions.leftCols(5);
  EXPECT_THROW(removeIntersections(bad), InvalidInput);
  bad = mesh;
  bad.triangles = mesh.triangles.leftCols(7);
  EXPECT_THROW(removeIntersections(bad), InvalidInput);
  bad = mesh;
  bad.triangles(0, 0) = 1000;
  EXPECT_THROW(removeIntersections(bad), InvalidInput);
}

/// A cigar whose map is twisted: triangles of a grid wind round it, and cut across each other.
SphereSurface twistedCigar(int threads = 0) {
  return surfaceOver(
      8000,
      [](const Vector3d& u) {
        const double angle = 10.0 * u.z();
        const Vector3d turned(std::cos(angle) * u.x() - std::sin(angle) * u.y(),
                              std::sin(angle) * u.x() + std::cos(angle) * u.y(), u.z());
        return Vector3d(turned.x(), 0.15 * turned.y(), 2.0 * turned.z());
      },
      threads);
}

TEST(Untangle, SlidesVerticesUntilNothingIntersectsAndKeepsAllElse) {
  const SphereSurface surface = twistedCigar();
  const GridSphere grid = makeGridSphere(SphereGrid::Icosahedral, 8);
  const ResampledMesh before = resampleSurface(surface, grid);
  const std::size_t pairs = findSelfIntersections(before.points, before.triangles).size();
  ASSERT_GT(pairs, 0U);
  ResampledMesh mesh = before;
  const UntanglingReport report = untangle(surface, mesh);
  EXPECT_EQ(report.before, pairs);
  EXPECT_EQ(report.after, 0U);
  EXPECT_EQ(findSelfIntersections(mesh.points, mesh.triangles).size(), report.after);
  EXPECT_EQ(mesh.triangles, before.triangles);
  Index moved = 0;
  for (Eigen::Index i = 0; i < mesh.points.cols(); ++i) {
    moved += mesh.directions.col(i) != before.directions.col(i) ? 1 : 0;
    EXPECT_NEAR(mesh.directions.col(i).norm(), 1.0, 1e-14);
    const SurfaceSample sample = surface.evaluate(Vector3d(mesh.directions.col(i)));
    EXPECT_EQ(sample.position, mesh.points.col(i));
    EXPECT_EQ(sample.normal, mesh.normals.col(i));
  }
  EXPECT_EQ(moved, report.moved);
  EXPECT_LT(moved, mesh.points.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](Eigen::Index k) {
      return Vector3d(mesh.directions.col(mesh.triangles(k, t)));
    };
    EXPECT_GT(corner(0).cross(corner(1)).dot(corner(2)), 0.0);
  }
  for (const int threads : {1, 3}) {
    ResampledMesh other = before;
    untangle(surface, other, threads);
    EXPECT_EQ(other.points, mesh.points) << threads;
  }
}

TEST(Untangle, ChangesNothingWhereNothingIntersects) {
  const SphereSurface surface = bumpySurface(20);
  const ResampledMesh before = resampleSurface(surface, makeGridSphere(SphereGrid::Octahedral, 9));
  ResampledMesh mesh = before;
  const UntanglingReport report = untangle(surface, mesh);
  EXPECT_EQ(report.before, 0U);
  EXPECT_EQ(report.rounds, 0);
  EXPECT_EQ(report.moved, 0);
  EXPECT_EQ(mesh.points, before.points);
  EXPECT_EQ(mesh.directions, before.directions);
}

TEST(Untangle, RefusesMeshesThatAreNoSphere) {
  const SphereSurface surface = bumpySurface(20);
  const ResampledMesh good = resampleSurface(surface, makeGridSphere(SphereGrid::Octahedral, 3));
  ResampledMesh mesh = good;
  EXPECT_THROW(untangle(surface, mesh, -1), InvalidInput);
  mesh.directions.conservativeResize(3, 5);
  EXPECT_THROW(untangle(surface, mesh), InvalidInput);
  mesh = good;
  mesh.triangles(0, 0) = 38;
  EXPECT_THROW(untangle(surface, mesh), InvalidInput);
}

TEST(GeometryImage, OfAnOctahedralMeshGivesTheMeshBack) {
  const SphereSurface surface = bumpySurface(20);
  const ResampledMesh mesh = resampleSurface(surface, makeGridSphere(SphereGrid::Octahedral, 9));
  const GeometryImage image = geometryImageOfMesh(mesh);
  EXPECT_EQ(image.side, 19);
  EXPECT_EQ(image.positions, makeGeometryImage(surface, 19).positions);
  const ResampledMesh back = meshOfGeometryImage(image);
  EXPECT_EQ(back.points, mesh.points);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_THROW(
      geometryImageOfMesh(resampleSurface(surface, makeGridSphere(SphereGrid::Icosahedral, 3))),
      InvalidInput);
}

/// The distance of each point from the nearest other, by brute force.
std::vector<double> nearestDistances(const Positions& points) {
  const NeighborLists lists = test::bruteForceNeighbors(points, 1);
  std::vector<double> result;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    result.push_back(
        (points.col(i) - points.col(lists.indices[static_cast<std::size_t>(i)])).norm());
  return result;
}

TEST(SampleEvenly, PointsKeepTheirDistance) {
  const SphereSurface surface = surfaceOver(1000, [](const Vector3d& u) { return u; });
  for (const std::size_t count : {50U, 400U, 1500U}) {
    const SurfacePoints samples = sampleEvenly(surface, count);
    ASSERT_EQ(samples.points.cols(), static_cast<Eigen::Index>(count));
    // Of disks that are packed as densely as can be.
    const double best =
        2.0 * std::sqrt(surface.area() / (2.0 * std::sqrt(3.0) * static_cast<double>(count)));
    const std::vector<double> distances = nearestDistances(samples.points);
    // Poisson disk sets reach 0.65 to 0.85; random points have nearly 0.
    EXPECT_GT(*std::min_element(distances.begin(), distances.end()), 0.6 * best);
    EXPECT_LT(*std::max_element(distances.begin(), distances.end()), 1.3 * best);
  }
}

TEST(SampleEvenly, LiesOnTheSurface) {
  const SphereSurface surface = surfaceOver(1000, [](const Vector3d& u) { return 3.0 * u; });
  const SurfacePoints samples = sampleEvenly(surface, 300);
  for (Eigen::Index i = 0; i < samples.points.cols(); ++i) {
    const Vector3d point = samples.points.col(i);
    EXPECT_LT((surface.evaluate(point).position - point).norm(), 1e-13);
    EXPECT_EQ(surface.evaluate(samples.locations[static_cast<std::size_t>(i)]).position, point);
    EXPECT_NEAR(samples.normals.col(i).norm(), 1.0, 1e-15);
    EXPECT_GT(samples.normals.col(i).dot(point.normalized()), 0.99);
  }
}

TEST(SampleEvenly, IsEvenInSpaceWhateverTheMap) {
  // A cigar, whose ends the map squeezes: as many points for each part as it has area.
  const SphereSurface surface = surfaceOver(4000, [](const Vector3d& u) {
    return Vector3d(u.x(), u.y(), 8.0 * u.z() * std::abs(u.z()));
  });
  const std::size_t count = 3000;
  const SurfacePoints samples = sampleEvenly(surface, count);
  for (const double z : {0.5, 2.0, 6.0}) {
    double area = 0.0;
    const Triangles& triangles = surface.triangles();
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      const Vector3d a = surface.points().col(triangles(0, t));
      const Vector3d b = surface.points().col(triangles(1, t));
      const Vector3d c = surface.points().col(triangles(2, t));
      if ((a + b + c).z() / 3.0 > z)
        area += 0.5 * (b - a).cross(c - a).norm();
    }
    const auto expected = area / surface.area() * static_cast<double>(count);
    const auto found = static_cast<double>((samples.points.row(2).array() > z).count());
    EXPECT_NEAR(found, expected, 0.05 * expected + 3.0);
  }
}

TEST(SampleEvenly, SheetsThatAreCloseDoNotPushEachOther) {
  // A plate that is far thinner than the distance of the points: as many on either side, and no
  // farther from each other on a side than they would be without the other.
  const SphereSurface surface =
      surfaceOver(2000, [](const Vector3d& u) { return Vector3d(u.x(), u.y(), 1e-3 * u.z()); });
  const std::size_t count = 400;
  const SurfacePoints samples = sampleEvenly(surface, count);
  Positions upper(3, 0);
  for (Eigen::Index i = 0; i < samples.points.cols(); ++i)
    if (samples.normals(2, i) > 0.0)
      upper = test::horizontally(upper, samples.points.col(i));
  EXPECT_NEAR(static_cast<double>(upper.cols()), 200.0, 10.0);
  const std::vector<double> distances = nearestDistances(upper);
  const double best =
      2.0 * std::sqrt(surface.area() / (2.0 * std::sqrt(3.0) * static_cast<double>(count)));
  EXPECT_GT(*std::min_element(distances.begin(), distances.end()), 0.6 * best);
}

TEST(SampleEvenly, IsTheSameForTheSameSeedAndAnyNumberOfThreads) {
  const auto place = [](const Vector3d& u) { return Vector3d(2.0 * u.x(), u.y(), u.z()); };
  const SurfacePoints expected = sampleEvenly(surfaceOver(500, place, 1), 2000, 7);
  for (const int threads : {2, 3}) {
    const SurfacePoints samples = sampleEvenly(surfaceOver(500, place, threads), 2000, 7);
    EXPECT_EQ(samples.points, expected.points);
    EXPECT_EQ(samples.normals, expected.normals);
  }
  EXPECT_NE(sampleEvenly(surfaceOver(500, place), 2000, 8).points, expected.points);
}

TEST(SampleEvenly, OnePointIsEnough) {
  EXPECT_EQ(sampleEvenly(bumpySurface(20), 1).points.cols(), 1);
}

TEST(SampleEvenly, RefusesBadInput) {
  const SphereSurface surface = bumpySurface(20);
  EXPECT_THROW(sampleEvenly(surface, 0), InvalidInput);
  EXPECT_THROW(sampleEvenly(surface, (std::size_t{1} << 24) + 1), InvalidInput);
  EXPECT_THROW(sampleEvenly(surfaceOver(20, [](const Vector3d&) { return Vector3d(1, 2, 3); }), 5),
               InvalidInput);
}

}  // namespace
}  // namespace spherical_param
