#pragma once

#include "indexed.h"
#include "sphere_mesh.h"
#include "spherical_param/types.h"
#include "view_mesh.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// The distance of each point to its sixth neighbour.
///
/// \param points 3 x n, n >= 2.
Indexed<double> spacingOf(const Positions& points, const Execution& execution);

/// Opens the mesh of a view where the depth jumps: at sides that are longer than 4 times the
/// smaller spacing of their ends (6 times, if they run more across the rays than along them), or
/// within 5 degrees of the ray and longer than that spacing. The rest is an oriented manifold with
/// boundary.
///
/// The rule is milder for points in pieces of fewer than `min_points` points, and in narrow gaps
/// between surfaces that meet in one point: 6 and 8 times, and a side is no jump if the surface
/// goes straight on at both ends. So the boundaries of scans, which are sampled sparsely, stay.
///
/// \param points  3 x n.
/// \param spacing of the points, \see spacingOf.
/// \param view    of these points.
SphereMesh openJumps(const Positions& points, const Indexed<double>& spacing, const ViewMesh& view,
                     std::size_t min_points);

/// A gap within a surface, and the triangles over it.
struct Gap {
  std::vector<Index> loop;       ///< vertices around it
  std::vector<Index> triangles;  ///< over it
};

/// Which gaps are filled.
struct GapLimits {
  std::size_t small = 0;  ///< edges of gaps that noise makes: short, and without points inside
  std::size_t edges = 0;  ///< of any gaps
};

/// Fills gaps with the triangles that were opened there.
///
/// \return the filled gaps, without small ones.
std::vector<Gap> fillGaps(const Positions& points, const Indexed<double>& spacing,
                          const ViewMesh& view, const GapLimits& most, SphereMesh& mesh);

}  // namespace spherical_param::internal
