#include "component_tree.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {

ComponentTree::ComponentTree(const Positions& points)
    : points_(points), order_(firstIndices(columnCount(points))), component_(order_) {
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

void ComponentTree::setComponents(Indexed<Index> component) {
  component_ = std::move(component);
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

void ComponentTree::visit(const Node& node, Index i, const std::vector<Index>& excluded,
                          Index component, Pair& best) const {
  const auto point = points_.col(i);
  const auto accepts = [&](Index other) {
    return component == kAnyOther ? other != component_[i] : other == component || other == kMixed;
  };
  // A node at exactly the best distance may still hold a point of a lower index.
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
  visit(right_first ? right : left, i, excluded, component, best);
  visit(right_first ? left : right, i, excluded, component, best);
}

}  // namespace spherical_param::internal
