#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

namespace spherical_param {

/// \addtogroup triangulation
/// @{

/// Delaunay triangulation of points on the sphere (their convex hull): incremental, with exact
/// predicates.
///
/// \param directions 3 x n, unit vectors up to rounding, n >= 4; repetitions allowed.
/// \param execution  progress; the work runs on one thread.
/// \return 3 x (2n - 4), outward on the sphere: closed, manifold, of genus 0, over all points.
/// \throw InvalidInput for n < 4, too many points, or a vector that is not of unit length;
/// Cancelled. Cost: O(n log n), typically.
Triangles triangulateSphere(const Positions& directions, const Execution& execution = {});

/// @}

}  // namespace spherical_param
