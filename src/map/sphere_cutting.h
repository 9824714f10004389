#pragma once

#include "indexed.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// The planes through the centre of the sphere that charts are cut along: x, y, z, x - y, x + y,
/// x - z, x + z, y - z, y + z = 0. Their combinations of coordinates have exact signs in doubles.
inline constexpr int kCutPlanes = 9;

/// On which side of each of the planes a direction is: 1, 0 or -1.
using PlaneSigns = std::array<std::int8_t, kCutPlanes>;

PlaneSigns planeSigns(const Eigen::Vector3d& direction);

/// A side of a cell: the plane, and the sign that directions of the cell have there, or 0.
struct CellSide {
  int plane = 0;
  int sign = 1;
};

/// The convex cones that make up the sphere in a chart. Two of them share a whole side, an edge
/// from the centre, or the centre alone.
using SphereCells = Indexed<std::vector<CellSide>>;

bool isInCell(const PlaneSigns& signs, const std::vector<CellSide>& cell);

/// A mesh on the sphere in which each triangle is in one cell.
struct CutSphere {
  Indexed<CutVertex> vertices;      ///< the first are those of the mesh
  Indexed<Eigen::Vector3d> points;  ///< in the flat triangles of the mesh, not of unit length
  Indexed<std::array<Index, 3>> triangles;  ///< outward
  Indexed<Index> cells;                     ///< the cell of each triangle
  Indexed<Index> source;                    ///< triangle of the mesh that each is a part of
};

/// Cuts a mesh on the sphere along the sides of cells.
///
/// A great circle is a straight line in the flat triangle below one on the sphere, and a part of a
/// triangle in a convex cone is a convex polygon. Exact signs of the mesh's corners alone decide on
/// which side of a plane a point is, also a new one. So the result is closed whatever the
/// triangles, and a point on an edge is the same for both of its triangles.
///
/// \param triangles 3 x m, a closed sphere; \param sphere 3 x v; no triangle is flipped.
/// \param apex if >= 0: a polygon with a corner where the signs of all planes up to this one are 0
///             is cut into triangles from that corner.
CutSphere cutSphere(const Triangles& triangles, const Positions& sphere, const SphereCells& cells,
                    int apex = -1);

}  // namespace spherical_param::internal
