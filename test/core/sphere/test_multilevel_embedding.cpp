#include "multilevel_embedding.h"

#include "embeddings.h"
#include "paper_method.h"

namespace spherical_param::test {
namespace {

double energyOf(const Graph& graph, const Embedding& embedding) {
  return EmbeddingEnergy(graph, 1).value(embedding.directions);
}

TEST(MultilevelEmbedding, SameMinimumWhateverTheStart) {
  const Cloud cloud = dentedCloud(3000);
  const Embedding one = solve(cloud.graph, converging(1e-12), 200, 1);
  for (const std::uint32_t seed : {2U, 3U, 4U}) {
    const Embedding other = solve(cloud.graph, converging(1e-12), 300, seed);
    EXPECT_NEAR(energyOf(cloud.graph, other), energyOf(cloud.graph, one),
                1e-9 * energyOf(cloud.graph, one));
    // Up to a rotation or reflection: the angles between nodes are the same.
    for (Eigen::Index i = 0; i + 7 < 3000; i += 7)
      EXPECT_NEAR(one.directions.col(i).dot(one.directions.col(i + 7)),
                  other.directions.col(i).dot(other.directions.col(i + 7)), 1e-6);
  }
}

TEST(MultilevelEmbedding, UnfoldsABentTubeThatTheIterationFolds) {
  const Mesh tube = bentTube(25.0, 4.0, 16);
  const Graph graph = graphOfMesh(tube.points, tube.triangles);
  const auto folded = [&](const Positions& directions) {
    return fractionBeyondTwoSteps(graph, triangulateSphere(directions));
  };
  EXPECT_GT(folded(internal::paper::embed(graph, tube.points, {}, 1e-8, {}).directions), 0.01);
  EXPECT_LT(folded(solve(graph).directions), 0.001);
  EXPECT_LT(folded(solve(graph, converging(1e-9)).directions), 0.001);
}

TEST(MultilevelEmbedding, TangentialLaplacianVanishesAndLevelsAreReported) {
  const Cloud cloud = dentedCloud(5000);
  const GraphHierarchy hierarchy = buildGraphHierarchy(cloud.graph, 1, 200);
  const Embedding result = embedByLevels(cloud.graph, hierarchy, converging(1e-12));
  EXPECT_TRUE(result.report.converged());
  EXPECT_LT(meanTangentialLaplacian(cloud.graph, result.directions, EdgeWeights::Adaptive), 1e-12);
  EXPECT_LT((result.directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
  EXPECT_NEAR(result.report.residuals.back(), result.report.residual, 1e-15);
  EXPECT_GT(result.report.residuals.front(), 1e-5);
  EXPECT_LT(fractionBeyondTwoSteps(cloud.graph, triangulateSphere(result.directions)), 1e-3);
  ASSERT_EQ(result.report.levels.size(), hierarchy.levels.size() + 1);
  for (std::size_t l = 0; l < result.report.levels.size(); ++l) {
    const LevelReport& level = result.report.levels[l];
    const Graph& graph = l == 0 ? cloud.graph : hierarchy.levels[l - 1].graph;
    EXPECT_EQ(level.nodes, graph.size());
    EXPECT_EQ(level.edges, graph.edgeCount());
    EXPECT_GT(level.newton_iterations, 0);
    // The start is solved to 0.003 of its edges, which are about 0.3 long.
    EXPECT_LT(level.residual, 1e-3);
  }
  EXPECT_EQ(result.report.start_level, hierarchy.levels.size());
  EXPECT_EQ(result.report.barrier, EmbeddingBarrier::None);
}

TEST(MultilevelEmbedding, GraphsOfAllSizes) {
  for (Index n = 4; n <= 40; ++n) {
    const Positions points = randomSphere(n, static_cast<std::uint64_t>(n));
    const Graph graph = graphOfMesh(points, triangulateSphere(points));
    const Embedding result = solve(graph, converging(1e-10), 4, 1);
    EXPECT_NE(result.report.stop_reason, StopReason::Unfinished) << n;
    if (result.report.stop_reason != StopReason::Collapsed) {
      ASSERT_EQ(result.directions.cols(), n);
      EXPECT_LT((result.directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14) << n;
    }
  }
}

TEST(MultilevelEmbedding, WhereNothingHoldsItABarrierDoes) {
  // A path: nothing holds its ends apart.
  constexpr Index n = 30;
  std::vector<std::pair<Index, Index>> path;
  for (Index i = 1; i < n; ++i)
    path.emplace_back(i - 1, i);
  const Embedding result = solve(unitGraph(n, path));
  EXPECT_EQ(result.report.barrier, EmbeddingBarrier::Everywhere);
  ASSERT_EQ(result.directions.cols(), n);
  EXPECT_LT(result.report.centroid_norm, 0.95);
}

/// The graph of a dented sphere without its first nodes, which are around the pole.
Graph openGraph(Index nodes, Index first) {
  const Graph graph = dentedCloud(nodes).graph;
  Graph open;
  for (const Index i : NumberRange(first, nodes)) {
    for (const std::size_t e : graph.entries(i))
      if (graph.neighbors[e] >= first) {
        open.neighbors.push_back(graph.neighbors[e] - first);
        open.lengths.push_back(graph.lengths[e]);
      }
    open.endRow();
  }
  return open;
}

TEST(MultilevelEmbedding, ABarrierThatHardlyPullsIsOnCoarseLevelsAlone) {
  // Too many nodes for the graph itself to be solved.
  const Embedding result = solve(openGraph(12500, 600));
  EXPECT_EQ(result.report.barrier, EmbeddingBarrier::CoarseLevels);
  EXPECT_LT(result.report.centroid_norm, 0.95);
}

TEST(MultilevelEmbedding, OpenSurfacesDoNotSlipOffTheSphere) {
  // The lower two thirds of a sphere: the boundary is a hole to pull the sphere through.
  const Graph open = openGraph(3000, 1000);
  for (const Setting& options : {Setting(), converging(1e-9)}) {
    const Embedding result = solve(open, options);
    ASSERT_EQ(result.directions.cols(), 2000);
    EXPECT_LT(result.report.centroid_norm, 0.95);
    EXPECT_LT(fractionBeyondTwoSteps(open, triangulateSphere(result.directions)), 0.1);
  }
}

}  // namespace
}  // namespace spherical_param::test
