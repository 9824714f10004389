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

TEST(GraphHierarchy, LevelsAreSeveralTimesSmallerConnectedAndSymmetric) {
  const Graph graph = sphereGraph(randomSphere(20000, 7));
  const GraphHierarchy hierarchy = buildGraphHierarchy(graph, 1, 100);
  ASSERT_GE(hierarchy.levels.size(), 3U);
  double finer = 20000.0;
  for (const HierarchyLevel& level : hierarchy.levels) {
    const auto nodes = static_cast<double>(level.graph.size());
    EXPECT_GT(finer / nodes, 3.0);
    EXPECT_LT(finer / nodes, 7.0);
    // Interpolation is by weighted means.
    EXPECT_EQ(level.prolongation.rows(), static_cast<Eigen::Index>(finer));
    EXPECT_GT(level.prolongation.coeffs().minCoeff(), 0.0);
    const Eigen::VectorXd sums =
        level.prolongation * Eigen::VectorXd::Ones(level.prolongation.cols());
    EXPECT_LT((sums.array() - 1.0).abs().maxCoeff(), 1e-12);
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
