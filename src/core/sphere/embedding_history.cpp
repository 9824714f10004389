#include "embedding_history.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Number i of `count` numbers in even distances from 0 to `size` - 1.
std::size_t evenly(std::size_t i, std::size_t count, std::size_t size) {
  return count < 2 ? 0 : i * (size - 1) / (count - 1);
}

/// Of the steps of one kind, most are near the first.
bool isKept(int iteration) {
  while (iteration > 8 && iteration % 2 == 0)
    iteration /= 2;
  return iteration <= 8;
}

}  // namespace

EmbeddingRecorder::EmbeddingRecorder(std::size_t nodes, const EmbeddingOptions& limits)
    : max_frames_(static_cast<std::size_t>(limits.history_frames)) {
  const std::size_t count = std::min(nodes, static_cast<std::size_t>(limits.history_vertices));
  for (std::size_t i = 0; i < count; ++i)
    history_.vertices.push_back(static_cast<Index>(evenly(i, count, nodes)));
}

void EmbeddingRecorder::record(HistoryFrame state, const std::function<Positions()>& directions) {
  std::vector<HistoryFrame>& frames = history_.frames;
  const bool is_end = state.step == EmbeddingStep::End;
  if (history_.vertices.empty() ||
      (!is_end && state.step != EmbeddingStep::Sweeps && !isKept(state.iteration)))
    return;
  // What came from a coarser level was carried here already.
  if (state.step == EmbeddingStep::Start && !frames.empty())
    return;
  state.sphere = directions()(Eigen::all, history_.vertices);
  // One state may be the end of one kind of step and the beginning of the next.
  if (!frames.empty() && frames.back().level == state.level &&
      frames.back().sphere == state.sphere) {
    state.residual = state.residual ? state.residual : frames.back().residual;
    if (!is_end) {
      state.step = frames.back().step;
      state.iteration = frames.back().iteration;
    }
    frames.pop_back();
  }
  frames.push_back(std::move(state));
  // Which states are evenly spaced is known at the end only: until then more are kept.
  if (frames.size() > 3 * max_frames_)
    thinTo(2 * max_frames_);
}

void EmbeddingRecorder::thinTo(std::size_t count) {
  std::vector<HistoryFrame>& frames = history_.frames;
  if (frames.size() <= count)
    return;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = evenly(i, count, frames.size());
    if (from != i)
      frames[i] = std::move(frames[from]);
  }
  frames.resize(count);
}

EmbeddingHistory EmbeddingRecorder::take() {
  thinTo(max_frames_);
  return std::exchange(history_, {});
}

}  // namespace spherical_param::internal
