#pragma once

#include "meshed_cloud.h"
#include "open_surface.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"

namespace spherical_param::internal {

/// Measures, checks and diagnoses a mesh. The result is on nodes and in their unit, \see toInput.
///
/// \param triangles of the mesh that are not over openings.
/// \param is_clean  none of them intersect.
Surface judge(const Positions& points, MeshedCloud mesh, Triangles triangles, bool is_clean,
              const OpenSurface& openings, const Options& options, const Execution& execution);

}  // namespace spherical_param::internal
