#pragma once

#include "neighbor_graph.h"
#include "neighbors.h"
#include "ordered_points.h"
#include "spherical_param/options.h"
#include "tangent_stars.h"

#include <vector>

namespace spherical_param::internal {

/// The distinct points of a cloud, or of a subset, with their neighbours. A subset reuses the
/// search structure and the results of the cloud; only nodes beside removed points are processed
/// again.
class Neighborhoods {
public:
  /// Finds the neighbours of a cloud's points.
  ///
  /// \param cloud     3 x n.
  /// \param inputs    indices of the points to use, ascending, finite.
  /// \param options   method, k
  /// \param search_of makes the search; empty: a k-d tree is built.
  /// \throw InvalidInput for too many points, too large coordinates, or fewer than four distinct
  ///        points.
  Neighborhoods(const Positions& cloud, std::vector<Index> inputs, const Options& options,
                const NeighborSearchFactory& search_of, const Execution& execution);
  /// A subset of `all`, which must outlive this.
  Neighborhoods(const Positions& cloud, std::vector<Index> inputs, const Options& options,
                const Neighborhoods& all, const Execution& execution);
  Neighborhoods(const Neighborhoods& other) = delete;  // searches point here
  Neighborhoods& operator=(const Neighborhoods& other) = delete;

  /// Finds the stars of all nodes and their agreed graph, if that is not done.
  void findStars(const Execution& execution);
  /// Frees neighbours and stars, which are not needed once there is a graph.
  void release();

  const Positions& points() const { return nodes_.points; }  ///< 3 x v, of the nodes
  /// The nodes; their input points are positions in inputs().
  OrderedPoints& nodes() { return nodes_; }
  const std::vector<Index>& inputs() const { return inputs_; }
  const Neighbors& neighbors() const { return neighbors_; }
  const Stars& stars() const { return stars_; }
  const Graph& agreed() const { return agreed_; }  ///< \see agreedGraph

  /// The inputs of marked nodes. \param marked one entry for each node.
  std::vector<Index> inputsOf(const std::vector<char>& marked) const;
  /// The inputs of each group of nodes, the largest group first, ties by the lowest input.
  /// \param group of each node, in [0, number of nodes); -1: none.
  std::vector<std::vector<Index>> groupInputs(const std::vector<Index>& group) const;

private:
  std::vector<Index> inputs_;
  OrderedPoints nodes_;
  Neighbors neighbors_;
  Stars stars_;
  Graph agreed_;
  const Neighborhoods* all_ = nullptr;
  NodeSubset subset_;  ///< of `all_`
};

}  // namespace spherical_param::internal
