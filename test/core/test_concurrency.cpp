// Calls from several threads share nothing. A program of its own, so that the thread sanitizer has
// no more to build than this.

#include "helpers.h"

#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/sphere_triangulation.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace spherical_param {
namespace {

Positions ellipsoid(Index n) {
  return Eigen::Vector3d(1.0, 0.8, 0.5).asDiagonal() * test::spiralSphere(n);
}

TEST(Concurrency, ReconstructionsAgreeWithSingleOnes) {
  constexpr std::size_t count = 4;
  Options options;
  options.threads = 1;
  options.embedding.max_iterations = 50;
  options.graph.k = 8;
  const auto run = [&](std::size_t i) {
    const Positions points = ellipsoid(300 + 50 * static_cast<Index>(i));
    return reconstruct(points, test::bruteForceNeighbors(points, 8), options,
                       test::bruteForceSearch(points));
  };
  std::vector<Result> alone(count);
  for (std::size_t i = 0; i < count; ++i)
    alone[i] = run(i);
  const std::vector<Result> together = test::runTogether(count, run);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(alone[i].triangles, together[i].triangles);
    EXPECT_EQ(alone[i].sphere, together[i].sphere);
    EXPECT_EQ(alone[i].embedding.residuals, together[i].embedding.residuals);
  }
}

TEST(Concurrency, TriangulationsAgreeWithSingleOnes) {
  for (const TriangulationMethod method :
       {TriangulationMethod::Qhull, TriangulationMethod::Incremental}) {
    constexpr std::size_t count = 4;
    std::vector<Triangles> alone(count);
    const auto run = [method](std::size_t i) {
      return triangulateSphere(test::randomSphere(500 + 100 * static_cast<Index>(i), i), {method})
          .triangles;
    };
    for (std::size_t i = 0; i < count; ++i)
      alone[i] = run(i);
    const std::vector<Triangles> together = test::runTogether(count, run);
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_EQ(alone[i], together[i]);
  }
}

TEST(Concurrency, MapsAgreeWithSingleOnes) {
  constexpr std::size_t count = 4;
  const auto run = [](std::size_t i) {
    const Positions points = ellipsoid(200 + 50 * static_cast<Index>(i));
    const Positions start = points.colwise().normalized();
    SphereMapOptions options;
    options.threads = 1;
    return computeSphereMap(points, triangulateSphere(start).triangles, start, options).sphere;
  };
  std::vector<Positions> alone(count);
  for (std::size_t i = 0; i < count; ++i)
    alone[i] = run(i);
  const std::vector<Positions> together = test::runTogether(count, run);
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_EQ(alone[i], together[i]);
}

TEST(Concurrency, OneSurfaceAnswersSeveralThreads) {
  constexpr std::size_t count = 4;
  const Positions points = ellipsoid(500);
  const Positions sphere = points.colwise().normalized();
  const SphereSurface surface(points, triangulateSphere(sphere).triangles, sphere);
  const Positions directions = test::randomSphere(300, 7);
  const Positions expected = surface.evaluate(directions).positions;
  const auto run = [&](std::size_t /*i*/) {
    Positions positions(3, directions.cols());
    for (Eigen::Index j = 0; j < directions.cols(); ++j)
      positions.col(j) = surface.evaluate(Eigen::Vector3d(directions.col(j))).position;
    return positions;
  };
  const std::vector<Positions> together = test::runTogether(count, run);
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_EQ(together[i], expected);
}

// Each thread writes its own counter and, behind the barrier, reads all others: with a barrier that
// let one pass too early the counters would differ.
}  // namespace
}  // namespace spherical_param
