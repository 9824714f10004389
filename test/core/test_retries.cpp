#include "retries.h"

#include "reconstructions.h"
#include "spherical_param/option_table.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::BestOfRuns;
using internal::Candidate;
using internal::planOf;

std::set<std::string> changedOptions(const Options& options, const Options& from) {
  std::set<std::string> names;
  for (const OptionRow& row : optionTable())
    if (row.get(options) != row.get(from))
      names.insert(row.name);
  return names;
}

TEST(Retries, DifferInOneThingEach) {
  using Names = std::set<std::string>;
  const std::vector<Names> changes{
      {}, {}, {"graph", "k"}, {"seed"}, {"embedding", "max_iterations"}, {"seed"}, {"seed"}};
  Options options;
  options.embedding.exponent = 3.0;
  std::set<std::string> descriptions;
  std::set<std::uint32_t> seeds;
  for (int run = 0; run < 7; ++run) {
    SCOPED_TRACE(run);
    const internal::Plan plan = planOf(run, options);
    EXPECT_EQ(changedOptions(plan.options, options), changes[static_cast<std::size_t>(run)]);
    EXPECT_EQ(plan.options.graph.agreement == StarAgreement::Either, run == 1);
    EXPECT_TRUE(descriptions.insert(plan.description).second) << plan.description;
    seeds.insert(plan.options.seed);
  }
  EXPECT_EQ(seeds.size(), 4U);
  EXPECT_EQ(planOf(0, options).description, "as asked");
  EXPECT_EQ(planOf(2, options).description, "8 nearest neighbours");
  EXPECT_EQ(planOf(2, options).options.graph.k, 8);
  EXPECT_EQ(planOf(4, options).options.embedding.max_iterations, 0);
  EXPECT_EQ(planOf(1, test::paper()).description, "seed 2");
  EXPECT_EQ(planOf(2, test::paper()).description, "radial start");
  // The iteration knows no other exponent.
  options.embedding.exponent = 4.0;
  EXPECT_NO_THROW(checkOptions(planOf(4, options).options));
  EXPECT_TRUE(planOf(0, options).options.optimization.finish_on_points);
  options.smoothing.steps = 1;
  EXPECT_FALSE(planOf(0, options).options.optimization.finish_on_points);
}

Candidate candidate(std::size_t intersections, double energy) {
  Candidate mesh;
  mesh.optimization.self_intersections.resize(intersections);
  mesh.optimization.report.energy = energy;
  mesh.graph.report.edges = static_cast<std::size_t>(energy);
  return mesh;
}

TEST(Retries, BestRunHasTheFewestIntersectionsThenTheLeastEnergy) {
  BestOfRuns best;
  const std::vector<std::pair<std::size_t, double>> meshes{{5, 1}, {7, 0}, {3, 9}, {3, 8}, {3, 8}};
  const std::vector<std::size_t> chosen{0, 0, 2, 3, 3};
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    best.add("run", candidate(meshes[i].first, meshes[i].second), 1.0);
    ASSERT_EQ(best.runs.size(), i + 1);
    EXPECT_EQ(best.runs[i].self_intersections, meshes[i].first);
    EXPECT_EQ(best.runs[i].energy, meshes[i].second);
    for (std::size_t j = 0; j <= i; ++j)
      EXPECT_EQ(best.runs[j].chosen, j == chosen[i]) << i << " " << j;
    EXPECT_EQ(best.mesh.optimization.report.energy, meshes[chosen[i]].second);
    // The cloud is judged by the first graph.
    EXPECT_EQ(best.graph().report.edges, 1U);
  }
}

TEST(Retries, MeshIsGoodWithoutIntersectionsOrIfOnlyNoiseMakesThem) {
  EXPECT_TRUE(candidate(0, 1).isGood());
  Candidate mesh = candidate(1, 1);
  EXPECT_FALSE(mesh.isGood());
  mesh.optimization.report.noise_steps = 3;
  EXPECT_TRUE(mesh.isGood());
  mesh.optimization.report.smoothed_self_intersections = 1;
  EXPECT_FALSE(mesh.isGood());
  // On smoothed points, their own intersections count alone.
  mesh.smoothed.points.resize(3, 1);
  EXPECT_TRUE(mesh.isGood());
  mesh.optimization.report.smoothed_self_intersections = 0;
  mesh.smoothed.report.self_intersections = 1;
  EXPECT_FALSE(mesh.isGood());
}

TEST(Retries, AreWorthItForASurfaceOrFewIntersections) {
  const Positions points = test::spiralSphere(600);
  Candidate mesh;
  mesh.graph.graph = buildNeighborGraph(points, test::bruteForceNeighbors(points, 12)).graph;
  mesh.optimization.triangles = triangulateSphere(points).triangles;
  const auto is_worth = [&](std::size_t intersections, const Options& options = {}) {
    mesh.optimization.self_intersections.resize(intersections);
    return internal::isWorthRetrying(points, mesh, internal::OpenSurface(), options);
  };
  EXPECT_FALSE(is_worth(0));
  EXPECT_TRUE(is_worth(100));
  Options none;
  none.retries = 0;
  EXPECT_FALSE(is_worth(1, none));
  EXPECT_FALSE(is_worth(1, test::quick()));
  // No surface: the points of the mesh are not those of the graph.
  mesh.optimization.triangles =
      mesh.optimization.triangles.unaryExpr([](Index i) { return static_cast<Index>(i * 7 % 600); })
          .eval();
  EXPECT_TRUE(is_worth(1));  // of 1196 triangles
  EXPECT_FALSE(is_worth(2));
}

TEST(Retries, AreMadeUntilNoTrianglesIntersectAndTheBestCounts) {
  int retried = 0;
  for (const unsigned seed : {1U, 3U}) {
    // A cluster far below the distance of the points is hard to mesh: which one is, goes by its
    // last digits, and so by the compiler.
    Positions cluster = 1e-8 * test::randomSphere(12, seed);
    cluster.row(2).array() += 1.0;
    const Positions points = test::horizontally(test::spiralSphere(400), cluster);
    for (const int retries : {0, 2}) {
      Options options;
      options.retries = retries;
      const Result result = test::mesh(points, options);
      test::expectGuarantees(points, result);
      EXPECT_EQ(result.runs.size() > 1U, retries > 0 && result.runs.front().self_intersections > 0);
      EXPECT_LE(result.runs.size(), static_cast<std::size_t>(retries) + 1);
      for (const RunReport& run : result.runs)
        EXPECT_TRUE(&run == &result.runs.back() || run.self_intersections > 0);
      EXPECT_TRUE(retries == 0 || result.runs.back().self_intersections == 0);
      EXPECT_TRUE(result.runs.back().chosen);
      EXPECT_EQ(result.optimization.energy, result.runs.back().energy);
      retried += result.runs.size() > 1U ? 1 : 0;
    }
  }
  EXPECT_GT(retried, 0) << "nothing was shown: take other clusters";
}

TEST(Retries, AreNotMadeWhereTheCloudIsNoClosedSurface) {
  const Positions points = test::withNoise(test::twoSpheres(40, 40, 6.0), 0.4, 1);
  const Result result = test::mesh(points);
  test::expectGuarantees(points, result);
  EXPECT_FALSE(result.self_intersections.empty());
  EXPECT_EQ(result.runs.size(), 1U);
}

}  // namespace
}  // namespace spherical_param
