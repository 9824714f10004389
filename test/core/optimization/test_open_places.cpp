#include "graphs.h"
#include "open_places.h"

#include "core/topology/topologies.h"
#include "graph.h"
#include "open_shapes.h"

namespace spherical_param {
namespace {

using internal::OpenPlaces;

TEST(OpenPlaces, AreTrianglesNearALoopWithALongSide) {
  // Rings 0, 1, 2, ... of 40 points; the loops are rings 0 and 19.
  const Positions points = test::tube(20, 40);
  const Graph graph = test::graphOf(points, test::bruteForceNeighbors(points, 24)).graph;
  const OpenPlaces places(points, graph, test::openingsOf(points, graph));
  EXPECT_TRUE(places.isOpen(0, 10, 20));
  EXPECT_TRUE(places.isOpen(20, 0, 10));
  EXPECT_TRUE(places.isOpen(0, 2, 1));      // two steps along the loop
  EXPECT_FALSE(places.isOpen(0, 1, 40));    // of the surface
  EXPECT_TRUE(places.isOpen(80, 90, 100));  // two steps from the loop
  EXPECT_FALSE(places.isOpen(160, 170, 180));
  EXPECT_TRUE(places.isRim(0, 1));
  EXPECT_TRUE(places.isRim(39, 0));
  EXPECT_FALSE(places.isRim(0, 2));
  EXPECT_FALSE(places.isRim(40, 41));
}

}  // namespace
}  // namespace spherical_param
