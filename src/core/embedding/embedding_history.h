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

/// A state of an embedding on its way to the result, as an observer is shown it.
struct EmbeddingState {
  std::size_t level = 0;  ///< of the hierarchy: 0 is the graph itself, 1 the next coarser
  std::size_t nodes = 0;  ///< of the level
  EmbeddingStep step = EmbeddingStep::Start;  ///< kind of the work before it
  int iteration = 0;                          ///< steps of this kind that were made on this level
  std::optional<double>
      residual;  ///< mean tangential Laplacian, where the solver knows it [radius]
  /// Makes a copy of the state, 3 x nodes, unit vectors; to be called before the observer returns.
  /// Many states are shown: ask for those alone that are of use.
  std::function<Positions()> directions;
};

/// Shown the states of an embedding one after the other, from the calling thread only. What it
/// throws is passed on. The result is the same, bit by bit, with an observer or without.
using EmbeddingObserver = std::function<void(const EmbeddingState&)>;

/// An EmbeddingObserver that keeps a history of bounded size: of some nodes, which are spread over
/// the graph as those of a coarse level are, and of some states. Of steps of one kind on a level
/// it takes numbers 0 to 8, 10, 12, 14, 16, 20 and so on: most happens first.
///
/// States of coarser levels are carried to the nodes by the interpolation of the hierarchy, as the
/// solver does it, so that all frames show the same vertices, and a finer level goes on where the
/// coarser one ended.
class EmbeddingRecorder {
public:
  /// For an embedding without levels: keeps nodes in even distances.
  /// \param nodes of the graph. \param limits of the history.
  EmbeddingRecorder(std::size_t nodes, const EmbeddingOptions& limits);
  /// For an embedding by levels: keeps nodes that coarser levels are made of.
  /// \param nodes of the graph. \param hierarchy is used here only. \param limits of the history.
  EmbeddingRecorder(std::size_t nodes, const GraphHierarchy& hierarchy,
                    const EmbeddingOptions& limits);

  /// Takes a state, if it is one to be kept. Cost: O(vertices) and the copy of the state.
  /// \param state as an observer is shown it.
  void operator()(const EmbeddingState& state);

  /// Gives the history away. \return it; the recorder is empty thereafter.
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
  /// Leaves out states evenly until this number is left.
  void thinTo(std::size_t count);

  std::size_t max_vertices_;
  std::size_t max_frames_;
  std::vector<std::vector<Index>> wanted_;  ///< nodes of each level that the others rest on
  std::vector<Carry> carries_;              ///< [l]: from level l + 1 to level l
  EmbeddingHistory history_;
};

}  // namespace spherical_param::internal
