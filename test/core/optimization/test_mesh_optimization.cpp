#include "mesh_optimization.h"

#include "optimization_cases.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::test {
namespace {

MeshOptimization optimize(const Case& of, const OptimizationOptions& options = {},
                          const Execution& execution = {}) {
  return optimizeMesh(of.points, SphereMesh(of.triangles, columnCount(of.points)), of.graph,
                      options, execution);
}

/// What holds of every result.
void expectGuarantees(const Case& of, const MeshOptimization& result) {
  EXPECT_TRUE(isSphereOverAll(result.mesh.triangles(), static_cast<Index>(of.points.cols())));
  EXPECT_EQ(result.intersecting.pairs, findSelfIntersections(of.points, result.mesh.triangles()));
}

TEST(MeshOptimization, ACubeGetsItsEdgesFromScrambledMeshes) {
  const auto expect_cube = [](int cells, int flips, std::uint64_t seed) {
    SCOPED_TRACE(seed);
    const Case of = scrambled(radialStart(cubeGrid(cells + 1)), flips, seed);
    const MeshOptimization result = optimize(of);
    expectGuarantees(of, result);
    // 12 edges of length 1 are bent by a right angle; the 12 cells^2 triangles have half a diagonal
    // of their cell as circumradius. 1e-6: acos near 1 is off by 1e-8, on flat edges of length 60.
    const double energy = 12.0 * kPi / 2.0 + 0.3 * 12.0 * cells * std::sqrt(0.5);
    EXPECT_NEAR(energyOf(of.points, result.mesh.triangles()), energy, 1e-6);
    EXPECT_NEAR(std::abs(volumeOf(of.points, result.mesh.triangles())), 1.0, 1e-12);
    EXPECT_TRUE(result.intersecting.pairs.empty());
  };
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    expect_cube(1, 10, seed);
  expect_cube(4, 60, 3);
}

TEST(MeshOptimization, NoiseAloneIsSmoothedAndReportedOnTheGivenPoints) {
  const Case noisy = noisySphere(200, 0.5, 26);
  for (const auto& [of, is_noisy] :
       {std::pair(ellipsoid(500, 0.8, 0.6), false), std::pair(radialStart(cubeGrid(6)), false),
        std::pair(noisy, true)}) {
    const MeshOptimization result = optimize(of);
    expectGuarantees(of, result);
    EXPECT_EQ(result.report.is_noisy, is_noisy);
  }
  // Without the finish, intersections are those on the smoothed points.
  OptimizationOptions unfinished;
  unfinished.finish_on_points = false;
  const MeshOptimization result = optimize(noisy, unfinished);
  EXPECT_NE(result.intersecting.pairs,
            findSelfIntersections(noisy.points, result.mesh.triangles()));
}

TEST(MeshOptimization, RepairsEndAfterWorkProportionalToThePoints) {
  for (const Index n : {500, 1500}) {
    Case of = ellipsoid(n, 1.0, 1.0);
    of.points = randomCube(n, 31);  // nearly all triangles intersect others
    const MeshOptimization result = optimize(of);
    expectGuarantees(of, result);
    EXPECT_GT(result.report.recreated, 400U);
    // Twice, as on noise; a part of at most 96 vertices may begin below the limit.
    EXPECT_LE(result.report.recreated, 2 * (10000 + 10 * static_cast<std::size_t>(n) + 96));
    OptimizationOptions of_small_part;
    of_small_part.fraction = 0.01;
    EXPECT_LE(optimize(of, of_small_part).report.recreated,
              2 * (2000 + static_cast<std::size_t>(n) + 96));
  }
}

}  // namespace
}  // namespace spherical_param::test
