#pragma once

#include "spherical_param/types.h"

namespace spherical_param {

/// A triangulation of all points on the sphere, and how it came about.
struct SphereTriangulation {
  Triangles triangles;      ///< 3 x (2n - 4), outward on the sphere: closed, manifold, genus 0
  Index hull_vertices = 0;  ///< points that the convex hull holds as vertices
  Index reinserted = 0;     ///< points that the hull left out, put back: n - hull_vertices
  /// Of these, points at exactly the position of another point.
  Index coincident = 0;
  /// The hull could not be used (flat or inconsistent); all points were inserted one by one.
  bool hull_rejected = false;
};

/// Triangulates unit vectors by their convex hull (Zwicker and Gotsman 2004, section 3), with EVERY
/// point as a vertex.
///
/// The hull is computed by reentrant qhull. Points that it leaves out (coincident, or closer to
/// coplanar than its round-off) are inserted into the triangle or edge that holds them on the
/// sphere, followed by edge flips towards the Delaunay criterion. Splits and flips whose new edge
/// is not there yet keep any closed genus-0 manifold one, so the topology rests neither on
/// qhull nor on rounding.
///
/// \param directions 3 x n, unit vectors up to rounding, n >= 4; repetitions allowed.
/// \throw InvalidInput for n < 4 or a vector that is not of unit length; ComputeError if qhull
/// runs out of memory. Cost: O(n log n), typically.
SphereTriangulation triangulateSphere(const Positions& directions);

}  // namespace spherical_param
