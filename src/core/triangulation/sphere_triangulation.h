#pragma once

#include "spherical_param/options.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param {

/// \addtogroup triangulation
/// @{

/// How a triangulation of the sphere came about.
struct TriangulationReport {
  Index hull_vertices = 0;  ///< points that the method holds as vertices by itself
  Index reinserted = 0;     ///< points that it left out, put back: n - hull_vertices
  /// Points at exactly the position of another point (within rounding for
  /// TriangulationMethod::Incremental).
  Index coincident = 0;
  /// The hull could not be used (flat or inconsistent); all points were inserted one by one.
  bool hull_rejected = false;
};

/// A triangulation of all points on the sphere.
struct SphereTriangulation {
  Triangles triangles;         ///< 3 x (2n - 4), outward on the sphere: closed, manifold, genus 0
  TriangulationReport report;  ///< how it came about
};

/// Triangulates unit vectors, with EVERY point as a vertex: by their convex hull (Zwicker and
/// Gotsman 2004, section 3), which is their Delaunay triangulation on the sphere.
///
/// Incremental: the points are seen stereographically from one of them, their coordinates in the
/// plane rounded to doubles, and inserted one after the other with flips towards the Delaunay
/// criterion (C. L. Lawson, 1977). From the rounding on, which is about that of the unit vectors
/// themselves, all decisions are exact: every point that is distinct in the plane is a vertex by
/// construction, however dense a cluster, and but for ties the order of the points does not
/// matter. Points that coincide are put beside the first of them, and share its triangles. Takes
/// 2^29 points, some 100 bytes each. On uniform random points more than ten times faster than
/// qhull.
///
/// Qhull: the hull is computed by reentrant qhull. Points that it leaves out (coincident, or closer
/// to coplanar than its round-off) are inserted into the triangle or edge that holds them on the
/// sphere, followed by edge flips towards the Delaunay criterion. Splits and flips whose new edge
/// is not there yet keep any closed genus-0 manifold one, so the topology rests neither on
/// qhull nor on rounding.
///
/// \param directions 3 x n, unit vectors up to rounding, n >= 4; repetitions allowed.
/// \param method     how
/// \param execution  progress; both methods work on one thread.
/// \return the triangles, and how they came about.
/// \throw InvalidInput for n < 4, too many points, or a vector that is not of unit length;
/// ComputeError if qhull runs out of memory; Cancelled. Cost: O(n log n), typically.
SphereTriangulation triangulateSphere(const Positions& directions, TriangulationMethod method,
                                      const Execution& execution = {});

/// @}

}  // namespace spherical_param
