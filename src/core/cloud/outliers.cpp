#include "outliers.h"

#include "neighbor_search.h"
#include "progress.h"
#include "quadric_fit.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Number of neighbours to which the surface beside a near outlier is fitted.
constexpr std::size_t kFittedNeighbors = 20;

/// Whether the origin is off the quadric of least squares through its neighbours.
bool isOff(const std::vector<Eigen::Vector3d>& neighbors, QuadricFit& quadric) {
  constexpr double n = kFittedNeighbors;
  quadric.fit(neighbors, std::vector<double>(kFittedNeighbors, 1.0 / n));
  // In a gap between the neighbours, wider than a spacing, there is no surface.
  if (quadric.gap() > 1.0)
    return false;
  // Where there are no neighbours, the fit itself is less certain.
  const double distance = std::abs(quadric.height()) / std::sqrt(1.0 + quadric.leverage() / n);
  const double deviation = quadric.residual() * std::sqrt(n / (n - QuadricFit::kCoefficients));
  // Points nearer to the surface than this are never outliers [spacing].
  constexpr double min_distance = 0.25;
  // Outliers are off by more than this number of standard deviations of their neighbours. With
  // fewer, coarsely sampled objects lose points.
  constexpr double min_deviations = 20.0;
  return distance > std::max(min_distance, min_deviations * deviation);
}

/// The nearest others of a point that are not stray, at most `count`.
std::vector<NearPoint> nearestOnSurface(const Positions& points, Index i, const Row<Index>& list,
                                        const Indexed<char>& is_stray, std::size_t count) {
  std::vector<NearPoint> near = nearestOthers(points, i, list);
  near.erase(std::remove_if(near.begin(), near.end(),
                            [&](const NearPoint& each) { return is_stray[each.point] != 0; }),
             near.end());
  near.erase(near.begin() + static_cast<std::ptrdiff_t>(std::min(count, near.size())), near.end());
  return near;
}

/// The points that may be off the surface, since they are not in the plane of their star; without
/// stray points.
std::vector<Index> pointsOffPlane(const Stars& stars, const Indexed<char>& is_stray, int threads) {
  constexpr float max_height = 0.2F;
  return collectBlocks<Index>(
      stars.size(), threads, {}, [&](Index begin, Index end, std::vector<Index>& found) {
        for (Index i = begin; i < end; ++i)
          if (is_stray[i] == 0 && !(stars[i].tangent_plane && stars[i].height <= max_height))
            found.push_back(i);
      });
}

/// Marks the stray points, and isolated ones near a surface. These are far from the quadric through
/// their neighbours, compared to the spacing there and to the neighbours' own distances from it.
Indexed<char> withNearOutliers(const Positions& points, const Neighbors& neighbors,
                               const Stars& stars, const Indexed<char>& is_stray,
                               const Execution& execution) {
  const int threads = threadCount(execution.threads, stars.size());
  const FractionReport report = reportOf(execution, "outliers");
  // Points among more stray ones are not examined.
  constexpr std::size_t max_searched = 16 * kFittedNeighbors;
  Indexed<char> marked = is_stray;
  Indexed<double> spacing(stars.size());
  forEachIndex(stars.size(), threads, report, [&](Index i) {
    // The fourth is the median of six.
    const auto near = nearestOnSurface(points, i, listOf(neighbors.lists, i), is_stray, 4);
    spacing[i] = near.empty() ? 0.0 : std::sqrt(near.back().squared_distance);
  });
  std::vector<Index> due = pointsOffPlane(stars, is_stray, threads);
  for (std::size_t count = kFittedNeighbors;
       !due.empty() && count < std::min(stars.size(), max_searched); count *= 2) {
    const NeighborLists lists = neighbors.search(due, static_cast<int>(count));
    Indexed<char> has_few(due.size(), 0);  // the list has too many stray points
    forEachIndex<QuadricFit>(due.size(), threads, report, [&](QuadricFit& quadric, Index list) {
      const Index i = due[static_cast<std::size_t>(list)];
      const auto near =
          nearestOnSurface(points, i, listOf(lists, list), is_stray, kFittedNeighbors);
      has_few[list] = near.size() < kFittedNeighbors ? 1 : 0;
      std::vector<double> spacings;
      std::vector<Eigen::Vector3d> offsets;
      for (const NearPoint& each : near) {
        spacings.push_back(spacing[each.point]);
        offsets.push_back(each.offset);
      }
      const double unit = has_few[list] != 0 ? 0.0 : medianOf(spacings);
      if (!(unit > 0.0))
        return;
      for (Eigen::Vector3d& offset : offsets)
        offset /= unit;
      marked[i] = isOff(offsets, quadric) ? 1 : 0;
    });
    std::vector<Index> left;
    for (const Index list : indicesOf(has_few))
      if (has_few[list] != 0)
        left.push_back(due[static_cast<std::size_t>(list)]);
    due = std::move(left);
  }
  return marked;
}

/// Number of neighbours that define the surface at a point.
constexpr int kNeighbors = 16;
/// Fewer neighbours span no plane.
constexpr int kMinNeighbors = 3;

/// The distance of a point from the plane (or line) of least squares through its neighbours.
double distanceFromPlane(const Positions& points, Index i, const std::vector<Index>& neighbors) {
  // Relative to the point: far from the origin, digits would be lost.
  Eigen::Matrix3Xd offsets = points(Eigen::all, neighbors).colwise() - points.col(i);
  const Eigen::Vector3d centroid = offsets.rowwise().mean();
  offsets.colwise() -= centroid;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(offsets * offsets.transpose());
  const Eigen::Vector3d& spread = axes.eigenvalues();  // ascending, squared
  // Neighbours on a line have a smaller ratio of the spreads across and along it.
  constexpr double min_spread_ratio = 1e-6;
  if (spread[1] <= min_spread_ratio * min_spread_ratio * spread[2]) {
    const Eigen::Vector3d along = axes.eigenvectors().col(2);
    return spread[2] > 0.0 ? (centroid - centroid.dot(along) * along).norm() : centroid.norm();
  }
  return std::abs(centroid.dot(axes.eigenvectors().col(0)));
}

/// The neighbours of the points, without outliers, and the scores of the points.
class Scoring {
public:
  Scoring(const Positions& points, const NeighborLists& lists, int threads)
      : scores(lists.size(), 0.0), points_(points), threads_(threads), neighbors_(lists.size()),
        mean_distance_(lists.size()) {
    forEachIndex(lists.size(), threads_, {}, [&](Index i) {
      for (const NearPoint& near : nearestOthers(points_, i, listOf(lists, i)))
        neighbors_[i].push_back(near.point);
    });
  }

  /// Removes the given points from all lists, and computes the scores of the others.
  void compute(const Indexed<char>& is_outlier) {
    forEachIndex(scores.size(), threads_, {}, [&](Index i) {
      std::vector<Index>& around = neighbors_[i];
      const auto rest = std::stable_partition(around.begin(), around.end(),
                                              [&](Index j) { return is_outlier[j] == 0; });
      // If too few are left, the list stays as it was.
      if (rest - around.begin() >= kMinNeighbors)
        around.erase(rest, around.end());
      const Row<Index> used = usedOf(i);
      const double sum = std::accumulate(used.begin(), used.end(), 0.0, [&](double total, Index j) {
        return total + (points_.col(j) - points_.col(i)).norm();
      });
      mean_distance_[i] = used.size() > 0 ? sum / static_cast<double>(used.size()) : 0.0;
    });
    forEachIndex(scores.size(), threads_, {}, [&](Index i) {
      if (is_outlier[i] == 0)
        scores[i] = score(i);
    });
  }

  Indexed<double> scores;

private:
  /// The kNeighbors nearest of the remaining neighbours.
  Row<Index> usedOf(Index i) const {
    const std::vector<Index>& all = neighbors_[i];
    return Row<Index>(all.data(), all.data() + all.size()).first(kNeighbors);
  }

  double score(Index i) const {
    const Row<Index> used = usedOf(i);
    if (used.size() < kMinNeighbors)
      return 0.0;
    std::vector<Index> around(used.begin(), used.end());  // the densest first
    std::stable_sort(around.begin(), around.end(),
                     [&](Index j, Index k) { return mean_distance_[j] < mean_distance_[k]; });
    const double scale = mean_distance_[around[around.size() / 2]];
    if (!(scale > 0.0))
      return 0.0;  // neighbours in one place have no scale
    // Neighbours may be outliers if their mean distance is longer than this [median of these].
    constexpr double max_distance_ratio = 2.0;
    while (mean_distance_[around.back()] > max_distance_ratio * scale)
      around.pop_back();
    return distanceFromPlane(points_, i, around) / scale;
  }

  const Positions& points_;
  int threads_;
  Indexed<std::vector<Index>> neighbors_;
  Indexed<double> mean_distance_;
};

}  // namespace

DeviatingPoints deviatingPoints(const Positions& points, const NeighborLists& lists, double sigma,
                                const Execution& execution) {
  const int threads = threadCount(execution.threads, lists.size());
  const FractionReport report = reportOf(execution, "outliers");
  DeviatingPoints result;
  Scoring scoring(points, lists, threads);
  Indexed<char> is_outlier(lists.size(), 0);
  // The last round marks at most this fraction of all marked points.
  constexpr double min_gain = 0.01;
  std::size_t marked = 0;
  for (std::size_t gained = 1;
       gained > fractionOf(min_gain, marked) && lists.size() - marked > kMinNeighbors;
       marked += gained) {
    reportFraction(report, 0.0);
    scoring.compute(is_outlier);
    const auto mean_over_rest = [&](const auto& value) {
      const double sum = accumulate(is_outlier.size(), threads, 0.0, [&](Index i, double& total) {
        if (is_outlier[i] == 0)
          total += value(std::min(scoring.scores[i], 1.0));
      });
      return sum / static_cast<double>(lists.size() - marked);
    };
    const double mean = mean_over_rest([](double score) { return score; });
    const double deviation =
        std::sqrt(mean_over_rest([&](double score) { return (score - mean) * (score - mean); }));
    result.threshold = std::max(mean + sigma * deviation, 1.0);
    gained = 0;
    for (const Index i : indicesOf(is_outlier))
      if (is_outlier[i] == 0 && scoring.scores[i] > result.threshold) {
        is_outlier[i] = 1;
        ++gained;
      }
  }
  reportFraction(report, 1.0);
  result.scores = std::move(scoring.scores);
  for (const Index i : indicesOf(is_outlier))
    if (is_outlier[i] != 0)
      result.indices.push_back(i);
  return result;
}

Indexed<char> markOutliers(OutlierMode mode, double sigma, const Positions& points,
                           const Neighbors& neighbors, const Stars& stars,
                           const std::vector<StrayPoint>& stray, const Execution& execution) {
  Indexed<char> marked(stars.size(), 0);
  for (const StrayPoint& each : stray)
    marked[each.point] = 1;
  if (mode == OutlierMode::Auto)
    return withNearOutliers(points, neighbors, stars, marked, execution);
  // Without stray points: those of a net are neighbours of each other, and those between two sheets
  // are in the plane of both.
  Indexed<Index> others;
  for (const Index i : indicesOf(marked))
    if (marked[i] == 0)
      others.push_back(i);
  const Positions rest = points(Eigen::all, others);
  const DeviatingPoints found = deviatingPoints(
      rest, findNearestNeighbors(rest, 2 * kNeighbors, execution), sigma, execution);
  for (const Index i : found.indices)
    marked[others[i]] = 1;
  for (const StrayPoint& each : stray)
    marked[each.point] = each.distance > found.threshold ? 1 : 0;
  return marked;
}

}  // namespace spherical_param::internal
