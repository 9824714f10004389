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
  std::string fault;                                  ///< why it did not arrive; empty: it did
};

/// The result of moving landmarks.
struct SphereWarp {
  bool is_flipped = false;  ///< a triangle was flipped before, and still is
  double worst = 0.0;       ///< largest distance by which a step missed a landmark's place [rad]
};

/// Moves the vertices of a mesh on the sphere, one to one, such that some come to given places.
///
/// The landmarks move along arcs and carry the sphere with them: in each of many steps every point
/// moves along the tangential field of least norm of Wendland's kernel (1995) of the chord that
/// takes the landmarks on their way. Where a step flips triangles, vertices beside them are moved
/// between their neighbours; a step that leaves a triangle flipped is retried with half the length.
///
/// \param sphere 3 x v, unit vectors; \param triangles closed, manifold, of genus 0.
/// \param landmarks different vertices, different targets; their faults are set.
/// The same, bit by bit, for any number of threads.
SphereWarp moveLandmarks(Positions& sphere, const Triangles& triangles,
                         std::vector<Landmark>& landmarks, int threads,
                         const FractionReport& report);

}  // namespace spherical_param::internal
