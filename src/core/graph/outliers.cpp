#include "outliers.h"

#include "near_outliers.h"
#include "parallel.h"
#include "progress.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Neighbours that make the surface of a point.
constexpr std::size_t kNeighbors = 16;
/// Fewer span no plane.
constexpr std::size_t kMinNeighbors = 3;
/// Nothing nearer to the surface of its neighbours is an outlier [their mean distances].
constexpr double kMinScore = 1.0;
/// Neighbours with mean distances longer than this number of times their median may be outliers.
constexpr double kMaxDistanceRatio = 2.0;
/// Neighbours whose spread across is less than this fraction of that along are on a line.
constexpr double kMinSpreadRatio = 1e-6;

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
  if (spread[1] <= kMinSpreadRatio * kMinSpreadRatio * spread[2]) {
    const Eigen::Vector3d along = axes.eigenvectors().col(2);
    return spread[2] > 0.0 ? (centroid - centroid.dot(along) * along).norm() : centroid.norm();
  }
  return std::abs(centroid.dot(axes.eigenvectors().col(0)));
}

/// The points' neighbours, of which outliers are taken out, and their scores.
class Scoring {
public:
  Scoring(const Positions& points, const NeighborLists& lists, const Execution& execution)
      : points_(points), begin_(lists.offsets), count_(lists.size()), used_(lists.size()),
        neighbors_(lists.indices), mean_distance_(lists.size()), scores_(lists.size(), 0.0),
        threads_(threadCount(execution.threads, lists.size())) {
    forEachItem(lists.size(), threads_, [&](std::size_t, std::size_t i) { sortByDistance(i); });
  }

  /// Takes the given points out of all lists, and computes the scores of the others.
  void compute(const std::vector<char>& is_outlier) {
    forEachItem(used_.size(), threads_, [&](std::size_t, std::size_t i) {
      const auto begin = neighbors_.begin() + static_cast<std::ptrdiff_t>(begin_[i]);
      const auto end = begin + static_cast<std::ptrdiff_t>(count_[i]);
      const auto rest = std::count_if(
          begin, end, [&](Index j) { return is_outlier[static_cast<std::size_t>(j)] == 0; });
      // With too few left, those that were there are better than none.
      if (rest < end - begin && rest >= static_cast<std::ptrdiff_t>(kMinNeighbors)) {
        std::stable_partition(
            begin, end, [&](Index j) { return is_outlier[static_cast<std::size_t>(j)] == 0; });
        count_[i] = static_cast<std::size_t>(rest);
      }
      used_[i] = std::min(count_[i], kNeighbors);
      double sum = 0.0;
      for (std::size_t c = 0; c < used_[i]; ++c)
        sum += distance(i, begin[static_cast<std::ptrdiff_t>(c)]);
      mean_distance_[i] = used_[i] > 0 ? sum / static_cast<double>(used_[i]) : 0.0;
    });
    forEachBlock(used_.size(), threads_, [&](std::size_t, std::size_t first, std::size_t last) {
      std::vector<Neighbor> around;
      for (std::size_t i = first; i < last; ++i)
        if (is_outlier[i] == 0)
          scores_[i] = score(i, around);
    });
  }

  const std::vector<double>& scores() const { return scores_; }
  int threads() const { return threads_; }

private:
  double distance(std::size_t i, Index j) const {
    return (points_.col(j) - points_.col(static_cast<Eigen::Index>(i))).norm();
  }

  /// The entries of a list without the point itself and repetitions, nearest first, ties by index.
  void sortByDistance(std::size_t i) {
    std::vector<std::pair<double, Index>> entries;
    for (std::size_t e = begin_[i]; e < begin_[i + 1]; ++e)
      if (static_cast<std::size_t>(neighbors_[e]) != i)
        entries.emplace_back(distance(i, neighbors_[e]), neighbors_[e]);
    std::sort(entries.begin(), entries.end());
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
    count_[i] = entries.size();
    for (std::size_t c = 0; c < entries.size(); ++c)
      neighbors_[begin_[i] + c] = entries[c].second;
  }

  double score(std::size_t i, std::vector<Neighbor>& around) const {
    if (used_[i] < kMinNeighbors)
      return 0.0;
    around.clear();
    for (std::size_t c = 0; c < used_[i]; ++c) {
      const Index j = neighbors_[begin_[i] + c];
      around.push_back({mean_distance_[static_cast<std::size_t>(j)], c, j});
    }
    std::sort(around.begin(), around.end());
    const double scale = around[around.size() / 2].mean_distance;
    if (!(scale > 0.0))
      return 0.0;  // neighbours in one place have no scale
    while (around.back().mean_distance > kMaxDistanceRatio * scale)
      around.pop_back();
    return distanceFromPlane(points_, points_.col(static_cast<Eigen::Index>(i)), around) / scale;
  }

  const Positions& points_;
  const std::vector<std::size_t>& begin_;
  std::vector<std::size_t> count_;  ///< entries of each list that are left
  std::vector<std::size_t> used_;   ///< of these, the k nearest
  std::vector<Index> neighbors_;
  std::vector<double> mean_distance_;
  std::vector<double> scores_;
  int threads_;
};

/// The points that are not stray.
struct Others {
  Positions points;
  NodeSubset subset;
};

Others withoutStray(const Positions& points, const std::vector<StrayPoint>& stray) {
  Others others;
  others.subset.new_of_old.assign(static_cast<std::size_t>(points.cols()), 0);
  for (const StrayPoint& each : stray)
    others.subset.new_of_old[static_cast<std::size_t>(each.point)] = -1;
  for (std::size_t i = 0; i < others.subset.new_of_old.size(); ++i)
    if (others.subset.new_of_old[i] == 0) {
      others.subset.new_of_old[i] = static_cast<Index>(others.subset.old_of_new.size());
      others.subset.old_of_new.push_back(static_cast<Index>(i));
    }
  others.points = points(Eigen::all, others.subset.old_of_new);
  return others;
}

/// The nearest neighbours of all of the others, among themselves: those of a net have each other
/// for neighbours, and stray points between two sheets are in the plane of both.
NeighborLists listsOf(const Others& others, const Neighbors& neighbors, int count) {
  std::vector<Index> all(others.subset.old_of_new.size());
  std::iota(all.begin(), all.end(), Index{0});
  return searchWithin(others.points, neighbors.search, others.subset)(all, count);
}

}  // namespace

DeviatingPoints deviatingPoints(const Positions& points, const NeighborLists& lists, double sigma,
                                const Execution& execution) {
  const auto n = static_cast<std::size_t>(points.cols());
  DeviatingPoints result;
  Scoring scoring(points, lists, execution);
  std::vector<char> is_outlier(n, 0);
  std::size_t left = n;
  const FractionReport report = reportOf(execution, "outliers");
  bool found = left > 0;
  while (found) {
    reportFraction(report, 0.0);
    scoring.compute(is_outlier);
    const std::vector<double>& scores = scoring.scores();
    const auto mean_over_rest = [&](const auto& value) {
      return sumOfBlocks(n, scoring.threads(), 0.0,
                         [&](std::size_t begin, std::size_t end) {
                           double sum = 0.0;
                           for (std::size_t i = begin; i < end; ++i)
                             if (is_outlier[i] == 0)
                               sum += value(std::min(scores[i], 1.0));
                           return sum;
                         }) /
             static_cast<double>(left);
    };
    const double mean = mean_over_rest([](double score) { return score; });
    const double deviation =
        std::sqrt(mean_over_rest([&](double score) { return (score - mean) * (score - mean); }));
    result.threshold = std::max(mean + sigma * deviation, kMinScore);
    found = false;
    for (std::size_t i = 0; i < n; ++i)
      if (is_outlier[i] == 0 && scores[i] > result.threshold) {
        is_outlier[i] = 1;
        --left;
        found = true;
      }
    found = found && left > kMinNeighbors;
  }
  reportFraction(report, 1.0);
  result.scores = scoring.scores();
  for (std::size_t i = 0; i < n; ++i)
    if (is_outlier[i] != 0)
      result.indices.push_back(static_cast<Index>(i));
  return result;
}

std::vector<char> markOutliers(OutlierMode mode, double sigma, const Positions& points,
                               const Neighbors& neighbors, const std::vector<StrayPoint>& stray,
                               const Execution& execution) {
  std::vector<char> marked(static_cast<std::size_t>(points.cols()), 0);
  const Others others = withoutStray(points, stray);
  const auto mark_other = [&](std::size_t other) {
    marked[static_cast<std::size_t>(others.subset.old_of_new[other])] = 1;
  };
  double threshold = 0.0;  // of stray points
  if (mode == OutlierMode::Auto) {
    const std::vector<double> near = nearOutliers(
        others.points, listsOf(others, neighbors, kFittedNeighbors), execution.threads);
    for (std::size_t i = 0; i < near.size(); ++i)
      if (near[i] > 0.0)
        mark_other(i);
  } else {
    const DeviatingPoints found =
        deviatingPoints(others.points, listsOf(others, neighbors, 2 * static_cast<int>(kNeighbors)),
                        sigma, execution);
    threshold = found.threshold;
    for (const Index i : found.indices)
      mark_other(static_cast<std::size_t>(i));
  }
  for (const StrayPoint& each : stray)
    if (each.distance > threshold)
      marked[static_cast<std::size_t>(each.point)] = 1;
  return marked;
}

}  // namespace spherical_param::internal
