#pragma once

#include "meshed_cloud.h"
#include "open_mesh.h"
#include "spherical_param/execution.h"
#include "spherical_param/options.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <optional>

namespace spherical_param::internal {

/// Whether triangles that intersect are taken apart.
bool removesIntersections(const Options& options);

/// Removes the intersections of a mesh for good, if the options say so and time is left. The first
/// of these that leaves none:
///
/// 1. clearIntersections(), of at most 0.2 % of the points and 1 % of the triangles;
/// 2. leaveOutTangles(), of at most a tenth of the triangles;
/// 3. the faces of the graph become the mesh, without those that intersect, if a third of the
///    points is in it. Not for smoothed points.
///
/// A closed surface (SurfaceMode::Closed) loses no triangles.
///
/// \param points  nodes.
/// \param is_open the surface has openings, \see MeshedCloud::optimization of those without.
/// \param mesh    after 3. with triangles that are certain only.
/// \param open    the mesh and its openings. Unchanged if triangles still intersect.
/// \return the number of triangles that were left out because they intersect; nothing if some still
///         do.
std::optional<std::size_t> cleanMesh(const Positions& points, bool is_open, const Options& options,
                                     const Execution& execution, MeshedCloud& mesh, OpenMesh& open);

}  // namespace spherical_param::internal
