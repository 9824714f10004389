#pragma once

#include "cycle_labels.h"
#include "indexed.h"
#include "rows.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// A breadth-first search, with the label of the way to each node.
struct Wave {
  explicit Wave(std::size_t nodes) : reached(nodes), steps(nodes), from(nodes), label(nodes) {}

  /// Starts anew, without sources.
  void clear() {
    reached.clear();
    queue.clear();
  }

  /// Goes to a node from another one, or from itself: a source. Returns whether it is new.
  bool reach(Index v, Index before, CycleLabels::Label of_way = 0) {
    if (!reached.insert(v))
      return false;
    steps[v] = v == before ? 0 : steps[before] + 1;
    from[v] = before;
    label[v] = of_way;
    queue.push_back(v);
    return true;
  }

  /// The closed walk of the ways to two neighbours, from where these part.
  std::vector<Index> walkThrough(Index v, Index w) const {
    std::vector<Index> walk{v};
    std::vector<Index> back{w};
    while (walk.back() != back.back()) {
      std::vector<Index>& longer = steps[walk.back()] > steps[back.back()] ? walk : back;
      longer.push_back(from[longer.back()]);
    }
    std::reverse(walk.begin(), walk.end());
    walk.insert(walk.end(), back.begin(), back.end() - 1);
    return walk;
  }

  IndexSet reached;
  Indexed<Index> steps;
  Indexed<Index> from;
  Indexed<CycleLabels::Label> label;
  std::vector<Index> queue;
};

/// The shortest closed walk through a node whose labels do not sum up to zero (by exclusive or).
///
/// \param may_pass whether the edge of an entry of the graph may be used.
/// \param label_of the label of the edge of an entry.
/// \return the nodes in order; empty if the walk is longer than twice the radius and a step.
template <typename MayPass, typename LabelOf>
std::vector<Index> shortestLoopThrough(Index source, Index radius, const NeighborRows& graph,
                                       const MayPass& may_pass, const LabelOf& label_of,
                                       Wave& wave) {
  wave.clear();
  wave.reach(source, source);
  Index best = 2 * radius + 2;
  std::array<Index, 2> ends{-1, -1};
  for (std::size_t i = 0; i < wave.queue.size(); ++i) {
    const Index v = wave.queue[i];
    const Index steps = wave.steps[v];
    if (steps > radius || 2 * steps + 1 >= best)
      break;
    for (const std::size_t e : graph.entries(v)) {
      const Index w = graph.neighbors[e];
      if (!may_pass(e) || w == wave.from[v])
        continue;
      const CycleLabels::Label label = wave.label[v] ^ label_of(e);
      if (!wave.reach(w, v, label) && label != wave.label[w] && steps + wave.steps[w] + 1 < best) {
        best = steps + wave.steps[w] + 1;
        ends = {v, w};
      }
    }
  }
  return ends[0] < 0 ? std::vector<Index>() : wave.walkThrough(ends[0], ends[1]);
}

}  // namespace spherical_param::internal
