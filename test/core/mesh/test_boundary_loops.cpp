#include "boundary_loops.h"

#include "open_shapes.h"

namespace spherical_param {
namespace {

TEST(BoundaryLoops, AreThoseOfAnIndependentWalkTheLongestFirst) {
  // A strip around a cylinder of 7 x 4 squares, each cut in two, without two of them.
  constexpr Index around = 7;
  std::vector<Index> corners;
  for (Index row = 0; row < 4; ++row)
    for (Index i = 0; i < around; ++i) {
      if (row == 1 && (i == 2 || i == 3))
        continue;
      const Index a = row * around + i;
      const Index b = row * around + (i + 1) % around;
      corners.insert(corners.end(), {a, b, a + around, b, b + around, a + around});
    }
  const Triangles strip =
      Eigen::Map<const Triangles>(corners.data(), 3, static_cast<Eigen::Index>(corners.size() / 3));
  const std::map<Index, Index> next = test::boundaryOf(strip);
  const auto loops = internal::boundaryLoops(strip, 5 * around);
  ASSERT_EQ(loops.size(), 3U);
  EXPECT_EQ(loops[0].size(), 7U);
  EXPECT_EQ(loops[1].size(), 7U);
  EXPECT_EQ(loops[2].size(), 6U);
  for (const std::vector<Index>& loop : loops) {
    EXPECT_EQ(loop.front(), *std::min_element(loop.begin(), loop.end()));
    for (std::size_t i = 0; i < loop.size(); ++i)
      EXPECT_EQ(next.at(loop[i]), loop[(i + 1) % loop.size()]);
  }
  EXPECT_TRUE(internal::boundaryLoops(Triangles(3, 0), 5).empty());
}

}  // namespace
}  // namespace spherical_param
