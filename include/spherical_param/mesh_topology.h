#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace spherical_param {

/// \addtogroup checks
/// @{

/// Combinatorial properties of a triangle mesh.
struct MeshTopology {
  std::size_t vertices = 0;      ///< vertices used by triangles
  std::size_t edges = 0;         ///< undirected edges
  std::size_t triangles = 0;     ///< triangles
  bool closed = false;           ///< not empty, and every edge has at least two triangles
  bool edge_manifold = false;    ///< no edge has more than two triangles, no triangle is degenerate
  bool vertex_manifold = false;  ///< the triangles around each vertex are one fan
  bool oriented = false;         ///< the triangles of each edge traverse it in opposite directions
  std::size_t components = 0;    ///< connected components of triangles (over shared vertices)
  std::size_t boundary_loops = 0;      ///< connected components of the edges with one triangle
  long long euler_characteristic = 0;  ///< V - E + F over the used vertices
  /// Sum of the genera g of the components: V - E + F = 2 components - 2 g - boundary_loops. Unset
  /// unless manifold and oriented.
  std::optional<long long> genus;
  std::vector<Index> nonmanifold_vertices;  ///< their triangles are not one fan; ascending
  std::vector<Index> unused_vertices;       ///< they have no triangles; ascending

  /// Manifold at edges and vertices. \return whether it is
  bool manifold() const { return edge_manifold && vertex_manifold; }
  /// A closed, manifold, consistently oriented sphere in one piece over all vertices.
  /// \return whether it is one
  bool isSphere() const { return isSurface() && closed && genus == 0; }
  /// A sphere with openings: a manifold with boundary and without handles, consistently oriented,
  /// in one piece over all vertices.
  /// \return whether it is one
  bool isOpenSurface() const { return isSurface() && !closed && genus == 0; }
  /// A manifold, closed or with boundary, consistently oriented, in one piece over all vertices.
  /// \return whether it is one
  bool isSurface() const {
    return triangles > 0 && manifold() && oriented && components == 1 && unused_vertices.empty();
  }
};

/// Checks the topology of a mesh from its indices.
///
/// \param triangles    3 x m, any order, m at most 2^30.
/// \param vertex_count vertices are [0, vertex_count).
/// \param threads 0: one for each processor; [0, 1024].
/// \return the same for any number of threads.
/// \throw InvalidInput for an index or threads out of range, or too many triangles. Cost: O(m + n),
/// and memory of 12 m + 8 n bytes.
MeshTopology checkTopology(const Triangles& triangles, std::size_t vertex_count, int threads = 0);

/// Signed volume enclosed by a closed mesh [cubed unit of the input], by the divergence theorem;
/// positive if the triangles are oriented outward. Meaningless for an open mesh.
///
/// \param points 3 x n; \param triangles 3 x m, indices in [0, n).
/// \return the volume; negative if the triangles are oriented inward.
/// \throw InvalidInput for an index out of range.
double signedVolume(const Positions& points, const Triangles& triangles);

/// Sum of the areas of the triangles [squared unit of the input].
///
/// \param points 3 x n
/// \param triangles 3 x m, indices in [0, n).
/// \return the sum.
/// \throw InvalidInput for an index out of range.
double surfaceArea(const Positions& points, const Triangles& triangles);

/// Reverses the orientation of every triangle.
///
/// \param triangles 3 x m, changed in place.
void flipOrientation(Triangles& triangles);

/// @}

}  // namespace spherical_param
