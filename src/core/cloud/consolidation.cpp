#include "consolidation.h"

#include "neighbor_search.h"
#include "ordered_points.h"
#include "power_of_two.h"
#include "progress.h"
#include "quadric_fit.h"
#include "rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

namespace spherical_param {
namespace internal {
namespace {

// The experiments are on 14 models, of each eight merged depth images with noise and registration
// errors ("scans"), and the vertices with noise of a quarter of an edge ("noise"); and on four
// models sampled so densely that the noise is several spacings ("dense"). RMS distances and errors
// of normals are relative to those of the better one of two Poisson reconstructions, as geometric
// means: .826 and .910 on the scans, .755 and .864 with noise.

/// Neighbourhoods that are tried: they reach to this neighbour.
constexpr std::array<std::size_t, 3> kScales{10, 20, 40};
/// Standard deviation of the weights [radius of the neighbourhood], in trials without the point
/// itself, and for the fit with it, which needs fewer others. With 0.4 normals with noise are 12 %
/// worse; with 0.5 better by 7 %, but those of three scans are worse than Poisson's.
constexpr double kTrialWidth = 0.5;
constexpr double kWidth = 0.45;
/// Above this median roundness of neighbourhoods, 0 for a plane, noise hides the surface from them.
/// Scans have 0.17 to 0.30, points with noise up to 0.38, dense ones 0.42 to 0.62, and 0.22 to 0.38
/// after one round of merging. Without a bound, normals of dense clouds are off by 14 to 42 degrees
/// instead of 5 to 8; with 0.3, the RMS distance of one scan is twice as large.
constexpr double kMinThickRoundness = 0.4;
/// Fewer points have no noise to speak of.
constexpr std::size_t kMinPoints = 20;
/// A quadric of least squares through neighbours, with Gaussian weights.
class SurfaceFit {
public:
  /// \param point    where the weights are greatest.
  /// \param left_out no neighbour is, or -1.
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

  /// From the quadric to the point, along the normal; 0 without enough neighbours.
  Eigen::Vector3d offset() const { return height() * quadric_.normal(); }
  double height() const { return quadric_.height() * width_; }
  /// Root mean square distance of the neighbours from the quadric.
  double noise() const { return quadric_.residual() * width_; }
  /// 0 if they are in a plane, 1 if all directions are alike.
  double roundness() const { return quadric_.roundness(); }

private:
  double width_ = 0.0;
  std::vector<double> weights_;           ///< of sum 1
  std::vector<Eigen::Vector3d> offsets_;  ///< from the point [width]
  QuadricFit quadric_;
};

/// A noisy cloud, its neighbourhoods and their fits.
class NoisyCloud {
public:
  NoisyCloud(Positions points, const Execution& execution)
      : points_(std::move(points)),  // 1.5 times the largest scale: as far as its weights go
        lists_(findNearestNeighbors(points_, 60, execution)),
        threads_(threadCount(execution.threads, lists_.size())),
        report_(reportOf(execution, "consolidation")), errors_(lists_.size()),
        scale_radii_(lists_.size()) {
    tryScales();
  }

  const Positions& points() const { return points_; }
  /// Whether the noise is above what neighbourhoods can tell from the surface.
  bool isThick() const { return roundness_ > kMinThickRoundness; }

  /// Clusters of neighbours, of some three points each.
  ///
  /// \return the number of clusters.
  Index clusters(Indexed<Index>& cluster) const {
    // Points of a cluster at most, and the nearest neighbours that they come from.
    constexpr int cluster_size = 4;
    constexpr std::size_t cluster_neighbors = 6;
    cluster.assign(lists_.size(), -1);
    Index count = 0;
    for (const Index i : indicesOf(cluster)) {
      if (cluster[i] >= 0)
        continue;
      int taken = 0;
      // The point is the first of its own neighbours, or one at the same place.
      cluster[i] = count;
      for (const Index j : listOf(lists_, i).first(cluster_neighbors + 1))
        if (cluster[j] < 0 && ++taken < cluster_size)
          cluster[j] = count;
      ++count;
    }
    return count;
  }

  /// Moves the points to the surface, and merges those that come closer than their noise.
  ///
  /// \param part of each point, the number of the point it is part of.
  /// \return the points that are left.
  Positions onSurface(Indexed<Index>& part, double& noise) {
    const Indexed<double> radii = chooseRadii();
    Indexed<double> deviations(lists_.size());
    Positions moved(3, points_.cols());
    forEachIndex<SurfaceFit>(lists_.size(), threads_, report_, [&](SurfaceFit& fit, Index i) {
      const Eigen::Vector3d point = points_.col(i);
      Eigen::Vector3d place = point;
      // The second fit is where the first has moved the point. With one, normals on the scans are 3
      // % worse, with three the same.
      for (int k = 0; k < 2; ++k) {
        fit.compute(points_, listOf(lists_, i), place, -1, kWidth * radii[i]);
        place -= fit.offset();
      }
      deviations[i] = fit.noise();
      // Where the surface is farther than the neighbourhood, there is none.
      const bool stays = !((place - point).norm() <= radii[i]);
      moved.col(i) = stays ? point : place;
    });
    Positions left = merged(moved, deviations, part);
    noise = medianOf(deviations);
    return left;
  }

private:
  /// How well the points are predicted by their neighbours, by each scale.
  void tryScales() {
    Indexed<double> roundness(lists_.size());
    forEachIndex<SurfaceFit>(lists_.size(), threads_, report_, [&](SurfaceFit& fit, Index i) {
      const Eigen::Vector3d point = points_.col(i);
      const Row<Index> all = listOf(lists_, i);
      for (std::size_t s = 0; s < kScales.size(); ++s) {
        const std::size_t last = std::min(kScales[s], all.size() - 1);
        scale_radii_[i][s] = (points_.col(*(all.begin() + last)) - point).norm();
        fit.compute(points_, all.first(last + last / 2 + 1), point, i,
                    kTrialWidth * scale_radii_[i][s]);
        errors_[i][s] = std::abs(fit.height());
        if (s == kScales.size() / 2)
          roundness[i] = fit.roundness();
      }
    });
    roundness_ = medianOf(roundness);
  }

  /// The radius of the best scale around each point, smoothly.
  Indexed<double> chooseRadii() const {
    Indexed<double> radii(lists_.size());
    forEachIndex(radii.size(), threads_, {}, [&](Index i) {
      // Which neighbourhood is best is decided by the errors at this number of nearest points
      // together. With one decision for all points, normals on the scans are 2 % worse.
      constexpr std::size_t jury = 48;
      ScaleValues sums{};
      for (const Index j : listOf(lists_, i).first(jury))
        for (std::size_t s = 0; s < kScales.size(); ++s)
          sums[s] += errors_[j][s];
      radii[i] =
          *(scale_radii_[i].begin() + (std::min_element(sums.begin(), sums.end()) - sums.begin()));
    });
    // The radii of neighbourhoods are averaged over this number of nearest points, twice: the
    // surface is as smooth as they are. Without, normals on the scans are 5 % worse.
    constexpr std::size_t averaged = 20;
    Indexed<double> means(radii.size());
    for (int round = 0; round < 2; ++round) {
      forEachIndex(radii.size(), threads_, {}, [&](Index i) {
        const Row<Index> nearest = listOf(lists_, i).first(averaged);
        double sum = 0.0;
        for (const Index j : nearest)
          sum += radii[j];
        means[i] = sum / static_cast<double>(nearest.size());
      });
      radii.swap(means);
    }
    return radii;
  }

  /// Merges points that are nearer to each other than their noise. Without, the meshes are as good,
  /// but have triangles far below the noise; at twice that distance normals on the scans are 2 %
  /// worse.
  Positions merged(const Positions& moved, const Indexed<double>& deviations,
                   Indexed<Index>& part) const {
    part.assign(lists_.size(), -1);
    Positions left(3, moved.cols());
    Index count = 0;
    for (const Index i : indicesOf(part)) {
      if (part[i] >= 0)
        continue;
      for (const Index j : listOf(lists_, i))
        if (part[j] < 0 && (moved.col(j) - moved.col(i)).norm() <= deviations[i])
          part[j] = count;
      part[i] = count;
      left.col(count++) = moved.col(i);
    }
    return left.leftCols(count);
  }

  using ScaleValues = std::array<double, kScales.size()>;

  Positions points_;
  NeighborLists lists_;
  int threads_;
  FractionReport report_;
  Indexed<ScaleValues> errors_;
  Indexed<ScaleValues> scale_radii_;
  double roundness_ = 0.0;
};

Positions meansOf(const Positions& points, const Indexed<Index>& cluster, Index count) {
  Positions means = Positions::Zero(3, count);
  Eigen::RowVectorXd sizes = Eigen::RowVectorXd::Zero(count);
  for (const Index i : indicesOf(cluster)) {
    means.col(cluster[i]) += points.col(i);
    sizes[cluster[i]] += 1.0;
  }
  return means.array().rowwise() / sizes.array();
}

/// The points, and of each node the one that it is part of.
struct ConsolidatedNodes {
  /// Each node is a point of its own.
  explicit ConsolidatedNodes(const Positions& nodes)
      : points(nodes), point_of_node(static_cast<std::size_t>(nodes.cols())) {
    std::iota(point_of_node.begin(), point_of_node.end(), Index{0});
  }

  Positions points;
  Indexed<Index> point_of_node;
  double noise = 0.0;
};

ConsolidatedNodes consolidated(const Positions& nodes, const Execution& execution) {
  ConsolidatedNodes result(nodes);
  Indexed<Index> part;
  const auto pass_on = [&] {
    for (Index& point : result.point_of_node)
      point = part[point];
  };
  NoisyCloud given(nodes, execution);
  std::optional<NoisyCloud> clustered;
  NoisyCloud* cloud = &given;
  while (cloud->isThick()) {
    // Neighbourhoods on thin limbs of few points are round as well, but do not become flatter,
    // however many points are merged. Where they are still round when fewer than this number are
    // left, nothing is merged: 3,400 points of an animal on thin legs became 22 otherwise.
    constexpr Index min_clusters = 200;
    const Index count = cloud->clusters(part);
    if (count < min_clusters) {
      result = ConsolidatedNodes(nodes);
      cloud = &given;
      break;
    }
    cloud = &clustered.emplace(meansOf(cloud->points(), part, count), execution);
    pass_on();
  }
  result.points = cloud->onSurface(part, result.noise);
  pass_on();
  return result;
}

/// The points in the order and the unit of the input.
Consolidation toInput(const Positions& input, const OrderedPoints& nodes,
                      const ConsolidatedNodes& consolidated) {
  Consolidation result;
  const Indexed<Index> node_of_input = nodesOfInput(nodes);
  Indexed<Index> number(static_cast<std::size_t>(consolidated.points.cols()), -1);
  result.points.resize(3, consolidated.points.cols());
  Index count = 0;
  Eigen::VectorXd moved(input.cols());
  for (const Index i : indicesOf(node_of_input)) {
    const Index point = consolidated.point_of_node[node_of_input[i]];
    if (number[point] < 0) {
      number[point] = count++;
      result.points.col(number[point]) =
          timesPowerOfTwo(consolidated.points.col(point), nodes.exponent);
    }
    result.point_of_input.push_back(number[point]);
    moved[i] = (result.points.col(number[point]) - input.col(i)).norm();
  }
  result.distinct_at.assign(number.size(), 0);
  for (const Index point : consolidated.point_of_node)
    ++result.distinct_at[static_cast<std::size_t>(number[point])];
  ConsolidationReport& report = result.report;
  report.noise = std::ldexp(consolidated.noise, nodes.exponent);
  report.merged = nodes.input_of_node.size() - number.size();
  if (input.cols() > 0) {
    report.max_displacement = moved.maxCoeff();
    report.mean_displacement = moved.mean();
    report.rms_displacement = std::sqrt(moved.squaredNorm() / static_cast<double>(moved.size()));
  }
  return result;
}

}  // namespace
}  // namespace internal

Consolidation consolidate(const Positions& points, const Execution& execution) {
  internal::checkThreads(execution.threads);
  internal::checkFinite("consolidate", points);
  const internal::OrderedPoints nodes = internal::orderPoints(points, execution.threads);
  if (nodes.input_of_node.size() >= internal::kMinPoints) {
    const internal::ConsolidatedNodes result = internal::consolidated(nodes.points, execution);
    if (result.points.cols() >= 4)  // fewer cannot be meshed
      return internal::toInput(points, nodes, result);
  }
  return internal::toInput(points, nodes, internal::ConsolidatedNodes(nodes.points));
}

}  // namespace spherical_param
