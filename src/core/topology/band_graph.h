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

/// A way through bands, with how much a sphere squeezes the surface on it.
struct SqueezedWay {
  std::vector<Index> bands;
  std::vector<double> squeeze;  ///< from the first band to each: logarithm of a scale
};

/// A surface in bands of 3 spacings, by their distance from an end: a Reeb graph.
///
/// On a sphere a tube shrinks by a constant factor for each width that it is long, exp(2 pi) for
/// its girth if the map is conformal.
class BandGraph {
public:
  /// Of a component of a graph.
  ///
  /// \param start   a node of it.
  /// \param band_of receives the band of each of its nodes; -1 before.
  BandGraph(const Graph& graph, const NodeSizes& sizes, Index start, Indexed<Index>& band_of);

  const Indexed<Band>& bands() const { return bands_; }
  /// To the band that is squeezed most, from the one from which that is least.
  SqueezedWay worstWay() const;

private:
  void findBands(const std::vector<Index>& nodes, const Indexed<double>& distance);
  void joinBands(const std::vector<Index>& nodes);
  double squeezeBetween(const Band& from, const Band& to) const;
  SqueezedWay worstWayFrom(Index root) const;

  const Graph& graph_;
  const NodeSizes& sizes_;
  Indexed<Index>& band_of_;
  Indexed<Band> bands_;
};

}  // namespace spherical_param::internal
