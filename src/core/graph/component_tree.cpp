#include "component_tree.h"

#include <algorithm>
#include <numeric>

namespace spherical_param::internal {
namespace {

/// For the few that are ever excluded.
bool contains(const std::vector<Index>& nodes, Index i) {
  return std::find(nodes.begin(), nodes.end(), i) != nodes.end();
}

}  // namespace

ComponentTree::ComponentTree(const Positions& points)
    : points_(points), order_(static_cast<std::size_t>(points.cols())),
      component_(order_.size(), 0) {
  std::iota(order_.begin(), order_.end(), Index{0});
  nodes_.reserve(order_.size() / 2 + 1);
  Node root;
  root.end = static_cast<Index>(order_.size());
  nodes_.push_back(root);
  // Children are appended behind their parent, so this visits every node after its parent.
  for (std::size_t node = 0; node < nodes_.size(); ++node)
    build(static_cast<Index>(node));
}

void ComponentTree::build(Index node) {
  Node& parent = nodes_[static_cast<std::size_t>(node)];
  const auto begin = order_.begin() + parent.begin;
  const auto end = order_.begin() + parent.end;
  std::for_each(begin, end, [&](Index i) { parent.box.extend(points_.col(i)); });
  if (parent.end - parent.begin <= kLeafSize)
    return;
  Eigen::Index axis = 0;
  parent.box.sizes().maxCoeff(&axis);
  const auto middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end, [&](Index i, Index j) {
    return std::pair(points_(axis, i), i) < std::pair(points_(axis, j), j);
  });
  Node left;
  left.begin = parent.begin;
  left.end = static_cast<Index>(middle - order_.begin());
  Node right;
  right.begin = left.end;
  right.end = parent.end;
  parent.left = static_cast<Index>(nodes_.size());
  nodes_.push_back(left);  // ends the validity of `parent`
  nodes_.push_back(right);
}

void ComponentTree::setComponents(const std::vector<Index>& component) {
  component_ = component;
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    if (node->left != 0) {
      const Index left = nodes_[static_cast<std::size_t>(node->left)].component;
      const Index right = nodes_[static_cast<std::size_t>(node->left) + 1].component;
      node->component = left == right ? left : kMixed;
      continue;
    }
    const auto component_at = [&](Index position) {
      return component_[static_cast<std::size_t>(order_[static_cast<std::size_t>(position)])];
    };
    node->component = component_at(node->begin);
    for (Index position = node->begin; position < node->end; ++position)
      if (component_at(position) != node->component)
        node->component = kMixed;
  }
}

void ComponentTree::nearestOther(Index i, const std::vector<Index>& excluded, Pair& best) const {
  const Index own = componentOf(i);
  visit(
      0, i, [&](Index component) { return component != own; },
      [&](Index j) { return componentOf(j) != own && !contains(excluded, j); }, best);
}

void ComponentTree::nearestIn(Index component, Index i, const std::vector<Index>& excluded,
                              Pair& best) const {
  visit(
      0, i, [&](Index other) { return other == component || other == kMixed; },
      [&](Index j) { return componentOf(j) == component && !contains(excluded, j); }, best);
}

void ComponentTree::nearestExcept(Index i, const std::vector<Index>& excluded, Pair& best) const {
  visit(
      0, i, [](Index) { return true; }, [&](Index j) { return j != i && !contains(excluded, j); },
      best);
}

template <typename MayHold, typename Accepts>
void ComponentTree::visit(Index node_index, Index i, const MayHold& may_hold,
                          const Accepts& accepts, Pair& best) const {
  const Node& node = nodes_[static_cast<std::size_t>(node_index)];
  const auto point = points_.col(i);
  // A node at exactly the best distance may still hold the tie with lower indices.
  if (!may_hold(node.component) || node.box.squaredExteriorDistance(point) > best.squared_distance)
    return;
  if (node.left == 0) {
    for (Index position = node.begin; position < node.end; ++position) {
      const Index j = order_[static_cast<std::size_t>(position)];
      if (!accepts(j))
        continue;
      const Pair pair{(point - points_.col(j)).squaredNorm(), std::min(i, j), std::max(i, j)};
      best = std::min(best, pair);
    }
    return;
  }
  const auto distance = [&](Index child) {
    return nodes_[static_cast<std::size_t>(child)].box.squaredExteriorDistance(point);
  };
  const bool right_first = distance(node.left + 1) < distance(node.left);
  visit(node.left + (right_first ? 1 : 0), i, may_hold, accepts, best);
  visit(node.left + (right_first ? 0 : 1), i, may_hold, accepts, best);
}

}  // namespace spherical_param::internal
