#pragma once

#include "embedding.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

namespace spherical_param::internal {

/// A state of an embedding, shown to an observer.
struct EmbeddingState {
  std::size_t level = 0;  ///< of the hierarchy: 0 is the graph itself, 1 the next coarser
  std::size_t nodes = 0;  ///< of the level
  EmbeddingStep step = EmbeddingStep::Start;  ///< the work before it
  int iteration = 0;                          ///< number of these steps on this level so far
  std::optional<double> residual;             ///< mean tangential Laplacian, if known [radius]
  /// The state on the nodes of the graph itself, unit vectors: that of a coarser level is carried
  /// there by the solver's interpolation, so that a finer level continues it. Call it before the
  /// observer returns, and only for useful states: there are many.
  std::function<Positions()> directions;
};

/// Receives the states of an embedding in turn, from the calling thread only. Its exceptions are
/// passed on. It does not change the result.
using EmbeddingObserver = std::function<void(const EmbeddingState&)>;

/// An EmbeddingObserver that records a history of bounded size: nodes in even distances along their
/// order, which is that of a space-filling curve, and some states. Of the steps of one kind on a
/// level it takes numbers 0 to 8, 10, 12, 14, 16, 20 and so on, since most happens first.
class EmbeddingRecorder {
public:
  /// \param nodes of the graph. \param limits of the history.
  EmbeddingRecorder(std::size_t nodes, const EmbeddingOptions& limits);

  /// Records a state, or skips it. Cost: that of the state.
  /// \param state of the embedding.
  void operator()(const EmbeddingState& state);

  /// Moves the history out. \return the history
  EmbeddingHistory take();

private:
  /// Drops states evenly down to this number.
  void thinTo(std::size_t count);

  std::size_t max_frames_;
  EmbeddingHistory history_;
};

}  // namespace spherical_param::internal
