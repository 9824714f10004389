#include "open_places.h"

#include "graphs.h"
#include "open_shapes.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::test {
namespace {

TEST(OpenPlaces, AreOverTheOpeningsAloneAndNotWhereTheyAreClosed) {
  const Positions points = sphereWithHoles(2000, 2, 0.4);
  const Graph graph = localDelaunayGraph(points).graph;
  const Openings openings = openingsOf(points, graph);
  ASSERT_EQ(openings.openings.size(), 2U);
  OpenPlaces places(points, graph, openings);
  const Triangles hull = triangulateSphere(points);
  for (const auto& t : hull.colwise()) {
    const Eigen::Vector3d middle = points(Eigen::all, t).rowwise().mean();
    const std::optional<std::size_t> over = places.openingOver(t[0], t[1], t[2]);
    EXPECT_EQ(places.isOpen(t[0], t[1], t[2]), over.has_value());
    EXPECT_TRUE(over || middle.norm() > 0.99);  // a chord
    EXPECT_TRUE(!over || (middle - openings.openings[*over].center).norm() < 0.5);
  }
  const std::vector<Index>& loop = openings.openings[1].loop;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    EXPECT_TRUE(places.isBoundary(loop[(i + 1) % loop.size()], loop[i]));
    EXPECT_FALSE(places.isBoundary(loop[i], loop[(i + 2) % loop.size()]));
  }
  const Index across = loop[loop.size() / 2];
  std::vector<Index> beside = rowOf(graph, loop[0]);
  beside.erase(std::remove_if(beside.begin(), beside.end(),
                              [&](Index v) { return std::count(loop.begin(), loop.end(), v) > 0; }),
               beside.end());
  EXPECT_TRUE(places.isOpen(loop[0], beside.at(0), across));
  EXPECT_FALSE(places.close(loop));  // it stays a boundary
  EXPECT_TRUE(places.close(beside));
  EXPECT_FALSE(places.isOpen(loop[0], beside[0], across));
  EXPECT_TRUE(places.isOpen(loop[0], loop[1], across));
}

}  // namespace
}  // namespace spherical_param::test
