#include "outliers.h"

#include "near_outliers.h"
#include "neighbor_search.h"
#include "progress.h"
#include "rows.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Neighbours that make the surface of a point.
constexpr int kNeighbors = 16;
/// Fewer span no plane.
constexpr int kMinNeighbors = 3;

/// A neighbour of a point; ordered by how crowded it is there, then by how near it is.
struct Neighbor {
  double mean_distance;  ///< from the neighbour to its own neighbours
  std::size_t rank;      ///< in the point's list, nearest first
  Index index;

  bool operator<(const Neighbor& other) const {
    return std::pair(mean_distance, rank) < std::pair(other.mean_distance, other.rank);
  }
};

/// The distance of a point from the plane (or line) of least squares through its neighbours.
double distanceFromPlane(const Positions& points, const Eigen::Vector3d& point,
                         const std::vector<Neighbor>& neighbors) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const Neighbor& neighbor : neighbors)
    centroid += points.col(neighbor.index) - point;  // differences: a far origin costs no digits
  centroid /= static_cast<double>(neighbors.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Neighbor& neighbor : neighbors) {
    const Eigen::Vector3d offset = points.col(neighbor.index) - point - centroid;
    scatter += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
  const Eigen::Vector3d& spread = axes.eigenvalues();  // ascending, squared
  // Neighbours whose spread across is less than this fraction of that along are on a line.
  constexpr double min_spread_ratio = 1e-6;
  if (spread[1] <= min_spread_ratio * min_spread_ratio * spread[2]) {
    const Eigen::Vector3d along = axes.eigenvectors().col(2);
    return spread[2] > 0.0 ? (centroid - centroid.dot(along) * along).norm() : centroid.norm();
  }
  return std::abs(centroid.dot(axes.eigenvectors().col(0)));
}

/// The points' neighbours, of which outliers are taken out, and their scores.
class Scoring {
public:
  Scoring(const Positions& points, const NeighborLists& lists, int threads)
      : scores(lists.size(), 0.0), points_(points), threads_(threads), neighbors_(lists.size()),
        mean_distance_(lists.size()) {
    forEachIndex(lists.size(), threads_, {}, [&](Index i) { sortByDistance(listOf(lists, i), i); });
  }

  /// Takes the given points out of all lists, and computes the scores of the others.
  void compute(const Indexed<char>& is_outlier) {
    forEachIndex(scores.size(), threads_, {}, [&](Index i) {
      std::vector<Index>& around = neighbors_[i];
      const auto rest = std::stable_partition(around.begin(), around.end(),
                                              [&](Index j) { return is_outlier[j] == 0; });
      // With too few left, those that were there are better than none.
      if (rest - around.begin() >= kMinNeighbors)
        around.erase(rest, around.end());
      const Row<Index> used = usedOf(i);
      const double sum = std::accumulate(used.begin(), used.end(), 0.0, [&](double total, Index j) {
        return total + distance(i, j);
      });
      mean_distance_[i] = used.size() > 0 ? sum / static_cast<double>(used.size()) : 0.0;
    });
    forEachIndex<std::vector<Neighbor>>(scores.size(), threads_, {},
                                        [&](std::vector<Neighbor>& around, Index i) {
                                          if (is_outlier[i] == 0)
                                            scores[i] = score(i, around);
                                        });
  }

  Indexed<double> scores;

private:
  double distance(Index i, Index j) const { return (points_.col(j) - points_.col(i)).norm(); }

  /// The k nearest of the neighbours that are left.
  Row<Index> usedOf(Index i) const {
    const std::vector<Index>& all = neighbors_[i];
    return Row<Index>(all.data(), all.data() + all.size()).first(kNeighbors);
  }

  /// The entries of a list without the point itself and repetitions, nearest first, ties by index.
  void sortByDistance(const Row<Index>& list, Index i) {
    std::vector<std::pair<double, Index>> entries;
    for (const Index j : list)
      if (j != i)
        entries.emplace_back(distance(i, j), j);
    std::sort(entries.begin(), entries.end());
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
    for (const auto& entry : entries)
      neighbors_[i].push_back(entry.second);
  }

  double score(Index i, std::vector<Neighbor>& around) const {
    const Row<Index> used = usedOf(i);
    if (used.size() < kMinNeighbors)
      return 0.0;
    around.clear();
    for (const Index j : used)
      around.push_back({mean_distance_[j], around.size(), j});
    std::sort(around.begin(), around.end());
    const double scale = around[around.size() / 2].mean_distance;
    if (!(scale > 0.0))
      return 0.0;  // neighbours in one place have no scale
    // Neighbours with mean distances longer than this number of times their median may be outliers.
    constexpr double max_distance_ratio = 2.0;
    while (around.back().mean_distance > max_distance_ratio * scale)
      around.pop_back();
    return distanceFromPlane(points_, points_.col(i), around) / scale;
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
  for (std::size_t left = lists.size(), before = 0; left != before && left > kMinNeighbors;) {
    reportFraction(report, 0.0);
    scoring.compute(is_outlier);
    const auto mean_over_rest = [&](const auto& value) {
      const double sum = accumulate(is_outlier.size(), threads, 0.0, [&](Index i, double& total) {
        if (is_outlier[i] == 0)
          total += value(std::min(scoring.scores[i], 1.0));
      });
      return sum / static_cast<double>(left);
    };
    const double mean = mean_over_rest([](double score) { return score; });
    const double deviation =
        std::sqrt(mean_over_rest([&](double score) { return (score - mean) * (score - mean); }));
    result.threshold = std::max(mean + sigma * deviation, 1.0);
    before = left;
    for (const Index i : indicesOf(is_outlier))
      if (is_outlier[i] == 0 && scoring.scores[i] > result.threshold) {
        is_outlier[i] = 1;
        --left;
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
                           const std::vector<StrayPoint>& stray, const Execution& execution) {
  Indexed<char> marked(static_cast<std::size_t>(points.cols()), 0);
  for (const StrayPoint& each : stray)
    marked[each.point] = 1;
  Indexed<Index> others;
  for (const Index i : indicesOf(marked))
    if (marked[i] == 0)
      others.push_back(i);
  // Among themselves: those of a net have each other for neighbours, and stray points between two
  // sheets are in the plane of both.
  const Positions rest = points(Eigen::all, others);
  if (mode == OutlierMode::Auto) {
    const Indexed<double> distances = nearOutliers(
        rest, findNearestNeighbors(rest, kFittedNeighbors, execution), execution.threads);
    for (const Index i : indicesOf(distances))
      if (distances[i] > 0.0)
        marked[others[i]] = 1;
    return marked;
  }
  const DeviatingPoints found = deviatingPoints(
      rest, findNearestNeighbors(rest, 2 * kNeighbors, execution), sigma, execution);
  for (const Index i : found.indices)
    marked[others[i]] = 1;
  for (const StrayPoint& each : stray)
    marked[each.point] = each.distance > found.threshold ? 1 : 0;
  return marked;
}

}  // namespace spherical_param::internal
