#include "depth_jumps.h"

#include "graph_building.h"
#include "neighbor_search.h"
#include "parallel.h"
#include "pi.h"
#include "rows.h"
#include "sphere_mesh.h"
#include "union_find.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Maximum length of the sides of a surface [spacing].
struct Rule {
  double along;             ///< of sides along the rays
  double across;            ///< of sides across the rays
  bool allows_straight_on;  ///< longer sides are no jumps where the surface goes straight on
};

constexpr Rule kRule{4.0, 6.0, false};
/// For boundaries and gaps, where the strict rule would leave out too many points.
constexpr Rule kMildRule{6.0, 8.0, true};
/// Cosine of the angle below which a side runs along its ray: 5 degrees.
const double kNearRay = std::cos(5.0 * kPi / 180.0);

class Opener {
public:
  Opener(const Positions& points, const Indexed<double>& spacing, const ViewMesh& view)
      : points_(points), spacing_(spacing), view_(view),
        mesh_(view.triangles, columnCount(points) + 1) {
    limitSpacing();
  }

  SphereMesh run(std::size_t min_points) {
    for (Index t = 0; t < mesh_.size(); ++t)
      mesh_.setOpen(t, isJumpAt(t, kRule));
    closeAtLoose(min_points);
    releasePinches();
    return std::move(mesh_);
  }

private:
  bool isOpen(Index t) const { return mesh_.isOpen(t); }

  /// Limits the spacing to that of a surface seen at a flat angle: a false point between surfaces
  /// is far from all other points, but near to their rays.
  void limitSpacing() {
    constexpr double max_angle = 3.0;  // [typical angle between rays]
    const Positions directions = directionsFrom(view_.place, points_);
    std::vector<double> angles;
    for (const auto& t : view_.triangles.colwise())
      for (int k = 0; k < 3; ++k)
        if (t[k] != view_.behind && t[(k + 1) % 3] != view_.behind)
          angles.push_back((directions.col(t[k]) - directions.col(t[(k + 1) % 3])).norm());
    const double typical = medianOf(angles);
    for (const Index v : indicesOf(spacing_))
      spacing_[v] =
          std::min(spacing_[v], max_angle * typical * (points_.col(v) - view_.place).norm());
  }

  bool isJumpAt(Index t, const Rule& rule) const {
    const auto& [a, b, c] = mesh_.vertices(t);
    return a == view_.behind || b == view_.behind || c == view_.behind || isFlat(a, b, c) ||
           isJump(a, b, rule) || isJump(b, c, rule) || isJump(c, a, rule);
  }

  /// Whether a triangle has no area, as at the boundary of a flat grid.
  bool isFlat(Index a, Index b, Index c) const {
    const Eigen::Vector3d corner = points_.col(a);
    return (points_.col(b) - corner).cross(Eigen::Vector3d(points_.col(c)) - corner).isZero(0.0);
  }

  bool isJump(Index a, Index b, const Rule& rule) const {
    const Eigen::Vector3d side = points_.col(b) - points_.col(a);
    const Eigen::Vector3d ray = (points_.col(a) + points_.col(b)) / 2.0 - view_.place;
    const double length = side.norm();
    const double cosine = std::abs(side.dot(ray)) / (length * ray.norm());
    const double spacing = std::min(spacing_[a], spacing_[b]);
    const double most = (2.0 * cosine * cosine > 1.0 ? rule.along : rule.across) * spacing;
    return (length > most || (cosine > kNearRay && length > spacing)) &&
           !(rule.allows_straight_on && length < 2.0 * std::min(lengthBehind(a, side / length),
                                                                lengthBehind(b, -side / length)));
  }

  /// Length of the edge before v that the side continues within 30 degrees; 0 if there is none.
  ///
  /// \param direction of the side from v.
  double lengthBehind(Index v, const Eigen::Vector3d& direction) const {
    double best = std::sqrt(0.75);
    double length = 0.0;
    mesh_.forEachAround(v, [&](Index t, int corner) {
      const Index w = mesh_.vertex(t, (corner + 1) % 3);
      if (w == view_.behind)
        return;
      const Eigen::Vector3d edge = points_.col(v) - points_.col(w);
      const double norm = edge.norm();
      if (edge.dot(direction) > best * norm) {
        best = edge.dot(direction) / norm;
        length = norm;
      }
    });
    return length;
  }

  /// Judges the triangles of points in small pieces by the mild rule.
  void closeAtLoose(std::size_t min_points) {
    UnionFind pieces = piecesOf(mesh_.surfaceTriangles(), columnCount(points_));
    const Partition partition(pieces);
    const auto is_loose = [&](Index v) {
      return v != view_.behind && partition.sizes[partition.of[v]] < min_points;
    };
    for (Index t = 0; t < mesh_.size(); ++t) {
      const auto& corners = mesh_.vertices(t);
      if (isOpen(t) && std::any_of(corners.begin(), corners.end(), is_loose))
        mesh_.setOpen(t, isJumpAt(t, kMildRule));
    }
  }

  /// Leaves one fan of the surface at each vertex: closes narrow gaps, opens smaller fans.
  void releasePinches() {
    std::vector<Index> due(columnCount(points_));
    for (std::size_t i = 0; i < due.size(); ++i)
      due[i] = static_cast<Index>(due.size() - i) - 1;
    Indexed<std::uint8_t> was_closed(mesh_.slotCount(), 0);  // so that this ends
    while (!due.empty()) {
      const Index v = due.back();
      due.pop_back();
      if (mesh_.triangleAt(v) < 0)
        continue;
      std::vector<Fan> fans = fansAt(mesh_, v, false);
      if (fans.size() < 2)
        continue;
      const Fan gap = narrowestGap(v, was_closed);
      for (const Index t : gap)
        was_closed[t] = 1;
      setOpen(gap, false, due);
      if (gap.empty())
        for (const Fan& fan : withoutLargest(std::move(fans)))
          setOpen(fan, true, due);
    }
  }

  void setOpen(const Fan& fan, bool is_open, std::vector<Index>& due) {
    for (const Index t : fan) {
      mesh_.setOpen(t, is_open);
      due.insert(due.end(), mesh_.vertices(t).begin(), mesh_.vertices(t).end());
      due.erase(std::remove(due.end() - 3, due.end(), view_.behind), due.end());
    }
  }

  /// The narrowest gap between fans at a vertex that is no jump by the mild rule; empty if all are.
  Fan narrowestGap(Index v, const Indexed<std::uint8_t>& was_closed) const {
    Fan best;
    double least = std::numeric_limits<double>::infinity();
    for (Fan& gap : fansAt(mesh_, v, true)) {
      if (std::any_of(gap.begin(), gap.end(),
                      [&](Index t) { return was_closed[t] != 0 || isJumpAt(t, kMildRule); }))
        continue;
      double width = 0.0;
      for (const Index t : gap)
        width = std::max(width, longestSide(t));
      if (width < least) {
        least = width;
        best = std::move(gap);
      }
    }
    return best;
  }

  double longestSide(Index t) const {
    const auto& [a, b, c] = mesh_.vertices(t);
    return std::max(
        {edgeLength(points_, a, b), edgeLength(points_, b, c), edgeLength(points_, c, a)});
  }

  const Positions& points_;
  Indexed<double> spacing_;
  const ViewMesh& view_;
  SphereMesh mesh_;
};

}  // namespace

Indexed<double> spacingOf(const Positions& points, const Execution& execution) {
  constexpr int neighbors = 6;
  const NeighborLists lists = findNearestNeighbors(points, neighbors, execution);
  Indexed<double> spacing(columnCount(points));
  forEachIndex(spacing.size(), threadCount(execution.threads, spacing.size()), {}, [&](Index i) {
    spacing[i] =
        std::sqrt(nearestOthers(points, i, listOf(lists, i), neighbors).back().squared_distance);
  });
  return spacing;
}

SphereMesh openJumps(const Positions& points, const Indexed<double>& spacing, const ViewMesh& view,
                     std::size_t min_points) {
  return Opener(points, spacing, view).run(min_points);
}

std::vector<Gap> fillGaps(const Positions& points, const Indexed<double>& spacing,
                          const ViewMesh& view, const GapLimits& most, SphereMesh& mesh) {
  std::vector<Gap> filled;
  IndexSet seen(mesh.slotCount());
  Indexed<Index> next(columnCount(points) + 1);  // around the gap
  for (Index first = 0; first < mesh.size(); ++first) {
    if (!mesh.isOpen(first) || !seen.insert(first))
      continue;
    Gap gap;
    gap.triangles.push_back(first);
    std::size_t edges = 0;
    bool is_behind = false;
    Index begin = -1;
    for (std::size_t head = 0; head < gap.triangles.size(); ++head) {
      const Index t = gap.triangles[head];
      for (int k = 0; k < 3; ++k) {
        is_behind = is_behind || mesh.vertex(t, k) == view.behind;
        const Index beyond = mesh.neighbor(t, k);
        if (mesh.isOpen(beyond)) {
          if (seen.insert(beyond))
            gap.triangles.push_back(beyond);
          continue;
        }
        ++edges;
        begin = mesh.side(t, k)[0];
        next[begin] = mesh.side(t, k)[1];
      }
    }
    if (is_behind || edges == 0)
      continue;
    for (Index v = begin; gap.loop.empty() || v != begin; v = next[v])
      gap.loop.push_back(v);
    double length = 0.0;  // in spacings
    for (const Index v : gap.loop)
      length += edgeLength(points, v, next[v]) / spacing[v];
    // Small gaps have no points inside: these may be far behind, and would become spikes. Gaps with
    // several loops are not filled: they are between surfaces of different depth.
    const bool is_small = edges <= most.small && length <= 2.0 * static_cast<double>(most.small) &&
                          gap.triangles.size() + 2 == edges;
    if (gap.loop.size() != edges || !(is_small || edges <= most.edges))
      continue;
    for (const Index t : gap.triangles)
      mesh.setOpen(t, false);
    if (!is_small)
      filled.push_back(std::move(gap));
  }
  return filled;
}

}  // namespace spherical_param::internal
