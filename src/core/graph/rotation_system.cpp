#include "rotation_system.h"

#include "graph_building.h"
#include "pi.h"
#include "union_find.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Edges between sheets are steeper than kMaxSheetSlope [sine], and their normals have a smaller
/// cosine than kMinSheetCosine. Normals of opposite sheets have a cosine below -kMinSheetCosine.
constexpr double kMaxSheetSlope = 0.6;
constexpr double kMinSheetCosine = 0.5;

/// The angle in (0, 2 pi] of a difference of angles.
double counterClockwise(double angle) {
  return angle > 0.0 ? angle : angle + 2.0 * kPi;
}

/// Number of edges that meet a condition.
template <typename Condition>
std::size_t countEdges(const NeighborRows& edges, const Condition& meets) {
  std::size_t count = 0;
  for (const Index v : edges.nodes())
    for (const Index w : edges.row(v))
      count += w > v && meets(v, w) ? 1 : 0;
  return count;
}

}  // namespace

Indexed<double> nodeSpacings(const Graph& graph, int threads) {
  Indexed<double> spacing(graph.size());
  forEachIndex(graph.size(), threadCount(threads, graph.size()), {},
               [&](Index v) { spacing[v] = nodeSpacing(graph, v); });
  return spacing;
}

RotationSystem::RotationSystem(const Positions& points, const Graph& graph,
                               const Indexed<double>& spacing, int threads)
    : points_(points), threads_(threadCount(threads, graph.size())), edges_(graph) {
  keepEdges([&](Index v, std::size_t e) {
    return graph.lengths[e] <= kMaxEdgeLength * std::max(spacing[v], spacing[graph.neighbors[e]]);
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

std::size_t RotationSystem::entryOf(Index v, Index w) const {
  std::size_t e = edges_.begin(v);
  while (edges_.neighbors[e] != w)
    ++e;
  return e;
}

void RotationSystem::separateOpposite() {
  separates_opposite_ = true;
  keepEdges([&](Index v, std::size_t e) { return !areOpposite(v, edges_.neighbors[e]); });
  sortAround();
}

bool RotationSystem::leavesSheet(Index v, Index w) const {
  return (separates_opposite_ && areOpposite(v, w)) ||
         (std::abs(cosine(v, w)) < kMinSheetCosine && slope(v, w) > kMaxSheetSlope);
}

bool RotationSystem::hasOpposite(const Graph& graph) const {
  return countEdges(graph, [&](Index v, Index w) { return areOpposite(v, w); }) > 0;
}

bool RotationSystem::isOneSided() const {
  // Normals of neighbours that are certainly on one sheet have a larger cosine.
  constexpr double min_one_sheet_cosine = 0.7;
  // On a Moebius band and a Klein bottle all twisted edges are against the others, on thin wings up
  // to two thirds.
  constexpr std::size_t min_against = 10;
  constexpr double min_fraction = 0.8;
  const auto n = static_cast<Index>(edges_.size());
  // Node v is v's normal as it is, v + n the turned one. Joined ones are on one side.
  UnionFind sides(2 * edges_.size());
  std::size_t against = 0;
  std::size_t twisted = 0;
  const auto for_each_edge = [&](const auto& visit) {
    for (const Index v : edges_.nodes())
      for (const Index w : edges_.row(v))
        if (v < w)
          visit(v, w);
  };
  for_each_edge([&](Index v, Index w) {
    if (cosine(v, w) >= min_one_sheet_cosine) {
      sides.unite(v, w);
      sides.unite(v + n, w + n);
    }
  });
  for_each_edge([&](Index v, Index w) {
    if (!isTwisted(v, w))
      return;
    ++twisted;
    if (!isInGap(v, w) || !isInGap(w, v))
      return;
    against += sides.find(v) == sides.find(w) ? 1 : 0;
    sides.unite(v, w + n);
    sides.unite(v + n, w);
  });
  return against >= std::max(min_against, fractionOf(min_fraction, twisted));
}

/// Whether neighbours on one sheet have normals to opposite sides.
bool RotationSystem::isTwisted(Index v, Index w) const {
  constexpr double min_cosine = 0.9;
  return cosine(v, w) < -min_cosine && slope(v, w) < kMaxSheetSlope / 2.0;
}

/// Whether a twisted edge of v is in a wide gap between the other edges. Beside an opposite sheet,
/// there is no gap.
bool RotationSystem::isInGap(Index v, Index w) const {
  constexpr double min_gap = 0.55 * kPi;
  const double angle = angles_[entryOf(v, w)];
  double after = 2.0 * kPi;
  double before = 2.0 * kPi;
  for (const std::size_t e : edges_.entries(v)) {
    if (isTwisted(v, edges_.neighbors[e]))
      continue;
    after = std::min(after, counterClockwise(angles_[e] - angle));
    before = std::min(before, counterClockwise(angle - angles_[e]));
  }
  return after + before >= min_gap;
}

NeighborRows RotationSystem::faces(std::size_t min_steps, double min_corner) const {
  NeighborRows found;
  std::vector<Index>& nodes = found.neighbors;
  std::vector<char> is_seen(edges_.neighbors.size(), 0);
  for (const Index v : edges_.nodes())
    for (const std::size_t e : edges_.entries(v)) {
      const std::size_t begin = nodes.size();
      double corners = 0.0;
      Index from = v;
      for (std::size_t edge = e; std::exchange(is_seen[edge], 1) == 0;) {
        const Index to = edges_.neighbors[edge];
        nodes.push_back(from);
        const std::size_t back = entryOf(to, from);
        edge = (back > edges_.begin(to) ? back : edges_.end(to)) - 1;
        corners += counterClockwise(angles_[back] - angles_[edge]);
        from = to;
      }
      const std::size_t steps = nodes.size() - begin;
      if (steps >= min_steps && corners >= min_corner * static_cast<double>(steps))
        found.endRow();
      else
        nodes.resize(begin);
    }
  return found;
}

/// Leaves out the edges that do not meet a condition.
template <typename Condition>
void RotationSystem::keepEdges(const Condition& meets) {
  edges_ = rowsOfBlocks(edges_.size(), threads_, {}, [&](Index begin, Index end, Graph& rows) {
    for (const Index v : NumberRange(begin, end)) {
      for (const std::size_t e : edges_.entries(v))
        if (meets(v, e))
          rows.neighbors.push_back(edges_.neighbors[e]);
      rows.endRow();
    }
  });
}

bool RotationSystem::areOpposite(Index v, Index w) const {
  return cosine(v, w) < -kMinSheetCosine;
}

/// Slope of an edge over the planes of its ends, the larger one [sine].
double RotationSystem::slope(Index v, Index w) const {
  const Eigen::Vector3d d = direction(v, w);
  return std::max(std::abs(d.dot(normals_.col(v))), std::abs(d.dot(normals_.col(w))));
}

/// For each edge, at its lower node, 1 if it crosses a shorter one. Only the diagonals of four
/// points that are all neighbours cross.
std::vector<char> RotationSystem::longerOfCrossing() const {
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

bool RotationSystem::isLonger(Index v, Index w, Index a, Index b) const {
  const double length = (points_.col(v) - points_.col(w)).squaredNorm();
  const double other = (points_.col(a) - points_.col(b)).squaredNorm();
  return length != other ? length > other : std::max(v, w) > std::max(a, b);
}

/// Whether two edges cross, seen along the normal of v.
bool RotationSystem::doCross(Index v, Index w, Index a, Index b) const {
  const Eigen::Vector3d normal = normals_.col(v);
  const auto side = [&](Index from, Index to, Index of) {
    const Eigen::Vector3d edge = points_.col(to) - points_.col(from);
    return normal.dot(edge.cross(Eigen::Vector3d(points_.col(of) - points_.col(from)))) > 0.0;
  };
  return side(v, w, a) != side(v, w, b) && side(a, b, v) != side(a, b, w);
}

Eigen::Vector3d RotationSystem::direction(Index v, Index w) const {
  return 1.0 / edgeLength(points_, v, w) * (points_.col(w) - points_.col(v));
}

void RotationSystem::findNormals() {
  normals_.resize(3, points_.cols());
  forEachIndex(edges_.size(), threads_, {}, [&](Index v) {
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0.0;
    const auto add = [&](Index w) {
      const Eigen::Vector3d d = direction(v, w);
      moments.col(0) += d.x() * d;
      moments.col(1).tail<2>() += d.y() * d.tail<2>();
      moments(2, 2) += d.z() * d.z();
      sum += d;
      count += 1.0;
    };
    for (const Index w : edges_.row(v)) {
      add(w);
      for (const Index x : edges_.row(w))
        if (x != v)
          add(x);
    }
    moments = moments.selfadjointView<Eigen::Lower>();
    // The moments are taken about half of the mean direction. About 0, a node on a sharp edge would
    // get the normal of one of its two planes.
    constexpr double centered = 0.5;
    if (count > 0.0)
      moments -= centered / count * sum * sum.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(moments);
    normals_.col(v) = solver.eigenvectors().col(0);
  });
}

/// Turns the normals of each component to one side, along edges between the most similar normals
/// first.
void RotationSystem::orientNormals() {
  constexpr int buckets = 256;
  std::array<std::vector<std::array<Index, 2>>, buckets> edges;  // the most similar first
  for (const Index v : edges_.nodes())
    for (const Index w : edges_.row(v))
      if (w > v)
        edges[static_cast<std::size_t>(std::clamp(
                  static_cast<int>((1.0 - std::abs(cosine(v, w))) * buckets), 0, buckets - 1))]
            .push_back({v, w});
  // Node v is v's normal as it is, v + n the turned one. The one on the side of the lowest node of
  // the component is in the set of a lower representative.
  const auto n = static_cast<Index>(edges_.size());
  UnionFind sides(2 * edges_.size());
  for (const auto& bucket : edges)
    for (const auto& [v, w] : bucket) {
      const auto [same, other] = cosine(v, w) < 0.0 ? std::pair(w + n, w) : std::pair(w, w + n);
      if (sides.find(v) == sides.find(other))
        continue;
      sides.unite(v, same);
      sides.unite(v + n, other);
    }
  for (const Index v : edges_.nodes())
    if (sides.find(v) > sides.find(v + n))
      normals_.col(v) *= -1.0;
}

/// Sorts the neighbours of each node counter-clockwise.
void RotationSystem::sortAround() {
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

}  // namespace spherical_param::internal
