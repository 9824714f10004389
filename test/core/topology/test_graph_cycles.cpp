#include "graph_cycles.h"

#include "graphs.h"
#include "helpers.h"
#include "spherical_param/sphere_triangulation.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

int cyclesOf(const Graph& graph, int reach) {
  return countCycles(graph, reach).value_or(-1);
}

TEST(GraphCycles, AHandleHasTwoAndOpeningsHaveOneLessThanThereAre) {
  const Positions sphere = test::spiralSphere(1000);
  const Triangles hull = triangulateSphere(sphere);
  for (const int reach : {1, 2, 3}) {
    SCOPED_TRACE(reach);
    // The positions do not matter.
    EXPECT_EQ(cyclesOf(test::graphOfMesh(test::spiralSphere(40 * 20), test::torusTriangles(40, 20)),
                       reach),
              2);
    EXPECT_EQ(cyclesOf(test::graphOfMesh(sphere, hull), reach), 0);
    Triangles open = hull;
    int cycles = 0;
    for (const Eigen::Vector3d& center :
         {Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Vector3d(0.0, 0.0, -1.0),
          Eigen::Vector3d(1.0, 0.0, 0.0)}) {
      Eigen::Index kept = 0;
      for (Eigen::Index t = 0; t < open.cols(); ++t) {
        bool is_far = true;
        for (int k = 0; k < 3; ++k)
          is_far = is_far && (Eigen::Vector3d(sphere.col(open(k, t))) - center).norm() > 0.35;
        if (is_far)
          open.col(kept++) = open.col(t);
      }
      open.conservativeResize(3, kept);
      EXPECT_EQ(cyclesOf(test::graphOfMesh(sphere, open), reach), cycles++);
    }
  }
}

TEST(GraphCycles, ARingOfThreeTimesTheReachDoesNotCount) {
  for (const int reach : {1, 2, 3})
    for (const Index length : {3 * reach, 3 * reach + 1}) {
      std::vector<std::pair<Index, Index>> ring;
      for (Index v = 0; v < length; ++v)
        ring.emplace_back(v, (v + 1) % length);
      EXPECT_EQ(cyclesOf(test::unitGraph(length, ring), reach), length == 3 * reach ? 0 : 1)
          << reach;
    }
}

TEST(GraphCycles, OfNoSurfaceAreNotCounted) {
  // Random edges: hundreds of cycles, and within three steps of a node half of all nodes.
  std::mt19937 random(5);
  std::vector<std::pair<Index, Index>> edges;
  for (Index v = 0; v < 400; ++v)
    for (int i = 0; i < 3; ++i)
      if (const auto w = static_cast<Index>(random() % 400); w != v)
        edges.emplace_back(v, w);
  const Graph chaos = test::unitGraph(400, edges);
  EXPECT_FALSE(countCycles(chaos, 1));
  EXPECT_FALSE(countCycles(chaos, 3));
}

}  // namespace
}  // namespace spherical_param::internal
