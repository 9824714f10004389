#pragma once

#include "embedding.h"
#include "embedding_history.h"
#include "graph_hierarchy.h"

namespace spherical_param::internal {

/// embed() with EmbeddingMethod::Multilevel, on checked input.
///
/// \param hierarchy of the graph. Coarsest levels of some hundred nodes suit best.
/// \param observer shown the start that is kept and each step of its solution, then each finer
///        level as it is interpolated, after its sweeps, and at each step of Newton's method, and
///        the end. May be empty. The coarsest level is solved once more for it. Where a level
///        collapses, its states are followed by those of the solution with a barrier.
/// \return the embedding. If all starts collapse even with a barrier: StopReason::Collapsed and no
///         columns.
Embedding embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy,
                        const EmbeddingOptions& options, NodeMass mass,
                        const EmbeddingObserver& observer, const Execution& execution);

}  // namespace spherical_param::internal
