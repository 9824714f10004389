#include "ray_pattern.h"

#include "indexed.h"
#include "neighbor_search.h"
#include "parallel.h"
#include "place_descent.h"
#include "rows.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Directions that are evenly spread over the sphere.
std::vector<Eigen::Vector3d> spreadDirections(int count) {
  constexpr double golden_angle = 2.399963229728653;
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double across = std::sqrt(1.0 - z * z);
    directions.emplace_back(across * std::cos(i * golden_angle),
                            across * std::sin(i * golden_angle), z);
  }
  return directions;
}

}  // namespace

RayPattern::RayPattern(const Positions& points, const NeighborSearch& search) {
  constexpr Eigen::Index most = 2000;
  constexpr int neighbors = 6;
  const std::vector<Index> sample = sampleOf(points, most);
  const NeighborLists lists = search(sample, neighbors);
  points_ = points(Eigen::all, sample);
  nearest_.resize(3, points_.cols());
  spacing_.resize(points_.cols());
  std::vector<double> distances;
  for (Index i = 0; i < points_.cols(); ++i) {
    const auto near =
        nearestOthers(points, sample[static_cast<std::size_t>(i)], listOf(lists, i), neighbors);
    nearest_.col(i) = points.col(near.front().point);
    spacing_[i] = std::log(near.back().squared_distance) / 2.0;
    distances.push_back(std::log(near.front().squared_distance) / 2.0);
  }
  const Eigen::ArrayXd logarithms =
      Eigen::Map<const Eigen::ArrayXd>(distances.data(), spacing_.size());
  spread_ = (logarithms - medianOf(distances)).abs().min(1.0).mean();
}

/// Mean deviation of the logarithm of the angle between neighbouring rays from its median, or from
/// a quadratic function of the direction, as pinhole cameras and scanners on a tripod have it.
double RayPattern::unevenness(const Eigen::Vector3d& place, bool is_quadratic) const {
  constexpr double min_angle = 1e-12;
  constexpr double outlier = 0.7;
  constexpr int rounds = 2;
  constexpr int terms = 10;
  const Eigen::Index n = points_.cols();
  Eigen::VectorXd angle(n);
  Eigen::Matrix<double, Eigen::Dynamic, terms> monomials(is_quadratic ? n : 0, terms);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d d = (points_.col(i) - place).normalized();
    angle[i] = std::log(d.cross((nearest_.col(i) - place).normalized()).norm() + min_angle);
    if (is_quadratic)
      monomials.row(i) << 1.0, d.x(), d.y(), d.z(), d.x() * d.x(), d.x() * d.y(), d.x() * d.z(),
          d.y() * d.y(), d.y() * d.z(), d.z() * d.z();
  }
  std::vector<double> values(angle.data(), angle.data() + n);
  angle.array() -= medianOf(values);
  Eigen::VectorXd rest = angle;
  for (int round = 0; is_quadratic && round < rounds; ++round) {
    const Eigen::VectorXd weights = (rest.array().abs() < outlier).cast<double>();
    Eigen::Matrix<double, terms, terms> normal =
        monomials.transpose() * weights.asDiagonal() * monomials;
    normal.diagonal().array() += 1e-6 * static_cast<double>(n);
    rest = angle -
           monomials * normal.ldlt().solve(monomials.transpose() * weights.cwiseProduct(angle));
  }
  const double mean = rest.cwiseAbs().cwiseMin(1.0).mean();
  return std::isfinite(mean) ? mean : 1.0;
}

bool RayPattern::isSensor(const Eigen::Vector3d& place) const {
  // Sensors have up to 0.09, also with coarse steps of depth; other places and objects at least
  // 0.15.
  constexpr double max_unevenness = 0.12;
  // Sensors have up to 0.34 [spread_]; points that are evenly spread over the surface itself have
  // more.
  constexpr double max_of_spread = 0.5;
  return unevenness(place, true) < std::min(max_unevenness, max_of_spread * spread_) ||
         isSpreadFrom(place);
}

bool RayPattern::isSpreadFrom(const Eigen::Vector3d& place) const {
  // The slope of the logarithms is 1 to 1.4 for scanners, and -0.9 to 0.3 for objects.
  constexpr double min_correlation = 0.8;
  const Eigen::ArrayXd distance =
      (points_.colwise() - place).colwise().norm().array().log().transpose();
  const Eigen::ArrayXd x = distance - distance.mean();
  const Eigen::ArrayXd y = spacing_.array() - spacing_.mean();
  const double common = (x * y).sum();
  const double slope = common / x.square().sum();
  return slope > 0.5 && slope < 2.0 &&
         common > min_correlation * std::sqrt(x.square().sum() * y.square().sum());
}

/// The middle of the points with the least spacing.
Eigen::Vector3d RayPattern::densest() const {
  constexpr double fraction = 0.02;
  std::vector<Index> order = firstIndices(columnCount(points_));
  const std::size_t part = fractionOf(fraction, columnCount(points_)) + 1;
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(part), order.end(),
      [&](Index a, Index b) { return std::pair(spacing_[a], a) < std::pair(spacing_[b], b); });
  order.resize(part);
  return points_(Eigen::all, order).rowwise().mean();
}

std::optional<Eigen::Vector3d> RayPattern::find(int threads) const {
  constexpr int directions = 50;
  constexpr double first_step = 0.2;
  constexpr double coarse_step = 0.01;
  constexpr double min_step = 5e-4;
  constexpr int max_moves = 10;
  const Eigen::Matrix3d axes = axesOf(points_).eigenvectors();
  const Eigen::Vector3d middle = middleOf(points_);
  const double extent = extentOf(points_);
  // A scanner within the points is where they are densest, in a narrow valley of the cost.
  std::array<Eigen::Vector3d, 2> starts = {densest(), middle};
  std::vector<Eigen::Vector3d> places;
  for (const double radii : {0.3, 0.6, 1.2, 2.5})
    for (const Eigen::Vector3d& direction : spreadDirections(directions))
      places.emplace_back(middle + radii * extent * direction);
  std::vector<double> costs(places.size());
  forEachTask(places.size(), threads,
              [&](std::size_t i) { costs[i] = unevenness(places[i], false); });
  starts[1] = places[static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) -
                                              costs.begin())];
  std::array<double, 2> found{};
  forEachTask(starts.size(), threads, [&](std::size_t i) {
    for (const bool is_quadratic : {false, true})
      found[i] = descend([&](const Eigen::Vector3d& at) { return unevenness(at, is_quadratic); },
                         axes, first_step * extent,
                         (is_quadratic ? min_step : coarse_step) * extent, max_moves, starts[i]);
  });
  const Eigen::Vector3d best = starts[found[1] < found[0] ? 1 : 0];
  return isSensor(best) ? std::optional(best) : std::nullopt;
}

}  // namespace spherical_param::internal
