#pragma once

#include "indexed.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"
#include "spherical_param/types.h"
#include "view_mesh.h"

#include <Eigen/Core>

#include <optional>

namespace spherical_param::internal {

/// How a place sees a cloud.
struct Sight {
  /// Fraction of the edges of the view at which the depth jumps: they are longer than 4 times the
  /// smaller spacing of their ends.
  double jumps = 1.0;
  /// Fraction of the points most of whose edges jump, and most of whose neighbours are such points:
  /// jumps form lines, but layers behind each other form areas.
  double layers = 1.0;
  /// Median difference in depth between a point and its neighbours [distance across the rays]: up
  /// to 1 for noisy scans, at least 1.6 for two layers.
  double roughness = 1.0;
  double rough = 1.0;      ///< fraction of the points with a roughness above 0.8
  bool is_around = false;  ///< points are all around the place

  /// Whether the place sees one layer.
  bool isOneLayer() const;
  /// Whether more points are rough than jumps explain: there is noise, or another layer nearby.
  bool isRough() const { return rough > 0.15 + 4.0 * jumps; }
};

/// \param points  3 x n.
/// \param spacing of the points, \see spacingOf.
/// \param view    of these points.
Sight assessView(const Positions& points, const Indexed<double>& spacing, const ViewMesh& view);

/// The mesh of a cloud from the first of some places that sees one layer.
struct FoundView {
  ViewMesh mesh;
  ViewSource source;
  Indexed<double> spacing;  ///< of the points, \see spacingOf
};

/// Looks for a place that sees a cloud as one layer: the viewpoint, the origin, far above an
/// elevation grid, the source of its rays, and far above a low sheet.
///
/// \param points    3 x n, finite, distinct, of an extent about 1.
/// \param viewpoint in the unit of the points; the origin if it is unknown.
/// \param search    among the points.
/// \return nothing if there is none.
/// Cost: O(n log n), with a small constant if there is none.
std::optional<FoundView> findView(const Positions& points, const Eigen::Vector3d& viewpoint,
                                  const NeighborSearch& search, const Execution& execution);

/// Whether the points have one height at each of at least half of the places of a grid in x and y.
bool isElevationGrid(const Positions& points);

/// A place far above points, along an axis.
Eigen::Vector3d farAbove(const Positions& points, const Eigen::Vector3d& axis);

/// Whether the caller gave a place.
bool isGiven(const Options& options);

/// The place that the caller gave, in the unit of nodes.
///
/// \param unit a power of two [unit of the input].
Eigen::Vector3d givenPlace(const Positions& nodes, double unit, const Options& options);

/// The directions of nodes from the place that the caller gave; nothing without a place.
std::optional<Positions> givenDirections(const Positions& nodes, double unit,
                                         const Options& options);

}  // namespace spherical_param::internal
