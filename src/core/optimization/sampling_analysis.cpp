#include "sampling_analysis.h"

#include "parallel.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Points that are looked at, about: the standard error of the mean is then below 0.02.
constexpr std::size_t kSamples = 2500;
/// Below so many points a quadric is not determined well enough.
constexpr std::size_t kFewestPoints = 8;

/// Sums over points.
struct Sums {
  double agreement = 0.0;  ///< of spread and bending
  double possible = 0.0;   ///< the most that it could be
  double unevenness = 0.0;

  Sums& operator+=(const Sums& other) {
    agreement += other.agreement;
    possible += other.possible;
    unevenness += other.unevenness;
    return *this;
  }
};

/// The part of a symmetric 2 x 2 matrix that has a direction, over its trace.
Eigen::Vector2d deviator(double xx, double xy, double yy) {
  const double trace = xx + yy;
  return trace > 0.0 ? Eigen::Vector2d((xx - yy) / trace, 2.0 * xy / trace)
                     : Eigen::Vector2d(0.0, 0.0);
}

void addAlignmentAt(std::size_t i, const Positions& points, const Graph& graph,
                    std::vector<Index>& wide, Sums& sums) {
  const auto row = [&](std::size_t v) {
    return std::pair(graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[v]),
                     graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[v + 1]));
  };
  const auto [begin, end] = row(i);
  wide.assign(begin, end);
  for (auto neighbor = begin; neighbor != end; ++neighbor) {
    const auto [first, last] = row(static_cast<std::size_t>(*neighbor));
    wide.insert(wide.end(), first, last);
  }
  std::sort(wide.begin(), wide.end());
  wide.erase(std::unique(wide.begin(), wide.end()), wide.end());
  wide.erase(std::remove(wide.begin(), wide.end(), static_cast<Index>(i)), wide.end());
  if (wide.size() < kFewestPoints)
    return;
  const auto offset = [&](Index v) -> Eigen::Vector3d {
    return points.col(v) - points.col(static_cast<Eigen::Index>(i));
  };
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Index v : wide)
    spread += offset(v) * offset(v).transpose();
  const double scale = std::sqrt(spread.trace() / static_cast<double>(wide.size()));
  if (!(scale > 0.0))
    return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const Eigen::Matrix3d frame = axes.eigenvectors() / scale;

  // Heights above the tangent plane: z = a x + b y + (c x^2 + 2 d x y + e y^2) / 2.
  Eigen::Matrix<double, 5, 5> normal_matrix = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
  for (const Index v : wide) {
    const Eigen::Vector3d local = frame.transpose() * offset(v);
    const double x = local[2];
    const double y = local[1];
    Eigen::Matrix<double, 5, 1> terms;
    terms << x, y, x * x / 2.0, x * y, y * y / 2.0;
    normal_matrix += terms * terms.transpose();
    right += local[0] * terms;
  }
  const Eigen::Matrix<double, 5, 1> quadric = normal_matrix.ldlt().solve(right);
  if (!quadric.allFinite())
    return;
  Eigen::Matrix2d hessian;
  hessian << quadric[2], quadric[3], quadric[3], quadric[4];
  // Bending by its amount, whatever its sign.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal(hessian);
  const Eigen::Matrix2d bending = principal.eigenvectors() *
                                  principal.eigenvalues().cwiseAbs().asDiagonal() *
                                  principal.eigenvectors().transpose();
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (auto neighbor = begin; neighbor != end; ++neighbor) {
    const Eigen::Vector3d local = frame.transpose() * offset(*neighbor);
    xx += local[2] * local[2];
    xy += local[2] * local[1];
    yy += local[1] * local[1];
  }
  const Eigen::Vector2d of_bending = deviator(bending(0, 0), bending(0, 1), bending(1, 1));
  const Eigen::Vector2d of_spread = deviator(xx, xy, yy);
  sums.agreement -= of_bending.dot(of_spread);
  sums.possible += of_bending.norm() * of_spread.norm();
}

double unevennessAt(std::size_t i, const Graph& graph) {
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
    sum += graph.lengths[e];
    squares += graph.lengths[e] * graph.lengths[e];
  }
  const auto count = static_cast<double>(graph.offsets[i + 1] - graph.offsets[i]);
  const double mean = sum / count;
  return mean > 0.0 ? std::sqrt(std::max(0.0, squares / count - mean * mean)) / mean : 0.0;
}

}  // namespace

Sampling analyzeSampling(const Positions& points, const Graph& graph, int threads) {
  const std::size_t n = graph.size();
  const std::size_t step = std::max<std::size_t>(1, n / kSamples);
  const std::size_t samples = n / step;
  // A sample is some eight times the work of other loops' items.
  const Sums sums = sumOfBlocks(samples, threadCount(threads, 8 * samples, kParallelThreshold),
                                Sums{}, [&](std::size_t begin, std::size_t end) {
                                  Sums part;
                                  std::vector<Index> wide;
                                  for (std::size_t s = begin; s < end; ++s) {
                                    addAlignmentAt(s * step, points, graph, wide, part);
                                    part.unevenness += unevennessAt(s * step, graph);
                                  }
                                  return part;
                                });
  Sampling result;
  if (sums.possible > 0.0)
    result.alignment = sums.agreement / sums.possible;
  if (samples > 0)
    result.unevenness = sums.unevenness / static_cast<double>(samples);
  return result;
}

}  // namespace spherical_param::internal
