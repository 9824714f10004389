#include "handles.h"

#include "cycle_labels.h"
#include "graph_building.h"
#include "indexed.h"
#include "loop_search.h"
#include "parallel.h"
#include "progress.h"
#include "shortest_paths.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace spherical_param::internal {
namespace {

using Label = CycleLabels::Label;

/// Faces of the rotation system up to this many edges bound.
constexpr std::size_t kMaxFace = 12;
/// What a loop needs to be a handle: steps, and steps of its dual, the shortest walk that crosses
/// it once. Below are gaps in the sampling.
constexpr std::size_t kMinLoop = 5;
constexpr int kMinDual = 6;
/// Where there are false edges: the least area. Of 238 clouds without handles, false loops that can
/// be glued and gain energy have up to 130, of 72 with handles the least true one has 105, the next
/// 117, 143 and 200.
constexpr double kMinArea = 140.0;
/// The area from which on it needs no comparison with the mesh without it; false loops have up to
/// 465.
constexpr double kSureArea = 800.0;
/// Up to this number of edges, one for so many steps, are left out where they join the sides of a
/// loop; it then needs a longer dual.
constexpr std::size_t kMaxLeftOut = 3;
constexpr std::size_t kStepsOfLeftOut = 10;
constexpr int kMinDualOfSeparated = 9;
/// Of neighbouring normals, but for their sign, on a walk along which they turn over. Of 330 clouds
/// of surfaces with two sides none has such a walk.
constexpr double kMinOneSidedCosine = 0.7;
/// The dual of a loop that separates.
constexpr int kSeparates = std::numeric_limits<int>::max();
/// The number of classes left if one is no handle.
constexpr int kNotAll = -1;
/// Loops of a class that are longer than the shortest by at most this factor are tried as well.
constexpr double kMaxDetour = 1.7;

/// The walks of four edges without a diagonal, each once.
NeighborRows squares(const NeighborRows& graph, int threads) {
  return rowsOfBlocks(graph.size(), threads, {}, [&](Index begin, Index end, Graph& found) {
    std::vector<Index> opposite;
    for (const Index v : NumberRange(begin, end)) {
      const Row<Index> around = graph.row(v);
      for (const Index a : around) {
        if (a < v)
          continue;
        opposite.clear();
        for (const Index w : graph.row(a))
          if (w > v && !around.contains(w))
            opposite.push_back(w);
        for (const Index b : around) {
          if (b <= a || graph.row(a).contains(b))
            continue;
          for (const Index w : opposite)
            if (graph.row(b).contains(w)) {
              found.neighbors.insert(found.neighbors.end(), {v, a, w, b});
              found.endRow();
            }
        }
      }
    }
  });
}

void append(const Row<Index>& row, NeighborRows& rows) {
  rows.neighbors.insert(rows.neighbors.end(), row.begin(), row.end());
  rows.endRow();
}

/// Walks that bound: squares, short faces and openings.
NeighborRows cellsOf(const NeighborRows& graph, const NeighborRows& faces,
                     const std::vector<Opening>& openings, int threads) {
  NeighborRows cells = squares(graph, threads);
  for (const Index face : faces.nodes())
    if (faces.row(face).size() > 3 && faces.row(face).size() <= kMaxFace)
      append(faces.row(face), cells);
  for (const Opening& opening : openings)
    append({opening.loop.data(), opening.loop.data() + opening.loop.size()}, cells);
  return cells;
}

/// Whether the faces of a graph make a sphere of it, and at most one of them does not bound: it has
/// no cycles then.
bool isSphere(const NeighborRows& graph, const NeighborRows& faces,
              const std::vector<Opening>& openings) {
  if (graph.size() + faces.size() != graph.neighbors.size() / 2 + 2)
    return false;
  std::ptrdiff_t unbounded = 0;
  for (const Index face : faces.nodes())
    unbounded += faces.row(face).size() > kMaxFace ? 1 : 0;
  for (const Opening& opening : openings)
    unbounded -= opening.loop.size() > kMaxFace ? 1 : 0;
  if (unbounded > 1)
    return false;
  UnionFind parts = connectedComponents(graph);
  for (const Index v : graph.nodes())
    if (parts.find(v) != 0)
      return false;
  return true;
}

/// Which classes of walks are handles: if there are no false edges, all, and their area tells
/// nothing. Of 77 clouds of 100 to 2,500 points where all are, 76 have the true genus, and 64 are
/// meshed with it instead of 19; of 462 clouds without handles it is none.
enum class Classes { All, Some };

class HandleSearch {
  using Edge = std::array<Index, 2>;  // {lower, higher}
  enum class Side : std::uint8_t { None, On, Left, Right };

public:
  /// \param graph of the rotation system; must outlive this.
  HandleSearch(const RotationSystem& rotation, const NumberedGraph& graph,
               const CycleLabels& labels, const std::vector<Opening>& openings, Classes handles,
               const Execution& execution)
      : rotation_(rotation), graph_(graph), labels_(labels), handles_(handles),
        blocked_(graph_.size(), 0), side_(graph_.size(), Side::None),
        threads_(threadCount(execution.threads, graph_.size())),
        waves_(static_cast<std::size_t>(threads_)), report_(reportOf(execution, "openings")) {
    for (const Opening& opening : openings)
      for (const Index v : opening.loop)
        blocked_[v] = 1;
  }

  /// Nothing if all classes should be handles, and are not.
  std::optional<Handles> run() {
    left_ = labels_.rank();
    // Twice as far each time: the walks through each source get longer, the sources fewer.
    for (Index radius = 4; left_ > 0 && radius < 2 * static_cast<Index>(graph_.size()); radius *= 2)
      while (left_ > 0 && searchWithin(radius))
        reportFraction(report_, 0.8);
    if (handles_ == Classes::All && left_ != 0)
      return std::nullopt;
    return std::move(found_);
  }

private:
  bool mayPass(std::size_t e) const {
    return blocked_[graph_.neighbors[e]] == 0 && !labels_.isLeftOut(graph_.edges[e]);
  }

  /// Considers the walks of up to 2 radius + 1 steps. Returns whether there were any.
  bool searchWithin(Index radius) {
    const std::vector<Index> sources = sourcesApart(radius / 4);
    std::vector<std::vector<Index>> walks(sources.size());
    forEachTask(sources.size(), threads_,
                [&](std::size_t i) { walks[i] = shortestThrough(sources[i], radius); });
    std::stable_sort(walks.begin(), walks.end(),
                     [](const auto& a, const auto& b) { return a.size() < b.size(); });
    bool has_found = false;
    for (std::size_t i = 0; i < walks.size() && left_ > 0; ++i) {
      const Label label = walks[i].empty() || isBlocked(walks[i]) ? 0 : labels_.of(walks[i]);
      if (label == 0)
        continue;
      has_found = true;
      consider(walks, i, label);
    }
    return has_found;
  }

  Wave& waveOfThread() {
    std::optional<Wave>& wave = waves_[threadNumber()];
    if (!wave)
      wave.emplace(graph_.size());
    return *wave;
  }

  /// Ends of edges with a label, at least some steps apart: any walk that does not bound passes
  /// one.
  std::vector<Index> sourcesApart(Index distance) {
    std::vector<Index> sources;
    IndexSet near(graph_.size());
    std::vector<Index> disc;
    for (const Index v : graph_.nodes()) {
      if (blocked_[v] != 0 || near.contains(v) || !hasLabel(v))
        continue;
      sources.push_back(v);
      collectDisc(v, distance, graph_, near, disc);
    }
    return sources;
  }

  bool hasLabel(Index v) const {
    for (const std::size_t e : graph_.entries(v))
      if (mayPass(e) && labels_[graph_.edges[e]] != 0)
        return true;
    return false;
  }

  bool isBlocked(const std::vector<Index>& walk) const {
    return std::any_of(walk.begin(), walk.end(), [&](Index v) { return blocked_[v] != 0; });
  }

  /// The shortest walk through a node that does not bound; empty if it is longer than twice the
  /// radius and a step.
  std::vector<Index> shortestThrough(Index source, Index radius) {
    return shortestLoopThrough(
        source, radius, graph_, [&](std::size_t e) { return mayPass(e); },
        [&](std::size_t e) { return labels_[graph_.edges[e]]; }, waveOfThread());
  }

  /// A walk that is the shortest through some of its nodes.
  std::vector<Index> tightened(std::vector<Index> walk) {
    for (bool has_changed = true; has_changed;) {
      has_changed = false;
      const std::size_t step = std::max<std::size_t>(1, walk.size() / 8);
      for (std::size_t i = 0; i < walk.size() && !has_changed; i += step) {
        std::vector<Index> shorter = shortestThrough(walk[i], static_cast<Index>(walk.size() / 2));
        if (!shorter.empty() && shorter.size() < walk.size()) {
          walk = std::move(shorter);
          has_changed = true;
        }
      }
    }
    return walk;
  }

  /// Whether the normals are turned along a walk on which neighbours have similar ones.
  bool isOneSided(const std::vector<Index>& walk) const {
    bool is_turned = false;
    Index from = walk.back();
    for (const Index to : walk) {
      const double cosine = rotation_.cosine(std::exchange(from, to), to);
      if (std::abs(cosine) < kMinOneSidedCosine)
        return false;
      is_turned = is_turned != (cosine < 0.0);
    }
    return is_turned;
  }

  /// Takes the shortest walk of a class, or another one, for a handle; or the class for bounding.
  void consider(const std::vector<std::vector<Index>>& walks, std::size_t first, Label label) {
    std::vector<Index> shortest = tightened(walks[first]);
    found_.is_one_sided = found_.is_one_sided || isOneSided(shortest);
    std::optional<CutLoop> loop = examined(std::move(shortest));
    const double longest = kMaxDetour * static_cast<double>(walks[first].size());
    for (std::size_t i = first; !loop && i < walks.size(); ++i)
      if (static_cast<double>(walks[i].size()) <= longest && !isBlocked(walks[i]) &&
          labels_.of(walks[i]) == label)
        loop = examined(walks[i]);
    if (!loop) {
      left_ = handles_ == Classes::All ? kNotAll : left_ - 1;
      labels_.fill(label);
      return;
    }
    left_ -= 2;
    labels_.fill(labels_.of(loop->nodes));
    for (const Index v : loop->nodes) {
      blocked_[v] = 1;
      for (const Index w : graph_.row(v))
        blocked_[w] = 1;
    }
    found_.loops.push_back(std::move(*loop));
  }

  /// The walk as a cut, if it is one.
  std::optional<CutLoop> examined(std::vector<Index> walk) {
    const std::size_t steps = walk.size();
    if (steps < kMinLoop)
      return std::nullopt;
    std::vector<Index> sorted = walk;
    sortUnique(sorted);
    if (sorted.size() < steps)
      return std::nullopt;
    CutLoop loop;
    loop.nodes = std::move(walk);
    const std::size_t may_leave_out = std::min(kMaxLeftOut, steps / kStepsOfLeftOut);
    Dual dual = dualOf(loop);
    while (dual.steps < (loop.left_out.empty() ? kMinDual : kMinDualOfSeparated)) {
      if (loop.left_out.size() == may_leave_out)
        return std::nullopt;
      loop.left_out.push_back(dual.joint);
      dual = dualOf(loop);
    }
    // Of a torus with this loop and its dual [squared steps].
    const double area = static_cast<double>(steps) * dual.steps;
    // Without a dual the loop separates: it is around a gap.
    if (dual.steps == kSeparates || (handles_ == Classes::Some && area < kMinArea))
      return std::nullopt;
    loop.certainty = handles_ == Classes::All
                         ? 1.0
                         : std::clamp((area - kMinArea) / (kSureArea - kMinArea), 0.0, 1.0);
    return loop;
  }

  /// The shortest walk that crosses a loop once.
  struct Dual {
    int steps = kSeparates;
    Edge joint{-1, -1};  ///< its longest edge, which is most likely false
  };

  Dual dualOf(const CutLoop& loop) {
    Wave& wave = waveOfThread();
    std::vector<Index> touched = loop.nodes;
    Dual dual = jointBeside(loop, touched, wave);
    if (dual.joint[0] < 0)
      dual = shortestAcross(loop, touched, wave);
    for (const Index v : touched)
      side_[v] = Side::None;
    return dual;
  }

  /// Marks the nodes beside a loop. A node on both sides is a walk of no steps.
  ///
  /// \param touched nodes that have a mark.
  Dual jointBeside(const CutLoop& loop, std::vector<Index>& touched, Wave& wave) {
    Dual dual;
    for (const Index v : loop.nodes)
      side_[v] = Side::On;
    for (std::size_t i = 0; i < loop.nodes.size(); ++i) {
      const Index v = loop.nodes[i];
      const Row<Index> around = graph_.row(v);
      const std::size_t after = rotation_.entryOf(v, loop.after(i)) - graph_.begin(v);
      Side side = Side::Left;
      for (std::size_t k = 1; k < around.size(); ++k) {
        const Index w = around.begin()[(after + k) % around.size()];
        if (w == loop.before(i))
          side = Side::Right;
        if (side_[w] == Side::On || loop.leavesOut(v, w))
          continue;
        if (side_[w] == Side::None) {
          side_[w] = side;
          touched.push_back(w);
          wave.from[w] = v;
        } else if (side_[w] != side) {
          dual = {0, longer(edgeOf(v, w), edgeOf(wave.from[w], w))};
        }
      }
    }
    return dual;
  }

  /// The shortest walk from the left side of a loop to the right one.
  Dual shortestAcross(const CutLoop& loop, const std::vector<Index>& touched, Wave& wave) const {
    wave.clear();
    for (const Index v : touched)
      if (side_[v] == Side::Left)
        wave.reach(v, v);
    for (std::size_t i = 0; i < wave.queue.size(); ++i) {
      const Index v = wave.queue[i];
      for (const std::size_t e : graph_.entries(v)) {
        Index w = graph_.neighbors[e];
        if (side_[w] == Side::On || labels_.isLeftOut(graph_.edges[e]) || loop.leavesOut(v, w) ||
            !wave.reach(w, v) || side_[w] != Side::Right)
          continue;
        Dual dual{wave.steps[w], edgeOf(v, w)};
        for (; side_[w] != Side::Left; w = wave.from[w])
          dual.joint = longer(dual.joint, edgeOf(wave.from[w], w));
        return dual;
      }
    }
    return {};
  }

  static Edge edgeOf(Index v, Index w) { return {std::min(v, w), std::max(v, w)}; }
  Edge longer(const Edge& a, const Edge& b) const {
    return rotation_.isLonger(b[0], b[1], a[0], a[1]) ? b : a;
  }

  const RotationSystem& rotation_;
  const NumberedGraph& graph_;
  CycleLabels labels_;
  Classes handles_;
  Indexed<char> blocked_;  ///< 1 in loops of openings, on loops that were found, and beside these
  Indexed<Side> side_;     ///< None between two loops
  int threads_;
  std::vector<std::optional<Wave>> waves_;  ///< of the threads
  FractionReport report_;
  int left_ = 0;  ///< cycles
  Handles found_;
};

}  // namespace

Handles findHandles(const RotationSystem& rotation, const std::vector<Opening>& openings,
                    const Execution& execution) {
  NeighborRows faces = rotation.faces(1, 0.0);
  if (isSphere(rotation.edges(), faces, openings))
    return {};
  const NumberedGraph graph(rotation.edges());
  const CycleLabels labels(
      graph, cellsOf(graph, faces, openings, threadCount(execution.threads, graph.size())));
  faces = {};
  const auto search = [&](Classes handles) {
    return HandleSearch(rotation, graph, labels, openings, handles, execution).run();
  };
  std::optional<Handles> all = search(Classes::All);
  return all ? std::move(*all) : *search(Classes::Some);
}

}  // namespace spherical_param::internal
