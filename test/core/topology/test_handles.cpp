#include "handles.h"

#include "handle_shapes.h"
#include "open_shapes.h"
#include "topologies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace spherical_param::internal {
namespace {

TEST(Handles, OfATorusIsTheShortestLoopAroundItsTube) {
  for (const int around : {6, 9, 16}) {
    const test::Topology of(test::torusCloud(40, around, 1.0, 0.0225 * around));
    ASSERT_EQ(of.handles.loops.size(), 1U) << around;
    const CutLoop& loop = of.handles.loops.front();
    EXPECT_EQ(loop.nodes.size(), static_cast<std::size_t>(around));
    // From ring to ring, but for the one of the loop and the steps to both sides of it.
    EXPECT_EQ(loop.dual, 38);
    EXPECT_TRUE(loop.left_out.empty());
    EXPECT_FALSE(of.handles.is_one_sided);
    for (std::size_t i = 0; i < loop.nodes.size(); ++i)
      EXPECT_TRUE(of.graph.row(loop.nodes[i]).contains(loop.nodes[(i + 1) % loop.nodes.size()]));
  }
}

TEST(Handles, AreFoundOneForEachAndApart) {
  for (const auto& [points, genus] :
       {std::pair(test::spiralSphere(3000), 0U), std::pair(test::doubleTorus(0.12), 2U),
        std::pair(test::plateWithHoles(0.12), 5U), std::pair(test::trefoil(0.22), 1U),
        std::pair(test::latticeOfTubes(0.08), 28U)}) {
    const test::Topology of(points);
    ASSERT_EQ(of.handles.loops.size(), genus);
    std::set<Index> nodes;
    for (const CutLoop& loop : of.handles.loops)
      for (const Index v : loop.nodes) {
        EXPECT_TRUE(nodes.insert(v).second);
        EXPECT_EQ(loop.certainty, 1.0);
      }
  }
}

TEST(Handles, OfFewPointsMayBeGaps) {
  // 9 around the tube. Without false edges a handle needs a walk of 6 steps across its loop.
  EXPECT_EQ(test::Topology(test::torusCloud(9, 9, 1.0, 0.4)).handles.loops.size(), 1U);
  EXPECT_TRUE(test::Topology(test::torusCloud(7, 9, 1.0, 0.4)).handles.loops.empty());
}

TEST(Handles, LoopsDoNotPassThoseOfOpenings) {
  const Positions torus = test::torusCloud(80, 30, 2.5, 1.0);
  const test::Topology of(test::pointsWhere(torus, [](const Eigen::Vector3d& p) {
    return (p - Eigen::Vector3d(3.5, 0.0, 0.0)).norm() > 0.7;
  }));
  ASSERT_EQ(of.openings.openings.size(), 1U);
  ASSERT_EQ(of.handles.loops.size(), 1U);
  const std::vector<Index>& around = of.openings.openings.front().loop;
  for (const Index v : of.handles.loops.front().nodes)
    EXPECT_EQ(std::count(around.begin(), around.end(), v), 0);
}

TEST(Handles, AKleinBottleHasOneSide) {
  EXPECT_TRUE(test::Topology(test::kleinBottle(120, 60)).handles.is_one_sided);
}

TEST(Handles, AreTheSameForAnyNumberOfThreads) {
  const Positions points = test::withNoise(test::plateWithHoles(0.09), 0.005, 3);
  const test::Topology one(points, test::onThreads(1));
  const test::Topology three(points, test::onThreads(3));
  ASSERT_EQ(one.handles.loops.size(), three.handles.loops.size());
  for (std::size_t i = 0; i < one.handles.loops.size(); ++i) {
    EXPECT_EQ(one.handles.loops[i].nodes, three.handles.loops[i].nodes);
    EXPECT_EQ(one.handles.loops[i].dual, three.handles.loops[i].dual);
  }
}

}  // namespace
}  // namespace spherical_param::internal
