#include "box_tree.h"

#include <utility>

namespace spherical_param::internal {

void BoxTree::build(Groups groups, int threads) {
  if (groups.empty())
    return;
  levels_.push_back(std::move(groups));
  while (levels_.back().size() > 1) {
    const Groups& below = levels_.back();
    Groups level((below.size() + BoxGroup::kSize - 1) / BoxGroup::kSize);
    forEachIndex(below.size(), below.size() >= kParallelThreshold ? threads : 1, {}, [&](Index i) {
      level[i / BoxGroup::kSize].set(i % BoxGroup::kSize, below[i].all());
    });
    levels_.push_back(std::move(level));
  }
}

void BoxTree::set(Index i, const FloatBox& box) {
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

}  // namespace spherical_param::internal
