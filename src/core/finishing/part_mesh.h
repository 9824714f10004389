#pragma once

#include "embedding.h"
#include "intersecting_pairs.h"
#include "mesh_optimization.h"
#include "open_surface.h"
#include "sphere_mesh.h"
#include "spherical_param/self_intersection.h"

#include <cstddef>
#include <optional>

namespace spherical_param::internal {

/// A mesh of a part, from its first triangles to the last change. Vertices are nodes, in the unit
/// of the nodes.
struct PartMesh {
  SphereMesh mesh;
  OpenSurface openings;                      ///< of the surface, and which of them are left open
  Positions smoothed;                        ///< 3 x n; empty without smoothing
  std::optional<SmoothingReport> smoothing;  ///< unset without smoothing
  Embedding embedding;  ///< without directions if it was not needed, or there is none
  OptimizationReport optimization;
  IntersectingPairs intersecting;           ///< triangles of the surface
  std::size_t left_out_triangles = 0;       ///< because they intersect
  bool has_certain_triangles_only = false;  ///< see Surface
  std::size_t cut_handles = 0;              ///< certain handles of the cloud that are not wanted
  std::size_t possible_handles = 0;         ///< of the faces of the graph alone

  bool isSmoothed() const { return smoothed.cols() > 0; }
  /// \see Surface::isUsable
  bool isUsable() const {
    return !intersecting.is_sample &&
           100 * countTriangles(intersecting.pairs) <= mesh.surfaceCount();
  }
};

}  // namespace spherical_param::internal
