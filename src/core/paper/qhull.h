#pragma once

#include "spherical_param/types.h"

namespace spherical_param::internal {

/// The convex hull of points, by reentrant qhull.
///
/// \param points 3 x n, n >= 4.
/// \return its triangles, outward: closed, manifold, of genus 0 over all points; none if qhull
/// fails on them or leaves points out.
/// \throw ComputeError if qhull runs out of memory.
Triangles hullByQhull(const Positions& points);

}  // namespace spherical_param::internal
