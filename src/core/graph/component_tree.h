#pragma once

#include "indexed.h"

#include <Eigen/Geometry>

#include <limits>
#include <tuple>
#include <vector>

namespace spherical_param::internal {

/// A k-d tree that finds the nearest point of another component than the query's. It skips subtrees
/// within the query's component, whose points a general search would visit.
class ComponentTree {
public:
  /// Two points of different components; ordered by distance, then by indices, so that ties are
  /// broken consistently.
  struct Pair {
    double squared_distance = std::numeric_limits<double>::infinity();
    Index from = -1;
    Index to = -1;

    bool operator<(const Pair& other) const {
      return std::tuple(squared_distance, from < 0, from, to) <
             std::tuple(other.squared_distance, other.from < 0, other.from, other.to);
    }
  };

  /// \param points 3 x n, finite, n >= 1; must outlive the tree.
  explicit ComponentTree(const Positions& points);

  /// \param component n entries, >= 0: the component of each point. At first, each point is one.
  void setComponents(Indexed<Index> component);

  static constexpr Index kAnyOther = -1;
  /// Finds the nearest point to point i in a component, except those in `excluded`. Replaces `best`
  /// by this pair if it is less.
  void findNearest(Index i, const std::vector<Index>& excluded, Pair& best,
                   Index component = kAnyOther) const {
    visit(nodes_[0], i, excluded, component, best);
  }

private:
  static constexpr Index kLeafSize = 8;
  static constexpr Index kMixed = -1;  ///< component of a node that holds several

  struct Node {
    Eigen::AlignedBox<double, 3> box;
    Index begin = 0;  ///< points order_[begin] ... order_[end - 1]
    Index end = 0;
    Index left = 0;  ///< children left and left + 1; 0: a leaf
    Index component = kMixed;
  };

  void build(Node& node);
  void visit(const Node& node, Index i, const std::vector<Index>& excluded, Index component,
             Pair& best) const;

  const Positions& points_;
  Indexed<Index> order_;
  Indexed<Index> component_;
  Indexed<Node> nodes_;
};

}  // namespace spherical_param::internal
