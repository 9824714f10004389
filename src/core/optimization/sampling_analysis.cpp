#include "sampling_analysis.h"

#include "indexed.h"
#include "optimization_constants.h"
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

/// The neighbours of point i, and theirs, without i; ascending.
void collectWide(Index i, const Graph& graph, std::vector<Index>& wide) {
  wide.assign(graph.row(i).begin(), graph.row(i).end());
  for (const Index v : graph.row(i))
    wide.insert(wide.end(), graph.row(v).begin(), graph.row(v).end());
  sortUnique(wide);
  wide.erase(std::remove(wide.begin(), wide.end(), i), wide.end());
}

/// The absolute curvature of the surface through local points, with the height as the first
/// coordinate, in the coordinates (third, second). Empty if it is not determined.
std::optional<Eigen::Matrix2d> bendingOf(const Eigen::Matrix3Xd& local) {
  // Heights above the tangent plane: z = a x + b y + (c x^2 + 2 d x y + e y^2) / 2.
  Eigen::Matrix<double, 5, 5> normal_matrix = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
  for (Eigen::Index v = 0; v < local.cols(); ++v) {
    const double x = local(2, v);
    const double y = local(1, v);
    Eigen::Matrix<double, 5, 1> terms;
    terms << x, y, x * x / 2.0, x * y, y * y / 2.0;
    normal_matrix += terms * terms.transpose();
    right += local(0, v) * terms;
  }
  const Eigen::Matrix<double, 5, 1> quadric = normal_matrix.ldlt().solve(right);
  if (!quadric.allFinite())
    return std::nullopt;
  Eigen::Matrix2d hessian;
  hessian << quadric[2], quadric[3], quadric[3], quadric[4];
  // Bending by its amount, whatever its sign.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal(hessian);
  return principal.eigenvectors() * principal.eigenvalues().cwiseAbs().asDiagonal() *
         principal.eigenvectors().transpose();
}

void addAlignmentAt(Index i, const Positions& points, const Graph& graph, std::vector<Index>& wide,
                    Sums& sums) {
  collectWide(i, graph, wide);
  if (wide.size() < optimization_constants::kMinQuadricPoints)
    return;
  const auto offset = [&](Index v) -> Eigen::Vector3d { return points.col(v) - points.col(i); };
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Index v : wide)
    spread += offset(v) * offset(v).transpose();
  const double scale = std::sqrt(spread.trace() / static_cast<double>(wide.size()));
  if (!(scale > 0.0))
    return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const Eigen::Matrix3d frame = axes.eigenvectors() / scale;
  Eigen::Matrix3Xd local(3, static_cast<Eigen::Index>(wide.size()));
  Eigen::Index column = 0;
  for (const Index v : wide)
    local.col(column++) = frame.transpose() * offset(v);
  const std::optional<Eigen::Matrix2d> bending = bendingOf(local);
  if (!bending)
    return;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const Index v : graph.row(i)) {
    const Eigen::Vector3d neighbor = frame.transpose() * offset(v);
    xx += neighbor[2] * neighbor[2];
    xy += neighbor[2] * neighbor[1];
    yy += neighbor[1] * neighbor[1];
  }
  const Eigen::Vector2d of_bending = deviator((*bending)(0, 0), (*bending)(0, 1), (*bending)(1, 1));
  const Eigen::Vector2d of_spread = deviator(xx, xy, yy);
  sums.agreement -= of_bending.dot(of_spread);
  sums.possible += of_bending.norm() * of_spread.norm();
}

double unevennessAt(Index i, const Graph& graph) {
  double sum = 0.0;
  double squares = 0.0;
  for (const double length : graph.lengthsOf(i)) {
    sum += length;
    squares += length * length;
  }
  const auto count = static_cast<double>(graph.row(i).size());
  const double mean = sum / count;
  return mean > 0.0 ? std::sqrt(std::max(0.0, squares / count - mean * mean)) / mean : 0.0;
}

}  // namespace

Sampling analyzeSampling(const Positions& points, const Graph& graph, int threads) {
  const std::size_t n = graph.size();
  const std::size_t step = std::max<std::size_t>(1, n / optimization_constants::kTypicalSamples);
  const std::size_t samples = n / step;
  // A sample is some eight times the work of other loops' items.
  const Sums sums = sumOfBlocks(samples, threadCount(threads, 8 * samples), Sums{},
                                [&](std::size_t begin, std::size_t end) {
                                  Sums part;
                                  std::vector<Index> wide;
                                  for (std::size_t s = begin; s < end; ++s) {
                                    const auto i = static_cast<Index>(s * step);
                                    addAlignmentAt(i, points, graph, wide, part);
                                    part.unevenness += unevennessAt(i, graph);
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
