#pragma once

#include "corner_table.h"
#include "index_loops.h"
#include "spherical_param/types.h"

#include <array>

namespace spherical_param::internal {

/// A surface through the vertices of a closed mesh: over the tangent plane of each vertex a
/// quadratic height field through it, fitted to its neighbours (after M. Zwicker, M. Pauly, O.
/// Knoll and M. Gross: "Pointshop 3D", 2002, section 4); over a triangle those of its corners are
/// blended. The weights along an edge are those of its ends alone, so that the surface has no gaps.
/// A quadric counts as far as it fits: at sharp edges, what is left is the triangles.
class VertexQuadrics {
public:
  /// All must outlive the quadrics. \param normals 3 x v, unit vectors.
  VertexQuadrics(const Positions& points, const Triangles& triangles, const Positions& normals,
                 const CornerTable& corners, int threads);

  struct Point {
    Eigen::Vector3d position;
    Eigen::Vector3d normal;  ///< of any length, also zero where those of the corners cancel
  };

  /// \param weights >= 0, sum 1.
  Point at(Index triangle, const Eigen::Vector3d& weights) const;

private:
  /// In the tangent plane, in units of `size`: z = c0 x + c1 y + c2 x^2 + c3 x y + c4 y^2.
  struct Quadric {
    std::array<double, 5> coefficients{};
    double size = 0.0;         ///< mean length of the edges [unit of the input]
    double reliability = 0.0;  ///< in [0, 1]
  };

  Quadric fit(Index vertex, const CornerTable& corners, Indexed<Index>& around) const;

  const Positions& points_;
  const Triangles& triangles_;
  const Positions& normals_;
  Indexed<Quadric> quadrics_;
};

}  // namespace spherical_param::internal
