#pragma once

#include "embedding.h"
#include "graph_hierarchy.h"

namespace spherical_param::internal {

/// An embedding from coarse to fine. \see embed
///
/// \return the embedding of the first attempt that is accepted; `start_level` and `barrier` of its
///         report say which. Without columns if none is.
Embedding embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy,
                        const EmbeddingOptions& options, const Execution& execution);

}  // namespace spherical_param::internal
