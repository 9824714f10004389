#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param {

/// \addtogroup morphing
/// @{

/// A pair of corresponding vertices of two meshes.
struct PointPair {
  Index first = 0;   ///< vertex of the first mesh
  Index second = 0;  ///< vertex of the second mesh
};

/// Which sphere mesh carries both shapes of a morph.
enum class MorphConnectivity {
  /// Both triangulations of the sphere at once: the vertices of both meshes, and those where their
  /// edges cross. Each in-between is exact at both ends: every triangle is part of one of the first
  /// mesh, and of one of the second.
  AllVertices,
  /// A geodesic sphere of MorphOptions::samples vertices; the nearest vertex moves to each pair.
  Resampled,
};

/// Parameters of Morph.
struct MorphOptions : Execution {
  /// Find the best rotation of one sphere against the other: the least mean squared distance
  /// between both surfaces, each centred and scaled to the same area; with pairs, plus the mean
  /// squared distance of their places on the sphere. false: the maps as they are.
  bool align = true;
  std::vector<PointPair> pairs;  ///< honoured exactly or reported as impossible; at most 4096
  MorphConnectivity connectivity = MorphConnectivity::AllVertices;  ///< of the in-betweens
  std::size_t samples = 40962;  ///< of MorphConnectivity::Resampled, about; [12, 2^24]
};

/// A pair that cannot be honoured.
struct ImpossiblePair {
  std::size_t pair = 0;  ///< index in MorphOptions::pairs
  std::string reason;    ///< one sentence
};

/// Two shapes on one mesh.
struct MorphResult {
  Triangles triangles;  ///< 3 x m: manifold, genus 0, outward; closed if both surfaces are
  Positions first;      ///< 3 x w, the first shape at the vertices [its unit]
  Positions second;     ///< 3 x w, the second shape at the vertices [its unit]
  Positions sphere;     ///< 3 x w, unit vectors: directions on the first sphere
  std::vector<SphereLocation> first_places;   ///< w, of the vertices in the first mesh
  std::vector<SphereLocation> second_places;  ///< w, of the vertices in the second mesh
  /// On the second sphere, before the pairs are honoured, R u is what u is on the first.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  /// Mean squared distance of both surfaces, each centred and scaled to area 1, as rotated.
  double alignment_error = 0.0;
  std::vector<ImpossiblePair> impossible;  ///< left out; empty if all pairs are honoured
  /// Largest distance on the sphere between the places of an honoured pair at the end of the
  /// motion, before they become one [rad].
  double worst_pair = 0.0;
};

/// Puts two genus-0 surfaces on one mesh, by their maps to the sphere (Zwicker and Gotsman 2004,
/// section 5). Openings of either surface are openings of the mesh.
///
/// Pairs are honoured by a smooth one-to-one motion of the sphere: landmarks move along arcs with
/// their surroundings. A pair is impossible if its vertices are out of range, if one of them has
/// another partner in an earlier pair, or if no motion takes it to its place while others stay
/// apart. With SurfaceFit::Linear the first and the second shape are the two meshes, cut along each
/// other's edges.
///
/// \param first surface at the beginning, with its map.
/// \param second surface at the end, with its map.
/// \param options alignment, pairs, connectivity, threads, progress
/// \return both shapes on the triangles of one sphere, and how well they fit.
/// \throw InvalidInput for options out of range; ComputeError if the rounding of a rotation makes a
/// map lose its one-to-one property; Cancelled.
/// The same, bit by bit, for any number of threads.
MorphResult morphSurfaces(const SphereSurface& first, const SphereSurface& second,
                          const MorphOptions& options = {});

/// Vertices of the in-between at t: (1 - t) first + t second.
///
/// \param morph of morphSurfaces().
/// \param t     any finite number; [0, 1] lies between.
/// \return 3 x w, for MorphResult::triangles.
Positions inBetween(const MorphResult& morph, double t);

/// @}

}  // namespace spherical_param
