#include "necks.h"

#include "band_graph.h"
#include "cut_graph.h"
#include "graph_building.h"
#include "loop_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Spheres that are squeezed more are cut [logarithm of a scale]. Of 40 dumbbells of 500 to 8,000
/// points on thin tubes, 15 have intersections without cuts, 14 with 6, 9 with 5.5, 4 with 5, 4
/// or 3. But of 14 models, 6 cuts none, 5.5 and 5 one, 4 three: their meshes do not become better,
/// and the map to one sphere is lost.
constexpr double kMaxSqueeze = 6.0;
/// Nodes of a loop.
constexpr std::size_t kMinNeck = 6;
/// Loops of a sphere that do not divide it before it is left as it is: it may have a handle.
constexpr int kMaxRetries = 3;

/// Finds loops around bands.
class LoopAroundBand {
public:
  LoopAroundBand(const RotationSystem& rotation)
      : rotation_(rotation), graph_(rotation.edges()), taken_(graph_.size(), Taken::No),
        ring_(graph_.size(), kOutside), side_(graph_.size(), 0), on_path_(graph_.size()),
        is_label_(graph_.neighbors.size(), 0), wave_(graph_.size()) {}

  /// Keeps other loops at least two steps away from one.
  void keepFrom(const std::vector<Index>& loop) {
    for (const Index v : loop) {
      taken_[v] = Taken::On;
      for (const Index w : graph_.row(v))
        if (taken_[w] == Taken::No)
          taken_[w] = Taken::Beside;
    }
  }

  /// The shortest loop within a band and a step from it that crosses a path across the band oddly;
  /// empty: none.
  ///
  /// \param is_above whether a node beside the band is on its far side.
  template <typename IsAbove>
  std::vector<Index> find(const std::vector<Index>& band, const IsAbove& is_above) {
    spread(band, is_above);
    const std::vector<Index> path = pathAcross();
    label(path);
    std::vector<Index> best = shortest(path);
    forget(path);
    return best;
  }

private:
  enum class Taken : std::uint8_t { No, Beside, On };
  static constexpr int kOutside = -1;
  /// A path across a band starts and ends so many steps outside of it, loops are a step from it:
  /// they cannot pass its ends.
  static constexpr int kPathRing = 3;
  static constexpr int kLoopRing = 1;
  static constexpr char kBelow = 1;
  static constexpr char kAbove = 2;

  bool isInGraph(Index v) const { return v < static_cast<Index>(graph_.size()); }
  bool mayPass(Index v) const {
    return ring_[v] >= 0 && ring_[v] <= kLoopRing && taken_[v] == Taken::No;
  }

  /// Numbers the nodes around a band by their steps to it, and its sides.
  template <typename IsAbove>
  void spread(const std::vector<Index>& band, const IsAbove& is_above) {
    nodes_.clear();
    for (const Index v : band)
      if (isInGraph(v) && taken_[v] != Taken::On) {
        ring_[v] = 0;
        nodes_.push_back(v);
      }
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Index v = nodes_[i];
      if (ring_[v] == kPathRing)
        break;
      for (const Index w : graph_.row(v)) {
        if (ring_[w] != kOutside || taken_[w] == Taken::On)
          continue;
        ring_[w] = ring_[v] + 1;
        side_[w] = ring_[v] > 0 ? side_[v] : is_above(w) ? kAbove : kBelow;
        nodes_.push_back(w);
      }
    }
  }

  /// The shortest path from below to above; empty: none.
  std::vector<Index> pathAcross() {
    wave_.clear();
    for (const Index v : nodes_)
      if (ring_[v] == kPathRing && side_[v] == kBelow)
        wave_.reach(v, v);
    for (std::size_t i = 0; i < wave_.queue.size(); ++i) {
      Index v = wave_.queue[i];
      if (ring_[v] == kPathRing && side_[v] == kAbove) {
        std::vector<Index> path{v};
        while (wave_.from[v] != v)
          path.push_back(v = wave_.from[v]);
        std::reverse(path.begin(), path.end());
        return path;
      }
      for (const Index w : graph_.row(v))
        if (ring_[w] != kOutside)
          wave_.reach(w, v);
    }
    return {};
  }

  /// Marks the edges from a path to its left.
  void label(const std::vector<Index>& path) {
    on_path_.clear();
    for (const Index v : path)
      on_path_.insert(v);
    for (std::size_t i = 1; i + 1 < path.size(); ++i)
      for (const std::size_t e : graph_.entries(path[i]))
        if (!on_path_.contains(graph_.neighbors[e]) &&
            rotation_.isLeft(path[i - 1], path[i], path[i + 1], graph_.neighbors[e]))
          setLabels(path[i], e, 1);
  }

  void setLabels(Index v, std::size_t e, char value) {
    is_label_[e] = is_label_[rotation_.entryOf(graph_.neighbors[e], v)] = value;
  }

  std::vector<Index> shortest(const std::vector<Index>& path) {
    std::vector<Index> best;
    auto radius = static_cast<Index>(nodes_.size() / 2 + 1);
    for (const Index v : path) {
      if (!mayPass(v))
        continue;
      std::vector<Index> loop = shortestLoopThrough(
          v, radius, graph_, [&](std::size_t e) { return mayPass(graph_.neighbors[e]); },
          [&](std::size_t e) { return static_cast<CycleLabels::Label>(is_label_[e]); }, wave_);
      if (loop.size() < kMinNeck || (!best.empty() && loop.size() >= best.size()))
        continue;
      radius = static_cast<Index>(loop.size() / 2);
      best = std::move(loop);
    }
    return best;
  }

  void forget(const std::vector<Index>& path) {
    for (const Index v : nodes_) {
      ring_[v] = kOutside;
      side_[v] = 0;
    }
    for (const Index v : path)
      for (const std::size_t e : graph_.entries(v))
        if (is_label_[e] != 0)
          setLabels(v, e, 0);
  }

  const RotationSystem& rotation_;
  const NeighborRows& graph_;
  Indexed<Taken> taken_;
  std::vector<Index> nodes_;  ///< around a band
  Indexed<int> ring_;         ///< of those
  Indexed<char> side_;
  IndexSet on_path_;
  std::vector<char> is_label_;  ///< of entries
  Wave wave_;
};

/// What the nodes of a filled graph stand for.
NodeSizes sizesOf(const Graph& graph, const Indexed<Index>& node_of,
                  const Indexed<double>& spacing) {
  NodeSizes sizes;
  sizes.points.assign(graph.size(), 1.0);
  for (const Index v : graph.nodes()) {
    if (v < node_of.count()) {
      sizes.spacing.push_back(spacing[node_of[v]]);
      continue;
    }
    // The first neighbour of a virtual node is nearer to the rim.
    sizes.spacing.push_back(sizes.spacing[graph.row(v).begin()[0]]);
    const double steps = nodeSpacing(graph, v) / sizes.spacing[v];
    sizes.points[v] = steps * steps;
  }
  return sizes;
}

class NeckSearch {
public:
  NeckSearch(const Positions& points, const Graph& graph, const RotationSystem& rotation,
             const Openings& openings, const std::vector<CutLoop>& handles)
      : points_(points), graph_(graph), rotation_(rotation), openings_(openings), around_(rotation),
        tries_(graph.size(), 0), loops_(handles), handles_(handles.size()) {
    for (const CutLoop& loop : handles)
      around_.keepFrom(loop.nodes);
    for (const Opening& opening : openings.openings)
      around_.keepFrom(opening.loop);
  }

  Necks run() {
    while (cutOnce()) {
    }
    return {{loops_.begin() + static_cast<std::ptrdiff_t>(handles_), loops_.end()}, squeeze_};
  }

private:
  /// Cuts each sphere that is squeezed too much. Returns whether there was one.
  bool cutOnce() {
    if (loops_.empty() && openings_.openings.empty()) {
      UnionFind sets = connectedComponents(graph_);
      return cutSpheres(graph_, {openings_.spacing, Indexed<double>(graph_.size(), 1.0)}, sets);
    }
    const CutGraph cut = cutAlong(points_, graph_, rotation_, loops_);
    const FilledCut all = fillCut(cut, openings_);
    const Graph& graph = all.filled.graph;
    UnionFind sets = connectedComponents(graph);
    if (dropUseless(cut, sets))
      return true;
    return cutSpheres(graph, sizesOf(graph, cut.node_of, openings_.spacing), sets);
  }

  /// Cuts those components of a filled graph that are squeezed too much.
  bool cutSpheres(const Graph& graph, const NodeSizes& sizes, UnionFind& sets) {
    Indexed<Index> band_of(graph.size(), -1);
    bool has_cut = false;
    for (const Index v : graph_.nodes()) {
      if (sets.find(v) != v || tries_[v] >= kMaxRetries)
        continue;
      const Indexed<Band> bands = bandsOf(graph, sizes, v, band_of);
      std::vector<Index> loop = neckOf(bands, band_of);
      if (loop.empty()) {
        tries_[v] = kMaxRetries;
        continue;
      }
      around_.keepFrom(loop);
      loops_.push_back({std::move(loop), 1.0, {}});
      has_cut = true;
    }
    return has_cut;
  }

  /// Drops the loops that do not divide their sphere.
  bool dropUseless(const CutGraph& cut, UnionFind& sets) {
    const std::size_t count = loops_.size();
    std::vector<CutLoop> kept;
    for (std::size_t i = 0; i < count; ++i) {
      const Index sphere = sets.find(cut.rims[2 * i].front());
      if (i < handles_ || sphere != sets.find(cut.rims[2 * i + 1].front()))
        kept.push_back(std::move(loops_[i]));
      else
        ++tries_[sphere];
    }
    loops_ = std::move(kept);
    return loops_.size() < count;
  }

  /// The loop along which a sphere is cut; empty: none.
  std::vector<Index> neckOf(const Indexed<Band>& bands, const Indexed<Index>& band_of) {
    const std::vector<WayStep> way = worstWay(bands);
    const double worst = way.back().squeeze;
    squeeze_ = std::max(squeeze_, worst);
    if (worst <= kMaxSqueeze)
      return {};
    // About half way, the narrowest first; or those around a step across that.
    constexpr double around_half = 1.0 / 6.0;
    std::vector<Index> candidates;
    for (const auto& [band, squeeze] : way)
      if (std::abs(squeeze / worst - 0.5) <= around_half)
        candidates.push_back(band);
    for (std::size_t i = 1; candidates.empty() && i < way.size(); ++i)
      if (way[i].squeeze > worst / 2.0)
        candidates = {way[i - 1].band, way[i].band};
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](Index a, Index b) { return bands[a].girth < bands[b].girth; });
    for (const Index candidate : candidates) {
      const Band& band = bands[candidate];
      std::vector<Index> loop = around_.find(band.nodes, [&](Index v) {
        // Beside another cut a node may be of another sphere.
        return band_of[v] >= 0 && band_of[v] < bands.count() &&
               bands[band_of[v]].level > band.level;
      });
      if (!loop.empty())
        return loop;
    }
    return {};
  }

  const Positions& points_;
  const Graph& graph_;
  const RotationSystem& rotation_;
  const Openings& openings_;
  LoopAroundBand around_;
  Indexed<int> tries_;  ///< at the lowest node of a sphere
  std::vector<CutLoop> loops_;
  std::size_t handles_;
  double squeeze_ = 0.0;
};

}  // namespace

Necks findNecks(const Positions& points, const Graph& graph, const RotationSystem& rotation,
                const Openings& openings, const std::vector<CutLoop>& handles) {
  return NeckSearch(points, graph, rotation, openings, handles).run();
}

}  // namespace spherical_param::internal
