#pragma once

#include "graph.h"
#include "indexed.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// What the nodes of a graph stand for.
struct NodeSizes {
  Indexed<double> spacing;  ///< of the points around each
  Indexed<double> points;   ///< how many points each stands for: 1 unless it is virtual
};

/// Nodes at about the same distance from an end of a surface, all joined.
struct Band {
  Index level = 0;     ///< how many bands are nearer to the end
  double girth = 0.0;  ///< its length around [spacing]
  std::vector<Index> nodes;
  std::vector<Index> joined;  ///< the bands beside it
};

/// A surface in bands of 3 spacings, by their distance from an end: a Reeb graph.
///
/// \param start   a node of a component of the graph, which is the surface.
/// \param band_of receives the band of each of its nodes; -1 before.
Indexed<Band> bandsOf(const Graph& graph, const NodeSizes& sizes, Index start,
                      Indexed<Index>& band_of);

/// A step of a way through bands.
struct WayStep {
  Index band;
  double squeeze;  ///< by a sphere, of the surface from the first band to this one: log of a scale
};

/// The way to the band that is squeezed most, from the one from which that is least.
///
/// On a sphere a tube shrinks by a constant factor for each width that it is long, exp(2 pi) for
/// its girth if the map is conformal.
std::vector<WayStep> worstWay(const Indexed<Band>& bands);

}  // namespace spherical_param::internal
