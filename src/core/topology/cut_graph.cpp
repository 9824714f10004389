#include "cut_graph.h"

#include "graph_building.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

namespace spherical_param::internal {
namespace {

enum class Side : std::uint8_t { None, On, Left, Right };

/// What becomes of an edge.
struct Fate {
  bool is_dropped = false;
  bool is_doubled = false;
  std::array<bool, 2> is_right{};  ///< whether it goes to the right copy of its lower, higher end
};

class Cutter {
public:
  Cutter(const Positions& points, const Graph& graph, const RotationSystem& rotation)
      : points_(points), graph_(graph), rotation_(rotation), is_divided_(graph.size(), 0),
        side_(graph.size(), Side::None), right_of_(graph.size(), -1) {
    for (const Index v : graph.nodes())
      cut_.node_of.push_back(v);
  }

  void cut(const CutLoop& loop) {
    markSides(loop);
    for (std::size_t i = 0; i < loop.nodes.size(); ++i)
      divideAt(loop, i);
    for (const Index v : touched_)
      if (side_[v] == Side::Left)
        for (const std::size_t e : graph_.entries(v))
          if (side_[graph_.neighbors[e]] == Side::Right)
            fateOf(v, graph_.neighbors[e]).is_dropped = true;
    for (const auto& [v, w] : loop.left_out)
      fateOf(v, w).is_dropped = true;
    for (const Index v : touched_)
      side_[v] = Side::None;
    touched_.clear();
    std::vector<Index> right;
    for (const Index v : loop.nodes) {
      right.push_back(right_of_[v] = static_cast<Index>(cut_.node_of.size()));
      cut_.node_of.push_back(v);
    }
    std::reverse(right.begin(), right.end());
    cut_.rims.push_back(loop.nodes);
    cut_.rims.push_back(std::move(right));
  }

  CutGraph take() {
    Graph rest;  // of the edges that stay as they are
    std::vector<Bridge> edges;
    for (const Index v : graph_.nodes()) {
      for (const std::size_t e : graph_.entries(v)) {
        const Index w = graph_.neighbors[e];
        const auto fate = is_divided_[v] != 0 ? fates_.find(std::minmax(v, w)) : fates_.end();
        if (fate == fates_.end()) {
          rest.neighbors.push_back(w);
          rest.lengths.push_back(graph_.lengths[e]);
        } else if (v < w && !fate->second.is_dropped) {
          const std::array<bool, 2>& is_right = fate->second.is_right;
          edges.push_back(
              {is_right[0] ? right_of_[v] : v, is_right[1] ? right_of_[w] : w, graph_.lengths[e]});
          if (fate->second.is_doubled)
            edges.push_back({right_of_[v], right_of_[w], graph_.lengths[e]});
        }
      }
      rest.endRow();
    }
    cut_.graph = withEdges(rest, edges, cut_.node_of.size());
    cut_.points = points_(Eigen::all, cut_.node_of);
    return std::move(cut_);
  }

private:
  Fate& fateOf(Index v, Index w) {
    is_divided_[v] = is_divided_[w] = 1;
    return fates_[std::minmax(v, w)];
  }

  void mark(Index v, Side side) {
    if (side_[v] != Side::None)
      return;
    side_[v] = side;
    touched_.push_back(v);
  }

  /// Marks the nodes within two steps.
  void markSides(const CutLoop& loop) {
    for (const Index v : loop.nodes)
      mark(v, Side::On);
    const std::size_t n = loop.nodes.size();
    for (std::size_t i = 0; i < n; ++i)
      for (const Index w : rotation_.edges().row(loop.nodes[i]))
        if (!loop.leavesOut(loop.nodes[i], w))
          mark(w, sideOf(loop, i, w));
    for (std::size_t i = n, end = touched_.size(); i < end; ++i)
      for (const Index w : rotation_.edges().row(touched_[i]))
        if (!loop.leavesOut(touched_[i], w))
          mark(w, side_[touched_[i]]);
  }

  Side sideOf(const CutLoop& loop, std::size_t i, Index w) const {
    const bool is_left = rotation_.isLeft(loop.before(i), loop.nodes[i], loop.after(i), w);
    return is_left ? Side::Left : Side::Right;
  }

  /// Gives the edges of a node of a loop to its copies.
  void divideAt(const CutLoop& loop, std::size_t i) {
    const Index v = loop.nodes[i];
    for (const std::size_t e : graph_.entries(v)) {
      const Index w = graph_.neighbors[e];
      Fate& fate = fateOf(v, w);
      if (side_[w] != Side::On) {
        const Side side = side_[w] == Side::None ? sideOf(loop, i, w) : side_[w];
        fate.is_right[v < w ? 0 : 1] = side == Side::Right;
      } else if (w == loop.after(i) || w == loop.before(i)) {
        fate.is_doubled = true;
      } else if (v < w) {
        fate.is_right[0] = fate.is_right[1] = sideOf(loop, i, w) == Side::Right;
      }
    }
  }

  const Positions& points_;
  const Graph& graph_;
  const RotationSystem& rotation_;
  std::map<std::pair<Index, Index>, Fate> fates_;  ///< of edges {lower, higher} that may change
  Indexed<char> is_divided_;                       ///< 1 at their ends
  Indexed<Side> side_;
  std::vector<Index> touched_;
  Indexed<Index> right_of_;  ///< the right copy of a node; -1
  CutGraph cut_;
};

}  // namespace

CutGraph cutAlong(const Positions& points, const Graph& graph, const RotationSystem& rotation,
                  const std::vector<CutLoop>& loops) {
  Cutter cutter(points, graph, rotation);
  for (const CutLoop& loop : loops)
    cutter.cut(loop);
  return cutter.take();
}

FilledCut fillCut(const CutGraph& cut, const Openings& openings) {
  Openings all;
  for (const Index v : cut.node_of)
    all.spacing.push_back(openings.spacing[v]);
  for (const std::vector<Index>& rim : cut.rims)
    all.openings.push_back(measured(cut.points, all.spacing, rim));
  all.openings.insert(all.openings.end(), openings.openings.begin(), openings.openings.end());
  FilledCut result;
  result.filled = fillOpenings(cut.points, cut.graph, all);
  result.in_rims = cut.rims.empty() ? static_cast<Index>(cut.graph.size())
                                    : result.filled.ends[cut.rims.size() - 1];
  return result;
}

}  // namespace spherical_param::internal
