#include "rotation_system.h"

#include "graphs.h"
#include "handle_shapes.h"

namespace spherical_param::test {
namespace {

RotationSystem rotationOf(const Positions& points, const Graph& graph) {
  return {points, graph, nodeSpacings(graph, 1), 1};
}

TEST(RotationSystem, FacesOfAWellSampledSurfaceHaveItsEulerCharacteristic) {
  for (const auto& [points, euler] :
       {std::pair(spiralSphere(500), 2), {torusCloud(40, 16), 0}, {doubleTorus(0.15), -2}}) {
    const Graph graph = localDelaunayGraph(points).graph;
    const RotationSystem rotation = rotationOf(points, graph);
    const NeighborRows faces = rotation.faces(1, 0.0);
    EXPECT_EQ(faces.neighbors.size(), rotation.edges().neighbors.size());  // one on either side
    EXPECT_EQ(static_cast<int>(points.cols()) - static_cast<int>(faces.neighbors.size() / 2) +
                  static_cast<int>(faces.size()),
              euler);
    EXPECT_EQ(rotation.countTwisted(), 0U);
  }
  const Positions band = moebiusBand(160, 12);
  EXPECT_GE(rotationOf(band, localDelaunayGraph(band).graph).countTwisted(), 10U);
}

TEST(RotationSystem, OfCrossingEdgesTheLongerIsDropped) {
  // A rhombus with both diagonals.
  const Positions points{{-0.9, 0.9, 0.0, 0.0}, {0.0, 0.0, -0.8, 0.8}, {0.0, 0.0, 0.0, 0.0}};
  const Graph graph = graphOfMesh(points, tetrahedron());
  const RotationSystem rotation = rotationOf(points, graph);
  EXPECT_FALSE(rotation.edges().row(0).contains(1));
  EXPECT_TRUE(rotation.edges().row(2).contains(3));
}

}  // namespace
}  // namespace spherical_param::test
