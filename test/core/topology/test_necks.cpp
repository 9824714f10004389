#include "necks.h"

#include "cut_graph.h"
#include "filled_graph.h"
#include "graph_building.h"
#include "graphs.h"
#include "open_shapes.h"
#include "spherical_param/reconstruct.h"

namespace spherical_param::test {
namespace {

/// Points on a tube of radius 1 with round ends.
Positions needle(int rings, int around) {
  Positions points = tube(rings, around);
  const double step = 2.0 * kPi / around;
  const double end = step * (rings - 1);
  std::vector<Eigen::Vector3d> all(points.colwise().begin(), points.colwise().end());
  for (int ring = 1; ring * step < 1.4; ++ring) {
    const auto count = static_cast<int>(around * std::cos(ring * step));
    for (int a = 0; a < count; ++a) {
      const double angle = 2.0 * kPi * (a + 0.5 * ring) / count;
      const double radius = std::cos(ring * step);
      const double height = std::sin(ring * step);
      all.emplace_back(radius * std::cos(angle), radius * std::sin(angle), -height);
      all.emplace_back(radius * std::cos(angle), radius * std::sin(angle), end + height);
    }
  }
  all.emplace_back(0.0, 0.0, -1.0);
  all.emplace_back(0.0, 0.0, end + 1.0);
  return positionsOf(all);
}

struct Cut {
  Graph graph;
  Openings openings;
  std::vector<CutLoop> necks;
  std::size_t spheres = 0;
};

Cut cutOf(const Positions& points) {
  Cut cut;
  cut.graph = localDelaunayGraph(points).graph;
  const auto spacing = nodeSpacings(cut.graph, 1);
  RotationSystem rotation(points, cut.graph, spacing, 1);
  cut.openings = findOpenings(points, cut.graph, spacing, rotation);
  cut.graph = withoutFalseEdges(points, cut.graph, cut.openings.false_edges);
  cut.necks = findNecks(points, cut.graph, rotation, cut.openings, {}).loops;
  const CutGraph cut_graph = cutAlong(points, cut.graph, rotation, cut.necks);
  UnionFind sets = connectedComponents(cut_graph.graph);
  for (const Index v : cut_graph.graph.nodes())
    cut.spheres += sets.find(v) == v ? 1 : 0;
  return cut;
}

/// Checks that loops are walks of a graph, and two steps from each other and from openings.
void expectLoopsApart(const Cut& cut) {
  std::vector<std::vector<Index>> loops;
  for (const Opening& opening : cut.openings.openings)
    loops.push_back(opening.loop);
  for (const CutLoop& neck : cut.necks) {
    const std::size_t n = neck.nodes.size();
    EXPECT_GE(n, 6U);
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_TRUE(cut.graph.row(neck.nodes[i]).contains(neck.nodes[(i + 1) % n]));
    loops.push_back(neck.nodes);
  }
  std::map<Index, std::size_t> loop_of;
  for (std::size_t i = 0; i < loops.size(); ++i)
    for (const Index v : loops[i])
      EXPECT_TRUE(loop_of.emplace(v, i).second);
  for (std::size_t i = cut.openings.openings.size(); i < loops.size(); ++i)
    for (const Index v : loops[i])
      for (const Index w : cut.graph.row(v)) {
        const auto other = loop_of.find(w);
        EXPECT_TRUE(other == loop_of.end() || other->second == i);
      }
}

TEST(Necks, AreNoneWhereASphereHasRoom) {
  EXPECT_TRUE(cutOf(spiralSphere(1500)).necks.empty());
  EXPECT_TRUE(cutOf(randomSphere(1500, 1)).necks.empty());
  EXPECT_TRUE(cutOf(cubeGrid(14)).necks.empty());
  EXPECT_TRUE(cutOf(hemisphere(800)).necks.empty());
  EXPECT_TRUE(cutOf(needle(20, 16)).necks.empty());
}

TEST(Necks, DivideLongTubes) {
  for (const Positions& points :
       {needle(120, 12), withNoise(needle(120, 12), 0.05, 1), tube(120, 12)}) {
    const Cut cut = cutOf(points);
    EXPECT_GE(cut.necks.size(), 3U);
    EXPECT_EQ(cut.spheres, cut.necks.size() + 1);
    expectLoopsApart(cut);
  }
}

TEST(Necks, MakeMeshesOfLongTubesSound) {
  const Result result = reconstruct(needle(200, 10));
  ASSERT_EQ(result.surfaces.size(), 1U);
  const Surface& surface = result.surfaces.front();
  EXPECT_TRUE(surface.topology.isSphere());
  EXPECT_TRUE(surface.self_intersections.empty());
  // There is no map to one sphere.
  EXPECT_EQ(surface.sphere.cols(), 0);
}

}  // namespace
}  // namespace spherical_param::test
