#pragma once

#include "progress.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// The Delaunay triangulation of points on the sphere.
struct SphereDelaunay {
  Triangles triangles;  ///< 3 x (2n - 4), outward on the sphere: closed, manifold, genus 0
  /// Points at the place of another point; they share its triangles.
  Index coincident = 0;
};

/// Triangulates points on the sphere by inserting each into the triangle that contains it, with
/// edge flips until all triangles around it are Delaunay (C. L. Lawson, 1977).
///
/// One point is the pole. Stereographic projection from it maps the others to a plane, and circles
/// on the sphere to circles or lines: the Delaunay triangulation of the sphere is that of the
/// plane, with the pole at infinity. The coordinates in the plane are rounded once, about as much
/// as those of a unit vector; then every decision is exact. The result does not depend on the order
/// of the points, except for four or more points on one circle. Points that coincide in the plane
/// share the triangles of the first of them evenly.
///
/// \param directions 3 x n, unit vectors up to rounding, 4 <= n <= 2^29: some 2n triangles are
///                   numbered in 31 bits.
/// \param report     called with the fraction that is done.
/// Cost: O(n log n) expected, about 100 bytes a point.
SphereDelaunay incrementalDelaunay(const Positions& directions, const FractionReport& report = {});

}  // namespace spherical_param::internal
