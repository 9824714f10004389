#include "sampling_analysis.h"

#include "optimization_constants.h"
#include "point_spread.h"
#include "rows.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace spherical_param::internal {
namespace {

/// The part of a symmetric matrix that has a direction, over its trace.
Eigen::Vector2d deviator(const Eigen::Matrix2d& of) {
  const double trace = of.trace();
  return trace > 0.0 ? Eigen::Vector2d((of(0, 0) - of(1, 1)) / trace, 2.0 * of(0, 1) / trace)
                     : Eigen::Vector2d(0.0, 0.0);
}

/// The absolute curvature of the surface through local points, the third coordinate of which is the
/// height above the tangent plane. Empty if it is not determined.
std::optional<Eigen::Matrix2d> bendingOf(const Positions& local) {
  // z = a x + b y + (c x^2 + 2 d x y + e y^2) / 2.
  const auto x = local.row(0).array();
  const auto y = local.row(1).array();
  Eigen::Matrix<double, 5, Eigen::Dynamic> terms(5, local.cols());
  terms << local.topRows<2>(), (x.square() / 2.0).matrix(), (x * y).matrix(),
      (y.square() / 2.0).matrix();
  const Eigen::Matrix<double, 5, 1> quadric =
      (terms * terms.transpose()).ldlt().solve(terms * local.row(2).transpose());
  if (!quadric.allFinite())
    return std::nullopt;
  Eigen::Matrix2d hessian;
  hessian << quadric[2], quadric[3], quadric[3], quadric[4];
  // Bending by its amount, whatever its sign.
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal;
  principal.computeDirect(hessian);
  return principal.eigenvectors() * principal.eigenvalues().cwiseAbs().asDiagonal() *
         principal.eigenvectors().transpose();
}

/// How far spread and bending at point i agree, and the most that they could.
Eigen::Array2d agreementAt(Index i, const Positions& points, const Graph& graph) {
  const std::vector<Index> wide = withinTwoSteps(graph, i);
  // With fewer points a quadric is not determined well enough.
  if (wide.size() < 8)
    return {0.0, 0.0};
  const Positions offsets = points(Eigen::all, wide).colwise() - points.col(i);
  const Eigen::Matrix3d spread = offsets * offsets.transpose();
  const double scale = std::sqrt(spread.trace() / static_cast<double>(wide.size()));
  if (!(scale > 0.0))
    return {0.0, 0.0};
  // The direction of the least spread comes last: it is that of the height.
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(spread);
  const Eigen::Matrix3d frame = axes.eigenvectors().rowwise().reverse().transpose() / scale;
  const std::optional<Eigen::Matrix2d> bending = bendingOf(frame * offsets);
  if (!bending)
    return {0.0, 0.0};
  Eigen::Matrix2d spread_of_neighbors = Eigen::Matrix2d::Zero();
  for (const Index v : graph.row(i)) {
    const Eigen::Vector2d neighbor = frame.topRows<2>() * (points.col(v) - points.col(i));
    spread_of_neighbors += neighbor * neighbor.transpose();
  }
  const Eigen::Vector2d of_bending = deviator(*bending);
  const Eigen::Vector2d of_spread = deviator(spread_of_neighbors);
  return {-of_bending.dot(of_spread), of_bending.norm() * of_spread.norm()};
}

double unevennessAt(Index i, const Graph& graph) {
  const Row<double> row = graph.lengthsOf(i);
  const Eigen::Map<const Eigen::ArrayXd> lengths(row.begin(), row.end() - row.begin());
  const double mean = lengths.mean();
  return mean > 0.0 ? std::sqrt((lengths - mean).square().mean()) / mean : 0.0;
}

}  // namespace

Sampling analyzeSampling(const Positions& points, const Graph& graph, int threads) {
  // The standard error of the mean is then below 0.02.
  const auto step = static_cast<Index>(std::max<std::size_t>(1, graph.size() / 2500));
  const std::size_t samples = graph.size() / static_cast<std::size_t>(step);
  // A sample is some eight times the work of other loops' items.
  const Eigen::Array3d sums =
      accumulate(samples, threadCount(threads, 8 * samples), Eigen::Array3d(Eigen::Array3d::Zero()),
                 [&](Index s, Eigen::Array3d& sum) {
                   sum.head<2>() += agreementAt(s * step, points, graph);
                   sum[2] += unevennessAt(s * step, graph);
                 });
  Sampling result;
  if (sums[1] > 0.0)
    result.alignment = sums[0] / sums[1];
  if (samples > 0)
    result.unevenness = sums[2] / static_cast<double>(samples);
  return result;
}

bool isEvenlySampled(const Positions& points, const Graph& graph, int threads) {
  const Sampling sampling = analyzeSampling(points, graph, threads);
  return sampling.alignment < optimization_constants::kMaxUnalignedSampling &&
         sampling.unevenness < optimization_constants::kMaxEvenSampling;
}

}  // namespace spherical_param::internal
