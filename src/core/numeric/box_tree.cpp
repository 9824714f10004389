#include "box_tree.h"

namespace spherical_param::internal {

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
