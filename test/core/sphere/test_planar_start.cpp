#include "planar_start.h"

#include "embeddings.h"

namespace spherical_param::test {
namespace {

TEST(PlanarStart, TheCentreOfAPathIsItsMiddle) {
  std::vector<std::pair<Index, Index>> path;
  for (Index i = 1; i < 31; ++i)
    path.emplace_back(i - 1, i);
  const std::vector<Index> nodes = centralNodes(unitGraph(31, path));
  EXPECT_EQ(nodes.size(), 31U);
  EXPECT_EQ(nodes.front(), 15);
  EXPECT_EQ(std::min(nodes[29], nodes[30]), 0);
  EXPECT_EQ(std::max(nodes[29], nodes[30]), 30);
}

TEST(PlanarStart, UnfoldsATubeThatItsDirectionsFold) {
  const Mesh tube = bentTube(12.0, 4.0, 16);
  const Graph graph = graphOfMesh(tube.points, tube.triangles);
  // The fraction of triangles on the side of most.
  const auto unfolded = [&](const Positions& directions) {
    double positive = 0.0;
    for (const auto& t : tube.triangles.colwise())
      positive += Eigen::Matrix3d(directions(Eigen::all, t)).determinant() > 0.0 ? 1.0 : 0.0;
    const double fraction = positive / static_cast<double>(tube.triangles.cols());
    return std::max(fraction, 1.0 - fraction);
  };
  const Positions start = planarStart(graph, centralNodes(graph).front());
  EXPECT_LT(unfolded(projectFromCentroid(tube.points)), 0.9);
  EXPECT_GT(unfolded(start), 0.95);  // sides are straight in the plane, not on the sphere
  EXPECT_LT(start.rowwise().mean().norm(), 0.1);
}

}  // namespace
}  // namespace spherical_param::test
