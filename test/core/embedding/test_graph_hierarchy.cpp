#include "graph_hierarchy.h"

#include "graphs.h"
#include "helpers.h"
#include "spherical_param/sphere_triangulation.h"

#include <gtest/gtest.h>

#include <limits>

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

bool areJoined(const Graph& graph, Index i, Index j) {
  const std::vector<Index> row = test::rowOf(graph, i);
  return std::binary_search(row.begin(), row.end(), j);
}

/// One level over a random sphere.
class GraphHierarchyOneLevel : public testing::Test {
protected:
  const Graph fine_ = sphereGraph(randomSphere(600, 5));
  const GraphHierarchy hierarchy_ = buildGraphHierarchy(fine_, 1, 300);
  const HierarchyLevel& level_ = hierarchy_.levels.at(0);
  std::vector<std::vector<double>> distances_;  ///< those of all nodes from each seed

  GraphHierarchyOneLevel() {
    for (const Index seed : level_.seeds)
      distances_.push_back(distancesFrom(fine_, seed));
  }
  /// Of a node from the seed of its aggregate.
  double distanceFromSeed(std::size_t node) const {
    return distances_[static_cast<std::size_t>(level_.aggregate_of[node])][node];
  }
};

// Which makes them a maximal independent set.
TEST_F(GraphHierarchyOneLevel, SeedsAreThoseTakenOneAfterTheOther) {
  ASSERT_EQ(hierarchy_.levels.size(), 1U);
  const std::size_t n = fine_.size();
  std::vector<std::pair<double, Index>> order(n);
  const double sum = std::accumulate(fine_.lengths.begin(), fine_.lengths.end(), 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    double own = 0.0;
    for (std::size_t e = fine_.offsets[i]; e < fine_.offsets[i + 1]; ++e)
      own += fine_.lengths[e];
    const double turn = 2.0 * static_cast<double>(n) / sum * own + 0.6180339887498949;
    order[i] = {turn - std::floor(turn), static_cast<Index>(i)};
  }
  std::sort(order.begin(), order.end());
  std::vector<Index> taken;
  for (const auto& [key, i] : order)
    if (std::none_of(taken.begin(), taken.end(),
                     [&, node = i](Index other) { return areJoined(fine_, node, other); }))
      taken.push_back(i);
  std::sort(taken.begin(), taken.end());
  EXPECT_EQ(level_.seeds, taken);
}

TEST_F(GraphHierarchyOneLevel, AggregatesAreGeodesicVoronoiCells) {
  for (std::size_t i = 0; i < fine_.size(); ++i) {
    for (const std::vector<double>& other : distances_)
      EXPECT_LE(distanceFromSeed(i), other[i] * (1.0 + 1e-14)) << "node " << i;
  }
}

TEST_F(GraphHierarchyOneLevel, EdgesAreShortestPathsThroughTouchingEdges) {
  std::map<std::pair<Index, Index>, double> expected;
  for (std::size_t i = 0; i < fine_.size(); ++i)
    for (std::size_t e = fine_.offsets[i]; e < fine_.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(fine_.neighbors[e]);
      const Index a = level_.aggregate_of[i];
      const Index b = level_.aggregate_of[j];
      if (a == b)
        continue;
      const double length = distanceFromSeed(i) + fine_.lengths[e] + distanceFromSeed(j);
      const auto [place, is_new] = expected.try_emplace({a, b}, length);
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

TEST_F(GraphHierarchyOneLevel, InterpolationGoesByInverseDistanceAndIsExactAtSeeds) {
  const auto& weights = level_.prolongation;
  for (std::size_t i = 0; i < fine_.size(); ++i) {
    const auto node = static_cast<Index>(i);
    if (distanceFromSeed(i) == 0.0) {
      EXPECT_EQ(weights.row(node).nonZeros(), 1);
      EXPECT_EQ(weights.coeff(node, level_.aggregate_of[i]), 1.0);
      continue;
    }
    // Paths to the seeds of the own and the neighbours' aggregates, by the first edge.
    std::map<Index, double> paths{{level_.aggregate_of[i], distanceFromSeed(i)}};
    for (std::size_t e = fine_.offsets[i]; e < fine_.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(fine_.neighbors[e]);
      const double length = distanceFromSeed(j) + fine_.lengths[e];
      const auto [place, is_new] = paths.try_emplace(level_.aggregate_of[j], length);
      place->second = std::min(place->second, length);
    }
    EXPECT_EQ(static_cast<std::size_t>(weights.row(node).nonZeros()), paths.size());
    EXPECT_NEAR(weights.row(node).sum(), 1.0, 1e-14);
    double sum = 0.0;
    for (const auto& [aggregate, length] : paths)
      sum += 1.0 / length;
    for (const auto& [aggregate, length] : paths)
      EXPECT_NEAR(weights.coeff(node, aggregate), 1.0 / length / sum, 1e-12);
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
    for (Index i = 0; i < static_cast<Index>(level.graph.size()); ++i)
      for (const Index j : test::rowOf(level.graph, i))
        EXPECT_TRUE(areJoined(level.graph, j, i));
  }
  EXPECT_LE(finer, 100.0);
}

TEST(GraphHierarchy, NeverFewerThanFourNodes) {
  EXPECT_TRUE(buildGraphHierarchy(Graph(), 1).levels.empty());
  // A complete graph: any seed covers all others.
  std::vector<std::pair<Index, Index>> edges;
  for (Index i = 0; i < 12; ++i)
    for (Index j = 0; j < i; ++j)
      edges.emplace_back(i, j);
  EXPECT_TRUE(buildGraphHierarchy(test::unitGraph(12, edges), 1, 4).levels.empty());
}

}  // namespace
}  // namespace spherical_param
