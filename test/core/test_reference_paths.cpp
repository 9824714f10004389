// The fast paths against the plain ones of test/reference, where no other test compares them.

#include "graph_hierarchy.h"
#include "helpers.h"
#include "mesh_optimizer.h"
#include "reference/edge_flips.h"
#include "reference/graph_coarsening.h"
#include "reference/self_intersection.h"
#include "neighbor_graph.h"
#include "spherical_param/self_intersection.h"
#include "sphere_triangulation.h"

#include <gtest/gtest.h>

#include <random>

namespace spherical_param {
namespace {

Graph graphOf(const Positions& points) {
  return test::graphOf(points, test::bruteForceNeighbors(points, 12)).graph;
}

TEST(ReferencePaths, CoarseningIsThatOfDijkstrasAlgorithm) {
  for (const Positions& points : {test::randomSphere(1000, 1), test::cubeGrid(10)}) {  // with ties
    const Graph graph = graphOf(points);
    for (const std::uint32_t seed : {1U, 7U}) {
      const auto level =
          internal::buildGraphHierarchy(graph, seed, static_cast<Index>(graph.size()) - 1)
              .levels.at(0);
      const internal::HierarchyLevel expected = reference::coarsen(graph, seed);
      EXPECT_EQ(level.seeds, expected.seeds);
      EXPECT_EQ(level.aggregate_of, expected.aggregate_of);
      EXPECT_EQ(level.graph.offsets, expected.graph.offsets);
      EXPECT_EQ(level.graph.neighbors, expected.graph.neighbors);
      EXPECT_EQ(level.graph.lengths, expected.graph.lengths);
      EXPECT_EQ((level.prolongation - expected.prolongation).norm(), 0.0);
    }
  }
}

TEST(ReferencePaths, FlipsAreThoseOfASortedSetOfGains) {
  for (const double noise : {0.0, 0.02}) {
    Positions points = test::withNoise(test::randomSphere(1000, 2), noise, 3);
    points.row(0) *= 3.0;  // the triangulation of the sphere is not that of the surface
    const Graph graph = graphOf(points);
    const Triangles triangles = triangulateSphere(points.colwise().normalized());
    internal::MeshOptimizer optimizer(points, triangles, graph, 1);
    optimizer.setEnergy({});
    EXPECT_GT(optimizer.flipAll(), 100U);
    EXPECT_EQ(optimizer.mesh().triangles(), reference::flipAll(points, triangles, graph));
  }
}

TEST(ReferencePaths, SelfIntersectionsAreThoseOfASweep) {
  const test::Tube tube = test::bentTube(20.0, 2.2 * test::kPi, 24);  // into itself
  const auto expected = reference::findSelfIntersections(tube.points, tube.triangles);
  EXPECT_GT(expected.size(), 100U);
  EXPECT_EQ(findSelfIntersections(tube.points, tube.triangles), expected);
  // Flat triangles, many of which share vertices, lie in one plane or touch.
  const Positions grid = test::cubeGrid(4);
  std::mt19937_64 random(4);
  const Triangles soup = Triangles(3, 200).unaryExpr([&](Index) {
    return static_cast<Index>(random() % static_cast<std::uint64_t>(grid.cols()));
  });
  EXPECT_EQ(findSelfIntersections(grid, soup), reference::findSelfIntersections(grid, soup));
}

}  // namespace
}  // namespace spherical_param
