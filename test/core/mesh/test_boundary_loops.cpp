#include "boundary_loops.h"

#include "open_shapes.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::test {
namespace {

TEST(BoundaryLoops, AreThoseOfTheDefinitionTheLongestFirst) {
  const Triangles hull = triangulateSphere(spiralSphere(300));
  const auto is_left_out = [](Index v) { return v < 6 || v % 90 == 20; };
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < hull.cols(); ++t)
    if (std::none_of(hull.col(t).begin(), hull.col(t).end(), is_left_out))
      kept.push_back(t);
  const Triangles open = hull(Eigen::all, kept);
  auto expected = *loopsOf(open);  // each with its lowest vertex last
  for (std::vector<Index>& loop : expected)
    std::rotate(loop.rbegin(), loop.rbegin() + 1, loop.rend());
  std::stable_sort(expected.begin(), expected.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  EXPECT_EQ(expected.size(), 4U);
  EXPECT_EQ(boundaryLoops(open, 300), expected);
  EXPECT_TRUE(boundaryLoops(hull, 300).empty());
}

}  // namespace
}  // namespace spherical_param::test
