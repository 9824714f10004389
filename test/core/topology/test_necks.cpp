#include "necks.h"

#include "cut_graph.h"
#include "filled_graph.h"
#include "graph_building.h"
#include "graphs.h"
#include "open_shapes.h"

namespace spherical_param::test {
namespace {

/// Points on a tube of radius 1 with round ends.
Positions needle(int rings, int around) {
  const Positions points = tube(rings, around);
  const double step = 2.0 * kPi / around;
  const double end = step * (rings - 1);
  std::vector<Eigen::Vector3d> all(points.colwise().begin(), points.colwise().end());
  for (int ring = 1; ring * step < 1.4; ++ring) {
    const auto count = static_cast<int>(around * std::cos(ring * step));
    for (int a = 0; a < count; ++a)
      for (const double z : {-std::sin(ring * step), end + std::sin(ring * step)})
        all.push_back(onCircle(2.0 * kPi * (a + 0.5 * ring) / count, std::cos(ring * step), z));
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
  std::map<Index, const void*> loop_of;
  for (const Opening& opening : cut.openings.openings)
    for (const Index v : opening.loop)
      EXPECT_TRUE(loop_of.emplace(v, &opening).second);
  for (const CutLoop& neck : cut.necks)
    for (const Index v : neck.nodes)
      EXPECT_TRUE(loop_of.emplace(v, &neck).second);
  for (const CutLoop& neck : cut.necks) {
    EXPECT_GE(neck.nodes.size(), 6U);
    for (std::size_t i = 0; i < neck.nodes.size(); ++i) {
      EXPECT_TRUE(cut.graph.row(neck.nodes[i]).contains(neck.after(i)));
      for (const Index w : cut.graph.row(neck.nodes[i]))
        EXPECT_TRUE(loop_of.count(w) == 0 || loop_of.at(w) == &neck);
    }
  }
}

TEST(Necks, AreNoneWhereASphereHasRoom) {
  for (const Positions& points :
       {spiralSphere(1500), randomSphere(1500, 1), cubeGrid(14), hemisphere(800), needle(20, 16)})
    EXPECT_TRUE(cutOf(points).necks.empty());
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

}  // namespace
}  // namespace spherical_param::test
