#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/result.h"

namespace spherical_param::internal {

/// Refines the triangles over filled openings to the density around them, and bends them so that
/// they go on as the surface around does (Liepa 2003: Filling holes in meshes). Where they would
/// intersect more than before, they bend less, or stay as they are. The given points stay. So do
/// triangles over an opening that form no disc, and a mesh with a sample of its intersections.
///
/// \param execution threads, progress, time limit: at its end the openings stay flat.
/// \param mesh      manifold, oriented, with its openings and self-intersections. It keeps its
///                  topology and the numbers of its triangles; further ones come last. The same,
///                  bit by bit, for any number of threads.
void fillSmoothly(const Execution& execution, Surface& mesh);

}  // namespace spherical_param::internal
