#include "box_tree.h"

#include "indexed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace spherical_param::test {
namespace {

using internal::BoxTree;
using internal::FloatBox;
using PlacePairs = std::set<std::pair<Index, Index>>;

BoxTree treeOf(const internal::Indexed<FloatBox>& boxes) {
  return {boxes.size(), 1, {}, [&](Index i) { return boxes[i]; }};
}

/// Boxes on a grid, so that many touch; most are small, a few as large as all, a few are equal.
internal::Indexed<FloatBox> randomBoxes(Index count, std::mt19937& random) {
  std::uniform_int_distribution<int> coordinate(0, 60);
  std::uniform_int_distribution<int> size(0, 6);
  internal::Indexed<FloatBox> boxes;
  for (Index i = 0; i < count; ++i) {
    const Eigen::Vector3f low =
        Eigen::Vector3i(coordinate(random), coordinate(random), 0).cast<float>();
    const float extent = static_cast<float>(i % 50 == 49 ? 60 : size(random));
    boxes.emplace_back(low, low + Eigen::Vector3f::Constant(extent));
    if (i % 20 == 19)
      boxes[i] = boxes[i / 2];
  }
  return boxes;
}

void expectOverlaps(const BoxTree& tree, const internal::Indexed<FloatBox>& boxes) {
  for (const Index first : {0, boxes.count() / 3})
    for (Index i = 0; i < boxes.count(); i += 7) {
      std::vector<Index> found;
      tree.forEachOverlapping(
          boxes[i], first, [](const FloatBox&) { return false; },
          [&](Index j) { found.push_back(j); });
      std::vector<Index> expected;
      for (Index j = first; j < boxes.count(); ++j)
        if (boxes[i].intersects(boxes[j]))
          expected.push_back(j);
      ASSERT_EQ(found, expected) << i;
    }
}

TEST(BoxTree, FindsTheBoxesAndPairsThatOverlap) {
  std::mt19937 random(1);
  for (const Index count : {1, 2, 8, 9, 64, 65, 512, 513, 1200}) {
    SCOPED_TRACE(count);
    const internal::Indexed<FloatBox> boxes = randomBoxes(count, random);
    const BoxTree tree = treeOf(boxes);
    expectOverlaps(tree, boxes);
    PlacePairs pairs;
    for (Index group = 0; group * internal::BoxGroup::kSize < count; ++group)
      tree.forEachPair(group, [&](Index i, Index j) {
        EXPECT_EQ(i / internal::BoxGroup::kSize, group);
        EXPECT_TRUE(pairs.emplace(i, j).second);
      });
    PlacePairs expected;
    for (Index i = 0; i < count; ++i)
      for (Index j = i + 1; j < count; ++j)
        if (boxes[i].intersects(boxes[j]))
          expected.emplace(i, j);
    EXPECT_EQ(pairs, expected);
  }
}

TEST(BoxTree, GrowsAndChanges) {
  std::mt19937 random(2);
  const internal::Indexed<FloatBox> before = randomBoxes(600, random);
  const internal::Indexed<FloatBox> after = randomBoxes(600, random);
  BoxTree tree;
  expectOverlaps(tree, {});
  internal::Indexed<FloatBox> boxes;
  for (Index i = 0; i < before.count(); ++i) {
    boxes.push_back(before[i]);
    tree.set(i, before[i]);
    if (i % 5 == 4) {
      boxes[i / 2] = i % 2 == 0 ? after[i] : FloatBox();
      tree.set(i / 2, boxes[i / 2]);
    }
    if (i < 10 || i % 60 == 4)
      expectOverlaps(tree, boxes);
  }
}

// What a query costs depends on what it finds, not on the number of boxes: flat, long, and doubled
// ones as well.
TEST(BoxTree, LooksAtFewBoxesBeyondThoseFound) {
  constexpr std::size_t side = 64;
  internal::Indexed<FloatBox> boxes;
  for (unsigned i = 0; i < 2 * side * side; ++i) {
    // Along a space-filling curve over a plane, each place twice.
    Eigen::Vector3f low = Eigen::Vector3f::Zero();
    for (unsigned bit = 0; bit < 6; ++bit) {
      low.x() += static_cast<float>((i / 2 >> 2 * bit & 1U) << bit);
      low.y() += static_cast<float>((i / 2 >> (2 * bit + 1) & 1U) << bit);
    }
    boxes.emplace_back(low, low + Eigen::Vector3f(0.9F, 0.9F, 0.0F));
  }
  const BoxTree tree = treeOf(boxes);
  std::size_t looks = 0;
  std::size_t found = 0;
  const auto ask = [&](const FloatBox& box, const auto& skips) {
    tree.forEachOverlapping(
        box, 0,
        [&](const FloatBox& within) {
          ++looks;
          return skips(within);
        },
        [&](Index) { ++found; });
  };
  for (const FloatBox& box : boxes)
    ask(box, [](const FloatBox&) { return false; });
  EXPECT_EQ(found, 2 * boxes.size());
  EXPECT_LT(looks, 10 * boxes.size());
  // One as large as all, of which only a diagonal is of interest.
  looks = found = 0;
  ask({Eigen::Vector3f::Zero(), Eigen::Vector3f::Constant(64.0F)}, [](const FloatBox& box) {
    return box.max().x() < box.min().y() || box.max().y() < box.min().x();
  });
  EXPECT_EQ(found, 2 * side);
  EXPECT_LT(looks, 12 * found);
}

}  // namespace
}  // namespace spherical_param::test
