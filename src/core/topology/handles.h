#pragma once

#include "openings.h"
#include "rotation_system.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// A closed walk on a surface that does not bound, with two sides.
struct CutLoop {
  /// The nodes before and after one of them.
  Index before(std::size_t i) const { return nodes[(i + nodes.size() - 1) % nodes.size()]; }
  Index after(std::size_t i) const { return nodes[(i + 1) % nodes.size()]; }
  bool leavesOut(Index v, Index w) const {
    return std::find(left_out.begin(), left_out.end(),
                     std::array{std::min(v, w), std::max(v, w)}) != left_out.end();
  }

  std::vector<Index> nodes;                    ///< in order, each once
  double certainty = 0.0;                      ///< in [0, 1]: of a handle; 1 needs no comparison
  std::vector<std::array<Index, 2>> left_out;  ///< edges that would join its sides beside it
};

/// The handles of a sampled surface.
struct Handles {
  std::vector<CutLoop> loops;  ///< one for each
  /// The surface has only one side, like a Klein bottle.
  bool is_one_sided = false;
};

/// Finds the handles of a sampled surface: disjoint loops, one for each, along which it can be cut
/// so that it stays connected.
///
/// Of the walks that do not bound (\see CycleLabels) the shortest is tightened and examined. It is
/// a handle if it has at least 5 steps and two sides, and the shortest walk from one side to the
/// other does not cross it, and has at least 6 steps. If all classes of walks turn out to be
/// handles, two classes each, they are certain. Otherwise there are false edges, and a handle needs
/// loop x dual of at least 140; other walks are taken for bounding.
///
/// \param openings  are filled; no loop passes theirs.
/// \param execution threads, progress
/// \return the shortest of similar length first, the same for any number of threads.
/// Cost: O(n) for the labels of a surface; the search adds the nodes within the length of each
/// loop, from sources that far apart.
Handles findHandles(const RotationSystem& rotation, const std::vector<Opening>& openings,
                    const Execution& execution = {});

}  // namespace spherical_param::internal
