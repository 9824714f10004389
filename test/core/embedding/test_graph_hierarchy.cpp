#include "graph_hierarchy.h"

#include "graphs.h"
#include "spherical_param/sphere_triangulation.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

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
  const std::vector<Index> row = rowOf(graph, i);
  return std::binary_search(row.begin(), row.end(), j);
}

/// A maximal independent set: in the order of a key of the lengths of their edges, each node that
/// is joined to none before it.
std::vector<Index> seedsTakenOneAfterTheOther(const Graph& graph) {
  std::vector<std::pair<double, Index>> order;
  const double sum = std::accumulate(graph.lengths.begin(), graph.lengths.end(), 0.0);
  for (std::size_t i = 0; i < graph.size(); ++i) {
    double own = 0.0;
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      own += graph.lengths[e];
    const double turn = 2.0 * static_cast<double>(graph.size()) / sum * own + 0.6180339887498949;
    order.emplace_back(turn - std::floor(turn), static_cast<Index>(i));
  }
  std::sort(order.begin(), order.end());
  std::vector<Index> taken;
  for (const auto& [key, i] : order)
    if (std::none_of(taken.begin(), taken.end(),
                     [&, node = i](Index other) { return areJoined(graph, node, other); }))
      taken.push_back(i);
  std::sort(taken.begin(), taken.end());
  return taken;
}

TEST(GraphHierarchy, ALevelHasTheGeodesicVoronoiCellsOfItsSeeds) {
  const Graph fine = sphereGraph(randomSphere(600, 5));
  const GraphHierarchy hierarchy = buildGraphHierarchy(fine, 1, 300);
  ASSERT_EQ(hierarchy.levels.size(), 1U);
  const HierarchyLevel& level = hierarchy.levels[0];
  EXPECT_EQ(level.seeds, seedsTakenOneAfterTheOther(fine));
  std::vector<std::vector<double>> distances;
  for (const Index seed : level.seeds)
    distances.push_back(distancesFrom(fine, seed));
  const auto from_seed = [&](std::size_t node) {
    return distances[static_cast<std::size_t>(level.aggregate_of[node])][node];
  };
  const auto shorten = [](auto& lengths, const auto& key, double length) {
    const auto place = lengths.try_emplace(key, length).first;
    place->second = std::min(place->second, length);
  };
  std::map<std::pair<Index, Index>, double> edges;  // the shortest paths through touching edges
  for (std::size_t i = 0; i < fine.size(); ++i) {
    for (const std::vector<double>& other : distances)
      EXPECT_LE(from_seed(i), other[i] * (1.0 + 1e-14)) << "node " << i;
    const Index own = level.aggregate_of[i];
    std::map<Index, double> paths{{own, from_seed(i)}};  // to seeds, by the first edge
    for (std::size_t e = fine.offsets[i]; e < fine.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(fine.neighbors[e]);
      const double length = fine.lengths[e] + from_seed(j);
      shorten(paths, level.aggregate_of[j], length);
      if (level.aggregate_of[j] != own)
        shorten(edges, std::pair(own, level.aggregate_of[j]), from_seed(i) + length);
    }
    // Interpolation goes by inverse distance, and is exact at seeds.
    if (from_seed(i) == 0.0)
      paths = {{own, 1.0}};
    const auto node = static_cast<Index>(i);
    EXPECT_EQ(static_cast<std::size_t>(level.prolongation.row(node).nonZeros()), paths.size());
    double sum = 0.0;
    for (const auto& [aggregate, length] : paths)
      sum += 1.0 / length;
    for (const auto& [aggregate, length] : paths)
      EXPECT_NEAR(level.prolongation.coeff(node, aggregate), 1.0 / length / sum, 1e-12);
  }
  ASSERT_EQ(level.graph.neighbors.size(), edges.size());
  for (std::size_t a = 0; a < level.graph.size(); ++a)
    for (std::size_t e = level.graph.offsets[a]; e < level.graph.offsets[a + 1]; ++e)
      EXPECT_NEAR(level.graph.lengths[e],
                  edges.at({static_cast<Index>(a), level.graph.neighbors[e]}), 1e-14);
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
      for (const Index j : rowOf(level.graph, i))
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
  EXPECT_TRUE(buildGraphHierarchy(unitGraph(12, edges), 1, 4).levels.empty());
}

}  // namespace
}  // namespace spherical_param::test
