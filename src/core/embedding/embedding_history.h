#pragma once

#include "embedding.h"
#include "graph_hierarchy.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// A state of an embedding, shown to an observer.
struct EmbeddingState {
  std::size_t level = 0;  ///< of the hierarchy: 0 is the graph itself, 1 the next coarser
  std::size_t nodes = 0;  ///< of the level
  EmbeddingStep step = EmbeddingStep::Start;  ///< the work before it
  int iteration = 0;                          ///< number of these steps on this level so far
  std::optional<double> residual;             ///< mean tangential Laplacian, if known [radius]
  /// Copies the state, 3 x nodes, unit vectors; call it before the observer returns, and only for
  /// useful states: there are many.
  std::function<Positions()> directions;
};

/// Receives the states of an embedding in turn, from the calling thread only. Its exceptions are
/// passed on. It does not change the result.
using EmbeddingObserver = std::function<void(const EmbeddingState&)>;

/// An EmbeddingObserver that records a history of bounded size: some nodes, spread over the graph
/// like those of a coarse level, and some states. Of the steps of one kind on a level it takes
/// numbers 0 to 8, 10, 12, 14, 16, 20 and so on, since most happens first.
///
/// States of coarser levels are carried to the nodes by the solver's interpolation, so that all
/// frames show the same vertices, and a finer level continues the coarser one.
class EmbeddingRecorder {
public:
  /// For an embedding without levels: records evenly spaced nodes.
  /// \param nodes of the graph. \param limits of the history.
  EmbeddingRecorder(std::size_t nodes, const EmbeddingOptions& limits);
  /// For an embedding by levels: records nodes of coarser levels.
  /// \param nodes of the graph. \param hierarchy used only here. \param limits of the history.
  EmbeddingRecorder(std::size_t nodes, const GraphHierarchy& hierarchy,
                    const EmbeddingOptions& limits);

  /// Records a state, or skips it. Cost: O(vertices) and the copy of the state.
  /// \param state of the embedding.
  void operator()(const EmbeddingState& state);

  /// Moves the history out. \return the history
  EmbeddingHistory take();

private:
  /// The interpolation from one level to the wanted nodes of the next finer one.
  struct Carry {
    std::vector<std::size_t> offsets{0};  ///< entries of each wanted node
    std::vector<std::pair<Index, double>>
        entries;  ///< place among the wanted coarser nodes, weight
  };

  void keepNodes(std::size_t nodes, const GraphHierarchy& hierarchy);
  Positions carried(const Positions& directions, std::size_t level) const;
  /// Drops states evenly down to this number.
  void thinTo(std::size_t count);

  std::size_t max_vertices_;
  std::size_t max_frames_;
  std::vector<std::vector<Index>> wanted_;  ///< recorded nodes of each level
  std::vector<Carry> carries_;              ///< [l]: from level l + 1 to level l
  EmbeddingHistory history_;
};

}  // namespace spherical_param::internal
