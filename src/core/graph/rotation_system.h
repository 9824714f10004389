#pragma once

#include "graph.h"
#include "indexed.h"
#include "rows.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Longer edges are not on the surface [larger spacing of their ends].
inline constexpr double kMaxEdgeLength = 1.5;

/// The spacing of each node. \see nodeSpacing
Indexed<double> nodeSpacings(const Graph& graph, int threads);

/// The short edges of a neighbour graph that do not cross, sorted around the normal of each node.
///
/// 1. Drop edges longer than 1.5 times the larger spacing of their ends.
/// 2. Fit a plane to the directions to the neighbours within two steps, and orient the normals,
///    along edges between similar normals first (Hoppe et al. 1992).
/// 3. Drop the longer of two crossing edges, and edges that are steep to a plane and join different
///    normals.
class RotationSystem {
public:
  /// \param points  3 x n, must outlive this.
  /// \param spacing of each node.
  RotationSystem(const Positions& points, const Graph& graph, const Indexed<double>& spacing,
                 int threads);

  int threads() const { return threads_; }
  /// The neighbours of each node, counter-clockwise.
  const NeighborRows& edges() const { return edges_; }
  /// Leaves out the edges between opposite sheets.
  void separateOpposite();
  /// Whether an edge joins two sheets: it is steep to one of them, and their normals differ.
  bool leavesSheet(Index v, Index w) const;
  /// Whether some edges of a graph join opposite sheets.
  bool hasOpposite(const Graph& graph) const;
  /// Whether the surface has only one side: many edges join normals to opposite sides, although
  /// paths around these edges turn no normal over.
  bool isOneSided() const;

  /// The loops of the faces with at least `min_steps` edges and a mean corner of at least
  /// `min_corner` [rad]; the face is on the left, seen from outside.
  NeighborRows faces(std::size_t min_steps, double min_corner) const;

private:
  /// The entry of w in the row of v.
  std::size_t entryOf(Index v, Index w) const;
  /// Cosine between the normals of two nodes.
  double cosine(Index v, Index w) const { return normals_.col(v).dot(normals_.col(w)); }
  /// Whether the edge of v and w is longer than that of a and b; a tie goes to the higher node.
  bool isLonger(Index v, Index w, Index a, Index b) const;
  template <typename Condition>
  void keepEdges(const Condition& meets);
  bool areOpposite(Index v, Index w) const;
  bool isTwisted(Index v, Index w) const;
  bool isInGap(Index v, Index w) const;
  double slope(Index v, Index w) const;
  bool areJoined(Index v, Index w) const { return edges_.row(v).contains(w); }
  std::vector<char> longerOfCrossing() const;
  bool doCross(Index v, Index w, Index a, Index b) const;
  Eigen::Vector3d direction(Index v, Index w) const;
  void findNormals();
  void orientNormals();
  void sortAround();

  const Positions& points_;
  int threads_;
  NeighborRows edges_;
  std::vector<double> angles_;  ///< of the edges
  Positions normals_;
  bool separates_opposite_ = false;
};

}  // namespace spherical_param::internal
