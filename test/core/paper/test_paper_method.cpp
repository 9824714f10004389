#include "paper_method.h"

#include "core/graph/graph_helpers.h"
#include "core/sphere/embeddings.h"
#include "union_find.h"

#include <tuple>

namespace spherical_param::test {
namespace {

using internal::paper::nearestNeighborGraph;

/// Total length of the minimum spanning tree over the parts (J. B. Kruskal, 1956, on all pairs).
double shortestJoin(const Positions& points, UnionFind parts) {
  std::vector<std::tuple<double, Index, Index>> pairs;
  for (Index i = 0; i < points.cols(); ++i)
    for (Index j = 0; j < i; ++j)
      pairs.emplace_back((points.col(i) - points.col(j)).norm(), i, j);
  std::sort(pairs.begin(), pairs.end());
  double total = 0.0;
  for (const auto& [length, i, j] : pairs)
    total += parts.unite(i, j) ? length : 0.0;
  return total;
}

TEST(PaperGraph, JoinsEachPointToItsKNearestInLongUntidyLists) {
  const Positions points = randomSphere(300, 1);
  for (const int k : {3, 7}) {
    const NeighborLists lists = bruteForceNeighbors(points, k);
    Edges expected;
    for (Index i = 0; i < points.cols(); ++i)
      for (const Index j : rowOf(lists, i))
        expected.insert({std::pair(i, j), std::pair(j, i)});
    const NeighborGraph result =
        nearestNeighborGraph(points, untidy(bruteForceNeighbors(points, 20)), k);
    expectConnectedGraphOf(points, result);
    for (const Bridge& bridge : result.bridges)
      expected.insert({std::pair(bridge.from, bridge.to), std::pair(bridge.to, bridge.from)});
    EXPECT_EQ(edgesOf(result.graph), expected);
  }
}

TEST(PaperGraph, ComponentsAreJoinedByTheirMinimumSpanningTree) {
  Positions pieces(3, 0);
  UnionFind parts(180);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-40.0, 40.0);
  for (Index piece = 0; piece < 9; ++piece) {
    Positions part = randomSphere(20, static_cast<std::uint64_t>(piece));
    part.colwise() += Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
    pieces = horizontally(pieces, part);
    for (Index i = 1; i < 20; ++i)
      parts.unite(20 * piece, 20 * piece + i);
  }
  // Pieces, and points without lists, all of which tie.
  const Positions grid = cubeGrid(5);
  for (const int k : {6, 0}) {
    const Positions& points = k > 0 ? pieces : grid;
    const NeighborGraph result = nearestNeighborGraph(points, bruteForceNeighbors(points, k), 25);
    expectConnectedGraphOf(points, result);
    EXPECT_EQ(result.bridges.size(), k > 0 ? 8U : columnCount(grid) - 1);
    EXPECT_TRUE(k > 0 || result.graph.edgeCount() == result.bridges.size());
    double total = 0.0;
    for (const Bridge& bridge : result.bridges) {
      EXPECT_DOUBLE_EQ(bridge.length, (points.col(bridge.from) - points.col(bridge.to)).norm());
      total += bridge.length;
      EXPECT_EQ(edgesOf(result.graph).count({bridge.from, bridge.to}), 1U);
    }
    EXPECT_NEAR(total, shortestJoin(points, k > 0 ? parts : UnionFind(columnCount(grid))), 1e-9);
  }
}

Graph nearestGraph(const Positions& points, int k) {
  return nearestNeighborGraph(points, bruteForceNeighbors(points, k), k).graph;
}

Embedding embed(const Graph& graph, const Positions& points, const PaperOptions& options,
                double tolerance) {
  return internal::paper::embed(graph, points, options, tolerance, {});
}

/// Figure 3 of the paper, word by word, without regard for speed: returns the state and the mean
/// tangential Laplacian after each number of steps.
std::vector<std::pair<Positions, double>> figure3(const Graph& graph, const Positions& p,
                                                  EdgeWeights weights, double lambda, int steps) {
  std::vector<std::pair<Positions, double>> states;
  Positions u = p;
  for (int step = 0; step <= steps; ++step) {
    const Eigen::Vector3d mean = u.rowwise().mean();
    u.colwise() -= mean;
    u.colwise().normalize();
    Positions next = u;
    double residual = 0.0;
    for (const Index i : graph.nodes()) {
      const Eigen::Vector3d ui = u.col(i);
      Eigen::Vector3d laplacian = Eigen::Vector3d::Zero();
      double sum = 0.0;
      for (const Index j : graph.row(i)) {
        const Eigen::Vector3d uj = u.col(j);
        const double length = (p.col(i) - p.col(j)).norm();
        const double w = weights == EdgeWeights::Uniform         ? 1.0
                         : weights == EdgeWeights::InverseLength ? 1.0 / length
                                                                 : (ui - uj).norm() / length;
        laplacian += w * (uj - ui);
        sum += w;
      }
      laplacian /= sum;
      const Eigen::Vector3d tangential = laplacian - laplacian.dot(ui) * ui;
      residual += tangential.norm() / static_cast<double>(graph.size());
      next.col(i) = (ui + lambda * tangential).normalized();
    }
    states.emplace_back(u, residual);
    u = next;
  }
  return states;
}

TEST(PaperEmbedding, IsTheIterationOfFigure3) {
  const Positions points = dentedCloud(300).points;
  const Graph graph = nearestGraph(points, 8);
  for (const EdgeWeights weights :
       {EdgeWeights::Uniform, EdgeWeights::InverseLength, EdgeWeights::Adaptive})
    for (const double lambda : {0.5, 0.2}) {
      const int steps = 25;
      const auto expected = figure3(graph, points, weights, lambda, steps);
      const Embedding result = embed(graph, points, {25, weights, lambda, steps}, 0.0);
      EXPECT_EQ(result.report.stop_reason, StopReason::IterationLimit);
      EXPECT_EQ(result.report.iterations, steps);
      ASSERT_EQ(result.report.residuals.size(), static_cast<std::size_t>(steps) + 1);
      // Rounding of 25 steps of a contracting iteration.
      for (std::size_t step = 0; step <= 25; ++step)
        EXPECT_NEAR(result.report.residuals[step], expected[step].second, 1e-13);
      EXPECT_LT((result.directions - expected.back().first).cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_EQ(result.report.residual, result.report.residuals.back());
      EXPECT_LT((result.directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 4e-15);
      EXPECT_NEAR(result.report.residual,
                  meanTangentialLaplacian(graph, result.directions, weights), 1e-14);
      const double tolerance = result.report.residuals[10];
      const Embedding early = embed(graph, points, {25, weights, lambda, steps}, tolerance);
      EXPECT_EQ(early.report.stop_reason, StopReason::Converged);
      EXPECT_LE(early.report.iterations, 10);
      EXPECT_LE(early.report.residual, tolerance);
    }
}

}  // namespace
}  // namespace spherical_param::test
