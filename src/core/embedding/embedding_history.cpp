#include "embedding_history.h"

#include <algorithm>

namespace spherical_param::internal {
namespace {

/// This number of times the limit is kept while states arrive: which of them are evenly spaced is
/// known at the end only.
constexpr std::size_t kSpare = 3;

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
    : EmbeddingRecorder(nodes, GraphHierarchy(), limits) {}

EmbeddingRecorder::EmbeddingRecorder(std::size_t nodes, const GraphHierarchy& hierarchy,
                                     const EmbeddingOptions& limits)
    : max_vertices_(static_cast<std::size_t>(limits.history_vertices)),
      max_frames_(static_cast<std::size_t>(limits.history_frames)) {
  keepNodes(nodes, hierarchy);
}

void EmbeddingRecorder::keepNodes(std::size_t nodes, const GraphHierarchy& hierarchy) {
  const std::vector<HierarchyLevel>& levels = hierarchy.levels;
  const auto size_of = [&](std::size_t l) { return l == 0 ? nodes : levels[l - 1].graph.size(); };
  const std::size_t most = std::min(nodes, max_vertices_);
  // The finest level that is small enough, or one finer if that is far too small.
  std::size_t level = 0;
  while (level < levels.size() && size_of(level) > most)
    ++level;
  if (level > 0 && 2 * size_of(level) < most)
    --level;
  const std::size_t count = std::min(most, size_of(level));
  std::vector<Index>& kept = history_.vertices;
  kept.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    kept[i] = static_cast<Index>(evenly(i, count, size_of(level)));
  for (std::size_t l = level; l > 0; --l)
    for (Index& node : kept)
      node = levels[l - 1].seeds[node];

  wanted_.assign(1, kept);
  for (const HierarchyLevel& coarser : levels) {
    const auto& weights = coarser.prolongation;
    const auto for_each_entry = [&weights](Index row, const auto& visit) {
      for (Index e = weights.outerIndexPtr()[row]; e < weights.outerIndexPtr()[row + 1]; ++e)
        visit(weights.innerIndexPtr()[e], weights.valuePtr()[e]);
    };
    std::vector<Index> needed;
    for (const Index node : wanted_.back())
      for_each_entry(node, [&](Index from, double) { needed.push_back(from); });
    std::sort(needed.begin(), needed.end());
    needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
    Carry carry;
    for (const Index node : wanted_.back()) {
      for_each_entry(node, [&](Index from, double weight) {
        const auto place = std::lower_bound(needed.begin(), needed.end(), from);
        carry.entries.emplace_back(static_cast<Index>(place - needed.begin()), weight);
      });
      carry.offsets.push_back(carry.entries.size());
    }
    carries_.push_back(std::move(carry));
    wanted_.push_back(std::move(needed));
  }
}

void EmbeddingRecorder::operator()(const EmbeddingState& state) {
  const bool is_end = state.step == EmbeddingStep::End;
  if (max_vertices_ == 0 || state.level >= wanted_.size() ||
      (!is_end && state.step != EmbeddingStep::Sweeps && !isKept(state.iteration)))
    return;
  // What came from a coarser level was carried here already.
  if (state.step == EmbeddingStep::Start && !history_.frames.empty())
    return;
  HistoryFrame frame;
  frame.level = state.level;
  frame.nodes = state.nodes;
  frame.step = state.step;
  frame.iteration = state.iteration;
  frame.residual = state.residual;
  frame.sphere = carried(state.directions(), state.level);
  std::vector<HistoryFrame>& frames = history_.frames;
  // One state may be the end of one kind of step and the beginning of the next.
  if (!frames.empty() && frames.back().level == frame.level &&
      frames.back().sphere == frame.sphere) {
    frame.residual = frame.residual ? frame.residual : frames.back().residual;
    if (!is_end) {
      frame.step = frames.back().step;
      frame.iteration = frames.back().iteration;
    }
    frames.pop_back();
  }
  frames.push_back(std::move(frame));
  if (frames.size() > kSpare * max_frames_)
    thinTo(2 * max_frames_);
}

Positions EmbeddingRecorder::carried(const Positions& directions, std::size_t level) const {
  Positions values(3, static_cast<Eigen::Index>(wanted_[level].size()));
  for (std::size_t i = 0; i < wanted_[level].size(); ++i)
    values.col(static_cast<Eigen::Index>(i)) = directions.col(wanted_[level][i]);
  for (std::size_t l = level; l-- > 0;) {
    const Carry& carry = carries_[l];
    Positions finer(3, static_cast<Eigen::Index>(wanted_[l].size()));
    for (std::size_t i = 0; i < wanted_[l].size(); ++i) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (std::size_t e = carry.offsets[i]; e < carry.offsets[i + 1]; ++e)
        sum += carry.entries[e].second * values.col(carry.entries[e].first);
      // Opposite places have no direction between them.
      finer.col(static_cast<Eigen::Index>(i)) =
          sum.norm() > 0.0 ? Eigen::Vector3d(sum.normalized())
                           : Eigen::Vector3d(values.col(carry.entries[carry.offsets[i]].first));
    }
    values = std::move(finer);
  }
  return values;
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
