#include "vertex_quadrics.h"

#include "tangent_basis.h"
#include "triangle_geometry.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace spherical_param::internal {
namespace {

using Eigen::Vector3d;
using Matrix5d = Eigen::Matrix<double, 5, 5>;
using Vector5d = Eigen::Matrix<double, 5, 1>;

/// A neighbour with more triangles does not add its own neighbours: around a hub, every fit would
/// take all vertices.
constexpr std::size_t kMaxAround = 32;
/// Five coefficients fit fewer heights so well that the residual says nothing.
constexpr std::size_t kMinNeighbors = 7;
/// Root mean square of the residual in fractions of that of the heights: a quadric is sure below
/// the first, and means nothing above the second. A fold of a plane has 0.2 to 0.4.
constexpr double kSureResidual = 0.08;
constexpr double kWrongResidual = 0.25;
/// Residuals below this fraction of the length of the edges do not count.
constexpr double kSmallResidual = 1e-3;
/// Least ratio of the pivots of the equations.
constexpr double kMinPivots = 1e-3;
/// The surface leaves the triangles by no more than this fraction of the length of the edges: the
/// height of an arc over its chord, for an arc of 90 degrees.
constexpr double kMaxDisplacement = 0.2;

/// 0 for x at `zero`, 1 at `one` and beyond, in between a smooth step.
double smoothStep(double zero, double one, double x) {
  const double t = std::clamp((x - zero) / (one - zero), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Vector5d monomials(double x, double y) {
  Vector5d result;
  result << x, y, x * x, x * y, y * y;
  return result;
}

}  // namespace

VertexQuadrics::VertexQuadrics(const Positions& points, const Triangles& triangles,
                               const Positions& normals, const CornerTable& corners, int threads)
    : points_(points), triangles_(triangles), normals_(normals), quadrics_(columnCount(points)) {
  forEachIndex<Indexed<Index>>(
      quadrics_.size(), threadCount(threads, quadrics_.size()), {},
      [&](Indexed<Index>& around, Index v) { quadrics_[v] = fit(v, corners, around); });
}

VertexQuadrics::Quadric VertexQuadrics::fit(Index vertex, const CornerTable& corners,
                                            Indexed<Index>& around) const {
  Quadric quadric;
  around.clear();
  const auto add_neighbors = [&](Index v) {
    corners.forEachCorner(
        v, [&](Index t, Index k) { around.push_back(triangles_(nextCorner(k), t)); });
  };
  add_neighbors(vertex);
  const Index nearest = indexCount(around);
  for (const Index v : around)
    quadric.size += (points_.col(v) - points_.col(vertex)).norm();
  quadric.size /= nearest;
  if (!(quadric.size > 0.0))
    return quadric;
  for (Index i = 0; i < nearest; ++i)
    if (corners.countAt(around[i]) <= kMaxAround)
      add_neighbors(around[i]);
  sortUnique(around);
  around.erase(std::remove(around.begin(), around.end(), vertex), around.end());
  if (around.size() < kMinNeighbors)
    return quadric;

  const Vector3d normal = normals_.col(vertex);
  const TangentBasis basis = tangentBasis(normal);
  Matrix5d matrix = Matrix5d::Zero();
  Vector5d right = Vector5d::Zero();
  double sum_of_squares = 0.0;
  double sum_of_weights = 0.0;
  for (const Index v : around) {
    const Vector3d p = (points_.col(v) - points_.col(vertex)) / quadric.size;
    const double square = p.squaredNorm();
    // Those next to the vertex count about thirty times as much as those of the second ring.
    const double weight = 1.0 / (1.0 + square * square * square);
    const Vector5d row = monomials(basis.col(0).dot(p), basis.col(1).dot(p));
    const double height = normal.dot(p);
    matrix += weight * row * row.transpose();
    right += weight * height * row;
    sum_of_squares += weight * height * height;
    sum_of_weights += weight;
  }
  const Eigen::LDLT<Matrix5d> factors(matrix);
  const Vector5d pivots = factors.vectorD();
  if (!(pivots.minCoeff() > kMinPivots * pivots.maxCoeff()))
    return quadric;
  const Vector5d solution = factors.solve(right);
  Eigen::Map<Vector5d>(quadric.coefficients.data()) = solution;

  // The residual for the degrees of freedom that five coefficients leave.
  const double n = indexCount(around);
  const double residual = std::sqrt(std::max(0.0, sum_of_squares - solution.dot(right)) /
                                    sum_of_weights * n / (n - 5.0));
  const double height = std::sqrt(sum_of_squares / sum_of_weights);
  quadric.reliability =
      smoothStep(kWrongResidual, kSureResidual,
                 std::max(0.0, residual - kSmallResidual) / (height + kSmallResidual));
  return quadric;
}

VertexQuadrics::Point VertexQuadrics::at(Index triangle, const Vector3d& weights) const {
  const Vector3d linear = blend(points_, triangles_, triangle, weights);
  Vector3d moved = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();
  for (Index k = 0; k < 3; ++k) {
    const Index v = triangles_(k, triangle);
    const Vector3d vertex_normal = normals_.col(v);
    const Quadric& quadric = quadrics_[v];
    normal += (1.0 - quadric.reliability) * weights[k] * vertex_normal;
    if (quadric.reliability == 0.0 || weights[k] == 0.0)
      continue;
    const double fraction = quadric.reliability * weights[k] * weights[k] / weights.squaredNorm();
    const TangentBasis basis = tangentBasis(vertex_normal);
    const Vector3d p = (linear - points_.col(v)) / quadric.size;
    const double x = basis.col(0).dot(p);
    const double y = basis.col(1).dot(p);
    const auto& c = quadric.coefficients;
    const double height = c[0] * x + c[1] * y + c[2] * x * x + c[3] * x * y + c[4] * y * y;
    const double displacement =
        std::clamp(height - vertex_normal.dot(p), -kMaxDisplacement, kMaxDisplacement);
    moved += fraction * quadric.size * displacement * vertex_normal;
    normal += fraction * (vertex_normal - (c[0] + 2.0 * c[2] * x + c[3] * y) * basis.col(0) -
                          (c[1] + c[3] * x + 2.0 * c[4] * y) * basis.col(1))
                             .normalized();
  }
  return {linear + moved, normal};
}

}  // namespace spherical_param::internal
