#include "result_units.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

TEST(ResultUnits, NodesWithoutTrianglesAreNoVertices) {
  // Input 4 repeats input 1, whose node is in no triangle.
  Positions points =
      positionsOf({{0, 0, 0}, {0.4, 0.3, 0.2}, {1, 0, 0}, {0, 1, 0}, {0.4, 0.3, 0.2}, {0, 0, 1}});
  OrderedPoints nodes = orderPoints(points, 1);
  const auto node_of = nodesOfInput(nodes);
  Surface surface;
  surface.triangles.resize(3, 4);
  surface.triangles << node_of[0], node_of[0], node_of[0], node_of[2], node_of[3], node_of[2],
      node_of[5], node_of[3], node_of[2], node_of[5], node_of[3], node_of[5];
  surface.sphere = nodes.points;
  surface.outliers = {node_of[1], node_of[5]};
  surface.topology.unused_vertices = {node_of[1]};
  toInput(nodes, surface);
  EXPECT_EQ(surface.vertex_of_input, (std::vector<Index>{0, -1, 1, 2, -1, 3}));
  EXPECT_EQ(surface.input_of_vertex, (std::vector<Index>{0, 2, 3, 5}));
  EXPECT_EQ(surface.sphere.cols(), 4);
  EXPECT_EQ(surface.triangles.maxCoeff(), 3);
  EXPECT_EQ(surface.outliers, (std::vector<Index>{5}));
  EXPECT_TRUE(surface.topology.unused_vertices.empty());

  std::vector<Index> unmeshed;
  surface.points.resize(3, 4);
  toCloud(points, {10, 11, 12, 13, 14, 15}, surface, unmeshed);
  EXPECT_EQ(surface.points, points(Eigen::all, std::vector<Index>{0, 2, 3, 5}));
  EXPECT_EQ(unmeshed, (std::vector<Index>{11, 14}));
  EXPECT_EQ(surface.inputs, (std::vector<Index>{10, 12, 13, 15}));
  EXPECT_EQ(surface.input_of_vertex, (std::vector<Index>{10, 12, 13, 15}));
  EXPECT_EQ(surface.vertex_of_input, (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(surface.vertexOf(11), -1);
}

TEST(ResultUnits, PointsWithoutAVertexAreNotMerged) {
  Consolidation consolidation;
  consolidation.points = positionsOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  consolidation.point_of_input = {0, 0, 1, 1, 1, 2};  // 3 and 4 are equal
  consolidation.distinct_at = {2, 2, 1};
  consolidation.report.merged = 2;
  Surface surface;
  surface.vertex_of_input = {-1, 0, 1};
  surface.input_of_vertex = {1, 2};
  toInput(consolidation, surface);
  EXPECT_EQ(surface.input_of_vertex, (std::vector<Index>{2, 5}));
  EXPECT_EQ(surface.consolidation->merged, 1U);

  std::vector<Index> unmeshed;
  toCloud({}, {0, 1, 2, 3, 4, 5}, surface, unmeshed);
  EXPECT_EQ(unmeshed, (std::vector<Index>{0, 1}));
  EXPECT_EQ(surface.duplicates(), 1U);
}

}  // namespace
}  // namespace spherical_param::test
