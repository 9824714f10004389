#include "embedding.h"

#include "embedding_starts.h"
#include "embeddings.h"
#include "iterative_embedding.h"
#include "neighbor_graph.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using test::bruteForceNeighbors;
using test::randomSphere;
using test::spiralSphere;

constexpr EdgeWeights kAllWeights[] = {EdgeWeights::Uniform, EdgeWeights::InverseLength,
                                       EdgeWeights::Adaptive};

Graph graphOf(const Positions& points, int k) {
  return test::graphOf(points, bruteForceNeighbors(points, k), test::nearest(k)).graph;
}

Embedding iterate(const Graph& graph, const Positions& start,
                  const EmbeddingOptions& options = {}) {
  return internal::embedIteratively(graph, start, options, {}, {});
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
    for (std::size_t i = 0; i < graph.size(); ++i) {
      const Eigen::Vector3d ui = u.col(static_cast<Index>(i));
      Eigen::Vector3d laplacian = Eigen::Vector3d::Zero();
      double sum = 0.0;
      for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
        const Eigen::Vector3d uj = u.col(graph.neighbors[e]);
        const double length = (p.col(static_cast<Index>(i)) - p.col(graph.neighbors[e])).norm();
        const double w = weights == EdgeWeights::Uniform         ? 1.0
                         : weights == EdgeWeights::InverseLength ? 1.0 / length
                                                                 : (ui - uj).norm() / length;
        laplacian += w * (uj - ui);
        sum += w;
      }
      laplacian /= sum;
      const Eigen::Vector3d tangential = laplacian - laplacian.dot(ui) * ui;
      residual += tangential.norm() / static_cast<double>(graph.size());
      next.col(static_cast<Index>(i)) = (ui + lambda * tangential).normalized();
    }
    states.emplace_back(u, residual);
    u = next;
  }
  return states;
}

TEST(SphereEmbedding, IsTheIterationOfFigure3) {
  const Positions points = test::dentedCloud(300).points;
  const Graph graph = graphOf(points, 8);
  for (const EdgeWeights weights : kAllWeights)
    for (const double lambda : {0.5, 0.2}) {
      const int steps = 25;
      const auto expected = figure3(graph, points, weights, lambda, steps);
      EmbeddingOptions options;
      options.weights = weights;
      options.damping = lambda;
      options.max_iterations = steps;
      options.tolerance = 0.0;
      const Embedding result = iterate(graph, points, options);
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
    }
}

TEST(SphereEmbedding, ConvergesToTheToleranceWhereTheCloudIsSymmetric) {
  // The centroid of a cloud that is symmetric to the origin stays there, so centring and
  // Laplacian do not work against each other.
  const Positions half = randomSphere(60, 3);
  Positions points = test::horizontally(half, -half);
  points.row(0) *= 1.5;
  EmbeddingOptions options;
  options.max_iterations = 20000;
  options.tolerance = 1e-10;
  const Graph graph = graphOf(points, 10);
  const Embedding result = iterate(graph, points, options);
  EXPECT_EQ(result.report.stop_reason, StopReason::Converged);
  EXPECT_LE(meanTangentialLaplacian(graph, result.directions, options.weights), 1.01e-10);
  EXPECT_LT(result.report.iterations, 20000);
}

TEST(SphereEmbedding, StagnationIsReported) {
  const Positions points = test::dentedCloud(200).points;
  EmbeddingOptions options;
  options.tolerance = 0.0;
  options.max_iterations = 1000000;
  options.stagnation_window = 50;
  const Embedding result = iterate(graphOf(points, 8), points, options);
  EXPECT_EQ(result.report.stop_reason, StopReason::Stagnated);
  const auto tail = result.report.residuals.end() - 50;
  EXPECT_LE(*std::max_element(tail, result.report.residuals.end()) -
                *std::min_element(tail, result.report.residuals.end()),
            1e-5 * *std::max_element(tail, result.report.residuals.end()));
}

/// A sphere of n points of radius 1 and one point far away: seen from the centroid, the sphere is
/// one place and the far point the opposite one. Centring spreads the one place over the
/// sphere again within a few steps.
Positions sphereWithOutlier(Index n) {
  return test::horizontally(spiralSphere(n), Eigen::Vector3d(1e6, 0.0, 0.0));
}

TEST(SphereEmbedding, CentringUndoesAPassingCollapse) {
  const Positions points = sphereWithOutlier(400);
  const Embedding result = iterate(graphOf(points, 10), points);
  EXPECT_NE(result.report.stop_reason, StopReason::Collapsed);
  EXPECT_LT(result.report.centroid_norm, 0.1);
}

TEST(SphereEmbedding, RankStartIsNeverCollapsed) {
  for (const Positions& points :
       {sphereWithOutlier(400), Positions(randomSphere(100, 1) * 1e-300),
        Positions(Positions::Constant(3, 50, 2.0)), test::dentedCloud(1000).points}) {
    const Positions directions = internal::projectByRank(points);
    EXPECT_LT((directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
    // All on one meridian: the mean radius is pi / 4.
    EXPECT_LT(directions.rowwise().mean().norm(), 0.8);
  }
}

TEST(SphereEmbedding, ProjectionGivesEveryPointADirection) {
  Positions points = test::horizontally(randomSphere(10, 1), -randomSphere(10, 1));
  points = test::horizontally(points, Positions::Zero(3, 1));  // the centroid itself
  for (const double scale : {1.0, 1e-300, 1e300}) {
    const Positions directions = internal::projectFromCentroid(points * scale);
    EXPECT_LT((directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
    EXPECT_LT((directions.leftCols(20) - points.leftCols(20)).cwiseAbs().maxCoeff(), 1e-14);
  }
}

}  // namespace
}  // namespace spherical_param
