#pragma once

#include "progress.h"
#include "spherical_param/types.h"

#include <string>
#include <vector>

namespace spherical_param::internal {

/// A vertex of a mesh on the sphere, and where it is to go.
struct Landmark {
  Index vertex = 0;
  Eigen::Vector3d target = Eigen::Vector3d::UnitX();  ///< unit vector
};

/// A mesh on the sphere after landmarks have gone to their places.
struct SphereWarp {
  Positions sphere;  ///< 3 x v, unit vectors; those of landmarks that arrived are their targets
  std::vector<std::string> reasons;  ///< of each landmark: why it did not; empty: it arrived
  double worst = 0.0;  ///< largest distance by which a step missed the place of a landmark, before
                       ///< that was put there [rad]
};

/// Number of triangles that are not counter-clockwise on the sphere, by an exact predicate.
Index countFlipped(const Positions& sphere, const Triangles& triangles, int threads);

/// Moves the vertices of a mesh on the sphere, one to one, such that some come to given places.
///
/// The landmarks move along arcs and carry the sphere with them: in each of many steps every point
/// moves along the tangential field of least norm of Wendland's kernel (1995) of the chord that
/// takes the landmarks on their way. Where a step flips triangles all the same, vertices beside
/// them are moved between their neighbours; a step that leaves one flipped is made shorter.
///
/// \param sphere 3 x v, unit vectors; \param triangles closed, manifold, of genus 0.
/// \param landmarks different vertices, different targets.
/// The same, bit by bit, for any number of threads.
SphereWarp moveLandmarks(const Positions& sphere, const Triangles& triangles,
                         const std::vector<Landmark>& landmarks, int threads,
                         const FractionReport& report);

}  // namespace spherical_param::internal
