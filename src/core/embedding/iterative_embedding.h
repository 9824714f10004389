#pragma once

#include "embedding.h"
#include "embedding_history.h"

namespace spherical_param::internal {

/// embed() with EmbeddingMethod::Iterative, on checked input. A collapse is reported.
///
/// \param start    3 x n, finite: the points or any other start.
/// \param observer receives every iteration and the end; may be empty.
Embedding embedIteratively(const Graph& graph, const Positions& start,
                           const EmbeddingOptions& options, const EmbeddingObserver& observer,
                           const Execution& execution);

}  // namespace spherical_param::internal
