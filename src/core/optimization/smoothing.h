#pragma once

#include "spherical_param/result.h"

namespace spherical_param {

/// Low-pass filters for noise. With the uniform Laplacian of the mesh (the mean of the neighbours
/// minus the point), whose frequencies k lie in [0, 3/2], each multiplies a part of frequency k by
/// a gain.
enum class SmoothingMethod {
  /// Laplacian smoothing (Zwicker and Gotsman 2004, section 4.2): a step moves each point by a
  /// fraction lambda towards the mean of its neighbours. Gain (1 - lambda k)^steps. Shrinks.
  Umbrella,
  /// The biharmonic flow dx/dt = -L^2 x (the higher order of Desbrun et al. 1999, "Implicit fairing
  /// of irregular meshes using diffusion and curvature flow"), exact in time. Gain 2^-(k / c)^2;
  /// the frequency c of gain one half is that of as many steps of Umbrella with lambda = 1. Removes
  /// as much noise, and hardly shrinks.
  Biharmonic,
};

/// Parameters of smoothSurface().
struct SmoothingOptions {
  SmoothingMethod method = SmoothingMethod::Biharmonic;  ///< the filter
  int steps = 0;  ///< strength, as in section 4.2 of the paper; [0, 10000], 0: none
  /// Finally move all points along their normals by one distance that restores the volume.
  bool restore_volume = true;
};

/// A smoothed surface.
struct Smoothing {
  Positions points;        ///< 3 x n, column i = point i [unit of the input]
  SmoothingReport report;  ///< displacements, volumes
};

/// Smooths the points of a closed mesh. The triangles stay as they are.
///
/// \param points    3 x n, finite. Points without triangles stay where they are. Coordinates should
///                  differ by 1e-90 to 1e90 at most, so that the volume is representable.
/// \param triangles 3 x m, closed, manifold, consistently oriented, any genus and number of pieces.
/// \param options filter, strength
/// \param threads 0: one for each processor; [0, 1024].
/// \return the points, the same, bit by bit, for any number of threads.
/// Cost: O(n) per step of Umbrella; Biharmonic O(n sqrt(steps)), five steps as much as some thirty
/// of Umbrella.
///
/// No guarantees: corners and edges are rounded, and points drift within the surface towards an
/// even spread. A volume near 0 cannot be restored (see volume_after).
Smoothing smoothSurface(const Positions& points, const Triangles& triangles,
                        const SmoothingOptions& options, int threads = 0);

}  // namespace spherical_param
