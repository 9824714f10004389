#include "graph_hierarchy.h"

#include "graphs.h"
#include "helpers.h"
#include "sphere_triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::buildGraphHierarchy;
using internal::GraphHierarchy;
using internal::HierarchyLevel;
using test::graphOfMesh;
using test::randomSphere;

Graph sphereGraph(const Positions& points) {
  return graphOfMesh(points, triangulateSphere(points));
}

/// Shortest paths from one node, by relaxing all edges until nothing changes.
std::vector<double> distancesFrom(const Graph& graph, Index source) {
  std::vector<double> distances(graph.size(), std::numeric_limits<double>::infinity());
  distances[static_cast<std::size_t>(source)] = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < graph.size(); ++i)
      for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
        const auto j = static_cast<std::size_t>(graph.neighbors[e]);
        if (distances[i] + graph.lengths[e] < distances[j]) {
          distances[j] = distances[i] + graph.lengths[e];
          changed = true;
        }
      }
  }
  return distances;
}

bool areJoined(const Graph& graph, std::size_t i, std::size_t j) {
  for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
    if (static_cast<std::size_t>(graph.neighbors[e]) == j)
      return true;
  return false;
}

/// One level over a random sphere.
class GraphHierarchyOneLevel : public testing::Test {
protected:
  const Graph fine_ = sphereGraph(randomSphere(600, 5));
  const GraphHierarchy hierarchy_ = buildGraphHierarchy(fine_, 1, 300);
  const HierarchyLevel& level_ = hierarchy_.levels.at(0);
};

TEST_F(GraphHierarchyOneLevel, SeedsAreAMaximalIndependentSet) {
  ASSERT_EQ(hierarchy_.levels.size(), 1U);
  std::vector<bool> is_seed(fine_.size(), false);
  for (const Index seed : level_.seeds)
    is_seed[static_cast<std::size_t>(seed)] = true;
  for (std::size_t i = 0; i < fine_.size(); ++i) {
    int around = 0;
    for (std::size_t e = fine_.offsets[i]; e < fine_.offsets[i + 1]; ++e)
      around += is_seed[static_cast<std::size_t>(fine_.neighbors[e])] ? 1 : 0;
    if (is_seed[i])
      EXPECT_EQ(around, 0) << "node " << i;
    else
      EXPECT_GT(around, 0) << "node " << i;
  }
}

TEST_F(GraphHierarchyOneLevel, SeedsAreThoseTakenOneAfterTheOther) {
  const std::size_t n = fine_.size();
  std::vector<std::pair<double, std::size_t>> order(n);
  const double sum = std::accumulate(fine_.lengths.begin(), fine_.lengths.end(), 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    double own = 0.0;
    for (std::size_t e = fine_.offsets[i]; e < fine_.offsets[i + 1]; ++e)
      own += fine_.lengths[e];
    const double turn = 2.0 * static_cast<double>(n) / sum * own + 0.6180339887498949;
    order[i] = {turn - std::floor(turn), i};
  }
  std::sort(order.begin(), order.end());
  std::vector<Index> taken;
  for (const auto& [key, i] : order)
    if (std::none_of(taken.begin(), taken.end(), [&, node = i](Index other) {
          return areJoined(fine_, node, static_cast<std::size_t>(other));
        }))
      taken.push_back(static_cast<Index>(i));
  std::sort(taken.begin(), taken.end());
  EXPECT_EQ(level_.seeds, taken);
}

TEST_F(GraphHierarchyOneLevel, AggregatesAreGeodesicVoronoiCells) {
  std::vector<std::vector<double>> distances;
  for (const Index seed : level_.seeds)
    distances.push_back(distancesFrom(fine_, seed));
  for (std::size_t i = 0; i < fine_.size(); ++i) {
    const double own = distances[static_cast<std::size_t>(level_.aggregate_of[i])][i];
    for (const std::vector<double>& other : distances)
      EXPECT_LE(own, other[i] * (1.0 + 1e-14)) << "node " << i;
  }
}

TEST_F(GraphHierarchyOneLevel, EdgesAreShortestPathsThroughTouchingEdges) {
  std::vector<std::vector<double>> distances;
  for (const Index seed : level_.seeds)
    distances.push_back(distancesFrom(fine_, seed));
  std::map<std::pair<Index, Index>, double> expected;
  for (std::size_t i = 0; i < fine_.size(); ++i)
    for (std::size_t e = fine_.offsets[i]; e < fine_.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(fine_.neighbors[e]);
      const Index a = level_.aggregate_of[i];
      const Index b = level_.aggregate_of[j];
      if (a == b)
        continue;
      const double length = distances[static_cast<std::size_t>(a)][i] + fine_.lengths[e] +
                            distances[static_cast<std::size_t>(b)][j];
      const auto [place, is_new] = expected.try_emplace({a, b}, length);
      if (!is_new)
        place->second = std::min(place->second, length);
    }
  ASSERT_EQ(level_.graph.neighbors.size(), expected.size());
  auto next = expected.begin();
  for (std::size_t a = 0; a < level_.graph.size(); ++a)
    for (std::size_t e = level_.graph.offsets[a]; e < level_.graph.offsets[a + 1]; ++e, ++next) {
      EXPECT_EQ(next->first, std::pair(static_cast<Index>(a), level_.graph.neighbors[e]));
      EXPECT_NEAR(level_.graph.lengths[e], next->second, 1e-14);
    }
}

TEST_F(GraphHierarchyOneLevel, InterpolationIsExactForConstantsAndAtSeeds) {
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(level_.prolongation.cols());
  const Eigen::VectorXd sums = level_.prolongation * ones;
  EXPECT_LT((sums.array() - 1.0).abs().maxCoeff(), 1e-14);
  for (std::size_t s = 0; s < level_.seeds.size(); ++s) {
    EXPECT_EQ(level_.prolongation.row(level_.seeds[s]).nonZeros(), 1);
    EXPECT_EQ(level_.prolongation.coeff(level_.seeds[s], static_cast<Index>(s)), 1.0);
  }
}

TEST_F(GraphHierarchyOneLevel, InterpolationGoesByInverseDistance) {
  for (std::size_t i = 0; i < fine_.size(); ++i) {
    // Paths to the seeds of the own and the neighbours' aggregates, by the first edge.
    std::map<Index, double> paths;
    const auto offer = [&](Index aggregate, double length) {
      const auto [place, is_new] = paths.try_emplace(aggregate, length);
      if (!is_new)
        place->second = std::min(place->second, length);
    };
    const auto to_own_seed = [&](std::size_t node) {
      const Index seed = level_.seeds[static_cast<std::size_t>(level_.aggregate_of[node])];
      return distancesFrom(fine_, seed)[node];
    };
    if (i % 20 != 0)
      continue;  // the oracle is slow
    const double own = to_own_seed(i);
    if (own == 0.0)
      continue;
    offer(level_.aggregate_of[i], own);
    for (std::size_t e = fine_.offsets[i]; e < fine_.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(fine_.neighbors[e]);
      offer(level_.aggregate_of[j], to_own_seed(j) + fine_.lengths[e]);
    }
    double sum = 0.0;
    for (const auto& [aggregate, length] : paths)
      sum += 1.0 / length;
    EXPECT_EQ(
        static_cast<std::size_t>(level_.prolongation.row(static_cast<Eigen::Index>(i)).nonZeros()),
        paths.size());
    for (const auto& [aggregate, length] : paths)
      EXPECT_NEAR(level_.prolongation.coeff(static_cast<Index>(i), aggregate), 1.0 / length / sum,
                  1e-12);
  }
}

TEST(GraphHierarchy, LevelsAreSeveralTimesSmallerConnectedAndSymmetric) {
  const Graph graph = sphereGraph(randomSphere(20000, 7));
  const GraphHierarchy hierarchy = buildGraphHierarchy(graph, 1, 100);
  ASSERT_GE(hierarchy.levels.size(), 3U);
  double finer = 20000.0;
  for (const HierarchyLevel& level : hierarchy.levels) {
    const auto nodes = static_cast<double>(level.graph.size());
    EXPECT_GT(finer / nodes, 3.0);
    EXPECT_LT(finer / nodes, 7.0);
    finer = nodes;
    for (const double distance : distancesFrom(level.graph, 0))
      EXPECT_TRUE(std::isfinite(distance));
    for (std::size_t i = 0; i < level.graph.size(); ++i)
      for (std::size_t e = level.graph.offsets[i]; e < level.graph.offsets[i + 1]; ++e)
        EXPECT_TRUE(areJoined(level.graph, static_cast<std::size_t>(level.graph.neighbors[e]), i));
  }
  EXPECT_LE(finer, 100.0);
}

TEST(GraphHierarchy, NeverFewerThanFourNodes) {
  EXPECT_TRUE(buildGraphHierarchy(Graph(), 1).levels.empty());
  // A complete graph: any seed covers all others.
  Graph graph;
  constexpr Index n = 12;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j)
      if (j != i) {
        graph.neighbors.push_back(j);
        graph.lengths.push_back(1.0);
      }
    graph.offsets.push_back(graph.neighbors.size());
  }
  EXPECT_TRUE(buildGraphHierarchy(graph, 1, 4).levels.empty());
}

}  // namespace
}  // namespace spherical_param
