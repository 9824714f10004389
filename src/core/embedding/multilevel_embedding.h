#pragma once

#include "embedding.h"
#include "graph_hierarchy.h"
#include "level_solver.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// How an embedding is attempted.
struct EmbeddingAttempt {
  std::size_t level;         ///< on which it starts: 0 is the graph itself
  EmbeddingBarrier barrier;  ///< where it has one
  std::size_t starts;        ///< maximum number of starts
  std::size_t compared;      ///< number of accepted starts of which the best is kept
};

/// The attempts at an embedding, in the order in which they are made.
///
/// 1. The start on the coarsest level.
/// 2. The same with a barrier on all levels but the graph itself, and with more starts. It helps
///    graphs of a few nodes and with wide gaps, on which all starts collapse.
/// 3. Starts on finer and finer levels: the fewer nodes are around a limb, the easier the sphere
///    slips off it.
/// 4. The barrier also on the graph itself, however hard it pulls.
std::vector<EmbeddingAttempt> attemptsOf(const EmbeddingLevels& levels, int starts);

/// An embedding from coarse to fine. \see embed
///
/// \return the embedding of the first attempt that is accepted; `start_level` and `barrier` of its
///         report say which. Without columns if none is.
Embedding embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy,
                        const EmbeddingOptions& options, const Execution& execution);

}  // namespace spherical_param::internal
