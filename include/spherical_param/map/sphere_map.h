#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param {

/// \addtogroup sphere_map
/// @{

/// A quantity over the triangles of a mesh, each weighted by its area in space.
struct DistortionStatistics {
  double mean = 0.0;  ///< weighted mean
  double p95 = 0.0;   ///< least value that 95 % of the area do not exceed
  double max = 0.0;   ///< over all triangles
};

/// Distortion of a map from a mesh to the unit sphere. For angles, sigma_1 >= sigma_2 are the
/// singular values of the linear map from a triangle to the flat triangle between its corners on
/// the sphere. For areas, r is the triangle's fraction of the sphere over its fraction of the
/// surface in space.
struct MapDistortion {
  /// Triangles whose corners are not counter-clockwise seen from outside the sphere: det(a, b, c)
  /// <= 0, by an exact predicate. 0: the map is one to one.
  Index flipped_triangles = 0;
  /// Triangles without area in space, within rounding; not in the statistics.
  Index degenerate_triangles = 0;
  DistortionStatistics angle;  ///< sigma_1 / sigma_2; 1: conformal
  DistortionStatistics area;   ///< max(r, 1 / r); 1: equal areas
  /// Absolute difference of the angles at the corners, as in Choi, Lam and Lui 2015; the mean over
  /// all corners, unweighted [degree].
  double mean_angle_difference = 0.0;
  /// L2 stretch efficiency of Praun and Hoppe 2003 (after Sander et al. 2001), in (0, 1]; 1: no
  /// stretch. Computed without their subdivision of triangles.
  double stretch_efficiency = 0.0;
};

/// Measures a map to the sphere.
///
/// \param points    3 x v, the mesh in space; \param sphere 3 x v, unit vectors.
/// \param triangles 3 x m.
/// \param threads   0: one for each processor; [0, 1024]
/// \return flips, distortion of angles and areas, stretch.
/// \throw InvalidInput for sizes that do not match or an index out of range. Cost: O(m log m).
MapDistortion measureMapDistortion(const Positions& points, const Triangles& triangles,
                                   const Positions& sphere, int threads = 0);

/// Parameters of computeSphereMap().
struct SphereMapOptions : Execution {
  /// Weight of area against angle in the energy, in [0, 1]; 0: as conformal as possible, 1: as
  /// area-preserving as a one-to-one map can be.
  double area_weight = 0.85;
  /// Maximum number of sweeps over the vertices of each level; [0, 1000]. 0: only a valid map.
  int sweeps = 15;
};

/// One level of the hierarchy of meshes, finest first.
struct SphereMapLevel {
  std::size_t vertices = 0;  ///< of the level's mesh
  int sweeps = 0;            ///< that were made
  double energy = 0.0;       ///< mean energy per unit of area after them
};

/// A map from a genus-0 mesh to the unit sphere that is one to one.
struct SphereMap {
  Positions sphere;  ///< 3 x v, unit vectors
  Positions caps;    ///< 3 x c, unit vectors: vertices inside the openings; empty for a closed mesh
  MapDistortion distortion;            ///< of `sphere`
  MapDistortion before;                ///< of the start that was given; 0 without one
  std::vector<SphereMapLevel> levels;  ///< finest first
};

/// Makes a map of low distortion from a mesh to the sphere that is one to one: no triangle is
/// flipped.
///
/// \param points    3 x v, finite, 4 <= v <= 2^28 [unit of the input].
/// \param triangles manifold, consistently oriented outward, of genus 0, in one piece, every vertex
///                  used; with openings or, as 3 x (2v - 4), without.
/// \param start     3 x v, unit vectors: the embedding; it gives the map its orientation in space,
///                  and may have flipped triangles. Or 3 x 0.
/// \param options areas against angles, sweeps, threads, progress
/// \return the map, and how good it is.
/// \throw InvalidInput for an invalid mesh or start; ComputeError; Cancelled.
///
/// The openings of a mesh are closed by caps, discs in rings whose vertices are between the loop
/// and its centroid, and so they stay open on the sphere. The distortion is that of the mesh only.
///
/// Coarse to fine over a hierarchy of the mesh, after E. Praun and H. Hoppe (2003): vertices are
/// taken out one by one until a tetrahedron is left, and put back into the kernels of their rings
/// on the sphere, where they are moved to where the distortion is least: MIPS (K. Hormann and
/// G. Greiner, 2000) for the angles, r + 1 / r and |log r| for the areas. Triangles without an
/// area, or of less than a millionth of the mean, are given that much on the sphere.
///
/// The same, bit by bit, for any number of threads. Cost: O(v log v).
SphereMap computeSphereMap(const Positions& points, const Triangles& triangles,
                           const Positions& start, const SphereMapOptions& options = {});

/// @}

}  // namespace spherical_param
