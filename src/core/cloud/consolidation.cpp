#include "consolidation.h"

#include "corner_table.h"
#include "neighbor_search.h"
#include "ordered_points.h"
#include "pi.h"
#include "power_of_two.h"
#include "progress.h"
#include "quadric_fit.h"
#include "rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace spherical_param {
namespace internal {
namespace {

/// Standard deviation of the weights [radius of the neighbourhood]: in trials without the point
/// itself, and in fits with it, which need fewer others. Larger ones smooth noise better, but lose
/// detail.
constexpr double kTrialWidth = 0.5;
constexpr double kWidth = 0.45;
/// Maximum roundness of a flat neighbourhood.
constexpr double kMaxRoundness = 0.4;
/// Number of neighbours in the smallest neighbourhood.
constexpr Index kMinSize = 10;
/// Number of probes around one, with itself, that decide together.
constexpr int kJury = 12;
/// Fewer points are not consolidated.
constexpr std::size_t kMinPoints = 20;

/// A quadric of least squares through neighbours, with Gaussian weights.
class SurfaceFit {
public:
  /// \param point    where the weights are greatest.
  /// \param left_out a neighbour that is left out, or -1.
  /// \param width    standard deviation of the weights.
  void compute(const Positions& points, const Row<Index>& neighbors, const Eigen::Vector3d& point,
               Index left_out, double width) {
    // Beyond this number of standard deviations weights are 0.
    constexpr double reach = 3.0;
    width_ = width;
    weights_.clear();
    offsets_.clear();
    for (const Index j : neighbors) {
      const Eigen::Vector3d offset = (points.col(j) - point) / width;
      const double squared = offset.squaredNorm();
      if (j == left_out || !(squared < reach * reach))
        continue;
      weights_.push_back(std::exp(-0.5 * squared));
      offsets_.push_back(offset);
    }
    const double total = std::accumulate(weights_.begin(), weights_.end(), 0.0);
    for (double& weight : weights_)
      weight /= total;
    quadric_.fit(offsets_, weights_);
  }

  /// The vector from the quadric to the point, along the normal; 0 without enough neighbours.
  Eigen::Vector3d offset() const { return height() * quadric_.normal(); }
  double height() const { return quadric_.height() * width_; }
  /// Root mean square distance of the neighbours from the quadric.
  double noise() const { return quadric_.residual() * width_; }
  /// 0 if the neighbours are in a plane, 1 if all directions are alike.
  double roundness() const { return quadric_.roundness(); }

private:
  double width_ = 0.0;
  std::vector<double> weights_;           ///< of sum 1
  std::vector<Eigen::Vector3d> offsets_;  ///< from the point [width]
  QuadricFit quadric_;
};

/// The indices by ascending values; ties by index.
std::vector<Index> orderOf(const Indexed<double>& values) {
  std::vector<Index> order = firstIndices(values.size());
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return std::pair(values[a], a) < std::pair(values[b], b); });
  return order;
}

/// Points that were moved to the surface.
struct MovedPoints {
  std::vector<Index> from;  ///< their numbers before, ascending
  Positions points;
  Indexed<double> distances;  ///< noise does not separate nearer points from each
  Indexed<double> noise;      ///< RMS distance of the points around each from the surface
};

/// A noisy cloud, and the neighbourhoods that show its surface. Their size is chosen at probes;
/// where neighbourhoods are large, there are fewer probes.
class NoisyCloud {
public:
  /// \param quiet  execution of searches, without reports.
  /// \param report receives fractions of the work.
  NoisyCloud(const Positions& points, const Execution& quiet, FractionReport report)
      : points_(points), report_(std::move(report)), execution_(quiet),
        search_(makeNeighborSearch(points, quiet)),
        threads_(threadCount(quiet.threads, columnCount(points))) {
    rankPoints();
    findProbes();
    chooseSizes();
  }

  /// Moves points to the surface: as many as the noise leaves detail.
  MovedPoints onSurface() const {
    // One point is moved for this number of neighbours in a neighbourhood.
    constexpr Index neighbors_of_point = 80;
    const std::vector<Index> probe_of =
        findNearest(points_(Eigen::all, pointsOf(probes_)), points_, execution_);
    MovedPoints moved;
    std::vector<Index> probe_of_moved;
    std::map<Index, Rows> moved_of_size;
    for (Index i = 0; i < points_.cols(); ++i) {
      const Index probe = probe_of[static_cast<std::size_t>(i)];
      const Index size = probes_[probe].size;
      if (rank_[i] % std::max(1, size / neighbors_of_point) != 0)
        continue;
      Rows& rows = moved_of_size[size];
      rows.items.push_back(static_cast<Index>(moved.from.size()));
      rows.points.push_back(i);
      moved.from.push_back(i);
      probe_of_moved.push_back(probe);
    }
    moved.points.resize(3, static_cast<Eigen::Index>(moved.from.size()));
    moved.distances.resize(moved.from.size());
    moved.noise.resize(moved.from.size());
    forEachNeighborhood(
        moved_of_size, 2, 0.5, [&](SurfaceFit& fit, Index item, Index i, const Row<Index>& around) {
          const auto place = static_cast<std::size_t>(item);
          const Probe& probe = probes_[probe_of_moved[place]];
          const Eigen::Vector3d from = points_.col(i);
          double radius = probe.radius;
          fit.compute(points_, around, from, -1, kWidth * radius);
          // A limb or sheet beside the probe may be thinner.
          for (Index size = probe.size / 2; size >= probe.flat && fit.roundness() > kMaxRoundness;
               size /= 2) {
            radius = std::min(radius, radiusAt(i, around, size));
            fit.compute(points_, around, from, -1, kWidth * radius);
          }
          Eigen::Vector3d to = from;
          // The second fit is at the place to which the first has moved the point.
          for (int k = 0; k < 2; ++k) {
            fit.compute(points_, around, to, -1, kWidth * radius);
            to -= fit.offset();
          }
          // There is no surface if it is farther than the radius of the neighbourhood.
          moved.points.col(item) = (to - from).norm() <= radius ? to : from;
          moved.noise[item] = fit.noise();
          constexpr double max_distance = 0.3;  // [standard deviation of the weights]
          moved.distances[item] = std::min(fit.noise(), max_distance * kWidth * radius);
        });
    return moved;
  }

private:
  /// A point at which neighbourhoods of several sizes are tried.
  struct Probe {
    Index point;
    Index flat;              ///< number of neighbours in the smallest flat neighbourhood
    double roundness = 1.0;  ///< of that neighbourhood
    Index size = 0;          ///< number of neighbours in the neighbourhood that predicts best
    double radius = 0.0;     ///< of that neighbourhood, averaged
  };

  /// Items of one size of neighbourhoods, and their points.
  struct Rows {
    std::vector<Index> items;
    std::vector<Index> points;
  };

  static std::vector<Index> pointsOf(const Indexed<Probe>& probes) {
    std::vector<Index> points;
    for (const Probe& probe : probes)
      points.push_back(probe.point);
    return points;
  }

  /// Calls work(fit, item, point, neighbours) for all items, block by block, since lists are long.
  ///
  /// \param factor number of neighbours to search for [size].
  /// \param done   fraction of the work that is done before.
  template <typename Work>
  void forEachNeighborhood(const std::map<Index, Rows>& rows_of_size, Index factor, double done,
                           const Work& work) const {
    constexpr std::ptrdiff_t block = 2048;
    for (const auto& [size, rows] : rows_of_size) {
      const auto count = static_cast<std::ptrdiff_t>(rows.points.size());
      const std::vector<Index>& items = rows.items;
      for (std::ptrdiff_t begin = 0; begin < count; begin += block) {
        const auto first = rows.points.begin() + begin;
        const std::vector<Index> queries(first, first + std::min(block, count - begin));
        reportFraction(report_, done);
        const NeighborLists lists = search_(queries, factor * size);
        forEachIndex<SurfaceFit>(queries.size(), threads_, {}, [&](SurfaceFit& fit, Index q) {
          work(fit, items[static_cast<std::size_t>(begin + q)],
               queries[static_cast<std::size_t>(q)], listOf(lists, q));
        });
      }
    }
  }

  /// The distance of the last neighbour in a neighbourhood.
  double radiusAt(Index point, const Row<Index>& around, Index size) const {
    const auto last = std::min(static_cast<std::size_t>(size), around.size() - 1);
    return (points_.col(*(around.begin() + last)) - points_.col(point)).norm();
  }

  /// The probes around each, nearest first.
  NeighborLists juryOf(const Indexed<Probe>& probes) const {
    return findNearestNeighbors(points_(Eigen::all, pointsOf(probes)), kJury, execution_);
  }

  /// Ranks the points by the distances of their neighbours. Points at even steps of this order are
  /// a sample that does not depend on the place of the cloud.
  void rankPoints() {
    constexpr int neighbors = 4;
    const NeighborLists lists = search_(firstIndices(columnCount(points_)), neighbors);
    Indexed<double> distances(lists.size());
    forEachIndex(lists.size(), threads_, {}, [&](Index i) {
      for (const Index j : listOf(lists, i))
        distances[i] += (points_.col(j) - points_.col(i)).norm();
    });
    rank_.resize(lists.size());
    Index rank = 0;
    for (const Index i : orderOf(distances))
      rank_[i] = rank++;
  }

  /// Finds the smallest flat neighbourhoods: where noise exceeds the spacing, small ones are as
  /// thick as they are wide.
  void findProbes() {
    // The largest neighbourhood has at most this fraction of the points, and at most this number.
    constexpr double max_fraction = 0.05;
    constexpr Index max_size = 640;
    constexpr Index first_step = 4;
    const auto n = static_cast<Index>(points_.cols());
    Indexed<Probe> open;
    for (const Index i : indicesOf(rank_))
      if (rank_[i] % first_step == 0)
        open.push_back({i, kMinSize});
    Index step = first_step;
    for (Index size = kMinSize; !open.empty(); size *= 2) {
      step *= 2;
      Indexed<double> roundness(open.size());
      const std::vector<Index> points = pointsOf(open);
      forEachNeighborhood({{size, {firstIndices(open.size()), points}}}, 3, 0.0,
                          [&](SurfaceFit& fit, Index q, Index i, const Row<Index>& around) {
                            fit.compute(points_, around, points_.col(i), -1,
                                        kTrialWidth * radiusAt(i, around, 2 * size));
                            roundness[q] = fit.roundness();
                          });
      const NeighborLists juries = juryOf(open);
      Indexed<Probe> rest;
      for (const Index q : indicesOf(open)) {
        std::vector<double> values;
        for (const Index j : listOf(juries, q))
          values.push_back(roundness[j]);
        // Thin limbs are round at any size, and least at the smallest.
        const double median = medianOf(values);
        Probe& probe = open[q];
        if (median < probe.roundness) {
          probe.roundness = median;
          probe.flat = size;
        }
        if (median <= kMaxRoundness || 2.0 * size >= max_fraction * n || size == max_size)
          probes_.push_back(probe);
        else if (rank_[probe.point] % step == 0)
          rest.push_back(probe);
      }
      open.swap(rest);
    }
    std::sort(probes_.begin(), probes_.end(),
              [](const Probe& a, const Probe& b) { return a.point < b.point; });
  }

  /// Chooses the neighbourhoods that predict points best by the others: leave-one-out
  /// cross-validation.
  void chooseSizes() {
    // Sizes of 1, 2, 4 and 8 times the smallest flat one.
    constexpr Index trials = 4;
    // The largest neighbourhood with up to this error is taken [smallest error].
    constexpr double max_error = 1.03;
    using Trials = std::array<double, trials>;
    Indexed<Trials> errors(probes_.size());
    Indexed<Trials> radii(probes_.size());
    std::map<Index, Rows> probes_of_size;
    for (const Index p : indicesOf(probes_)) {
      Rows& rows = probes_of_size[probes_[p].flat];
      rows.items.push_back(p);
      rows.points.push_back(probes_[p].point);
    }
    forEachNeighborhood(probes_of_size, 3 << (trials - 2), 0.2,
                        [&](SurfaceFit& fit, Index p, Index i, const Row<Index>& around) {
                          Index size = probes_[p].flat;
                          for (std::size_t t = 0; t < trials; ++t, size *= 2) {
                            radii[p][t] = radiusAt(i, around, size);
                            fit.compute(points_,
                                        around.first(static_cast<std::size_t>(size + size / 2 + 1)),
                                        points_.col(i), i, kTrialWidth * radii[p][t]);
                            errors[p][t] = std::abs(fit.height());
                          }
                        });
    const NeighborLists juries = juryOf(probes_);
    Indexed<double> radius(probes_.size());
    for (const Index p : indicesOf(probes_)) {
      Trials sums{};
      for (const Index j : listOf(juries, p))
        for (std::size_t t = 0; t < trials; ++t)
          sums[t] += errors[j][t];
      const double most = max_error * *std::min_element(sums.begin(), sums.end());
      for (std::size_t t = 0; t < trials; ++t)
        if (sums[t] <= most) {
          probes_[p].size = probes_[p].flat << t;
          radius[p] = radii[p][t];
        }
    }
    // The surface is only as smooth as the radii are.
    constexpr std::size_t averaged = 6;
    for (int round = 0; round < 2; ++round) {
      for (const Index p : indicesOf(probes_)) {
        const Row<Index> nearest = listOf(juries, p).first(averaged);
        double sum = 0.0;
        for (const Index j : nearest)
          sum += radius[j];
        probes_[p].radius = sum / static_cast<double>(nearest.size());
      }
      for (const Index p : indicesOf(probes_))
        radius[p] = probes_[p].radius;
    }
  }

  const Positions& points_;
  FractionReport report_;
  const Execution& execution_;
  NeighborSearch search_;
  int threads_;
  Indexed<Index> rank_;    ///< of each point in an order by its neighbours
  Indexed<Probe> probes_;  ///< in the order of the points
};

/// The consolidated points, and the one that each node is merged into.
struct ConsolidatedNodes {
  /// Each node is its own point.
  explicit ConsolidatedNodes(const Positions& nodes)
      : points(nodes), point_of_node(firstIndices(columnCount(nodes))) {}

  Positions points;
  Indexed<Index> point_of_node;
  double noise = 0.0;
};

/// Merges points within the distance of another one, which stays: small distances first. Returns
/// the points that stay, ascending.
std::vector<Index> thinned(const Positions& points, const Indexed<double>& distances,
                           const Execution& execution) {
  constexpr int max_merged = 60;
  const NeighborLists lists = findNearestNeighbors(points, max_merged, execution);
  Indexed<char> is_merged(lists.size(), 0);
  std::vector<Index> left;
  for (const Index i : orderOf(distances)) {
    if (is_merged[i] != 0)
      continue;
    left.push_back(i);
    for (const Index j : listOf(lists, i))
      if ((points.col(j) - points.col(i)).norm() <= distances[i])
        is_merged[j] = 1;
  }
  std::sort(left.begin(), left.end());
  return left;
}

ConsolidatedNodes consolidated(const Positions& nodes, const Execution& execution) {
  ConsolidatedNodes result(nodes);
  const FractionReport report = reportOf(execution, "consolidation");
  const auto report_from = [&report](double begin, double length) -> FractionReport {
    return [=](double fraction) { reportFraction(report, begin + length * fraction); };
  };
  Execution quiet;
  quiet.threads = execution.threads;
  const MovedPoints coarse = NoisyCloud(nodes, quiet, report_from(0.0, 0.7)).onSurface();
  // The second pass takes off the rest of the noise.
  const MovedPoints fine = NoisyCloud(coarse.points, quiet, report_from(0.7, 0.3)).onSurface();
  Indexed<double> distances;
  for (const Index c : fine.from)
    distances.push_back(coarse.distances[c]);
  const std::vector<Index> left = thinned(fine.points, distances, quiet);
  result.points = fine.points(Eigen::all, left);
  // Each node is merged into the nearest point, unless it became a point itself.
  const std::vector<Index> nearest = findNearest(result.points, nodes, quiet);
  result.point_of_node.assign(nearest.begin(), nearest.end());
  Index point = 0;
  for (const Index f : left) {
    const Index c = fine.from[static_cast<std::size_t>(f)];
    result.point_of_node[coarse.from[static_cast<std::size_t>(c)]] = point++;
  }
  std::vector<double> noise(coarse.noise.begin(), coarse.noise.end());
  result.noise = medianOf(noise);
  return result;
}

/// The points in the order of the input and in its unit.
Consolidation toInput(const OrderedPoints& nodes, const ConsolidatedNodes& consolidated) {
  Consolidation result;
  const Indexed<Index> node_of_input = nodesOfInput(nodes);
  Indexed<Index> number(static_cast<std::size_t>(consolidated.points.cols()), -1);
  result.points.resize(3, consolidated.points.cols());
  Index count = 0;
  for (const Index i : indicesOf(node_of_input)) {
    const Index point = consolidated.point_of_node[node_of_input[i]];
    if (number[point] < 0) {
      number[point] = count++;
      result.points.col(number[point]) =
          timesPowerOfTwo(consolidated.points.col(point), nodes.exponent);
    }
    result.point_of_input.push_back(number[point]);
  }
  result.distinct_at.assign(number.size(), 0);
  for (const Index point : consolidated.point_of_node)
    ++result.distinct_at[static_cast<std::size_t>(number[point])];
  ConsolidationReport& report = result.report;
  report.noise = std::ldexp(consolidated.noise, nodes.exponent);
  report.merged = nodes.input_of_node.size() - number.size();
  return result;
}

/// The squared distance of a point from a triangle.
double squaredDistance(const Eigen::Vector3d& point, const Eigen::Matrix3d& corners) {
  Eigen::Matrix<double, 3, 2> sides;
  sides << corners.col(1) - corners.col(0), corners.col(2) - corners.col(0);
  const Eigen::Vector3d offset = point - corners.col(0);
  const Eigen::Vector2d place = sides.colPivHouseholderQr().solve(offset);
  if (place.minCoeff() >= 0.0 && place.sum() <= 1.0)
    return (offset - sides * place).squaredNorm();
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::Vector3d side = corners.col((k + 1) % 3) - corners.col(k);
    const Eigen::Vector3d from = point - corners.col(k);
    const double length = side.squaredNorm();
    const double along = length > 0.0 ? std::clamp(from.dot(side) / length, 0.0, 1.0) : 0.0;
    least = std::min(least, (from - along * side).squaredNorm());
  }
  return least;
}

}  // namespace

bool isNoisy(const Positions& points, const Neighbors& neighbors, const Stars& stars,
             const Execution& execution) {
  // Noise is the median error of the prediction of a point by its 10 nearest [spacing]: at most .12
  // in clean clouds, .13 to .28 in merged scans.
  constexpr double min_noise = 0.12;
  // The same in distances of the nearest point, times the irregularity: .2 to .4 for noise of a
  // quarter of an edge, .27 to .59 for merged scans.
  constexpr double min_relative_noise = 0.38;
  // Noise lets the error grow up to 1.15 times from 10 points to 20; limbs and walls that are
  // thinner than the neighbourhood 1.19 to 7 times.
  constexpr double max_growth = 1.18;
  // Fraction of the edges that only one of two stars has: at most .035 for separate sheets, at
  // least .05 for merged scans.
  constexpr double min_disagreement = 0.04;
  constexpr Index samples = 400;
  const auto n = static_cast<Index>(points.cols());
  std::vector<Index> queries;
  for (Index i = 0; i < n; i += n / samples + 1)
    queries.push_back(i);
  if (!neighbors.search || queries.size() < samples / 2 ||
      !(oneSidedFraction(stars, execution.threads, reportOf(execution, "consolidation")) >
        min_disagreement))
    return false;
  constexpr Index reach = 6 * kMinSize;  // neighbours within the weights around 20
  const NeighborLists lists = neighbors.search(queries, reach);
  std::vector<double> nearest;
  std::vector<double> spacings;
  std::array<std::vector<double>, 2> errors;
  SurfaceFit fit;
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const Index i = queries[q];
    std::vector<Index> around;
    for (const NearPoint& other : nearestOthers(points, i, listOf(lists, static_cast<Index>(q))))
      around.push_back(other.point);
    const auto distance = [&](Index k) {
      return (points.col(around[static_cast<std::size_t>(k - 1)]) - points.col(i)).norm();
    };
    if (static_cast<Index>(around.size()) < reach)
      return false;
    nearest.push_back(distance(1));
    spacings.push_back(distance(kMinSize) * std::sqrt(kPi / kMinSize));
    for (std::size_t t = 0; t < errors.size(); ++t) {
      const Index size = kMinSize << t;
      fit.compute(points, {around.data(), around.data() + around.size()}, points.col(i), i,
                  kTrialWidth * distance(size));
      errors[t].push_back(std::abs(fit.height()));
    }
  }
  const double spacing = medianOf(spacings);
  const double distance = medianOf(nearest);
  const double noise = medianOf(errors[0]);
  return noise > min_noise * spacing &&
         noise * spacing > min_relative_noise * distance * distance &&
         medianOf(errors[1]) < max_growth * noise;
}

double distanceWithin(double fraction, const Positions& points,
                      const std::vector<Index>& vertex_of_point, const Positions& vertices,
                      const Triangles& triangles, int threads) {
  const CornerTable corners(triangles, columnCount(vertices),
                            threadCount(threads, columnCount(vertices)));
  std::vector<double> distances(columnCount(points), -1.0);
  forEachIndex(distances.size(), threadCount(threads, distances.size()), {}, [&](Index i) {
    const auto place = static_cast<std::size_t>(i);
    if (vertex_of_point[place] < 0)
      return;
    double least = std::numeric_limits<double>::infinity();
    corners.forEachCorner(vertex_of_point[place], [&](Index t, Index) {
      least =
          std::min(least, squaredDistance(points.col(i), vertices(Eigen::all, triangles.col(t))));
    });
    distances[place] = std::sqrt(least);
  });
  distances.erase(std::remove(distances.begin(), distances.end(), -1.0), distances.end());
  if (distances.empty())
    return 0.0;
  const auto nth = distances.begin() + static_cast<std::ptrdiff_t>(
                                           fraction * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), nth, distances.end());
  return *nth;
}

}  // namespace internal

Consolidation consolidate(const Positions& points, const Execution& execution) {
  internal::checkThreads(execution.threads);
  internal::checkFinite("consolidate", points);
  const internal::OrderedPoints nodes = internal::orderPoints(points, execution.threads);
  if (nodes.input_of_node.size() >= internal::kMinPoints) {
    const internal::ConsolidatedNodes result = internal::consolidated(nodes.points, execution);
    if (result.points.cols() >= 4)  // fewer cannot be meshed
      return internal::toInput(nodes, result);
  }
  return internal::toInput(nodes, internal::ConsolidatedNodes(nodes.points));
}

}  // namespace spherical_param
