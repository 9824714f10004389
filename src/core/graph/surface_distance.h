#pragma once

#include "component_tree.h"
#include "graph.h"
#include "indexed.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Distances of other points to the points on surfaces.
class SurfaceDistance {
public:
  /// \param points 3 x n, n >= 1.
  /// \param agreed see agreedGraph(). Both must outlive this.
  SurfaceDistance(const Positions& points, const Graph& agreed)
      : points_(points), agreed_(agreed), tree_(points) {}

  /// \param on_surface n entries; not all 0.
  void setSurfaces(const Indexed<char>& on_surface);

  /// The nearest point on a surface. \param i not on a surface
  Index nearest(Index i) const;

  /// Distance of point i to the surface in mean lengths of edges there; 0 if noise may explain it.
  double beyondNoise(Index i) const;

  /// Length of edges at point i relative to those at the nearest surface.
  double coarseness(Index i) const;

private:
  const Positions& points_;
  const Graph& agreed_;
  ComponentTree tree_;
};

}  // namespace spherical_param::internal
