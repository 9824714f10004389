#include "cycle_labels.h"

#include "graphs.h"
#include "helpers.h"
#include "spherical_param/sphere_triangulation.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

constexpr Index kRings = 20;
constexpr Index kAround = 9;

Graph torusGraph() {
  // The positions do not matter.
  return test::graphOfMesh(test::spiralSphere(kRings * kAround),
                           test::torusTriangles(kRings, kAround));
}

/// Around the tube, with a spike there and back.
std::vector<Index> meridian(Index ring) {
  std::vector<Index> walk = test::range(ring * kAround, (ring + 1) * kAround);
  walk.push_back(ring * kAround);
  walk.push_back((ring + 1) % kRings * kAround);
  return walk;
}

std::vector<Index> parallel(Index around) {
  std::vector<Index> walk;
  for (Index ring = 0; ring < kRings; ++ring)
    walk.push_back(ring * kAround + around);
  return walk;
}

NeighborRows cells(const std::vector<std::vector<Index>>& walks) {
  NeighborRows rows;
  for (const std::vector<Index>& walk : walks) {
    rows.neighbors.insert(rows.neighbors.end(), walk.begin(), walk.end());
    rows.endRow();
  }
  return rows;
}

TEST(CycleLabels, TellWhichWalksOfATorusBound) {
  const NumberedGraph graph(torusGraph());
  CycleLabels labels(graph, {});
  EXPECT_EQ(labels.rank(), 2);
  EXPECT_TRUE(labels.areComplete());
  EXPECT_EQ(labels.of({0, 1, kAround + 1}), 0U);
  EXPECT_NE(labels.of(meridian(0)), 0U);
  EXPECT_EQ(labels.of(meridian(0)), labels.of(meridian(7)));
  EXPECT_NE(labels.of(parallel(0)), 0U);
  EXPECT_EQ(labels.of(parallel(0)), labels.of(parallel(5)));
  EXPECT_NE(labels.of(meridian(0)), labels.of(parallel(0)));
  labels.fill(labels.of(meridian(3)));
  EXPECT_EQ(labels.of(meridian(0)), 0U);
  EXPECT_NE(labels.of(parallel(0)), 0U);
}

TEST(CycleLabels, CellsBoundAsTrianglesDo) {
  const NumberedGraph graph(torusGraph());
  const CycleLabels labels(graph, cells({parallel(2)}));
  EXPECT_EQ(labels.rank(), 1);
  EXPECT_EQ(labels.of(parallel(8)), 0U);
  EXPECT_NE(labels.of(meridian(0)), 0U);
  EXPECT_EQ(CycleLabels(graph, cells({parallel(2), meridian(2), meridian(5)})).rank(), 0);
}

TEST(CycleLabels, EdgesWithoutABitAreLeftOut) {
  // Two nodes joined by many ways of two steps: a cycle for each way but the first.
  for (const Index ways : {65, 66, 200}) {
    std::vector<std::pair<Index, Index>> edges;
    for (Index way = 0; way < ways; ++way) {
      edges.emplace_back(0, 2 + way);
      edges.emplace_back(2 + way, 1);
    }
    const NumberedGraph graph(test::unitGraph(2 + ways, edges));
    CycleLabels labels(graph, {});
    EXPECT_EQ(labels.rank(), 64);
    EXPECT_EQ(labels.areComplete(), ways == 65);
    Index left_out = 0;
    for (std::uint32_t edge = 0; edge < graph.ends.size(); ++edge)
      left_out += labels.isLeftOut(edge) ? 1 : 0;
    EXPECT_EQ(left_out, ways - 65);
    labels.fill(CycleLabels::Label{1} << 63);
    EXPECT_EQ(labels.rank(), 63);
  }
}

}  // namespace
}  // namespace spherical_param::internal
