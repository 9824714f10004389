#include "band_graph.h"

#include "graphs.h"
#include "open_shapes.h"
#include "rotation_system.h"

namespace spherical_param::test {
namespace {

/// How much a sphere squeezes a cloud.
double squeezeOf(const Positions& points) {
  const Graph graph = localDelaunayGraph(points).graph;
  const NodeSizes sizes{nodeSpacings(graph, 1), Indexed<double>(graph.size(), 1.0)};
  Indexed<Index> band_of(graph.size(), -1);
  const Indexed<Band> bands = bandsOf(graph, sizes, 0, band_of);
  for (const Index v : graph.nodes()) {
    const std::vector<Index>& nodes = bands[band_of[v]].nodes;
    EXPECT_EQ(std::count(nodes.begin(), nodes.end(), v), 1);
  }
  return worstWay(bands).back().squeeze;
}

TEST(BandGraph, SeesHowMuchATubeIsSqueezed) {
  EXPECT_LT(squeezeOf(spiralSphere(1500)), 3.0);
  EXPECT_LT(squeezeOf(randomSphere(1500, 1)), 4.0);
  // Half as long as it is from its middle to its ends: sqrt(1/2) for each radius.
  const double step = 2.0 * kPi / 14;
  for (const int rings : {60, 120}) {
    const double expected = std::sqrt(0.5) * step * rings / 2.0;
    EXPECT_NEAR(squeezeOf(tube(rings, 14)), expected, 0.25 * expected);
  }
}

}  // namespace
}  // namespace spherical_param::test
