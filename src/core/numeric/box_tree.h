#pragma once

#include "rows.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// A box rounded to floats: half the memory. Rounding keeps the order of numbers, so boxes that
/// overlap still overlap. An empty box, the default, overlaps nothing.
using FloatBox = Eigen::AlignedBox3f;

/// Eight boxes side by side, to compare a box with all of them at once. Unused ones are empty.
struct BoxGroup {
  static constexpr Index kSize = 8;
  using Lanes = Eigen::Array<float, kSize, 3>;

  Lanes lower = Lanes::Constant(std::numeric_limits<float>::infinity());
  Lanes upper = -lower;

  void set(Index lane, const FloatBox& box) {
    lower.row(lane) = box.min().transpose();
    upper.row(lane) = box.max().transpose();
  }
  FloatBox at(Index lane) const {
    return {lower.row(lane).matrix().transpose(), upper.row(lane).matrix().transpose()};
  }
  /// The box around all eight.
  FloatBox all() const {
    return {lower.colwise().minCoeff().matrix().transpose(),
            upper.colwise().maxCoeff().matrix().transpose()};
  }
  /// Calls visit(lane) for each box that overlaps `box`.
  template <typename Visit>
  void forEachOverlapping(const FloatBox& box, const Visit& visit) const {
    const auto gap = [&](int k) {
      return (lower.col(k) - box.max()[k]).max(box.min()[k] - upper.col(k));
    };
    const Eigen::Array<float, kSize, 1> gaps = gap(0).max(gap(1)).max(gap(2));
    for (Index lane = 0; lane < kSize; ++lane)
      if (gaps[lane] <= 0.0F)
        visit(lane);
  }
};

/// Boxes in a packed tree: box i of a level holds the boxes 8 i ... 8 i + 7 of the level below
/// (I. Kamel and C. Faloutsos, "On packing R-trees", 1993). Queries are fast if boxes that follow
/// each other are near.
class BoxTree {
public:
  BoxTree() = default;
  /// \param box_of returns box i of [0, count).
  template <typename BoxOf>
  BoxTree(std::size_t count, int threads, const FractionReport& report, const BoxOf& box_of) {
    if (count == 0)
      return;
    addLevel(count, threads, report, box_of);
    while (levels_.back().size() > 1) {
      const Groups& below = levels_.back();
      addLevel(below.size(), below.size() >= kParallelThreshold ? threads : 1, {},
               [&](Index i) { return below[i].all(); });
    }
  }

  FloatBox at(Index i) const { return levels_[0][i / BoxGroup::kSize].at(i % BoxGroup::kSize); }
  /// Changes box i, or appends it: i is at most the number of boxes.
  void set(Index i, const FloatBox& box) {
    if (levels_.empty())
      levels_.emplace_back();
    FloatBox changed = box;
    for (std::size_t level = 0;; ++level) {
      Groups& groups = levels_[level];
      const Index group = i / BoxGroup::kSize;
      if (group == groups.count())
        groups.emplace_back();
      groups[group].set(i % BoxGroup::kSize, changed);
      if (groups.size() == 1)
        return;
      i = group;
      changed = groups[group].all();
      if (level + 1 == levels_.size()) {
        const FloatBox first = groups[0].all();
        levels_.emplace_back(1).front().set(0, first);
      }
    }
  }

  /// Calls visit(i) for each box i >= first that overlaps `box`.
  ///
  /// \param skips (outer) returns whether the boxes within `outer` are left out.
  template <typename Skips, typename Visit>
  void forEachOverlapping(const FloatBox& box, Index first, const Skips& skips,
                          const Visit& visit) const {
    if (!levels_.empty())
      descend(levels_.size() - 1, 0, 0, box, first, skips,
              [&](Index i, const FloatBox&) { visit(i); });
  }

  /// Calls visit(i, j) for each pair of overlapping boxes, i < j, where i is in the group.
  template <typename Visit>
  void forEachPair(Index group, const Visit& visit) const {
    const BoxGroup& own = levels_[0][group];
    const auto visit_pairs = [&](Index other, const FloatBox& box) {
      own.forEachOverlapping(box, [&](Index lane) {
        levels_[0][other].forEachOverlapping(own.at(lane), [&](Index other_lane) {
          const Index i = group * BoxGroup::kSize + lane;
          const Index j = other * BoxGroup::kSize + other_lane;
          if (i < j)
            visit(i, j);
        });
      });
    };
    const FloatBox box = own.all();
    if (levels_.size() == 1)
      visit_pairs(0, box);
    else
      descend(
          levels_.size() - 1, 0, 1, box, group * BoxGroup::kSize,
          [](const FloatBox&) { return false; }, visit_pairs);
  }

private:
  using Groups = Indexed<BoxGroup>;

  /// Adds a level of `count` boxes on top.
  template <typename BoxOf>
  void addLevel(std::size_t count, int threads, const FractionReport& report, const BoxOf& box_of) {
    Groups groups((count + BoxGroup::kSize - 1) / BoxGroup::kSize);
    static_assert(kBlockSize % BoxGroup::kSize == 0, "a group is in one block");
    forEachIndex(count, threads, report,
                 [&](Index i) { groups[i / BoxGroup::kSize].set(i % BoxGroup::kSize, box_of(i)); });
    levels_.push_back(std::move(groups));
  }

  /// Calls visit(i, its box) for boxes of the level `last`.
  template <typename Skips, typename Visit>
  void descend(std::size_t level, Index group, std::size_t last, const FloatBox& box, Index first,
               const Skips& skips, const Visit& visit) const {
    const BoxGroup& boxes = levels_[level][group];
    boxes.forEachOverlapping(box, [&](Index lane) {
      const Index i = group * BoxGroup::kSize + lane;
      const FloatBox found = boxes.at(lane);
      if (i < first >> 3 * level || skips(found))
        return;
      if (level == last)
        visit(i, found);
      else
        descend(level - 1, i, last, box, first, skips, visit);
    });
  }

  std::vector<Groups> levels_;  ///< from all boxes to one group
};

}  // namespace spherical_param::internal
