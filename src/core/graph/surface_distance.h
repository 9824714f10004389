#pragma once

#include "component_tree.h"
#include "graph.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// Distances to the points that are on surfaces, of those that are on none.
class SurfaceDistance {
public:
  /// \param points 3 x n, n >= 1.
  /// \param agreed n nodes: the edges on which both stars agree. Both must outlive it.
  SurfaceDistance(const Positions& points, const Graph& agreed)
      : points_(points), agreed_(agreed), tree_(points) {}

  /// \param on_surface n entries; not all 0.
  void setSurfaces(const std::vector<char>& on_surface);

  /// The point on a surface that is nearest to point i, which is on none.
  Index nearest(Index i) const;

  /// The distance of point i to the surface in mean lengths of edges there, if that is too far for
  /// noise; or 0.
  double beyondNoise(Index i) const;

  /// How many times longer the edges are at point i than at the nearest surface.
  double coarseness(Index i) const;

private:
  const Positions& points_;
  const Graph& agreed_;
  ComponentTree tree_;
};

}  // namespace spherical_param::internal
