#include "band_graph.h"

#include "pi.h"
#include "shortest_paths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Width of a band [spacing].
constexpr double kBandWidth = 3.0;
/// Area of a point [squared spacing]: that of a triangular lattice.
constexpr double kAreaOfPoint = 0.866;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// The nodes of a component by ascending distance from one of them.
///
/// \param distance infinite before [spacing].
std::vector<Index> byDistance(const Graph& graph, const NodeSizes& sizes, Index start,
                              Indexed<double>& distance) {
  return shortestPaths(start, distance, [&](Index v, const auto& go) {
    for (const std::size_t e : graph.entries(v)) {
      const Index w = graph.neighbors[e];
      if (distance[w] <= distance[v])
        continue;  // saves the division
      const double spacing = (sizes.spacing[v] + sizes.spacing[w]) / 2.0;
      go(w, spacing > 0.0 ? graph.lengths[e] / spacing : 1.0);
    }
  });
}

}  // namespace

BandGraph::BandGraph(const Graph& graph, const NodeSizes& sizes, Index start,
                     Indexed<Index>& band_of)
    : graph_(graph), sizes_(sizes), band_of_(band_of) {
  Indexed<double> distance(graph.size(), kFar);
  std::vector<Index> nodes = byDistance(graph, sizes, start, distance);
  const Index end = nodes.back();
  for (const Index v : nodes)
    distance[v] = kFar;
  nodes = byDistance(graph, sizes, end, distance);
  findBands(nodes, distance);
  joinBands(nodes);
}

void BandGraph::findBands(const std::vector<Index>& nodes, const Indexed<double>& distance) {
  const auto level = [&](Index v) { return static_cast<Index>(distance[v] / kBandWidth); };
  for (const Index v : nodes) {
    if (band_of_[v] >= 0)
      continue;
    Band band;
    band.level = level(v);
    band.nodes.push_back(v);
    band_of_[v] = bands_.count();
    double points = 0.0;
    for (std::size_t i = 0; i < band.nodes.size(); ++i) {
      points += sizes_.points[band.nodes[i]];
      for (const Index w : graph_.row(band.nodes[i]))
        if (band_of_[w] < 0 && level(w) == band.level) {
          band_of_[w] = bands_.count();
          band.nodes.push_back(w);
        }
    }
    band.girth = kAreaOfPoint * points / kBandWidth;
    bands_.push_back(std::move(band));
  }
}

void BandGraph::joinBands(const std::vector<Index>& nodes) {
  for (const Index v : nodes)
    for (const Index w : graph_.row(v)) {
      std::vector<Index>& joined = bands_[band_of_[v]].joined;
      if (band_of_[w] != band_of_[v] && (joined.empty() || joined.back() != band_of_[w]))
        joined.push_back(band_of_[w]);
    }
  for (Band& band : bands_)
    sortUnique(band.joined);
}

double BandGraph::squeezeBetween(const Band& from, const Band& to) const {
  // The tip of a limb may be as narrow as it is sampled.
  if (to.joined.size() < 2)
    return 0.0;
  const double way = kBandWidth * std::abs(to.level - from.level);
  const double slope = (to.girth - from.girth) / (2.0 * kPi * way);
  const double girth = (from.girth + to.girth) / 2.0;
  return std::max(0.0, 2.0 * kPi * way / girth * std::sqrt((1.0 + slope * slope) / 2.0) +
                           std::log(to.girth / from.girth));
}

SqueezedWay BandGraph::worstWayFrom(Index root) const {
  Indexed<double> squeeze(bands_.size(), kFar);
  Indexed<Index> from(bands_.size(), -1);
  const std::vector<Index> reached = shortestPaths(root, squeeze, [&](Index a, const auto& go) {
    for (const Index b : bands_[a].joined)
      if (go(b, squeezeBetween(bands_[a], bands_[b])))
        from[b] = a;
  });
  // The first of those that are squeezed most.
  const Index last = *std::find_if(reached.begin(), reached.end(),
                                   [&](Index a) { return squeeze[a] == squeeze[reached.back()]; });
  SqueezedWay way;
  for (Index band = last; band >= 0; band = from[band]) {
    way.bands.push_back(band);
    way.squeeze.push_back(squeeze[band]);
  }
  std::reverse(way.bands.begin(), way.bands.end());
  std::reverse(way.squeeze.begin(), way.squeeze.end());
  return way;
}

SqueezedWay BandGraph::worstWay() const {
  // From a tip to the tip that is the farthest from it: the best root is between them.
  const SqueezedWay across = worstWayFrom(worstWayFrom(0).bands.back());
  SqueezedWay least = across;
  for (const Index root : across.bands) {
    SqueezedWay way = worstWayFrom(root);
    if (way.squeeze.back() < least.squeeze.back())
      least = std::move(way);
  }
  return least;
}

}  // namespace spherical_param::internal
