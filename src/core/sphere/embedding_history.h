#pragma once

#include "embedding.h"

#include <cstddef>
#include <functional>
#include <utility>

namespace spherical_param::internal {

/// Records a history of bounded size: nodes in even distances along their order, which is that of a
/// space-filling curve, and some states. Of the steps of one kind on a level it takes numbers 0 to
/// 8, 10, 12, 14, 16, 20 and so on, since most happens first.
class EmbeddingRecorder {
public:
  /// \param nodes of the graph. \param limits of the history.
  EmbeddingRecorder(std::size_t nodes, const EmbeddingOptions& limits);

  /// Records a state, or skips it.
  ///
  /// \param state      without its sphere.
  /// \param directions returns the state on the nodes of the graph itself, unit vectors: that of a
  ///                   coarser level is carried there by the solver's interpolation, so that a
  ///                   finer level continues it. Only called for useful states: there are many.
  void record(HistoryFrame state, const std::function<Positions()>& directions);

  /// Moves the history out.
  EmbeddingHistory take();

private:
  /// Drops states evenly down to this number.
  void thinTo(std::size_t count);

  std::size_t max_frames_;
  EmbeddingHistory history_;
};

/// Leaves out the recorded vertices for which keeps(vertex) is false.
template <typename Keeps>
void keepVertices(const Keeps& keeps, EmbeddingHistory& history) {
  std::vector<Eigen::Index> places;
  std::vector<Index> kept;
  for (std::size_t i = 0; i < history.vertices.size(); ++i)
    if (keeps(history.vertices[i])) {
      places.push_back(static_cast<Eigen::Index>(i));
      kept.push_back(history.vertices[i]);
    }
  history.vertices = std::move(kept);
  for (HistoryFrame& frame : history.frames)
    frame.sphere = Positions(frame.sphere(Eigen::all, places));
}

}  // namespace spherical_param::internal
