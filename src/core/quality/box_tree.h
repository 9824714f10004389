#pragma once

#include "parallel.h"
#include "triangle_pair.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// A box rounded to floats: half the memory. Rounding keeps the order of numbers, so that boxes
/// that overlap still do.
struct FloatBox {
  Eigen::Array3f lower;
  Eigen::Array3f upper;

  /// Overlaps nothing.
  FloatBox()
      : lower(Eigen::Array3f::Constant(std::numeric_limits<float>::infinity())), upper(-lower) {}
  FloatBox(const Eigen::Array3f& low, const Eigen::Array3f& high) : lower(low), upper(high) {}
  explicit FloatBox(const Box& box)
      : lower(box.lower.cast<float>()), upper(box.upper.cast<float>()) {}
};

/// Eight boxes side by side, to compare a box with all of them at once. Unused ones overlap
/// nothing.
struct BoxGroup {
  static constexpr std::size_t kSize = 8;
  using Lanes = Eigen::Array<float, kSize, 3>;

  Lanes lower = Lanes::Constant(std::numeric_limits<float>::infinity());
  Lanes upper = -lower;

  void set(std::size_t lane, const FloatBox& box) {
    lower.row(static_cast<Eigen::Index>(lane)) = box.lower;
    upper.row(static_cast<Eigen::Index>(lane)) = box.upper;
  }
  FloatBox at(std::size_t lane) const {
    return {lower.row(static_cast<Eigen::Index>(lane)), upper.row(static_cast<Eigen::Index>(lane))};
  }
  /// The box of all.
  FloatBox all() const { return {lower.colwise().minCoeff(), upper.colwise().maxCoeff()}; }
  /// Calls visit(lane) for each box that overlaps one.
  template <typename Visit>
  void forEachOverlapping(const FloatBox& box, const Visit& visit) const {
    const auto gap = [&](int k) {
      return (lower.col(k) - box.upper[k]).max(box.lower[k] - upper.col(k));
    };
    const Eigen::Array<float, kSize, 1> gaps = gap(0).max(gap(1)).max(gap(2));
    for (std::size_t lane = 0; lane < kSize; ++lane)
      if (gaps[static_cast<Eigen::Index>(lane)] <= 0.0F)
        visit(lane);
  }
};

/// Boxes in a packed tree: box i of a level is that of the boxes 8 i ... 8 i + 7 of the level below
/// (I. Kamel and C. Faloutsos, "On packing R-trees", 1993). Queries are fast if boxes that follow
/// each other are near.
class BoxTree {
public:
  BoxTree() = default;
  /// \param box_of returns box i of [0, count).
  template <typename BoxOf>
  BoxTree(std::size_t count, int threads, const FractionReport& report, const BoxOf& box_of) {
    std::vector<BoxGroup> groups((count + BoxGroup::kSize - 1) / BoxGroup::kSize);
    static_assert(kBlockSize % BoxGroup::kSize == 0, "a group is in one block");
    forEachItem(count, threads, report, [&](std::size_t i) {
      groups[i / BoxGroup::kSize].set(i % BoxGroup::kSize, box_of(static_cast<Index>(i)));
    });
    build(std::move(groups), threads);
  }

  FloatBox at(Index place) const {
    const auto i = static_cast<std::size_t>(place);
    return levels_[0][i / BoxGroup::kSize].at(i % BoxGroup::kSize);
  }
  /// Changes a box, or adds one: its place is at most the number of boxes.
  void set(Index place, const FloatBox& box);

  /// Calls visit(i) for each box that overlaps one.
  ///
  /// \param first the first box of interest.
  /// \param skips whether boxes within a box are of no interest.
  template <typename Skips, typename Visit>
  void forEachOverlapping(const FloatBox& box, Index first, const Skips& skips,
                          const Visit& visit) const {
    if (!levels_.empty())
      descend({levels_.size() - 1, 0}, 0, box, static_cast<std::size_t>(first), skips,
              [&](std::size_t i, const FloatBox&) { visit(static_cast<Index>(i)); });
  }

  /// Calls visit(i, j) for each pair of overlapping boxes, i < j, with i in the block of kBlockSize
  /// from `begin` on.
  template <typename Visit>
  void forEachPair(Index begin, const Visit& visit) const {
    constexpr std::size_t block_level = 3;
    static_assert(1U << 3 * block_level == kBlockSize && 1U << 3 == BoxGroup::kSize);
    const std::size_t block = static_cast<std::size_t>(begin) / kBlockSize;
    const std::size_t top = levels_.size() - 1;
    if (top < block_level)
      return join(top, 0, 0, levels_[top][0].all(), visit);
    descend(
        {top, 0}, block_level, levels_[block_level - 1][block].all(), block * kBlockSize,
        [](const FloatBox&) { return false; },
        [&](std::size_t other, const FloatBox& box) {
          join(block_level - 1, block, other, box, visit);
        });
  }

private:
  void build(std::vector<BoxGroup> groups, int threads);

  struct Node {
    std::size_t level;
    std::size_t group;
  };

  /// Calls visit(i, its box) for boxes of the level `last`.
  template <typename Skips, typename Visit>
  void descend(const Node& node, std::size_t last, const FloatBox& box, std::size_t first,
               const Skips& skips, const Visit& visit) const {
    const BoxGroup& boxes = levels_[node.level][node.group];
    boxes.forEachOverlapping(box, [&](std::size_t lane) {
      const std::size_t i = node.group * BoxGroup::kSize + lane;
      const FloatBox found = boxes.at(lane);
      if (i < first >> 3 * node.level || skips(found))
        return;
      if (node.level == last)
        visit(i, found);
      else
        descend({node.level - 1, i}, last, box, first, skips, visit);
    });
  }

  /// Calls visit(i, j) for the pairs of boxes of two groups, a <= b.
  ///
  /// \param box of b.
  template <typename Visit>
  void join(std::size_t level, std::size_t a, std::size_t b, const FloatBox& box,
            const Visit& visit) const {
    const BoxGroup& boxes = levels_[level][a];
    const BoxGroup& others = levels_[level][b];
    boxes.forEachOverlapping(box, [&](std::size_t lane) {
      const std::size_t i = a * BoxGroup::kSize + lane;
      others.forEachOverlapping(boxes.at(lane), [&](std::size_t other_lane) {
        const std::size_t j = b * BoxGroup::kSize + other_lane;
        if (level > 0 && i <= j)
          join(level - 1, i, j, others.at(other_lane), visit);
        else if (i < j)
          visit(static_cast<Index>(i), static_cast<Index>(j));
      });
    });
  }

  std::vector<std::vector<BoxGroup>> levels_;  ///< from all boxes to one group
};

}  // namespace spherical_param::internal
