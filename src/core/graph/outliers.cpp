#include "outliers.h"

#include "caller_neighbors.h"
#include "local_delaunay_graph.h"
#include "near_outliers.h"
#include "neighbor_graph.h"
#include "neighbor_lists.h"
#include "neighbor_search.h"
#include "ordered_points.h"
#include "parallel.h"
#include "progress.h"
#include "spherical_param/errors.h"
#include "stray_points.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

/// Fewer span no plane.
constexpr std::size_t kMinNeighbors = 3;
/// Fewer positions cannot be meshed.
constexpr std::size_t kMinPositions = 4;
/// Neighbours with mean distances longer than this number of times their median may be outliers.
constexpr double kMaxDistanceRatio = 2.0;
/// Neighbours whose spread across is less than this fraction of that along are on a line.
constexpr double kMinSpreadRatio = 1e-6;

[[noreturn]] void fail(const std::string& what) {
  throw InvalidInput("findOutliers: " + what);
}

void checkOptions(const OutlierOptions& options) {
  if (!(options.sigma >= 0.0 && options.sigma <= 1000.0))
    fail("sigma = " + std::to_string(options.sigma) +
         " is out of range; use a value in [0, 1000], mostly 2 to 5");
  if (options.k < static_cast<int>(kMinNeighbors))
    fail("k = " + std::to_string(options.k) + " is too small; use 3 or more neighbours");
  if (!(options.least_score >= 0.0 && std::isfinite(options.least_score)))
    fail("least_score = " + std::to_string(options.least_score) +
         " is out of range; use a finite value that is not negative");
}

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
  Scoring(const Positions& points, const NeighborLists& lists, const OutlierOptions& options,
          const Execution& execution)
      : points_(points), k_(static_cast<std::size_t>(options.k)), begin_(lists.offsets),
        count_(lists.size()), used_(lists.size()), neighbors_(lists.indices),
        mean_distance_(lists.size()), scores_(lists.size(), 0.0),
        threads_(
            internal::threadCount(execution.threads, lists.size(), internal::kParallelThreshold)) {
    internal::forEachItem(lists.size(), threads_,
                          [&](std::size_t, std::size_t i) { sortByDistance(i); });
  }

  /// Takes the given points out of all lists, and computes the scores of the others.
  void compute(const std::vector<char>& is_outlier) {
    internal::forEachItem(used_.size(), threads_, [&](std::size_t, std::size_t i) {
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
      used_[i] = std::min(count_[i], k_);
      double sum = 0.0;
      for (std::size_t c = 0; c < used_[i]; ++c)
        sum += distance(i, begin[static_cast<std::ptrdiff_t>(c)]);
      mean_distance_[i] = used_[i] > 0 ? sum / static_cast<double>(used_[i]) : 0.0;
    });
    internal::forEachBlock(used_.size(), threads_,
                           [&](std::size_t, std::size_t first, std::size_t last) {
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
  std::size_t k_;
  const std::vector<std::size_t>& begin_;
  std::vector<std::size_t> count_;  ///< entries of each list that are left
  std::vector<std::size_t> used_;   ///< of these, the k nearest
  std::vector<Index> neighbors_;
  std::vector<double> mean_distance_;
  std::vector<double> scores_;
  int threads_;
};

}  // namespace

Outliers findOutliers(const Positions& points, const NeighborLists& lists,
                      const OutlierOptions& options, const Execution& execution) {
  checkOptions(options);
  const auto n = static_cast<std::size_t>(points.cols());
  internal::checkNeighborLists("findOutliers", lists, n);
  internal::checkFinite("findOutliers", points);

  Outliers result;
  Scoring scoring(points, lists, options, execution);
  std::vector<char> is_outlier(n, 0);
  std::size_t left = n;
  const internal::FractionReport report = internal::reportOf(execution, "outliers");
  bool found = left > 0;
  while (found) {
    internal::reportFraction(report, 0.0);
    scoring.compute(is_outlier);
    ++result.rounds;
    const std::vector<double>& scores = scoring.scores();
    const auto mean_over_rest = [&](const auto& value) {
      return internal::sumOfBlocks(n, scoring.threads(), 0.0,
                                   [&](std::size_t begin, std::size_t end) {
                                     double sum = 0.0;
                                     for (std::size_t i = begin; i < end; ++i)
                                       if (is_outlier[i] == 0)
                                         sum += value(std::min(scores[i], 1.0));
                                     return sum;
                                   }) /
             static_cast<double>(left);
    };
    result.mean = mean_over_rest([](double score) { return score; });
    result.standard_deviation = std::sqrt(mean_over_rest(
        [&](double score) { return (score - result.mean) * (score - result.mean); }));
    result.threshold =
        std::max(result.mean + options.sigma * result.standard_deviation, options.least_score);
    found = false;
    for (std::size_t i = 0; i < n; ++i)
      if (is_outlier[i] == 0 && scores[i] > result.threshold) {
        is_outlier[i] = 1;
        --left;
        found = true;
      }
    // With sigma and least_score near 0 there is no end to it before all points are outliers.
    found = found && left > kMinNeighbors;
  }
  internal::reportFraction(report, 1.0);
  result.scores = scoring.scores();
  for (std::size_t i = 0; i < n; ++i)
    if (is_outlier[i] != 0)
      result.indices.push_back(static_cast<Index>(i));
  return result;
}

namespace {

/// The stray points of nodes and neighbour lists of them. \see findStrayPoints
std::vector<StrayPoint> strayNodes(const Positions& nodes, const NeighborLists& lists,
                                   const NeighborSearch& search, const Execution& execution) {
  const internal::AgreedGraph agreed = internal::agreedGraph(nodes, lists, search, execution);
  return internal::strayPoints(nodes, agreed.graph, agreed.in_stars_of);
}

/// The columns of a matrix that are not among the stray points, and their numbers.
Positions othersOf(const Positions& nodes, const std::vector<StrayPoint>& stray,
                   std::vector<Index>& numbers) {
  auto next = stray.begin();
  for (Index i = 0; i < static_cast<Index>(nodes.cols()); ++i)
    if (next != stray.end() && next->point == i)
      ++next;
    else
      numbers.push_back(i);
  Positions others(3, static_cast<Eigen::Index>(numbers.size()));
  for (std::size_t i = 0; i < numbers.size(); ++i)
    others.col(static_cast<Eigen::Index>(i)) = nodes.col(numbers[i]);
  return others;
}

/// The outliers among distinct points: the others are compared without the stray ones, and these
/// are outliers if their distance is above the threshold of the others.
Outliers findAmongNodes(const Positions& nodes, const OutlierOptions& options,
                        const Execution& execution) {
  const int count = std::min(options.k, std::numeric_limits<int>::max() / 2) * 2;
  std::vector<Index> numbers(static_cast<std::size_t>(nodes.cols()));
  std::iota(numbers.begin(), numbers.end(), Index{0});
  const NeighborSearch search = makeNeighborSearch(nodes, execution);
  const NeighborLists lists = search(numbers, count);
  Execution preparation = execution;  // to the caller one stage, whatever is done in it
  if (execution.progress)
    preparation.progress = [&](const Progress& progress) {
      return execution.progress({"neighbors", progress.fraction});
    };
  const std::vector<StrayPoint> stray = strayNodes(nodes, lists, search, preparation);
  if (stray.empty()) {
    internal::reportFraction(internal::reportOf(preparation, "neighbors"), 1.0);
    return findOutliers(nodes, lists, options, execution);
  }
  numbers.clear();
  const Positions others = othersOf(nodes, stray, numbers);
  Outliers result =
      findOutliers(others, findNearestNeighbors(others, count, execution), options, execution);
  std::vector<double> scores(static_cast<std::size_t>(nodes.cols()));
  for (std::size_t i = 0; i < numbers.size(); ++i)
    scores[static_cast<std::size_t>(numbers[i])] = result.scores[i];
  for (Index& i : result.indices)
    i = numbers[static_cast<std::size_t>(i)];
  for (const StrayPoint& each : stray) {
    scores[static_cast<std::size_t>(each.point)] = each.distance;
    if (each.distance > result.threshold)
      result.indices.push_back(each.point);
  }
  std::sort(result.indices.begin(), result.indices.end());
  result.scores = std::move(scores);
  return result;
}

}  // namespace

Outliers findOutliers(const Positions& points, const OutlierOptions& options,
                      const Execution& execution) {
  checkOptions(options);
  internal::checkThreads(execution.threads);
  internal::checkFinite("findOutliers", points);
  const internal::OrderedPoints nodes = internal::orderPoints(points, execution.threads);
  const auto n = static_cast<std::size_t>(points.cols());
  if (nodes.input_of_node.size() < kMinPositions) {
    Outliers none;
    none.scores.assign(n, 0.0);
    return none;
  }
  Outliers result = findAmongNodes(nodes.points, options, execution);

  const std::vector<Index> node_of_input = internal::nodesOfInput(nodes);
  std::vector<char> is_outlier(nodes.input_of_node.size(), 0);
  for (const Index node : result.indices)
    is_outlier[static_cast<std::size_t>(node)] = 1;
  result.indices.clear();
  std::vector<double> scores(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto node = static_cast<std::size_t>(node_of_input[i]);
    scores[i] = result.scores[node];
    if (is_outlier[node] != 0)
      result.indices.push_back(static_cast<Index>(i));
  }
  result.scores = std::move(scores);
  return result;
}

Outliers findStrayPoints(const Positions& points, const Execution& execution) {
  internal::checkThreads(execution.threads);
  internal::checkFinite("findStrayPoints", points);
  const internal::OrderedPoints nodes = internal::orderPoints(points, execution.threads);
  Outliers result;
  result.scores.assign(static_cast<std::size_t>(points.cols()), 0.0);
  if (nodes.input_of_node.size() < kMinPositions)
    return result;
  const internal::Neighbors neighbors =
      internal::nearestNeighbors(nodes, neighborsToSearch({}), execution);
  std::vector<double> distances(nodes.input_of_node.size(), 0.0);
  const std::vector<StrayPoint> stray =
      strayNodes(nodes.points, neighbors.lists, neighbors.search, execution);
  for (const StrayPoint& each : stray)
    distances[static_cast<std::size_t>(each.point)] = each.distance;
  // Near a surface, but off it: without the others, which are no surface.
  std::vector<Index> numbers;
  const Positions others = othersOf(nodes.points, stray, numbers);
  Execution search = execution;
  if (execution.progress)
    search.progress = [&](const Progress& progress) {
      return execution.progress({"outliers", progress.fraction});
    };
  const std::vector<double> near = internal::nearOutliers(
      others, findNearestNeighbors(others, internal::kFittedNeighbors, search), execution.threads);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    distances[static_cast<std::size_t>(numbers[i])] = near[i];
  const std::vector<Index> node_of_input = internal::nodesOfInput(nodes);
  for (std::size_t i = 0; i < node_of_input.size(); ++i) {
    result.scores[i] = distances[static_cast<std::size_t>(node_of_input[i])];
    if (result.scores[i] > 0.0)
      result.indices.push_back(static_cast<Index>(i));
  }
  return result;
}

}  // namespace spherical_param
