#include "component_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace spherical_param::internal {

ComponentTree::ComponentTree(const Positions& points)
    : points_(points), order_(static_cast<std::size_t>(points.cols())) {
  std::iota(order_.begin(), order_.end(), Index{0});
  component_ = order_;
  nodes_.reserve(order_.size() / 2 + 1);
  nodes_.push_back({{}, 0, static_cast<Index>(order_.size())});
  // Children are appended behind their parent, so this visits every node after its parent.
  for (Index node = 0; node < static_cast<Index>(nodes_.size()); ++node)
    build(nodes_[node]);
}

void ComponentTree::build(Node& node) {
  const auto begin = order_.begin() + node.begin;
  const auto end = order_.begin() + node.end;
  std::for_each(begin, end, [&](Index i) { node.box.extend(points_.col(i)); });
  if (node.end - node.begin <= kLeafSize)
    return;
  Eigen::Index axis = 0;
  node.box.sizes().maxCoeff(&axis);
  const Index middle = node.begin + (node.end - node.begin) / 2;
  std::nth_element(begin, order_.begin() + middle, end, [&](Index i, Index j) {
    return std::pair(points_(axis, i), i) < std::pair(points_(axis, j), j);
  });
  node.left = static_cast<Index>(nodes_.size());
  const Node left{{}, node.begin, middle};
  const Node right{{}, middle, node.end};
  nodes_.push_back(left);  // ends the validity of `node`
  nodes_.push_back(right);
}

void ComponentTree::setComponents(const std::vector<Index>& component) {
  std::copy(component.begin(), component.end(), component_.begin());
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    if (node->left != 0) {
      const Index left = nodes_[node->left].component;
      node->component = left == nodes_[node->left + 1].component ? left : kMixed;
      continue;
    }
    node->component = component_[order_[node->begin]];
    for (Index position = node->begin; position < node->end; ++position)
      if (component_[order_[position]] != node->component)
        node->component = kMixed;
  }
}

void ComponentTree::nearestOther(Index i, const std::vector<Index>& excluded, Pair& best) const {
  visit(
      nodes_[0], i, excluded, [own = component_[i]](Index other) { return other != own; }, best);
}

void ComponentTree::nearestIn(Index component, Index i, const std::vector<Index>& excluded,
                              Pair& best) const {
  visit(
      nodes_[0], i, excluded,
      [component](Index other) { return other == component || other == kMixed; }, best);
}

template <typename Accepts>
void ComponentTree::visit(const Node& node, Index i, const std::vector<Index>& excluded,
                          const Accepts& accepts, Pair& best) const {
  const auto point = points_.col(i);
  // A node at exactly the best distance may still hold the tie with lower indices.
  if (!accepts(node.component) || node.box.squaredExteriorDistance(point) > best.squared_distance)
    return;
  if (node.left == 0) {
    for (Index position = node.begin; position < node.end; ++position) {
      const Index j = order_[position];
      if (accepts(component_[j]) &&
          std::find(excluded.begin(), excluded.end(), j) == excluded.end())
        best = std::min(
            best, Pair{(point - points_.col(j)).squaredNorm(), std::min(i, j), std::max(i, j)});
    }
    return;
  }
  const Node& left = nodes_[node.left];
  const Node& right = nodes_[node.left + 1];
  const bool right_first =
      right.box.squaredExteriorDistance(point) < left.box.squaredExteriorDistance(point);
  visit(right_first ? right : left, i, excluded, accepts, best);
  visit(right_first ? left : right, i, excluded, accepts, best);
}

}  // namespace spherical_param::internal
