#include "openings.h"

#include "filled_graph.h"
#include "graph_cycles.h"
#include "node_spacing.h"
#include "parallel.h"
#include "pi.h"
#include "point_set.h"
#include "progress.h"
#include "spherical_param/errors.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

/// Edges longer than this are not taken for edges of the surface [larger spacing of their ends].
constexpr double kMaxLength = 1.5;
/// What a face needs to be an opening: edges, width [spacing] and mean corner [rad].
constexpr std::size_t kMinSteps = 7;
constexpr double kMinWidth = 3.0;
constexpr double kMinCorner = 0.65 * internal::kPi;
/// A face less round than this, 1 for a disc, is a slit, and must be wider [spacing]. Left open, a
/// seam of a closed model, 82 edges long and 3.6 spacings wide, makes the RMS of its open clouds 4
/// to 30 times as large; a true slit of 14 clouds that is filled 1.5 times. With 5 spacings another
/// two sheets join.
constexpr double kMinRoundness = 0.2;
constexpr double kMinSlitWidth = 4.0;
/// Edges between sheets are steeper than this [sine], and join normals of a smaller cosine.
constexpr double kMaxSheetSlope = 0.6;
constexpr double kMinSheetCosine = 0.5;
/// Opposite sheets have normals of a smaller cosine.
constexpr double kMaxOppositeCosine = -0.5;
/// Neighbours on one sheet for sure have normals of a larger cosine, but for the sign, and an edge
/// that is less steep to both planes [sine].
constexpr double kMinOneSheetCosine = 0.9;
constexpr double kMaxOneSheetSlope = 0.3;
/// The least number of such neighbours across which a surface has one side only.
constexpr std::size_t kMinTwisted = 10;
/// Cycles of up to three times this number of points do not count.
constexpr int kReach = 2;
/// How far the moments of directions are taken about their mean, not about 0.
constexpr double kCentered = 0.5;
/// From this width on an opening is certain [spacing].
constexpr double kCertainWidth = 9.0;
/// A narrower flat patch is a line [spacing].
constexpr double kMinPatchWidth = 0.1;
/// Loops nearer to a plane are flat [spacing].
constexpr double kMaxFlat = 0.01;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// The short edges of the graph that do not cross each other; those of each node in the order
/// around its normal.
class Rotation {
public:
  Rotation(const Positions& points, const Graph& graph, const std::vector<double>& spacing,
           int threads)
      : points_(points), threads_(threads) {
    keepEdges(graph.size(), graph.neighbors, graph.offsets, [&](Index v, Index w, std::size_t e) {
      return graph.lengths[e] <= kMaxLength * std::max(spacing[at(v)], spacing[at(w)]);
    });
    findNormals();
    orientNormals();
    const std::vector<Index> neighbors = neighbors_;
    const std::vector<std::size_t> offsets = offsets_;
    const std::vector<std::uint8_t> crosses = longerOfCrossing();
    keepEdges(graph.size(), neighbors, offsets, [&](Index v, Index w, std::size_t e) {
      return crosses[e] == 0 && !leavesSheet(v, w);
    });
    sortAround();
  }

  /// Leaves out the edges between opposite sheets.
  void separateOpposite() {
    separates_opposite_ = true;
    const std::vector<Index> neighbors = neighbors_;
    const std::vector<std::size_t> offsets = offsets_;
    keepEdges(offsets.size() - 1, neighbors, offsets,
              [&](Index v, Index w, std::size_t) { return !areOpposite(v, w); });
    sortAround();
  }

  /// Whether an edge joins two sheets: it is steep to one of them, and their normals differ.
  bool leavesSheet(Index v, Index w) const {
    const Eigen::Vector3d d = direction(v, w);
    if (separates_opposite_ && areOpposite(v, w))
      return true;
    return std::abs(normals_.col(v).dot(normals_.col(w))) < kMinSheetCosine &&
           std::max(std::abs(d.dot(normals_.col(v))), std::abs(d.dot(normals_.col(w)))) >
               kMaxSheetSlope;
  }

  /// Whether some edges of the graph join opposite sheets.
  bool hasOpposite(const Graph& graph) const {
    for (std::size_t v = 0; v < graph.size(); ++v)
      for (std::size_t e = graph.offsets[v]; e < graph.offsets[v + 1]; ++e)
        if (areOpposite(static_cast<Index>(v), graph.neighbors[e]))
          return true;
    return false;
  }

  /// Edges between neighbours on one sheet that have normals to opposite sides.
  std::size_t countTwisted() const {
    std::size_t count = 0;
    for (std::size_t v = 0; v + 1 < offsets_.size(); ++v)
      for (std::size_t e = offsets_[v]; e < offsets_[v + 1]; ++e)
        if (at(neighbors_[e]) > v && isTwisted(static_cast<Index>(v), neighbors_[e]))
          ++count;
    return count;
  }

  /// The loops of all faces with at least some edges whose mean corner is large enough, with the
  /// face on the left seen from where the normals point.
  std::vector<std::vector<Index>> faces(std::size_t min_steps, double min_corner) const {
    std::vector<std::vector<Index>> found;
    std::vector<std::uint8_t> is_seen(neighbors_.size(), 0);
    std::vector<Index> loop;
    for (std::size_t v = 0; v + 1 < offsets_.size(); ++v)
      for (std::size_t e = offsets_[v]; e < offsets_[v + 1]; ++e) {
        if (is_seen[e] != 0)
          continue;
        loop.clear();
        double corners = 0.0;
        auto from = static_cast<Index>(v);
        for (std::size_t edge = e; is_seen[edge] == 0;) {
          is_seen[edge] = 1;
          const Index to = neighbors_[edge];
          loop.push_back(from);
          const std::size_t back = entryOf(to, from);
          edge = back > offsets_[at(to)] ? back - 1 : offsets_[at(to) + 1] - 1;
          corners += cornerBetween(edge, back);
          from = to;
        }
        if (loop.size() >= min_steps && corners >= min_corner * static_cast<double>(loop.size()))
          found.push_back(loop);
      }
    return found;
  }

private:
  /// Makes the edges those of some others that meet a condition.
  template <typename Condition>
  void keepEdges(std::size_t n, const std::vector<Index>& neighbors,
                 const std::vector<std::size_t>& offsets, const Condition& meets) {
    neighbors_.clear();
    offsets_.assign(1, 0);
    for (std::size_t v = 0; v < n; ++v) {
      for (std::size_t e = offsets[v]; e < offsets[v + 1]; ++e)
        if (meets(static_cast<Index>(v), neighbors[e], e))
          neighbors_.push_back(neighbors[e]);
      offsets_.push_back(neighbors_.size());
    }
  }

  bool areOpposite(Index v, Index w) const {
    return normals_.col(v).dot(normals_.col(w)) < kMaxOppositeCosine;
  }

  bool areJoined(Index v, Index w) const {
    const auto begin = neighbors_.begin() + static_cast<std::ptrdiff_t>(offsets_[at(v)]);
    const auto end = neighbors_.begin() + static_cast<std::ptrdiff_t>(offsets_[at(v) + 1]);
    return std::find(begin, end, w) != end;
  }

  /// For each edge, 1 if it crosses a shorter one: the diagonals of four points that are all
  /// neighbours. Of two as long as each other, the one of the higher node counts as longer.
  std::vector<std::uint8_t> longerOfCrossing() const {
    std::vector<std::uint8_t> crosses(neighbors_.size(), 0);
    std::vector<std::vector<Index>> scratch(static_cast<std::size_t>(threads_));
    internal::forEachItem(offsets_.size() - 1, threads_, [&](std::size_t thread, std::size_t i) {
      const auto v = static_cast<Index>(i);
      std::vector<Index>& common = scratch[thread];
      for (std::size_t e = offsets_[i]; e < offsets_[i + 1]; ++e) {
        const Index w = neighbors_[e];
        common.clear();
        for (std::size_t f = offsets_[i]; f < offsets_[i + 1]; ++f)
          if (neighbors_[f] != w && areJoined(neighbors_[f], w))
            common.push_back(neighbors_[f]);
        // In an order that is the same from both ends.
        std::sort(common.begin(), common.end());
        for (std::size_t a = 0; a < common.size(); ++a)
          for (std::size_t b = a + 1; b < common.size(); ++b)
            if (areJoined(common[a], common[b]) && isLonger(v, w, common[a], common[b]) &&
                doCross(std::min(v, w), std::max(v, w), common[a], common[b]))
              crosses[e] = 1;
      }
    });
    return crosses;
  }

  bool isTwisted(Index v, Index w) const {
    const Eigen::Vector3d d = direction(v, w);
    return normals_.col(v).dot(normals_.col(w)) < -kMinOneSheetCosine &&
           std::abs(d.dot(normals_.col(v))) < kMaxOneSheetSlope &&
           std::abs(d.dot(normals_.col(w))) < kMaxOneSheetSlope;
  }

  bool isLonger(Index v, Index w, Index a, Index b) const {
    const double length = (points_.col(v) - points_.col(w)).squaredNorm();
    const double other = (points_.col(a) - points_.col(b)).squaredNorm();
    return length != other ? length > other : std::max(v, w) > std::max(a, b);
  }

  /// Whether two edges cross, seen along the normal of v.
  bool doCross(Index v, Index w, Index a, Index b) const {
    const Eigen::Vector3d normal = normals_.col(v);
    const auto side = [&](Index from, Index to, Index of) {
      const Eigen::Vector3d edge = points_.col(to) - points_.col(from);
      return normal.dot(edge.cross(Eigen::Vector3d(points_.col(of) - points_.col(from)))) > 0.0;
    };
    return side(v, w, a) != side(v, w, b) && side(a, b, v) != side(a, b, w);
  }

  Eigen::Vector3d direction(Index v, Index w) const {
    return (points_.col(w) - points_.col(v)).stableNormalized();
  }

  void findNormals() {
    const std::size_t n = offsets_.size() - 1;
    normals_.resize(3, static_cast<Eigen::Index>(n));
    internal::forEachItem(n, threads_, [&](std::size_t, std::size_t i) {
      const auto v = static_cast<Index>(i);
      Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double count = 0.0;
      const auto add = [&](Index w) {
        const Eigen::Vector3d d = direction(v, w);
        moments += d * d.transpose();
        sum += d;
        count += 1.0;
      };
      for (std::size_t e = offsets_[i]; e < offsets_[i + 1]; ++e) {
        const Index w = neighbors_[e];
        add(w);
        for (std::size_t f = offsets_[at(w)]; f < offsets_[at(w) + 1]; ++f)
          if (neighbors_[f] != v)
            add(neighbors_[f]);
      }
      // On a sharp edge the moments alone would decide for one of its two planes.
      if (count > 0.0)
        moments -= kCentered / count * sum * sum.transpose();
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
      solver.computeDirect(moments);
      normals_.col(v) = solver.eigenvectors().col(0);
    });
  }

  /// Turns the normals of each component to one side: along edges between the most similar normals
  /// first, by union and find with signs.
  void orientNormals() {
    constexpr int buckets = 256;
    const std::size_t n = offsets_.size() - 1;
    std::vector<std::vector<std::pair<Index, Index>>> edges(buckets);
    for (std::size_t v = 0; v < n; ++v)
      for (std::size_t e = offsets_[v]; e < offsets_[v + 1]; ++e) {
        const Index w = neighbors_[e];
        if (at(w) < v)
          continue;
        const double cosine =
            std::abs(normals_.col(static_cast<Eigen::Index>(v)).dot(normals_.col(w)));
        const auto bucket = static_cast<std::size_t>(
            std::clamp(static_cast<int>((1.0 - cosine) * buckets), 0, buckets - 1));
        edges[bucket].emplace_back(static_cast<Index>(v), w);
      }
    std::vector<Index> parent(n);
    std::vector<std::int8_t> sign(n, 1);  // of the normal, relative to its parent's
    for (std::size_t v = 0; v < n; ++v)
      parent[v] = static_cast<Index>(v);
    const auto find = [&](Index v) {
      int s = 1;
      while (parent[at(v)] != v) {
        const Index up = parent[at(v)];
        // The path is halved.
        sign[at(v)] =
            static_cast<std::int8_t>(sign[at(v)] * (parent[at(up)] == up ? 1 : sign[at(up)]));
        parent[at(v)] = parent[at(up)];
        s *= sign[at(v)];
        v = parent[at(v)];
      }
      return std::pair(v, s);
    };
    for (const auto& bucket : edges)
      for (const auto& [v, w] : bucket) {
        const auto [root_v, sign_v] = find(v);
        const auto [root_w, sign_w] = find(w);
        if (root_v == root_w)
          continue;
        const int same = normals_.col(v).dot(normals_.col(w)) < 0.0 ? -1 : 1;
        const Index low = std::min(root_v, root_w);
        const Index high = std::max(root_v, root_w);
        parent[at(high)] = low;
        sign[at(high)] = static_cast<std::int8_t>(sign_v * sign_w * same);
      }
    for (std::size_t v = 0; v < n; ++v)
      if (find(static_cast<Index>(v)).second < 0)
        normals_.col(static_cast<Eigen::Index>(v)) *= -1.0;
  }

  /// Sorts the neighbours of each node counter-clockwise.
  void sortAround() {
    const std::size_t n = offsets_.size() - 1;
    angles_.resize(neighbors_.size());
    std::vector<std::vector<std::pair<double, Index>>> scratch(static_cast<std::size_t>(threads_));
    internal::forEachItem(n, threads_, [&](std::size_t thread, std::size_t v) {
      auto& around = scratch[thread];
      around.clear();
      const Eigen::Vector3d normal = normals_.col(static_cast<Eigen::Index>(v));
      const Eigen::Vector3d x = normal.unitOrthogonal();
      const Eigen::Vector3d y = normal.cross(x);
      for (std::size_t e = offsets_[v]; e < offsets_[v + 1]; ++e) {
        const Eigen::Vector3d d = direction(static_cast<Index>(v), neighbors_[e]);
        around.emplace_back(std::atan2(y.dot(d), x.dot(d)), neighbors_[e]);
      }
      std::sort(around.begin(), around.end());
      for (std::size_t k = 0; k < around.size(); ++k) {
        angles_[offsets_[v] + k] = around[k].first;
        neighbors_[offsets_[v] + k] = around[k].second;
      }
    });
  }

  /// Where v names w.
  std::size_t entryOf(Index v, Index w) const {
    std::size_t e = offsets_[at(v)];
    while (neighbors_[e] != w)
      ++e;
    return e;
  }

  /// The angle counter-clockwise from one edge of a node to another, a full turn if they are one.
  double cornerBetween(std::size_t from, std::size_t to) const {
    const double angle = angles_[to] - angles_[from];
    return angle > 0.0 ? angle : angle + 2.0 * internal::kPi;
  }

  const Positions& points_;
  bool separates_opposite_ = false;
  int threads_;
  std::vector<std::size_t> offsets_{0};
  std::vector<Index> neighbors_;
  std::vector<double> angles_;
  Positions normals_;
};

/// Sizes of what a loop encloses.
Opening measured(const Positions& points, const std::vector<double>& spacing,
                 std::vector<Index> loop) {
  Opening opening;
  opening.loop = std::move(loop);
  const auto m = static_cast<double>(opening.loop.size());
  for (const Index v : opening.loop) {
    opening.center += points.col(v) / m;
    opening.spacing += spacing[at(v)] / m;
  }
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < opening.loop.size(); ++i) {
    const Eigen::Vector3d p = points.col(opening.loop[i]) - opening.center;
    const Eigen::Vector3d q =
        points.col(opening.loop[i + 1 < opening.loop.size() ? i + 1 : 0]) - opening.center;
    opening.boundary_length += (q - p).norm();
    area += p.cross(q) / 2.0;
    moments += p * p.transpose() / m;
  }
  opening.area = area.norm();
  opening.width = std::min(4.0 * opening.area / opening.boundary_length,
                           opening.boundary_length / internal::kPi);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments, Eigen::EigenvaluesOnly);
  opening.is_flat = std::sqrt(std::max(0.0, axes.eigenvalues()[0])) < kMaxFlat * opening.spacing;
  opening.certainty = std::clamp(
      (opening.width / opening.spacing - kMinWidth) / (kCertainWidth - kMinWidth), 0.0, 1.0);
  return opening;
}

/// The edges of a graph across openings, and from a loop to another sheet.
std::vector<std::array<Index, 2>> falseEdges(const Graph& graph, const Rotation& rotation,
                                             const Openings& found) {
  std::vector<Index> loop_of(graph.size(), -1);
  for (std::size_t i = 0; i < found.openings.size(); ++i)
    for (const Index v : found.openings[i].loop)
      loop_of[at(v)] = static_cast<Index>(i);
  std::vector<std::array<Index, 2>> edges;
  for (std::size_t v = 0; v < graph.size(); ++v)
    for (std::size_t e = graph.offsets[v]; e < graph.offsets[v + 1]; ++e) {
      const Index w = graph.neighbors[e];
      if (at(w) < v || (loop_of[v] < 0 && loop_of[at(w)] < 0))
        continue;
      const bool is_across =
          loop_of[v] == loop_of[at(w)] &&
          graph.lengths[e] > kMaxLength * std::max(found.spacing[v], found.spacing[at(w)]);
      if (is_across || rotation.leavesSheet(static_cast<Index>(v), w))
        edges.push_back({static_cast<Index>(v), w});
    }
  return edges;
}

/// The largest face of the graph of a flat patch, however narrow: what is around it. None of points
/// on a line.
std::optional<Opening> outsideOf(const Positions& points, const std::vector<double>& spacing,
                                 const Rotation& rotation) {
  std::optional<Opening> outside;
  for (std::vector<Index>& loop : rotation.faces(3, 0.0)) {
    Opening face = measured(points, spacing, std::move(loop));
    if (face.width >= kMinPatchWidth * face.spacing && (!outside || face.area > outside->area))
      outside = std::move(face);
  }
  return outside;
}

/// The openings that are seen.
Openings openingsOf(const Positions& points, const Graph& graph, const std::vector<double>& spacing,
                    const Rotation& rotation) {
  Openings result;
  result.spacing = spacing;
  for (std::vector<Index>& loop : rotation.faces(kMinSteps, kMinCorner)) {
    Opening opening = measured(points, spacing, std::move(loop));
    const double roundness = internal::kPi * opening.width / opening.boundary_length;
    if (opening.width >= (roundness < kMinRoundness ? kMinSlitWidth : kMinWidth) * opening.spacing)
      result.openings.push_back(std::move(opening));
  }
  if (result.openings.empty() && areCoplanar(points)) {
    std::optional<Opening> outside = outsideOf(points, spacing, rotation);
    if (outside)
      result.openings.push_back(std::move(*outside));
  }
  result.is_one_sided = !result.openings.empty() && rotation.countTwisted() >= kMinTwisted;
  result.false_edges = falseEdges(graph, rotation, result);
  std::stable_sort(
      result.openings.begin(), result.openings.end(),
      [](const Opening& a, const Opening& b) { return a.boundary_length > b.boundary_length; });
  return result;
}

/// Whether the openings are all that there are: the graph has no cycles when they are filled.
bool hasNoCyclesLeft(const Positions& points, const Graph& graph, const Openings& found) {
  return internal::countCycles(internal::fillOpenings(points, graph, found).graph, kReach) == 0;
}

}  // namespace

Openings findOpenings(const Positions& points, const Graph& graph, const Execution& execution) {
  const int threads = internal::threadCount(execution.threads, graph.size());
  std::vector<double> spacing(graph.size());
  std::vector<std::vector<double>> scratch(static_cast<std::size_t>(threads));
  internal::forEachItem(graph.size(), threads, [&](std::size_t thread, std::size_t v) {
    spacing[v] = internal::nodeSpacing(graph, v, scratch[thread]);
  });
  const internal::FractionReport report = internal::reportOf(execution, "openings");
  internal::reportFraction(report, 0.1);
  Rotation rotation(points, graph, spacing, threads);
  internal::reportFraction(report, 0.6);
  Openings found = openingsOf(points, graph, spacing, rotation);
  internal::reportFraction(report, 0.8);
  if (found.openings.empty() || !rotation.hasOpposite(graph) ||
      (found.is_one_sided && hasNoCyclesLeft(points, graph, found)))
    return found;
  rotation.separateOpposite();
  return openingsOf(points, graph, spacing, rotation);
}

}  // namespace spherical_param
