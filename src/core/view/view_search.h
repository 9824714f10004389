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
  /// Share of the edges of the view that are longer than 4 times the smaller spacing of their ends:
  /// the depth jumps there.
  double jumps = 1.0;
  /// Share of the points most of whose edges jump, as those of most of their neighbours: jumps are
  /// lines, but layers behind each other are areas.
  double layers = 1.0;
  /// Median difference in depth of a point from its neighbours, in distances across the rays: up to
  /// 1 of noisy scans, from 1.6 on of two layers, however coarse.
  double roughness = 1.0;
  double rough = 1.0;      ///< share of the points where it is above 0.8
  bool is_around = false;  ///< points are all around the place

  /// Whether the place sees one layer.
  bool isOneLayer() const;
  /// Whether more is rough than jumps explain: there is noise, or another layer near by.
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

/// Looks for a place that sees a cloud as one layer: the viewpoint, the origin, far above a low
/// sheet, and the place where its rays come from.
///
/// \param points    3 x n, finite, distinct, of an extent about 1.
/// \param viewpoint in the unit of the points; the origin if it is unknown.
/// \param search    among the points.
/// \return nothing if there is none.
/// Cost: where there is none, 10 to 50 ms and O(n log n) with a small constant.
std::optional<FoundView> findView(const Positions& points, const Eigen::Vector3d& viewpoint,
                                  const NeighborSearch& search, const Execution& execution);

/// Whether the points are the heights of at least half of the places of a grid in x and y: a
/// surface without jumps.
bool isElevationGrid(const Positions& points);

/// A place far above points, along an axis.
Eigen::Vector3d farAbove(const Positions& points, const Eigen::Vector3d& axis);

/// Whether the caller gave a place.
bool isGiven(const Options& options);

/// The place that the caller gave, in the unit of nodes.
///
/// \param unit a power of two [unit of the input].
Eigen::Vector3d givenPlace(const Positions& nodes, double unit, const Options& options);

/// The directions of nodes from the place that the caller gave; none if there is none.
std::optional<Positions> givenDirections(const Positions& nodes, double unit,
                                         const Options& options);

}  // namespace spherical_param::internal
