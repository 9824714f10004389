#pragma once

#include "indexed.h"
#include "openings.h"
#include "sphere_mesh.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace spherical_param::internal {

/// Decides from its three vertices alone whether a triangle is over an opening of the surface.
class OpenPlaces {
public:
  /// \param points   3 x n, must outlive this.
  /// \param graph    n nodes, of the openings.
  /// \param openings to be left open.
  OpenPlaces(const Positions& points, const Graph& graph, const Openings& openings);

  /// The opening under a triangle, as an index of `openings`, or nothing: its loop is nearest to
  /// most of the vertices.
  std::optional<std::size_t> openingOver(Index a, Index b, Index c) const;

  /// Whether a triangle is over an opening: its vertices are within two steps of loops and not
  /// closed, and a side is longer than edges of the surface.
  bool isOpen(Index a, Index b, Index c) const {
    return nearest_[a] >= 0 && nearest_[b] >= 0 && nearest_[c] >= 0 &&
           (isLong(a, b) || isLong(b, c) || isLong(c, a));
  }

  bool isOpen(const std::array<Index, 3>& corners) const {
    return isOpen(corners[0], corners[1], corners[2]);
  }

  /// Closes vertices that are not in a loop: their triangles belong to the surface. Returns whether
  /// that changes anything.
  bool close(const std::vector<Index>& vertices);

  /// Whether an edge is in the loop around an opening.
  bool isBoundary(Index a, Index b) const;

private:
  bool isLong(Index a, Index b) const;

  const Positions* points_;
  Indexed<Index> nearest_;  ///< opening of the nearest loop; -1: closed, or not within two steps
  Indexed<std::uint8_t> is_in_loop_;
  Indexed<double> spacing_;
  std::vector<std::array<Index, 2>> boundary_edges_;  ///< {lower, higher}, ascending
};

/// Open triangles that no other open triangles connect to a loop: they belong to the surface.
std::vector<Index> trianglesWithoutLoop(const SphereMesh& mesh, const OpenPlaces& openings);

}  // namespace spherical_param::internal
