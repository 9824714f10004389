#pragma once

#include "index_loops.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// Sign of the determinant of three directions, exact, and never 0: where they lie in one plane
/// through the centre, as if they had been moved by amounts without end smaller than any, that go
/// by their numbers (H. Edelsbrunner and E. P. Mücke, "Simulation of Simplicity", 1990).
///
/// \param points 3 x n, none zero; \param i, j, k different columns of it.
int orientationOf(const Positions& points, Index i, Index j, Index k);

/// A triangulation of the sphere, some of whose vertices are columns of a list of directions: a
/// closed genus-0 mesh, of which every triangle is counter-clockwise on the sphere and shorter than
/// a half circle. All decisions are exact. Its edges have numbers, in the order of their ends,
/// which the overlay is made of; neither CornerTable nor SphereMesh has edges.
class ArcMesh {
public:
  /// \param points must outlive this. \param triangles 3 x m, columns of `points`.
  ArcMesh(const Positions& points, const Triangles& triangles);

  Index edgeCount() const { return indexCount(edge_corner_); }
  bool isVertex(Index point) const { return corner_at_[point] >= 0; }
  /// Both ends of an edge, as its left triangle has it.
  std::array<Index, 2> ends(Index edge) const;
  /// The corner of the left triangle that is opposite to an edge, as 3 * triangle + corner.
  Index cornerOppositeTo(Index edge) const { return edge_corner_[edge]; }
  Index vertex(Index triangle, Index corner) const {
    return triangles_.data()[3 * triangle + corner];
  }

  /// What an arc from one direction to another meets.
  struct Walk {
    bool lost = false;    ///< it has no end: the triangles do not cover the sphere once
    Index along = -1;     ///< the edge that it is itself
    Index triangle = -1;  ///< that holds its end, unless that is a vertex
  };

  /// Follows the arc from a point to another.
  ///
  /// \param start   triangle that holds `from`; not asked for where that is a vertex.
  /// \param crossed the edges that it crosses, in order, are put behind those that are there.
  Walk walk(Index from, Index to, Index start, std::vector<Index>& crossed) const;

  /// Calls visit(edge, is its left end, other end) for the edges at a vertex, counter-clockwise.
  template <typename Visit>
  void forEachEdgeAt(Index vertex, const Visit& visit) const {
    const Index first = corner_at_[vertex];
    Index corner = first;
    do {
      const Index t = corner / 3;
      const Index k = corner % 3;
      const Index behind = 3 * t + (k + 2) % 3;
      const Index edge = edge_of_[behind];
      visit(edge, ends(edge)[0] == vertex, this->vertex(t, (k + 1) % 3));
      corner = nextAround(corner);
    } while (corner != first);
  }

private:
  /// How an arc leaves the triangles at its beginning.
  struct Exit {
    Walk walk;     ///< if the arc ends there
    Index corner;  ///< else: opposite to the side that the arc crosses; -1: none
  };
  Exit leaveVertex(Index from, Index to) const;
  Exit leaveTriangle(Index triangle, Index from, Index to) const;
  bool leavesBetween(Index from, Index to, Index right, Index left) const;

  /// The corner at the same vertex in the next triangle around it, counter-clockwise.
  Index nextAround(Index corner) const {
    const Index begin = corner - corner % 3;
    const Index next = begin + (corner + 1 - begin) % 3;
    const Index across = across_[next];
    // There the common side begins at the vertex, behind the opposite corner.
    return 3 * (across / 3) + (across % 3 + 1) % 3;
  }

  const Positions& points_;
  const Triangles& triangles_;
  Indexed<Index> across_;       ///< corner opposite to each corner, beyond its side
  Indexed<Index> edge_of_;      ///< the edge opposite to each corner
  Indexed<Index> edge_corner_;  ///< opposite to each edge, in its left triangle
  Indexed<Index> corner_at_;    ///< of each point; -1: no vertex
};

/// Where each of the points from `first` on is on a triangulated sphere; of vertices, in some
/// triangle at them.
///
/// \param points 3 x n, directions, the vertices of the triangles among them.
/// \return n - first places.
/// \throw ComputeError if the triangles do not cover the sphere once.
Indexed<SphereLocation> locateAll(const Positions& points, const Triangles& triangles,
                                  Eigen::Index first);

/// Both of two triangulations of the sphere at once: their vertices, and the points where edges of
/// one cross those of the other. Each face is a part of one triangle of each.
struct SphereOverlay {
  Positions directions;           ///< 3 x w: vertices of the first, others of the second, crossings
  Indexed<SphereLocation> first;  ///< w, places in the first mesh
  Indexed<SphereLocation> second;    ///< w, places in the second mesh
  std::vector<std::size_t> offsets;  ///< faces + 1, positions in `corners`
  std::vector<Index> corners;        ///< of the faces, counter-clockwise; convex, 3 to 6 each
};

/// Lays one triangulation of the sphere over another. Which faces there are is decided exactly.
///
/// \param first, second     3 x a and 3 x b, directions; all triangles counter-clockwise, none as
///                          wide as a half circle.
/// \param partner           b: the vertex of the first that is the same place, with equal
///                          coordinates; -1: none.
/// \throw ComputeError if the triangles do not cover the sphere once. Cost: O(a log a + b log b)
/// and the crossings, typically.
SphereOverlay overlaySpheres(const Positions& first, const Triangles& first_triangles,
                             const Positions& second, const Triangles& second_triangles,
                             const std::vector<Index>& partner, int threads);

}  // namespace spherical_param::internal
