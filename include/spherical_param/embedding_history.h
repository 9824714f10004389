#pragma once

#include "spherical_param/graph_hierarchy.h"
#include "spherical_param/sphere_embedding.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param {

/// How much of an embedding's history is kept.
struct HistoryLimits {
  /// Nodes of the finest level whose ways are kept, at most; 0: no history; [0, 2^24].
  Index vertices = 0;
  /// States at most; [2, 10000]. Of more, some between the first and the last are left out.
  int frames = 40;
};

/// One state of an embedding.
struct HistoryFrame {
  std::size_t level = 0;  ///< that was worked on: 0 is the graph itself, 1 the next coarser
  std::size_t nodes = 0;  ///< of that level
  EmbeddingStep step = EmbeddingStep::Start;  ///< kind of the work before it
  int iteration = 0;                          ///< steps of this kind that were made on this level
  std::optional<double> residual;  ///< mean tangential Laplacian, where it is known [radius]
  Positions sphere;                ///< 3 x EmbeddingHistory::vertices.size(), unit vectors
};

/// How an embedding unfolded, for some of its nodes.
struct EmbeddingHistory {
  std::vector<Index> vertices;       ///< nodes of the graph; in a Result: vertices
  std::vector<HistoryFrame> frames;  ///< in the order of the work; the last is the embedding
};

/// An EmbeddingObserver that keeps a history of bounded size: of some nodes, which are spread over
/// the graph as those of a coarse level are, and of some states. Of steps of one kind on a level
/// it takes numbers 0 to 8, 10, 12, 14, 16, 20 and so on: most happens first.
///
/// States of coarser levels are carried to the nodes by the interpolation of the hierarchy, as the
/// solver does it, so that all frames show the same vertices, and a finer level goes on where the
/// coarser one ended.
class EmbeddingRecorder {
public:
  /// For embedOnSphere(): keeps every so-manieth of the graph's nodes.
  /// \param nodes of the graph. \param limits of the history. \throw InvalidInput if out of range.
  EmbeddingRecorder(std::size_t nodes, const HistoryLimits& limits);
  /// For embedMultilevel(): keeps nodes that coarser levels are made of.
  /// \param nodes of the graph. \param hierarchy is used here only. \param limits of the history.
  /// \throw InvalidInput for limits out of range.
  EmbeddingRecorder(std::size_t nodes, const GraphHierarchy& hierarchy,
                    const HistoryLimits& limits);

  /// Takes a state, if it is one to be kept. Cost: O(vertices) and the copy of the state.
  /// \param state as an observer is shown it.
  void operator()(const EmbeddingState& state);

  /// Gives the history away. \return it; the recorder is empty thereafter.
  EmbeddingHistory take();

private:
  /// \cond
  /// The interpolation from one level to the wanted nodes of the next finer one.
  struct Carry {
    std::vector<std::size_t> offsets{0};  ///< entries of each wanted node
    std::vector<std::pair<Index, double>>
        entries;  ///< place among the wanted coarser nodes, weight
  };
  /// \endcond

  void keepNodes(std::size_t nodes, const GraphHierarchy& hierarchy);
  Positions carried(const Positions& directions, std::size_t level) const;
  /// Leaves out states evenly until so many are left.
  void thinTo(std::size_t count);

  HistoryLimits limits_;
  std::vector<std::vector<Index>> wanted_;  ///< nodes of each level that the others rest on
  std::vector<Carry> carries_;              ///< [l]: from level l + 1 to level l
  EmbeddingHistory history_;
};

}  // namespace spherical_param
