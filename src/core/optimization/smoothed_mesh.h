#pragma once

#include "mesh_optimization.h"
#include "open_places.h"
#include "smoothing.h"
#include "spherical_param/types.h"

#include <cstdint>

namespace spherical_param::internal {

/// A mesh and smoothed positions of its points.
struct SmoothedMesh {
  Triangles triangles;                     ///< optimised on the smoothed points
  Positions points;                        ///< 3 x n
  SmoothingReport report;                  ///< with the self-intersections on the smoothed points
  std::size_t intersecting_triangles = 0;  ///< of those self-intersections
  bool is_sample = false;                  ///< more triangles may intersect
  bool is_out_of_time = false;             ///< the time limit ended the optimisation early
};

/// Smooths the points and, if wanted, optimises the mesh on the smoothed points if triangles
/// intersect. Smoothing again with the better mesh gains nothing: on 26 clouds and 26
/// noisy clouds, three rounds leave 55,682 self-intersections after 10 steps of smoothing, one
/// round 49,997.
///
/// \param graph     of the points.
/// \param openings  of the surface; nullptr: it is closed.
/// \param optimizes whether the mesh is optimised.
/// \param seed      of the optimisation.
/// \param execution threads, progress
SmoothedMesh smoothMesh(const Positions& points, const Triangles& triangles, const Graph& graph,
                        const OpenPlaces* openings, const SmoothingOptions& options, bool optimizes,
                        std::uint32_t seed, const Execution& execution);

}  // namespace spherical_param::internal
