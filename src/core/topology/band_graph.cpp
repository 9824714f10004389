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

double squeezeBetween(const Band& from, const Band& to) {
  // The tip of a limb may be as narrow as it is sampled.
  if (to.joined.size() < 2)
    return 0.0;
  const double way = kBandWidth * std::abs(to.level - from.level);
  const double slope = (to.girth - from.girth) / (2.0 * kPi * way);
  const double girth = (from.girth + to.girth) / 2.0;
  return std::max(0.0, 2.0 * kPi * way / girth * std::sqrt((1.0 + slope * slope) / 2.0) +
                           std::log(to.girth / from.girth));
}

std::vector<WayStep> worstWayFrom(Index root, const Indexed<Band>& bands) {
  Indexed<double> squeeze(bands.size(), kFar);
  Indexed<Index> from(bands.size(), -1);
  const std::vector<Index> reached = shortestPaths(root, squeeze, [&](Index a, const auto& go) {
    for (const Index b : bands[a].joined)
      if (go(b, squeezeBetween(bands[a], bands[b])))
        from[b] = a;
  });
  // The first of those that are squeezed most.
  const Index last = *std::find_if(reached.begin(), reached.end(),
                                   [&](Index a) { return squeeze[a] == squeeze[reached.back()]; });
  std::vector<WayStep> way;
  for (Index band = last; band >= 0; band = from[band])
    way.push_back({band, squeeze[band]});
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace

Indexed<Band> bandsOf(const Graph& graph, const NodeSizes& sizes, Index start,
                      Indexed<Index>& band_of) {
  Indexed<double> distance(graph.size(), kFar);
  std::vector<Index> nodes = byDistance(graph, sizes, start, distance);
  const Index end = nodes.back();
  for (const Index v : nodes)
    distance[v] = kFar;
  nodes = byDistance(graph, sizes, end, distance);
  const auto level = [&](Index v) { return static_cast<Index>(distance[v] / kBandWidth); };
  Indexed<Band> bands;
  for (const Index v : nodes) {
    if (band_of[v] >= 0)
      continue;
    Band band;
    band.level = level(v);
    band.nodes.push_back(v);
    band_of[v] = bands.count();
    double points = 0.0;
    for (std::size_t i = 0; i < band.nodes.size(); ++i) {
      points += sizes.points[band.nodes[i]];
      for (const Index w : graph.row(band.nodes[i]))
        if (band_of[w] < 0 && level(w) == band.level) {
          band_of[w] = bands.count();
          band.nodes.push_back(w);
        }
    }
    band.girth = kAreaOfPoint * points / kBandWidth;
    bands.push_back(std::move(band));
  }
  for (const Index v : nodes)
    for (const Index w : graph.row(v)) {
      std::vector<Index>& joined = bands[band_of[v]].joined;
      if (band_of[w] != band_of[v] && (joined.empty() || joined.back() != band_of[w]))
        joined.push_back(band_of[w]);
    }
  for (Band& band : bands)
    sortUnique(band.joined);
  return bands;
}

std::vector<WayStep> worstWay(const Indexed<Band>& bands) {
  // From a tip to the tip that is the farthest from it: the best root is between them.
  const std::vector<WayStep> across = worstWayFrom(worstWayFrom(0, bands).back().band, bands);
  std::vector<WayStep> least = across;
  for (const WayStep& root : across) {
    std::vector<WayStep> way = worstWayFrom(root.band, bands);
    if (way.back().squeeze < least.back().squeeze)
      least = std::move(way);
  }
  return least;
}

}  // namespace spherical_param::internal
