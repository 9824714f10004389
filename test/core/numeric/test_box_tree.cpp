#include "box_tree.h"

#include "indexed.h"

#include <gtest/gtest.h>

namespace spherical_param::internal {
namespace {

// What a query costs depends on what it finds, not on the number of boxes: flat, long, and doubled
// ones as well.
TEST(BoxTree, LooksAtFewBoxesBeyondThoseFound) {
  constexpr std::size_t side = 64;
  Indexed<FloatBox> boxes;
  for (unsigned i = 0; i < 2 * side * side; ++i) {
    // Along a space-filling curve over a plane, each place twice.
    Eigen::Vector3f low = Eigen::Vector3f::Zero();
    for (unsigned bit = 0; bit < 6; ++bit) {
      low.x() += static_cast<float>((i / 2 >> 2 * bit & 1U) << bit);
      low.y() += static_cast<float>((i / 2 >> (2 * bit + 1) & 1U) << bit);
    }
    boxes.emplace_back(low, low + Eigen::Vector3f(0.9F, 0.9F, 0.0F));
  }
  const BoxTree tree(boxes.size(), 1, {}, [&](Index i) { return boxes[i]; });
  std::size_t looks = 0;
  std::size_t found = 0;
  for (const FloatBox& box : boxes)
    tree.forEachOverlapping(
        box, 0,
        [&](const FloatBox&) {
          ++looks;
          return false;
        },
        [&](Index) { ++found; });
  EXPECT_EQ(found, 2 * boxes.size());
  EXPECT_LT(looks, 10 * boxes.size());
}

}  // namespace
}  // namespace spherical_param::internal
