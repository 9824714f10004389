#include "openings.h"

#include "filled_graph.h"
#include "graph_building.h"
#include "graph_cycles.h"
#include "pi.h"
#include "point_set.h"
#include "progress.h"
#include "rows.h"
#include "union_find.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace spherical_param {
namespace internal {
namespace {

/// Edges longer than this are not taken for edges of the surface [larger spacing of their ends].
constexpr double kMaxLength = 1.5;
/// What a face needs to be an opening: edges, width [spacing] and mean corner [rad].
constexpr std::size_t kMinSteps = 7;
constexpr double kMinWidth = 3.0;
constexpr double kMinCorner = 0.65 * kPi;
/// Edges between sheets are steeper than this [sine], and join normals of a smaller cosine. Normals
/// of opposite sheets are as far apart, and to different sides.
constexpr double kMaxSheetSlope = 0.6;
constexpr double kMinSheetCosine = 0.5;

/// The short edges of the graph that do not cross each other; those of each node in the order
/// around its normal.
class Rotation {
public:
  Rotation(const Positions& points, const Graph& graph, const Indexed<double>& spacing, int threads)
      : points_(points), threads_(threads), edges_(graph) {
    keepEdges([&](Index v, std::size_t e) {
      return graph.lengths[e] <= kMaxLength * std::max(spacing[v], spacing[graph.neighbors[e]]);
    });
    findNormals();
    orientNormals();
    const std::vector<char> crosses = longerOfCrossing();
    keepEdges([&](Index v, std::size_t e) {
      const Index w = edges_.neighbors[e];
      return crosses[v < w ? e : entryOf(w, v)] == 0 && !leavesSheet(v, w);
    });
    sortAround();
  }

  /// Leaves out the edges between opposite sheets.
  void separateOpposite() {
    separates_opposite_ = true;
    keepEdges([&](Index v, std::size_t e) { return !areOpposite(v, edges_.neighbors[e]); });
    sortAround();
  }

  /// Whether an edge joins two sheets: it is steep to one of them, and their normals differ.
  bool leavesSheet(Index v, Index w) const {
    return (separates_opposite_ && areOpposite(v, w)) ||
           (std::abs(cosine(v, w)) < kMinSheetCosine && slope(v, w) > kMaxSheetSlope);
  }

  /// Whether some edges of the graph join opposite sheets.
  bool hasOpposite(const Graph& graph) const {
    return countEdges(graph, [&](Index v, Index w) { return areOpposite(v, w); }) > 0;
  }

  /// Edges between neighbours on one sheet that have normals to opposite sides.
  std::size_t countTwisted() const {
    // Neighbours on one sheet for sure have normals of a larger cosine, but for the sign, and an
    // edge that is half as steep as between sheets.
    constexpr double min_one_sheet_cosine = 0.9;
    return countEdges(edges_, [&](Index v, Index w) {
      return cosine(v, w) < -min_one_sheet_cosine && slope(v, w) < kMaxSheetSlope / 2.0;
    });
  }

  /// The loops of all faces with at least some edges whose mean corner is large enough, with the
  /// face on the left seen from where the normals point.
  std::vector<std::vector<Index>> faces(std::size_t min_steps, double min_corner) const {
    std::vector<std::vector<Index>> found;
    std::vector<char> is_seen(edges_.neighbors.size(), 0);
    std::vector<Index> loop;
    for (const Index v : edges_.nodes())
      for (const std::size_t e : edges_.entries(v)) {
        loop.clear();
        double corners = 0.0;
        Index from = v;
        for (std::size_t edge = e; std::exchange(is_seen[edge], 1) == 0;) {
          const Index to = edges_.neighbors[edge];
          loop.push_back(from);
          const std::size_t back = entryOf(to, from);
          edge = (back > edges_.begin(to) ? back : edges_.end(to)) - 1;
          corners += cornerBetween(edge, back);
          from = to;
        }
        if (loop.size() >= min_steps && corners >= min_corner * static_cast<double>(loop.size()))
          found.push_back(loop);
      }
    return found;
  }

private:
  /// Leaves out the edges that do not meet a condition.
  template <typename Condition>
  void keepEdges(const Condition& meets) {
    edges_ = rowsOfBlocks(edges_.size(), threads_, {}, [&](Index begin, Index end, Graph& rows) {
      for (const Index v : NumberRange(begin, end)) {
        for (const std::size_t e : edges_.entries(v))
          if (meets(v, e))
            rows.neighbors.push_back(edges_.neighbors[e]);
        rows.endRow();
      }
    });
  }

  /// Number of edges that meet a condition.
  template <typename Condition>
  static std::size_t countEdges(const NeighborRows& edges, const Condition& meets) {
    std::size_t count = 0;
    for (const Index v : edges.nodes())
      for (const Index w : edges.row(v))
        count += w > v && meets(v, w) ? 1 : 0;
    return count;
  }

  /// Cosine between the normals of two nodes.
  double cosine(Index v, Index w) const { return normals_.col(v).dot(normals_.col(w)); }

  bool areOpposite(Index v, Index w) const { return cosine(v, w) < -kMinSheetCosine; }

  /// Of an edge to the steeper of the planes of its ends [sine].
  double slope(Index v, Index w) const {
    const Eigen::Vector3d d = direction(v, w);
    return std::max(std::abs(d.dot(normals_.col(v))), std::abs(d.dot(normals_.col(w))));
  }

  bool areJoined(Index v, Index w) const { return edges_.row(v).contains(w); }

  /// For each edge, at its lower node, 1 if it crosses a shorter one: the diagonals of four points
  /// that are all neighbours. Of two as long as each other, the one of the higher node counts as
  /// longer.
  std::vector<char> longerOfCrossing() const {
    std::vector<char> crosses(edges_.neighbors.size(), 0);
    forEachIndex<std::vector<Index>>(
        edges_.size(), threads_, {}, [&](std::vector<Index>& common, Index v) {
          for (const std::size_t e : edges_.entries(v)) {
            const Index w = edges_.neighbors[e];
            if (w < v)
              continue;
            common.clear();
            for (const Index a : edges_.row(v))
              if (a != w && areJoined(a, w))
                common.push_back(a);
            for (const Index a : common)
              for (const Index b : common)
                if (a < b && areJoined(a, b) && isLonger(v, w, a, b) && doCross(v, w, a, b))
                  crosses[e] = 1;
          }
        });
    return crosses;
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
    normals_.resize(3, points_.cols());
    forEachIndex(edges_.size(), threads_, {}, [&](Index v) {
      Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double count = 0.0;
      const auto add = [&](Index w) {
        const Eigen::Vector3d d = direction(v, w);
        moments += d * d.transpose();
        sum += d;
        count += 1.0;
      };
      for (const Index w : edges_.row(v)) {
        add(w);
        for (const Index x : edges_.row(w))
          if (x != v)
            add(x);
      }
      // How far the moments of directions are taken about their mean, not about 0.
      constexpr double centered = 0.5;
      // On a sharp edge the moments alone would decide for one of its two planes.
      if (count > 0.0)
        moments -= centered / count * sum * sum.transpose();
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
      solver.computeDirect(moments);
      normals_.col(v) = solver.eigenvectors().col(0);
    });
  }

  /// Turns the normals of each component to one side: along edges between the most similar normals
  /// first.
  void orientNormals() {
    constexpr int buckets = 256;
    std::array<std::vector<std::array<Index, 2>>, buckets> edges;  // the most similar first
    for (const Index v : edges_.nodes())
      for (const Index w : edges_.row(v))
        if (w > v)
          edges[static_cast<std::size_t>(std::clamp(
                    static_cast<int>((1.0 - std::abs(cosine(v, w))) * buckets), 0, buckets - 1))]
              .push_back({v, w});
    // A normal as it is, or turned: one of each pair is on the side of the lowest node of its
    // component, which represents its set.
    const auto n = static_cast<Index>(edges_.size());
    UnionFind sides(2 * edges_.size());
    for (const auto& bucket : edges)
      for (const auto& [v, w] : bucket) {
        const bool turns = cosine(v, w) < 0.0;
        const Index on_side_of_v = turns ? w + n : w;
        if (sides.find(v) == sides.find(turns ? w : w + n))
          continue;
        sides.unite(v, on_side_of_v);
        sides.unite(v + n, turns ? w : w + n);
      }
    for (const Index v : edges_.nodes())
      if (sides.find(v) > sides.find(v + n))
        normals_.col(v) *= -1.0;
  }

  /// Sorts the neighbours of each node counter-clockwise.
  void sortAround() {
    angles_.resize(edges_.neighbors.size());
    using Around = std::vector<std::pair<double, Index>>;
    forEachIndex<Around>(edges_.size(), threads_, {}, [&](Around& around, Index v) {
      around.clear();
      const Eigen::Vector3d normal = normals_.col(v);
      const Eigen::Vector3d x = normal.unitOrthogonal();
      const Eigen::Vector3d y = normal.cross(x);
      for (const Index w : edges_.row(v)) {
        const Eigen::Vector3d d = direction(v, w);
        around.emplace_back(std::atan2(y.dot(d), x.dot(d)), w);
      }
      std::sort(around.begin(), around.end());
      std::size_t e = edges_.begin(v);
      for (const auto& [angle, w] : around) {
        angles_[e] = angle;
        edges_.neighbors[e++] = w;
      }
    });
  }

  /// Where v names w.
  std::size_t entryOf(Index v, Index w) const {
    std::size_t e = edges_.begin(v);
    while (edges_.neighbors[e] != w)
      ++e;
    return e;
  }

  /// The angle counter-clockwise from one edge of a node to another, a full turn if they are one.
  double cornerBetween(std::size_t from, std::size_t to) const {
    const double angle = angles_[to] - angles_[from];
    return angle > 0.0 ? angle : angle + 2.0 * kPi;
  }

  const Positions& points_;
  int threads_;
  NeighborRows edges_;
  std::vector<double> angles_;  ///< of the edges
  Positions normals_;
  bool separates_opposite_ = false;
};

/// Sizes of what a loop encloses.
Opening measured(const Positions& points, const Indexed<double>& spacing, std::vector<Index> loop) {
  Opening opening;
  opening.loop = std::move(loop);
  const auto m = static_cast<double>(opening.loop.size());
  for (const Index v : opening.loop) {
    opening.center += points.col(v) / m;
    opening.spacing += spacing[v] / m;
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
  opening.width =
      std::min(4.0 * opening.area / opening.boundary_length, opening.boundary_length / kPi);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments, Eigen::EigenvaluesOnly);
  // Loops nearer to a plane are flat [spacing].
  constexpr double max_flat = 0.01;
  opening.is_flat = std::sqrt(std::max(0.0, axes.eigenvalues()[0])) < max_flat * opening.spacing;
  opening.certainty =
      std::clamp((opening.width / opening.spacing - kMinWidth) / (2.0 * kMinWidth), 0.0, 1.0);
  return opening;
}

/// The edges of a graph across openings, and from a loop to another sheet.
std::vector<std::array<Index, 2>> falseEdges(const Graph& graph, const Rotation& rotation,
                                             const Openings& found) {
  Indexed<Index> loop_of(graph.size(), -1);
  Index loop = 0;
  for (const Opening& opening : found.openings) {
    for (const Index v : opening.loop)
      loop_of[v] = loop;
    ++loop;
  }
  std::vector<std::array<Index, 2>> edges;
  for (const Index v : graph.nodes())
    for (const std::size_t e : graph.entries(v)) {
      const Index w = graph.neighbors[e];
      if (w < v || (loop_of[v] < 0 && loop_of[w] < 0))
        continue;
      const bool is_across =
          loop_of[v] == loop_of[w] &&
          graph.lengths[e] > kMaxLength * std::max(found.spacing[v], found.spacing[w]);
      if (is_across || rotation.leavesSheet(v, w))
        edges.push_back({v, w});
    }
  return edges;
}

/// The largest face of the graph of a flat patch, however narrow: what is around it. None of points
/// on a line.
std::optional<Opening> outsideOf(const Positions& points, const Indexed<double>& spacing,
                                 const Rotation& rotation) {
  // A narrower flat patch is a line [spacing].
  constexpr double min_patch_width = 0.1;
  std::optional<Opening> outside;
  for (std::vector<Index>& loop : rotation.faces(3, 0.0)) {
    Opening face = measured(points, spacing, std::move(loop));
    if (face.width >= min_patch_width * face.spacing && (!outside || face.area > outside->area))
      outside = std::move(face);
  }
  return outside;
}

/// The openings that are seen.
Openings openingsOf(const Positions& points, const Graph& graph, const Indexed<double>& spacing,
                    const Rotation& rotation) {
  Openings result;
  // A face less round than this, 1 for a disc, is a slit, and must be wider [spacing]. Left open, a
  // seam of a closed model, 82 edges long and 3.6 spacings wide, makes the RMS of its open clouds 4
  // to 30 times as large; a true slit of 14 clouds that is filled 1.5 times. With 5 spacings
  // another two sheets join.
  constexpr double min_roundness = 0.2;
  constexpr double min_slit_width = 4.0;
  result.spacing = spacing;
  for (std::vector<Index>& loop : rotation.faces(kMinSteps, kMinCorner)) {
    Opening opening = measured(points, spacing, std::move(loop));
    const double roundness = kPi * opening.width / opening.boundary_length;
    if (opening.width >= (roundness < min_roundness ? min_slit_width : kMinWidth) * opening.spacing)
      result.openings.push_back(std::move(opening));
  }
  if (result.openings.empty() && areCoplanar(points)) {
    std::optional<Opening> outside = outsideOf(points, spacing, rotation);
    if (outside)
      result.openings.push_back(std::move(*outside));
  }
  // Neighbours on one sheet with opposite normals, from which on a surface has one side only.
  constexpr std::size_t min_twisted = 10;
  result.is_one_sided = !result.openings.empty() && rotation.countTwisted() >= min_twisted;
  result.false_edges = falseEdges(graph, rotation, result);
  std::stable_sort(
      result.openings.begin(), result.openings.end(),
      [](const Opening& a, const Opening& b) { return a.boundary_length > b.boundary_length; });
  return result;
}

/// Whether the openings are all that there are: the graph has no cycles when they are filled, but
/// for those of up to six points.
bool hasNoCyclesLeft(const Positions& points, const Graph& graph, const Openings& found) {
  return countCycles(fillOpenings(points, graph, found).graph, 2) == 0;
}

}  // namespace
}  // namespace internal

Openings findOpenings(const Positions& points, const Graph& graph, const Execution& execution) {
  const int threads = internal::threadCount(execution.threads, graph.size());
  internal::Indexed<double> spacing(graph.size());
  internal::forEachIndex(graph.size(), threads, {},
                         [&](Index v) { spacing[v] = internal::nodeSpacing(graph, v); });
  const internal::FractionReport report = internal::reportOf(execution, "openings");
  internal::reportFraction(report, 0.1);
  internal::Rotation rotation(points, graph, spacing, threads);
  internal::reportFraction(report, 0.6);
  Openings found = internal::openingsOf(points, graph, spacing, rotation);
  internal::reportFraction(report, 0.8);
  if (found.openings.empty() || !rotation.hasOpposite(graph) ||
      (found.is_one_sided && internal::hasNoCyclesLeft(points, graph, found)))
    return found;
  rotation.separateOpposite();
  return internal::openingsOf(points, graph, spacing, rotation);
}

}  // namespace spherical_param
