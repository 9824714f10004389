#include "smoothing.h"

#include "corner_table.h"
#include "pi.h"
#include "rows.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace spherical_param {
namespace {

/// Filters and volume of one mesh, on several threads.
class Filter {
public:
  Filter(const Triangles& triangles, std::size_t n, int requested_threads)
      : triangles_(triangles), threads_(internal::threadCount(requested_threads, n)),
        corners_(triangles, n, threads_) {}

  bool isUsed(Index v) const { return corners_.countAt(v) > 0; }

  /// Moves each point by a fraction of its Laplacian, all at once; `scratch` is overwritten.
  void step(Positions& points, double fraction, Positions& scratch) const {
    forEachPoint(
        [&](Index i) { scratch.col(i) = points.col(i) + fraction * laplacian(points, i); });
    points.swap(scratch);
  }

  void biharmonicFlow(Positions& points, int steps) const;

  /// Signed volume, by the divergence theorem.
  double volume(const Positions& points) const {
    // Each triangle is visited from its three corners.
    return sum([&](Index i) { return points.col(i).dot(normal(points, i)); }) / 18.0;
  }

  void restoreVolume(Positions& points, double volume) const;

  template <typename Term>
  double sum(const Term& term) const {
    return internal::accumulate(corners_.vertexCount(), threads_, 0.0,
                                [&](Index i, double& total) { total += term(i); });
  }

  template <typename Work>
  void forEachPoint(const Work& work) const {
    internal::forEachIndex(corners_.vertexCount(), threads_, {}, work);
  }

private:
  /// The mean of the neighbours of point i minus the point; 0 for a point of no triangle. As the
  /// fans of a closed manifold are cycles, their next corners alone are each neighbour once.
  Eigen::Vector3d laplacian(const Positions& points, Index i) const {
    Eigen::Vector3d total = Eigen::Vector3d::Zero();
    if (!isUsed(i))
      return total;
    corners_.forEachCorner(
        i, [&](Index t, Index k) { total += points.col(triangles_(internal::nextCorner(k), t)); });
    return total / static_cast<double>(corners_.countAt(i)) - points.col(i);
  }

  /// The sum of the normals of the triangles around point i, as long as twice their areas: six
  /// times the gradient of the volume.
  Eigen::Vector3d normal(const Positions& points, Index i) const {
    const Eigen::Vector3d center = points.col(i);
    Eigen::Vector3d total = Eigen::Vector3d::Zero();
    corners_.forEachCorner(i, [&](Index t, Index k) {
      total += (points.col(triangles_(internal::nextCorner(k), t)) - center)
                   .cross(points.col(triangles_(internal::previousCorner(k), t)) - center);
    });
    return total;
  }

  const Triangles& triangles_;
  int threads_;
  internal::CornerTable corners_;
};

/// The Chebyshev coefficients of 2^-(k / c)^2, c = 1 - 2^(-1 / steps), in x = 4/3 k - 1 of [-1, 1].
///
/// No eigenvalue k of the uniform Laplacian of a closed mesh, D^-1 (D - A) with degrees D and
/// adjacency A, exceeds 3/2: each edge is in two triangles, so that x' (D + A) x is half the sum
/// over the triangles of (x_i + x_j)^2 + (x_j + x_k)^2 + (x_k + x_i)^2 >= x_i^2 + x_j^2 + x_k^2,
/// and a vertex is in as many triangles as it has neighbours: x' (D + A) x >= x' D x / 2.
std::vector<double> biharmonicSeries(int steps) {
  const double cutoff = -std::expm1(-std::log(2.0) / steps);
  // In the angle of the nodes the filter is as wide as sqrt(c): this number of them resolves it to
  // 1e-9.
  const auto nodes = static_cast<std::size_t>(16.0 + 16.0 / std::sqrt(cutoff));
  std::vector<double> coefficients(nodes, 0.0);
  for (std::size_t q = 0; q < nodes; ++q) {
    const double angle =
        internal::kPi * (static_cast<double>(q) + 0.5) / static_cast<double>(nodes);
    const double k = 0.75 * (1.0 + std::cos(angle));
    const double value = std::exp2(-(k / cutoff) * (k / cutoff)) / static_cast<double>(nodes);
    for (std::size_t i = 0; i < nodes; ++i)
      coefficients[i] += (i == 0 ? 1.0 : 2.0) * value * std::cos(static_cast<double>(i) * angle);
  }
  // Exact to 1e-7, relative to the size of what is filtered: far below any noise.
  double omitted = 0.0;
  while (coefficients.size() > 2 && omitted + std::abs(coefficients.back()) < 1e-7) {
    omitted += std::abs(coefficients.back());
    coefficients.pop_back();
  }
  // A constant must stay: the gain at k = 0, where T_i(-1) = (-1)^i, is 1.
  double gain = 0.0;
  for (std::size_t i = 0; i < coefficients.size(); ++i)
    gain += i % 2 == 0 ? coefficients[i] : -coefficients[i];
  coefficients[0] += 1.0 - gain;
  return coefficients;
}

/// Runs the biharmonic flow. As all k lie in [0, 3/2], its gain is a short Chebyshev series of the
/// Laplacian: cheaper than solving with 1 + L^2 / c^2, and the same for any number of threads.
void Filter::biharmonicFlow(Positions& points, int steps) const {
  const std::vector<double> coefficients = biharmonicSeries(steps);
  // x applied to the points is -4/3 of the Laplacian minus the points.
  Positions before = points;  // T_0
  Positions last = -points;   // T_1
  step(last, 1.0 / 0.75, points);
  points = coefficients[0] * before + coefficients[1] * last;
  for (std::size_t degree = 2; degree < coefficients.size(); ++degree) {
    forEachPoint([&](Index i) {
      before.col(i) = -2.0 * (laplacian(last, i) / 0.75 + last.col(i)) - before.col(i);
      points.col(i) += coefficients[degree] * before.col(i);
    });
    before.swap(last);
  }
}

/// Moves all points by one distance along their normals so that the volume becomes the given one:
/// Newton's method. A step that leads farther away is halved: after much shrinking a whole one is
/// far too long.
void Filter::restoreVolume(Positions& points, double volume) const {
  double error = volume - this->volume(points);
  Positions moved(3, points.cols());
  constexpr int max_steps = 50;
  constexpr double min_fraction = 1e-3;
  double fraction = 1.0;
  for (int step = 0;
       step < max_steps && fraction > min_fraction && std::abs(error) > 1e-12 * std::abs(volume);
       ++step) {
    const double slope = sum([&](Index v) { return normal(points, v).norm(); }) / 6.0;
    const double distance = fraction * error / slope;
    if (!std::isfinite(distance))
      return;
    forEachPoint([&](Index v) {
      const Eigen::Vector3d direction = normal(points, v);
      const double length = direction.norm();
      moved.col(v) = points.col(v);
      if (length > 0.0)
        moved.col(v) += distance / length * direction;
    });
    const double new_error = volume - this->volume(moved);
    if (!(std::abs(new_error) < std::abs(error))) {
      fraction /= 2.0;
      continue;
    }
    points.swap(moved);
    error = new_error;
    fraction = 1.0;
  }
}

}  // namespace

Smoothing smoothSurface(const Positions& points, const Triangles& triangles,
                        const SmoothingOptions& options, int threads) {
  internal::checkTriangles("smoothSurface", triangles, points.cols());
  Smoothing result;
  result.points = points;
  if (triangles.cols() == 0)
    return result;
  const Filter filter(triangles, internal::columnCount(points), threads);

  // About a point of the mesh, so that a far origin costs no digits.
  const Eigen::Vector3d origin = points.col(triangles(0, 0));
  Positions smooth = points.colwise() - origin;
  result.report.volume_before = filter.volume(smooth);
  result.report.volume_after = result.report.volume_before;
  if (options.steps == 0)
    return result;

  Positions scratch(3, points.cols());
  if (options.method == SmoothingMethod::Biharmonic)
    filter.biharmonicFlow(smooth, options.steps);
  else
    for (int s = 0; s < options.steps; ++s)
      filter.step(smooth, 1.0, scratch);
  if (options.restore_volume)
    filter.restoreVolume(smooth, result.report.volume_before);
  result.report.volume_after = filter.volume(smooth);

  double used = 0.0;
  double squared = 0.0;
  for (Index i = 0; i < points.cols(); ++i) {
    if (!filter.isUsed(i))
      continue;
    result.points.col(i) = smooth.col(i) + origin;
    const double distance = (result.points.col(i) - points.col(i)).norm();
    result.report.max_displacement = std::max(result.report.max_displacement, distance);
    result.report.mean_displacement += distance;
    squared += distance * distance;
    used += 1.0;
  }
  result.report.mean_displacement /= used;
  result.report.rms_displacement = std::sqrt(squared / used);
  return result;
}

}  // namespace spherical_param
