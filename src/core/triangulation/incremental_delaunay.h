#pragma once

#include "progress.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// The Delaunay triangulation of points on the sphere, and the points that it could not
/// distinguish.
struct SphereDelaunay {
  Triangles triangles;  ///< 3 x (2n - 4), outward on the sphere: closed, manifold, genus 0
  /// Points at the place of another one, beside which they were put.
  Index coincident = 0;
};

/// Most points that incrementalDelaunay() takes: sides of triangles are numbered in 32 bits.
constexpr Index kMaxDelaunayPoints = Index{1} << 29;

/// Triangulates points on the sphere by inserting one after the other into the triangle that holds
/// it, with edge flips until all triangles around it are Delaunay (C. L. Lawson, 1977).
///
/// One of the points is the pole. The others are seen from it stereographically in a plane, where a
/// circle on the sphere is a circle again, or a line if it goes through the pole: the Delaunay
/// triangulation on the sphere is that of the plane, with the pole as its vertex at infinity. The
/// coordinates in the plane are rounded once, about as much as those of a unit vector are; from
/// then on every decision is exact. So the triangulation is that of the rounded points, whatever
/// their order, but for ties: where four or more lie on one circle, each choice is right. Points
/// that coincide in the plane share the triangles of the first of them evenly, as vertices of
/// their own.
///
/// \param directions 3 x n, unit vectors up to rounding, 4 <= n <= kMaxDelaunayPoints.
/// \param report     called with the fraction that is done.
/// Cost: O(n log n) expected, about 100 bytes a point.
SphereDelaunay incrementalDelaunay(const Positions& directions, const FractionReport& report = {});

}  // namespace spherical_param::internal
