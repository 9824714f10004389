#pragma once

#include "spherical_param/options.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param {

/// \addtogroup triangulation
/// @{

/// Report of a triangulation of the sphere.
struct TriangulationReport {
  Index hull_vertices = 0;  ///< vertices found by the method itself
  Index reinserted = 0;     ///< points inserted afterwards: n - hull_vertices
  /// Points at the position of another point (within rounding for
  /// TriangulationMethod::Incremental).
  Index coincident = 0;
  /// The hull was unusable (flat or inconsistent); all points were inserted one by one.
  bool hull_rejected = false;
};

/// A triangulation of all points on the sphere.
struct SphereTriangulation {
  Triangles triangles;         ///< 3 x (2n - 4), outward on the sphere: closed, manifold, genus 0
  TriangulationReport report;  ///< figures of the method
};

/// Triangulates unit vectors, with EVERY point as a vertex: by their convex hull (Zwicker and
/// Gotsman 2004, section 3), which is their Delaunay triangulation on the sphere.
///
/// Incremental: \see internal::incrementalDelaunay. Takes 2^29 points, some 100 bytes each. On
/// uniform random points more than ten times faster than qhull.
///
/// Qhull: the hull is computed by reentrant qhull. Points that it leaves out (coincident, or
/// coplanar within its round-off) are inserted into the triangle or edge that contains them on the
/// sphere, followed by edge flips towards the Delaunay criterion. Splits, and flips to a new edge,
/// keep a closed genus-0 manifold, so the topology depends neither on qhull nor on rounding.
///
/// \param directions 3 x n, unit vectors up to rounding, n >= 4; repetitions allowed.
/// \param method     Incremental or Qhull
/// \param execution  progress; both methods run on one thread.
/// \return the triangles and the report.
/// \throw InvalidInput for n < 4, too many points, or a vector that is not of unit length;
/// ComputeError if qhull runs out of memory; Cancelled. Cost: O(n log n), typically.
SphereTriangulation triangulateSphere(const Positions& directions, TriangulationMethod method,
                                      const Execution& execution = {});

/// @}

}  // namespace spherical_param
