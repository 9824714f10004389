#include "view_search.h"

#include "depth_jumps.h"
#include "neighbor_search.h"
#include "place_descent.h"
#include "ray_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// The depth jumps at longer sides [spacing].
constexpr double kJump = 4.0;

}  // namespace

bool Sight::isOneLayer() const {
  // Scans from their true places have up to 0.05 jumps, 0.003 layers and a roughness of 1; all
  // around, 0.1, 0.034 and 0.3. Objects from elsewhere have at least 0.14 jumps, or, if their
  // layers are within 4 spacings, a roughness of at least 1.6.
  constexpr double max_roughness = 1.3;
  return roughness < max_roughness && jumps < (is_around ? 0.2 : 0.15) &&
         layers < (is_around ? 0.06 : 0.02);
}

Sight assessView(const Positions& points, const Indexed<double>& spacing, const ViewMesh& view) {
  const auto n = static_cast<Index>(points.cols());
  struct Around {
    int edges = 0;
    int jumps = 0;
    int mixed = 0;  ///< neighbours most of whose edges jump
    double depth = 0.0;
    double across = 0.0;
  };
  Indexed<Around> around(columnCount(points));
  const Positions directions = directionsFrom(view.place, points);
  const auto for_each_edge = [&](const auto& visit) {
    for (const auto& t : view.triangles.colwise())
      for (int k = 0; k < 3; ++k)
        if (t[k] < t[(k + 1) % 3] && t[(k + 1) % 3] < n)
          visit(t[k], t[(k + 1) % 3]);
  };
  std::size_t edges = 0;
  std::size_t jumps = 0;
  for_each_edge([&](Index v, Index w) {
    const bool is_jump =
        (points.col(v) - points.col(w)).norm() > kJump * std::min(spacing[v], spacing[w]);
    const double depth = directions.col(v).dot(points.col(v) - view.place);
    const double depth_there = directions.col(w).dot(points.col(w) - view.place);
    const double across =
        (directions.col(v) - directions.col(w)).norm() * std::sqrt(depth * depth_there);
    around[v].depth += depth_there - depth;
    around[w].depth += depth - depth_there;
    for (const Index end : {v, w}) {
      ++around[end].edges;
      around[end].jumps += is_jump ? 1 : 0;
      around[end].across += across;
    }
    ++edges;
    jumps += is_jump ? 1 : 0;
  });
  const auto is_mixed = [&](Index v) { return 2 * around[v].jumps > around[v].edges; };
  for_each_edge([&](Index v, Index w) {
    around[v].mixed += is_mixed(w) ? 1 : 0;
    around[w].mixed += is_mixed(v) ? 1 : 0;
  });
  std::size_t layered = 0;
  std::size_t rough = 0;
  std::vector<double> roughness;
  for (Index v = 0; v < n; ++v)
    if (around[v].edges > 0) {
      roughness.push_back(std::abs(around[v].depth) / around[v].across);
      rough += roughness.back() > 0.8 ? 1 : 0;
      layered += is_mixed(v) && 2 * around[v].mixed >= around[v].edges ? 1 : 0;
    }
  Sight sight;
  if (edges == 0)
    return sight;
  sight.jumps = static_cast<double>(jumps) / static_cast<double>(edges);
  sight.layers = static_cast<double>(layered) / static_cast<double>(n);
  sight.rough = static_cast<double>(rough) / static_cast<double>(n);
  sight.roughness = medianOf(roughness);
  sight.is_around = view.behind < 0;
  return sight;
}

bool isElevationGrid(const Positions& points) {
  constexpr std::size_t min_lines = 10;
  // The numbers of different x and y among the first points.
  const auto lines_of = [&](std::size_t count) {
    std::array<std::size_t, 2> lines{};
    for (Eigen::Index k = 0; k < 2; ++k) {
      const auto row = points.row(k).head(static_cast<Eigen::Index>(count));
      std::vector<double> values(row.begin(), row.end());
      sortUnique(values);
      lines[static_cast<std::size_t>(k)] = values.size();
    }
    return lines;
  };
  const auto are_many = [&](const std::array<std::size_t, 2>& lines) {
    return lines[0] * lines[1] > 2 * columnCount(points);
  };
  // A quick test with few points: unless they are on a grid, their lines are already too many.
  const auto few = static_cast<std::size_t>(4.0 * std::sqrt(static_cast<double>(points.cols())));
  if (are_many(lines_of(std::min(few, columnCount(points)))))
    return false;
  const std::array<std::size_t, 2> lines = lines_of(columnCount(points));
  if (std::min(lines[0], lines[1]) < min_lines || are_many(lines))
    return false;
  std::vector<std::pair<double, double>> places;
  for (const auto& point : points.colwise())
    places.emplace_back(point.x(), point.y());
  sortUnique(places);
  return places.size() == columnCount(points);
}

Eigen::Vector3d farAbove(const Positions& points, const Eigen::Vector3d& axis) {
  // So far that rays are parallel within a thousandth, and near enough for directions to differ.
  constexpr double extents = 1024.0;
  return middleOf(points) + extents * extentOf(points) * axis.normalized();
}

namespace {

/// The shortest axis of a low sheet, upward; nothing for other clouds.
std::optional<Eigen::Vector3d> axisOfSheet(const Positions& points) {
  // Terrain has 0.05 to 0.21, objects at least 0.28.
  constexpr double max_flatness = 0.25;
  const auto solver = axesOf(points);
  const Eigen::Vector3d& variances = solver.eigenvalues();
  if (!(variances[0] < max_flatness * max_flatness * variances[1]))
    return std::nullopt;
  const Eigen::Vector3d axis = solver.eigenvectors().col(0);
  return axis.z() < 0.0 ? Eigen::Vector3d(-axis) : axis;
}

class Searcher {
public:
  Searcher(const Positions& points, const NeighborSearch& search, const Execution& execution)
      : points_(points), execution_(execution), report_(reportOf(execution, "view")),
        pattern_(points, search) {}

  std::optional<FoundView> run(const Eigen::Vector3d& viewpoint) {
    // Meshing a smaller cloud takes less time than a search.
    constexpr Eigen::Index min_of_sheet = 5000;
    constexpr Eigen::Index min_searched = 20000;
    reportFraction(report_, 0.0);
    if (!viewpoint.isZero(0.0))
      if (auto found = from(viewpoint, ViewSource::Given))
        return found;
    if (pattern_.isSensor(Eigen::Vector3d::Zero()))
      if (auto found = from(Eigen::Vector3d::Zero(), ViewSource::Origin))
        return found;
    if (points_.cols() < min_of_sheet)
      return std::nullopt;
    if (isElevationGrid(points_))
      return from(farAbove(points_, Eigen::Vector3d::UnitZ()), ViewSource::Above);
    if (points_.cols() >= min_searched)
      if (const auto place = pattern_.find(threadCount(execution_.threads, columnCount(points_))))
        if (auto found = from(refined(*place), ViewSource::Rays))
          return found;
    const auto axis = axisOfSheet(points_);
    return axis ? from(farAbove(points_, *axis), ViewSource::Above) : std::nullopt;
  }

private:
  /// The view from a place, if it is of one layer.
  std::optional<FoundView> from(const Eigen::Vector3d& place, ViewSource source) {
    constexpr Eigen::Index most = 2500;
    constexpr double max_jumps = 0.25;
    if (points_.cols() > 2 * most) {
      const Positions sample = points_(Eigen::all, sampleOf(points_, most));
      const Sight sight =
          assessView(sample, spacingOf(sample, execution_), triangulateView(sample, place, {}));
      // If the sample is all around the place, so is the cloud.
      if (!(sight.jumps < max_jumps) ||
          (sight.is_around && source != ViewSource::Given && !pattern_.isSpreadFrom(place)))
        return std::nullopt;
    }
    FoundView found{triangulateView(points_, place, report_), source, {}};
    const Sight sight = assessView(points_, spacing(), found.mesh);
    // Without a sensor, points all around a place are an object that may fold, unless nothing
    // jumps; points in front of it may be two layers.
    const bool is_whole = source == ViewSource::Given && sight.jumps == 0.0;
    const bool is_doubtful = sight.is_around ? !is_whole && !pattern_.isSpreadFrom(place)
                                             : sight.isRough() && !pattern_.isSensor(place);
    if (!sight.isOneLayer() || is_doubtful)
      return std::nullopt;
    found.spacing = std::move(spacing_);
    return found;
  }

  const Indexed<double>& spacing() {
    if (spacing_.empty())
      spacing_ = spacingOf(points_, execution_);
    return spacing_;
  }

  /// The place nearby from which the depth jumps least.
  Eigen::Vector3d refined(Eigen::Vector3d place) {
    constexpr int max_moves = 4;
    const double extent = extentOf(points_);
    const Eigen::Matrix3d axes = axesOf(points_).eigenvectors();
    double least = 1.0;
    std::vector<Index> window;
    Eigen::Vector3d next = place;
    constexpr int rounds = 12;
    constexpr double min_step = 0.001;
    double step = 0.02;
    for (int round = 0; round < rounds && step > min_step; ++round) {
      const ViewMesh view = triangulateView(points_, next, report_);
      const double jumps = assessView(points_, spacing(), view).jumps;
      if (jumps < least) {
        least = jumps;
        place = next;
        window = windowsAtJumps(view);
      } else {
        step /= 2.0;
      }
      if (window.empty())
        break;
      const Positions points = points_(Eigen::all, window);
      Indexed<double> spacing(window.size());
      for (std::size_t i = 0; i < window.size(); ++i)
        spacing[i] = spacing_[window[i]];
      next = place;
      descend(
          [&](const Eigen::Vector3d& at) {
            return assessView(points, spacing, triangulateView(points, at, {})).jumps;
          },
          axes, step * extent, 0.6 * step * extent, max_moves, next);
    }
    return place;
  }

  /// The points around some jumps, as the place sees them, ascending.
  std::vector<Index> windowsAtJumps(const ViewMesh& view) const {
    constexpr std::size_t windows = 16;
    constexpr std::ptrdiff_t points_of_window = 250;
    std::vector<Index> jumps;
    for (const auto& t : view.triangles.colwise())
      if (t[0] != view.behind && t[1] != view.behind &&
          (points_.col(t[0]) - points_.col(t[1])).norm() >
              kJump * std::min(spacing_[t[0]], spacing_[t[1]]))
        jumps.push_back(t[0]);
    const Positions directions = directionsFrom(view.place, points_);
    const auto size = std::min<std::ptrdiff_t>(points_of_window, points_.cols());
    std::vector<Index> all;
    for (std::size_t i = 0; i < std::min(windows, jumps.size()); ++i) {
      const Eigen::VectorXd cosines =
          directions.transpose() * directions.col(jumps[i * jumps.size() / windows]);
      std::vector<Index> order = firstIndices(columnCount(points_));
      std::nth_element(order.begin(), order.begin() + size - 1, order.end(), [&](Index a, Index b) {
        return std::pair(-cosines[a], a) < std::pair(-cosines[b], b);
      });
      all.insert(all.end(), order.begin(), order.begin() + size);
    }
    sortUnique(all);
    return all;
  }

  const Positions& points_;
  const Execution& execution_;
  FractionReport report_;
  RayPattern pattern_;
  Indexed<double> spacing_;
};

}  // namespace

std::optional<FoundView> findView(const Positions& points, const Eigen::Vector3d& viewpoint,
                                  const NeighborSearch& search, const Execution& execution) {
  return Searcher(points, search, execution).run(viewpoint);
}

bool isGiven(const Options& options) {
  return options.view == ViewMode::Up || options.view == ViewMode::Place;
}

Eigen::Vector3d givenPlace(const Positions& nodes, double unit, const Options& options) {
  return options.view == ViewMode::Up ? farAbove(nodes, Eigen::Vector3d::UnitZ())
                                      : Eigen::Vector3d(options.viewpoint / unit);
}

std::optional<Positions> givenDirections(const Positions& nodes, double unit,
                                         const Options& options) {
  return isGiven(options) ? std::optional(directionsFrom(givenPlace(nodes, unit, options), nodes))
                          : std::nullopt;
}

}  // namespace spherical_param::internal
