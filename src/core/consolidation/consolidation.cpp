#include "consolidation.h"

#include "median.h"
#include "neighbor_search.h"
#include "ordered_points.h"
#include "parallel.h"
#include "progress.h"
#include "quadric.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::FractionReport;
using internal::Quadric;

// The experiments are on 14 models, of each eight merged depth images with noise and registration
// errors ("scans"), and the vertices with noise of a quarter of an edge ("noise"); and on four
// models sampled so densely that the noise is several spacings ("dense"). RMS distances and errors
// of normals are relative to those of the better one of two Poisson reconstructions, as geometric
// means: .826 and .910 on the scans, .755 and .864 with noise.

/// Neighbourhoods that are tried: they reach to this neighbour.
constexpr std::array<std::size_t, 3> kScales{10, 20, 40};
/// Neighbours that are searched for: 1.5 times the largest scale, as far as its weights go.
constexpr int kNeighbors = 60;
/// Which neighbourhood is best is decided by the errors at this number of nearest points together.
/// With one decision for all points, normals on the scans are 2 % worse.
constexpr std::size_t kJury = 48;
/// The radii of neighbourhoods are averaged over this number of nearest points, twice: the surface
/// is as smooth as they are. Without, normals on the scans are 5 % worse.
constexpr std::size_t kAveraged = 20;
constexpr int kAverageRounds = 2;
/// Standard deviation of the weights [radius of the neighbourhood], in trials without the point
/// itself, and for the fit with it, which needs fewer others. With 0.4 normals with noise are 12 %
/// worse; with 0.5 better by 7 %, but those of three scans are worse than Poisson's.
constexpr double kTrialWidth = 0.5;
constexpr double kWidth = 0.45;
/// Beyond this number of standard deviations weights are 0.
constexpr double kReach = 3.0;
/// Fits of each point, each where the last one has moved it. With 1, normals on the scans are 3 %
/// worse, with 3 the same.
constexpr int kFits = 2;
/// Points that would move farther stay: no surface is near [radius].
constexpr double kMaxMove = 1.0;
/// Points that end nearer to each other than this become one [noise]. With 0 the meshes are as
/// good, but have triangles far below the noise, with 2, normals on the scans are 2 % worse.
constexpr double kMergeDistance = 1.0;
/// Above this median roundness of neighbourhoods, 0 for a plane, noise hides the surface from them.
/// Scans have 0.17 to 0.30, points with noise up to 0.38, dense ones 0.42 to 0.62, and 0.22 to 0.38
/// after one round of merging. Without a bound, normals of dense clouds are off by 14 to 42 degrees
/// instead of 5 to 8; with 0.3, the RMS distance of one scan is twice as large.
constexpr double kMinThickRoundness = 0.4;
/// Neighbourhoods on thin limbs of few points are round as well, but do not become flatter, however
/// many points are merged. Where they are still round when fewer than this number are left, nothing
/// is merged: 3,400 points of an animal on thin legs became 22 otherwise.
constexpr Index kMinClusters = 200;
/// Points of a cluster at most, and the nearest neighbours that they come from.
constexpr int kClusterSize = 4;
constexpr std::size_t kClusterNeighbors = 6;
/// Fewer points have no noise to speak of.
constexpr std::size_t kMinPoints = 20;
/// Fewer cannot be meshed.
constexpr Eigen::Index kMinLeft = 4;
/// Of the normal equations, so that they are regular whatever the neighbours.
constexpr double kRidge = 1e-9;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// The nearest neighbours of a point, itself among them, nearest first.
class Neighborhood {
public:
  Neighborhood(const NeighborLists& lists, std::size_t point)
      : begin_(lists.indices.data() + lists.offsets[point]),
        end_(lists.indices.data() + lists.offsets[point + 1]) {}

  const Index* begin() const { return begin_; }
  const Index* end() const { return end_; }
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  /// The nearest alone.
  Neighborhood first(std::size_t count) const {
    Neighborhood result = *this;
    result.end_ = begin_ + std::min(count, size());
    return result;
  }

private:
  const Index* begin_;
  const Index* end_;
};

/// A quadric of least squares through neighbours, with Gaussian weights.
class SurfaceFit {
public:
  /// \param point    where the weights are greatest.
  /// \param left_out no neighbour is, or -1.
  /// \param width    standard deviation of the weights.
  void compute(const Positions& points, const Neighborhood& neighbors, const Eigen::Vector3d& point,
               Index left_out, double width) {
    gather(points, neighbors, point, left_out, width);
    height_ = 0.0;
    noise_ = 0.0;
    roundness_ = 1.0;
    normal_.setZero();
    if (weights_.size() < static_cast<std::size_t>(Quadric::SizeAtCompileTime))
      return;
    findPlane();
    fit();
  }

  /// From the quadric to the point, along the normal.
  Eigen::Vector3d offset() const { return height_ * normal_; }
  double height() const { return height_; }
  /// Root mean square distance of the neighbours from the quadric.
  double noise() const { return noise_; }
  /// 0 if they are in a plane, 1 if all directions are alike.
  double roundness() const { return roundness_; }

private:
  void gather(const Positions& points, const Neighborhood& neighbors, const Eigen::Vector3d& point,
              Index left_out, double width) {
    width_ = width;
    weights_.clear();
    offsets_.clear();
    for (const Index j : neighbors) {
      const Eigen::Vector3d offset = (points.col(j) - point) / width;
      const double squared = offset.squaredNorm();
      if (j == left_out || !(squared < kReach * kReach))
        continue;
      weights_.push_back(std::exp(-0.5 * squared));
      offsets_.push_back(offset);
    }
    const double total = std::accumulate(weights_.begin(), weights_.end(), 0.0);
    for (double& weight : weights_)
      weight /= total;
  }

  void findPlane() {
    mean_.setZero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      mean_ += weights_[k] * offsets_[k];
      covariance += weights_[k] * offsets_[k] * offsets_[k].transpose();
    }
    covariance -= mean_ * mean_.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
    axes.computeDirect(covariance);
    normal_ = axes.eigenvectors().col(0);
    across_ = axes.eigenvectors().rightCols<2>();
    const Eigen::Vector3d& variances = axes.eigenvalues();
    if (variances[1] > 0.0)
      roundness_ = std::sqrt(std::max(variances[0], 0.0) / variances[1]);
  }

  void fit() {
    rows_.resize(Quadric::SizeAtCompileTime, static_cast<Eigen::Index>(weights_.size()));
    heights_.resize(weights_.size());
    Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
    Quadric right = Quadric::Zero();
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      const Quadric row = monomialsAt(offsets_[k]);
      heights_[k] = normal_.dot(offsets_[k] - mean_);
      rows_.col(static_cast<Eigen::Index>(k)) = row;
      matrix.selfadjointView<Eigen::Lower>().rankUpdate(row, weights_[k]);
      right += weights_[k] * heights_[k] * row;
    }
    matrix.diagonal().array() += kRidge;
    const Quadric quadric = matrix.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    double squares = 0.0;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      const double residual = heights_[k] - quadric.dot(rows_.col(static_cast<Eigen::Index>(k)));
      squares += weights_[k] * residual * residual;
    }
    noise_ = std::sqrt(squares) * width_;
    height_ = (-normal_.dot(mean_) - quadric.dot(monomialsAt(Eigen::Vector3d::Zero()))) * width_;
  }

  Quadric monomialsAt(const Eigen::Vector3d& offset) const {
    const Eigen::Vector2d place = across_.transpose() * (offset - mean_);
    return internal::monomials(place.x(), place.y());
  }

  double width_ = 0.0;
  std::vector<double> weights_;           ///< of sum 1
  std::vector<Eigen::Vector3d> offsets_;  ///< from the point [width]
  Eigen::Vector3d mean_;                  ///< of the offsets
  Eigen::Vector3d normal_;
  Eigen::Matrix<double, 3, 2> across_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows_;
  std::vector<double> heights_;
  double height_ = 0.0;
  double noise_ = 0.0;
  double roundness_ = 1.0;
};

/// A noisy cloud, its neighbourhoods and their fits.
class NoisyCloud {
public:
  NoisyCloud(Positions points, const Execution& execution)
      : points_(std::move(points)), lists_(findNearestNeighbors(points_, kNeighbors, execution)),
        threads_(internal::threadCount(execution.threads, size())),
        report_(internal::reportOf(execution, "consolidation")),
        fits_(static_cast<std::size_t>(threads_)) {
    tryScales();
  }

  std::size_t size() const { return static_cast<std::size_t>(points_.cols()); }
  const Positions& points() const { return points_; }
  /// Whether the noise is above what neighbourhoods can tell from the surface.
  bool isThick() const { return roundness_ > kMinThickRoundness; }

  /// Clusters of neighbours, of some three points each.
  ///
  /// \return the number of clusters.
  Index clusters(std::vector<Index>& cluster) const {
    cluster.assign(size(), -1);
    Index count = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      if (cluster[i] >= 0)
        continue;
      int taken = 0;
      // The point is the first of its own neighbours, or one at the same place.
      cluster[i] = count;
      for (const Index j : around(i).first(kClusterNeighbors + 1))
        if (cluster[at(j)] < 0 && ++taken < kClusterSize)
          cluster[at(j)] = count;
      ++count;
    }
    return count;
  }

  /// Moves the points to the surface, and merges those that come closer than their noise.
  ///
  /// \param part of each point, the number of the point it is part of.
  /// \return the points that are left.
  Positions onSurface(std::vector<Index>& part, double& noise) {
    chooseRadii();
    std::vector<double> deviations(size());
    Positions moved(3, points_.cols());
    internal::forEachItem(size(), threads_, report_, [&](std::size_t thread, std::size_t i) {
      SurfaceFit& fit = fits_[thread];
      const Eigen::Vector3d point = points_.col(static_cast<Eigen::Index>(i));
      Eigen::Vector3d place = point;
      for (int k = 0; k < kFits; ++k) {
        fit.compute(points_, around(i), place, -1, kWidth * radii_[i]);
        place -= fit.offset();
      }
      deviations[i] = fit.noise();
      const bool stays = !((place - point).norm() <= kMaxMove * radii_[i]);
      moved.col(static_cast<Eigen::Index>(i)) = stays ? point : place;
    });
    Positions left = merged(moved, deviations, part);
    noise = internal::medianOf(deviations);
    return left;
  }

private:
  Neighborhood around(std::size_t i) const { return {lists_, i}; }

  /// How well the points are predicted by their neighbours, by each scale.
  void tryScales() {
    std::vector<double> roundness(size());
    errors_.resize(size());
    scale_radii_.resize(size());
    internal::forEachItem(size(), threads_, report_, [&](std::size_t thread, std::size_t i) {
      SurfaceFit& fit = fits_[thread];
      const Eigen::Vector3d point = points_.col(static_cast<Eigen::Index>(i));
      const Neighborhood all = around(i);
      for (std::size_t s = 0; s < kScales.size(); ++s) {
        const std::size_t last = std::min(kScales[s], all.size() - 1);
        scale_radii_[i][s] = (points_.col(*(all.begin() + last)) - point).norm();
        fit.compute(points_, all.first(last + last / 2 + 1), point, static_cast<Index>(i),
                    kTrialWidth * scale_radii_[i][s]);
        errors_[i][s] = std::abs(fit.height());
        if (s == kScales.size() / 2)
          roundness[i] = fit.roundness();
      }
    });
    roundness_ = internal::medianOf(roundness);
  }

  /// The radius of the best scale around each point, smoothly.
  void chooseRadii() {
    radii_.resize(size());
    internal::forEachItem(size(), threads_, [&](std::size_t, std::size_t i) {
      std::array<double, kScales.size()> sums{};
      for (const Index j : around(i).first(kJury))
        for (std::size_t s = 0; s < kScales.size(); ++s)
          sums[s] += errors_[at(j)][s];
      const auto best = std::min_element(sums.begin(), sums.end()) - sums.begin();
      radii_[i] = scale_radii_[i][static_cast<std::size_t>(best)];
    });
    std::vector<double> means(size());
    for (int round = 0; round < kAverageRounds; ++round) {
      internal::forEachItem(size(), threads_, [&](std::size_t, std::size_t i) {
        const Neighborhood nearest = around(i).first(kAveraged);
        double sum = 0.0;
        for (const Index j : nearest)
          sum += radii_[at(j)];
        means[i] = sum / static_cast<double>(nearest.size());
      });
      radii_.swap(means);
    }
  }

  Positions merged(const Positions& moved, const std::vector<double>& deviations,
                   std::vector<Index>& part) const {
    part.assign(size(), -1);
    Positions left(3, moved.cols());
    Index count = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      if (part[i] >= 0)
        continue;
      const auto point = moved.col(static_cast<Eigen::Index>(i));
      for (const Index j : around(i))
        if (part[at(j)] < 0 && (moved.col(j) - point).norm() <= kMergeDistance * deviations[i])
          part[at(j)] = count;
      part[i] = count;
      left.col(count++) = point;
    }
    return left.leftCols(count);
  }

  Positions points_;
  NeighborLists lists_;
  int threads_;
  FractionReport report_;
  std::vector<SurfaceFit> fits_;  ///< of each thread
  std::vector<std::array<double, kScales.size()>> errors_;
  std::vector<std::array<double, kScales.size()>> scale_radii_;
  std::vector<double> radii_;
  double roundness_ = 0.0;
};

Positions meansOf(const Positions& points, const std::vector<Index>& cluster, Index count) {
  Positions means = Positions::Zero(3, count);
  Eigen::RowVectorXd sizes = Eigen::RowVectorXd::Zero(count);
  for (std::size_t i = 0; i < cluster.size(); ++i) {
    means.col(cluster[i]) += points.col(static_cast<Eigen::Index>(i));
    sizes[cluster[i]] += 1.0;
  }
  return means.array().rowwise() / sizes.array();
}

/// The points, and of each node the one that it is part of.
struct ConsolidatedNodes {
  Positions points;
  std::vector<Index> point_of_node;
  double noise = 0.0;
};

/// Each node is a point of its own.
std::vector<Index> unmerged(const Positions& nodes) {
  std::vector<Index> point_of_node(static_cast<std::size_t>(nodes.cols()));
  std::iota(point_of_node.begin(), point_of_node.end(), Index{0});
  return point_of_node;
}

ConsolidatedNodes consolidated(const Positions& nodes, const Execution& execution) {
  ConsolidatedNodes result;
  result.point_of_node = unmerged(nodes);
  const auto pass_on = [&](const std::vector<Index>& part) {
    for (Index& point : result.point_of_node)
      point = part[at(point)];
  };
  std::vector<Index> part;
  NoisyCloud given(nodes, execution);
  std::optional<NoisyCloud> clustered;
  NoisyCloud* cloud = &given;
  while (cloud->isThick()) {
    const Index count = cloud->clusters(part);
    if (count < kMinClusters) {
      result.point_of_node = unmerged(nodes);
      cloud = &given;
      break;
    }
    cloud = &clustered.emplace(meansOf(cloud->points(), part, count), execution);
    pass_on(part);
  }
  result.points = cloud->onSurface(part, result.noise);
  pass_on(part);
  return result;
}

/// The points in the order and the unit of the input.
Consolidation toInput(const Positions& input, const internal::OrderedPoints& nodes,
                      const ConsolidatedNodes& consolidated) {
  Consolidation result;
  const std::vector<Index> node_of_input = internal::nodesOfInput(nodes);
  std::vector<Index> number(static_cast<std::size_t>(consolidated.points.cols()), -1);
  result.points.resize(3, consolidated.points.cols());
  Index count = 0;
  Eigen::VectorXd moved(input.cols());
  for (Eigen::Index i = 0; i < input.cols(); ++i) {
    const Index point = consolidated.point_of_node[at(node_of_input[static_cast<std::size_t>(i)])];
    if (number[at(point)] < 0) {
      number[at(point)] = count++;
      result.points.col(number[at(point)]) = consolidated.points.col(point).unaryExpr(
          [&](double x) { return std::ldexp(x, nodes.exponent); });
    }
    result.point_of_input.push_back(number[at(point)]);
    moved[i] = (result.points.col(result.point_of_input.back()) - input.col(i)).norm();
  }
  ConsolidationReport& report = result.report;
  report.noise = std::ldexp(consolidated.noise, nodes.exponent);
  report.merged = nodes.input_of_node.size() - at(count);
  if (input.cols() > 0) {
    report.max_displacement = moved.maxCoeff();
    report.mean_displacement = moved.mean();
    report.rms_displacement = std::sqrt(moved.squaredNorm() / static_cast<double>(moved.size()));
  }
  return result;
}

}  // namespace

Consolidation consolidate(const Positions& points, const Execution& execution) {
  internal::checkThreads(execution.threads);
  internal::checkFinite("consolidate", points);
  const internal::OrderedPoints nodes = internal::orderPoints(points, execution.threads);
  if (nodes.input_of_node.size() >= kMinPoints) {
    const ConsolidatedNodes result = consolidated(nodes.points, execution);
    if (result.points.cols() >= kMinLeft)
      return toInput(points, nodes, result);
  }
  return toInput(points, nodes, {nodes.points, unmerged(nodes.points), 0.0});
}

}  // namespace spherical_param
