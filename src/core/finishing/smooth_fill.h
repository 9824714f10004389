#pragma once

#include "intersecting_pairs.h"
#include "spherical_param/result.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// A mesh as it is written, in the unit and with the vertices of the stage that made it.
struct FinishedMesh {
  Positions points;  ///< 3 x v, consolidated and smoothed if that was asked for
  Triangles triangles;
  std::vector<Opening> openings;  ///< with the triangles over filled ones
  IntersectingPairs intersecting;
  std::vector<Index> input_of_vertex;  ///< v entries
  std::size_t added_vertices = 0;      ///< they come last
  std::size_t smoothly_filled = 0;     ///< openings that have them
  FacedBy faced_by = FacedBy::Outward;
  bool is_out_of_time = false;
};

/// Refines the triangles over filled openings to the density around them, and bends them so that
/// they go on as the surface around does (Liepa 2003: Filling holes in meshes). Where they would
/// intersect more than before, they bend less, or stay as they are. The given points stay. So do
/// triangles over an opening that form no disc, and a mesh with a sample of its intersections.
///
/// \param execution threads, progress, time limit: at its end the openings stay flat.
/// \param mesh      manifold, oriented. It keeps its topology and the numbers of its triangles;
///                  further ones come last. The same, bit by bit, for any number of threads.
void fillSmoothly(const Execution& execution, FinishedMesh& mesh);

}  // namespace spherical_param::internal
