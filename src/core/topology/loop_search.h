#pragma once

#include "cycle_labels.h"
#include "indexed.h"
#include "rows.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// A breadth-first search from a node, with the label of the way to each.
struct Wave {
  explicit Wave(std::size_t nodes) : reached(nodes), steps(nodes), from(nodes), label(nodes) {}

  IndexSet reached;
  Indexed<Index> steps;
  Indexed<Index> from;
  Indexed<CycleLabels::Label> label;
  std::vector<Index> queue;

  /// Starts anew at a node.
  void start(Index source);
  /// From a node back to the source.
  std::vector<Index> wayTo(Index v) const;
};

/// The walk of two ways back to one node, without what they share.
std::vector<Index> closedWalk(std::vector<Index> first, std::vector<Index> second);

/// The shortest closed walk through a node whose labels do not sum up to zero (by exclusive or).
///
/// \param may_pass whether the edge of an entry of the graph may be used.
/// \param label_of the label of the edge of an entry.
/// \return the nodes in order; empty if the walk is longer than twice the radius and a step.
template <typename MayPass, typename LabelOf>
std::vector<Index> shortestLoopThrough(Index source, Index radius, const NeighborRows& graph,
                                       const MayPass& may_pass, const LabelOf& label_of,
                                       Wave& wave) {
  wave.start(source);
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
      if (wave.reached.insert(w)) {
        wave.steps[w] = steps + 1;
        wave.from[w] = v;
        wave.label[w] = label;
        wave.queue.push_back(w);
      } else if (label != wave.label[w] && steps + wave.steps[w] + 1 < best) {
        best = steps + wave.steps[w] + 1;
        ends = {v, w};
      }
    }
  }
  if (ends[0] < 0)
    return {};
  return closedWalk(wave.wayTo(ends[0]), wave.wayTo(ends[1]));
}

}  // namespace spherical_param::internal
