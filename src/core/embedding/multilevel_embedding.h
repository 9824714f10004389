#pragma once

#include "embedding.h"
#include "embedding_history.h"
#include "graph_hierarchy.h"

namespace spherical_param::internal {

/// embed() with EmbeddingMethod::Multilevel, on checked input.
///
/// \param hierarchy of the graph. Coarsest levels of some hundred nodes suit best.
/// \param observer receives the chosen start and each step of its solution; then each finer level
///        after interpolation, after its sweeps and at each step of Newton's method; then the end.
///        May be empty. The coarsest level is solved once more for it. If a level collapses, its
///        states are followed by those of the solution with a barrier.
/// \return the embedding; StopReason::Collapsed and no columns if all starts collapse even with a
///         barrier.
Embedding embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy,
                        const EmbeddingOptions& options, NodeMass mass,
                        const EmbeddingObserver& observer, const Execution& execution);

}  // namespace spherical_param::internal
