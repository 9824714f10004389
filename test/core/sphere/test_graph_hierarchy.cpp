#include "graph_hierarchy.h"

#include "graphs.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::test {
namespace {

Graph sphereGraph(const Positions& points) {
  return graphOfMesh(points, triangulateSphere(points));
}

/// Shortest paths from one node, by relaxing all edges until nothing changes.
Indexed<double> distancesFrom(const Graph& graph, Index source) {
  Indexed<double> distances(graph.size(), std::numeric_limits<double>::infinity());
  distances[source] = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (const Index i : graph.nodes())
      for (const std::size_t e : graph.entries(i)) {
        const double through = distances[i] + graph.lengths[e];
        double& distance = distances[graph.neighbors[e]];
        changed = changed || through < distance;
        distance = std::min(distance, through);
      }
  }
  return distances;
}

/// A maximal independent set: in the order of a key of the lengths of their edges, each node that
/// is joined to none before it.
std::vector<Index> seedsTakenOneAfterTheOther(const Graph& graph) {
  std::vector<std::pair<double, Index>> order;
  const double sum = std::accumulate(graph.lengths.begin(), graph.lengths.end(), 0.0);
  for (const Index i : graph.nodes()) {
    const Row<double> lengths = graph.lengthsOf(i);
    const double own = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    const double turn = 2.0 * static_cast<double>(graph.size()) / sum * own + 0.6180339887498949;
    order.emplace_back(turn - std::floor(turn), i);
  }
  std::sort(order.begin(), order.end());
  std::vector<Index> taken;
  for (const auto& [key, i] : order)
    if (std::none_of(taken.begin(), taken.end(),
                     [&, node = i](Index other) { return graph.row(node).contains(other); }))
      taken.push_back(i);
  std::sort(taken.begin(), taken.end());
  return taken;
}

TEST(GraphHierarchy, ALevelHasTheGeodesicVoronoiCellsOfItsSeeds) {
  const Graph fine = sphereGraph(randomSphere(600, 5));
  const GraphHierarchy hierarchy = buildGraphHierarchy(fine, 1, 300);
  ASSERT_EQ(hierarchy.levels.size(), 1U);
  const HierarchyLevel& level = hierarchy.levels[0];
  Indexed<Index> cell(fine.size(), 0);  // of each node, by the number of its seed
  Indexed<double> from_seed(fine.size(), std::numeric_limits<double>::infinity());
  Index seeds = 0;
  for (const Index seed : seedsTakenOneAfterTheOther(fine)) {
    const Indexed<double> distances = distancesFrom(fine, seed);
    for (const Index i : fine.nodes())
      if (distances[i] < from_seed[i]) {
        from_seed[i] = distances[i];
        cell[i] = seeds;
      }
    ++seeds;
  }
  ASSERT_EQ(static_cast<Index>(level.graph.size()), seeds);
  const auto shorten = [](auto& lengths, const auto& key, double length) {
    const auto place = lengths.try_emplace(key, length).first;
    place->second = std::min(place->second, length);
  };
  std::map<std::pair<Index, Index>, double> edges;  // the shortest paths through touching edges
  for (const Index i : fine.nodes()) {
    const Index own = cell[i];
    std::map<Index, double> paths{{own, from_seed[i]}};  // to seeds, by the first edge
    for (const std::size_t e : fine.entries(i)) {
      const Index j = fine.neighbors[e];
      const double length = fine.lengths[e] + from_seed[j];
      shorten(paths, cell[j], length);
      if (cell[j] != own)
        shorten(edges, std::pair(own, cell[j]), from_seed[i] + length);
    }
    // Interpolation goes by inverse distance, and is exact at seeds.
    if (from_seed[i] == 0.0)
      paths = {{own, 1.0}};
    EXPECT_EQ(static_cast<std::size_t>(level.prolongation.row(i).nonZeros()), paths.size());
    double sum = 0.0;
    for (const auto& [aggregate, length] : paths)
      sum += 1.0 / length;
    for (const auto& [aggregate, length] : paths)
      EXPECT_NEAR(level.prolongation.coeff(i, aggregate), 1.0 / length / sum, 1e-12);
  }
  ASSERT_EQ(level.graph.neighbors.size(), edges.size());
  for (const Index a : level.graph.nodes())
    for (const std::size_t e : level.graph.entries(a))
      EXPECT_NEAR(level.graph.lengths[e], edges.at({a, level.graph.neighbors[e]}), 1e-14);
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
    for (const Index i : level.graph.nodes())
      for (const Index j : level.graph.row(i))
        EXPECT_TRUE(level.graph.row(j).contains(i));
  }
  EXPECT_LE(finer, 100.0);
}

TEST(GraphHierarchy, NeverFewerThanFourNodes) {
  EXPECT_TRUE(buildGraphHierarchy(Graph(), 1, 4).levels.empty());
  // A complete graph: any seed covers all others.
  std::vector<std::pair<Index, Index>> edges;
  for (Index i = 0; i < 12; ++i)
    for (Index j = 0; j < i; ++j)
      edges.emplace_back(i, j);
  EXPECT_TRUE(buildGraphHierarchy(unitGraph(12, edges), 1, 4).levels.empty());
}

}  // namespace
}  // namespace spherical_param::test
