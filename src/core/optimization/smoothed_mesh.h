#pragma once

#include "spherical_param/mesh_optimization.h"
#include "spherical_param/smoothing.h"
#include "spherical_param/types.h"

#include <cstdint>

namespace spherical_param::internal {

/// A mesh and smoothed positions of its points.
struct SmoothedMesh {
  Triangles triangles;     ///< optimised on the smoothed points
  Positions points;        ///< 3 x n
  SmoothingReport report;  ///< with the self-intersections on the smoothed points
};

/// Smooths the points and, with OptimizationMethod::Full, optimises the mesh on the smoothed ones.
/// Where that leaves triangles that intersect, the points are smoothed anew with the better mesh;
/// the best round is returned.
///
/// \param graph     of the points.
/// \param method    of the optimisation.
/// \param seed      of the optimisation.
/// \param execution threads, progress
SmoothedMesh smoothMesh(const Positions& points, const Triangles& triangles, const Graph& graph,
                        const SmoothingOptions& options, OptimizationMethod method,
                        std::uint32_t seed, const Execution& execution);

}  // namespace spherical_param::internal
