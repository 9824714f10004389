#pragma once

#include "graph.h"
#include "ordered_points.h"
#include "spherical_param/options.h"
#include "tangent_stars.h"

#include <optional>
#include <vector>

namespace spherical_param::internal {

/// Nodes, and a search among them; the search may be empty.
struct SearchedNodes {
  OrderedPoints nodes;
  NeighborSearch search;
};

/// The distinct points of a cloud, or of some of its points, with their neighbours. Without
/// outliers, or for a part, all are found anew: updating them would save little time.
class Neighborhoods {
public:
  /// Finds the neighbours of a cloud's points.
  ///
  /// \param cloud     3 x n.
  /// \param inputs    indices of the points to use, ascending, finite.
  /// \param options   method, k
  /// \param search_of makes the search; if empty, a k-d tree is built.
  /// \param known     the nodes of these points, if they are known already.
  /// \throw InvalidInput for too many points, too large coordinates, or fewer than four distinct
  ///        points.
  Neighborhoods(const Positions& cloud, const std::vector<Index>& inputs, const Options& options,
                const NeighborSearchFactory& search_of, const Execution& execution,
                std::optional<SearchedNodes> known = {});

  /// Finds the stars of all nodes and their agreed graph, unless they are known.
  void findStars(const Execution& execution);
  /// Frees neighbours, stars and agreed graph, which are not needed once there is a graph.
  void release();

  /// Whether these are the neighbourhoods of the given points.
  bool areOf(const std::vector<Index>& inputs) const { return inputs_ == inputs; }
  const Positions& points() const { return nodes_.points; }  ///< 3 x v, of the nodes
  /// The nodes. Their input points are positions in the inputs.
  OrderedPoints& nodes() { return nodes_; }
  const Neighbors& neighbors() const { return neighbors_; }
  const Stars& stars() const { return stars_; }
  Graph& agreed() { return agreed_; }  ///< \see agreedGraph

  /// The inputs of marked nodes. \param marked one entry for each node.
  std::vector<Index> inputsOf(const Indexed<char>& marked) const;
  /// The inputs of each group of nodes, the largest group first, ties by the lowest input.
  /// \param group of each node, in [0, number of nodes); -1: none.
  std::vector<std::vector<Index>> groupInputs(const Indexed<Index>& group) const;

private:
  Indexed<Index> inputs_;
  OrderedPoints nodes_;
  Neighbors neighbors_;
  Stars stars_;
  Graph agreed_;
};

}  // namespace spherical_param::internal
