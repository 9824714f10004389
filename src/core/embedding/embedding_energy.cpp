#include "embedding_energy.h"

#include "parallel.h"
#include "tangential_laplacian.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace spherical_param::internal {

EmbeddingEnergy::EmbeddingEnergy(const Graph& graph, int threads)
    : graph_(graph), threads_(threadCount(threads, graph.size())) {}

double EmbeddingEnergy::value(const Positions& u) const {
  const double sum =
      sumOfBlocks(graph_.size(), threads_, 0.0, [&](std::size_t begin, std::size_t end) {
        double energy = 0.0;
        for (std::size_t i = begin; i < end; ++i)
          for (std::size_t e = graph_.offsets[i]; e < graph_.offsets[i + 1]; ++e) {
            const Index j = graph_.neighbors[e];
            if (static_cast<std::size_t>(j) > i)
              break;  // each edge once
            const double squared = (u.col(j) - u.col(static_cast<Eigen::Index>(i))).squaredNorm();
            energy +=
                edgeWeight(EdgeWeights::Adaptive, graph_.lengths[e], std::sqrt(squared)) * squared;
          }
        return energy;
      });
  const double barrier =
      masses_.size() > 0 ? -barrier_ * std::log1p(-(u * masses_).squaredNorm()) : 0.0;
  return sum / 3.0 + barrier;
}

void EmbeddingEnergy::addBarrier(const Positions& u) {
  masses_.resize(0);
  barrier_ = value(u);
  masses_.resize(u.cols());
  for (std::size_t i = 0; i < graph_.size(); ++i) {
    double squares = 0.0;
    for (std::size_t e = graph_.offsets[i]; e < graph_.offsets[i + 1]; ++e)
      squares += (u.col(graph_.neighbors[e]) - u.col(static_cast<Eigen::Index>(i))).squaredNorm();
    const auto degree = static_cast<double>(graph_.offsets[i + 1] - graph_.offsets[i]);
    masses_[static_cast<Eigen::Index>(i)] = squares / std::max(degree, 1.0);
  }
  masses_ /= std::max(masses_.sum(), std::numeric_limits<double>::min());
}

EmbeddingEnergy::Residual EmbeddingEnergy::gradient(const Positions& u, Positions& gradient) const {
  gradient.resize(3, u.cols());
  const bool has_barrier = masses_.size() > 0;
  Eigen::Vector3d pull = Eigen::Vector3d::Zero();
  if (has_barrier) {
    const Eigen::Vector3d centroid = u * masses_;
    pull = 2.0 * barrier_ / (1.0 - centroid.squaredNorm()) * centroid;
  }
  Residual residual =
      sumOfBlocks(graph_.size(), threads_, Residual(), [&](std::size_t begin, std::size_t end) {
        Residual sums;
        for (std::size_t i = begin; i < end; ++i) {
          const Eigen::Vector3d center = u.col(static_cast<Eigen::Index>(i));
          Eigen::Vector3d sum = Eigen::Vector3d::Zero();
          if (has_barrier)
            sum = masses_[static_cast<Eigen::Index>(i)] * pull;
          double weights = 0.0;
          double lengths = 0.0;
          for (std::size_t e = graph_.offsets[i]; e < graph_.offsets[i + 1]; ++e) {
            const Eigen::Vector3d edge = center - u.col(graph_.neighbors[e]);
            const double length = edge.norm();
            const double w = edgeWeight(EdgeWeights::Adaptive, graph_.lengths[e], length);
            sum += w * edge;
            weights += w;
            lengths += w * length;
          }
          sum -= sum.dot(center) * center;
          gradient.col(static_cast<Eigen::Index>(i)) = sum;
          if (lengths > 0.0) {
            sums.absolute += sum.norm() / weights;
            sums.relative += sum.norm() / lengths;
          }
        }
        return sums;
      });
  const auto n = static_cast<double>(std::max<std::size_t>(graph_.size(), 1));
  residual.absolute /= n;
  residual.relative /= n;
  return residual;
}

void EmbeddingEnergy::multiplyHessian(const Positions& u, const Positions& x,
                                      Positions& product) const {
  const bool has_barrier = masses_.size() > 0;
  Eigen::Vector3d pull = Eigen::Vector3d::Zero();
  Eigen::Vector3d change = Eigen::Vector3d::Zero();  // of the pull along x
  if (has_barrier) {
    const Eigen::Vector3d centroid = u * masses_;
    const Eigen::Vector3d moved = x * masses_;
    const double gap = 1.0 - centroid.squaredNorm();
    pull = 2.0 * barrier_ / gap * centroid;
    change = 2.0 * barrier_ / gap * (moved + 2.0 / gap * centroid.dot(moved) * centroid);
  }
  product.resize(3, u.cols());
  forEachBlock(graph_.size(), threads_, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const Eigen::Vector3d center = u.col(column);
      const Eigen::Vector3d own = x.col(column);
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double curvature = 0.0;
      if (has_barrier) {
        sum = masses_[column] * change;
        curvature = masses_[column] * pull.dot(center);
      }
      for (std::size_t e = graph_.offsets[i]; e < graph_.offsets[i + 1]; ++e) {
        const Eigen::Vector3d edge = center - u.col(graph_.neighbors[e]);
        const Eigen::Vector3d difference = own - x.col(graph_.neighbors[e]);
        const double squared = edge.squaredNorm();
        if (squared == 0.0)
          continue;
        const double w = edgeWeight(EdgeWeights::Adaptive, graph_.lengths[e], std::sqrt(squared));
        sum += w * difference + w / squared * edge.dot(difference) * edge;
        curvature += w * squared / 2.0;
      }
      product.col(column) = sum - sum.dot(center) * center - curvature * own;
    }
  });
}

Eigen::SparseMatrix<double, Eigen::RowMajor, Index>
EmbeddingEnergy::laplacian(const Positions& u) const {
  // Stretching an edge is twice as stiff as turning it.
  constexpr double stiffness = 1.5;
  const auto n = static_cast<Eigen::Index>(graph_.size());
  Eigen::SparseMatrix<double, Eigen::RowMajor, Index> matrix(n, n);
  matrix.reserve(static_cast<Eigen::Index>(graph_.neighbors.size()) + n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    matrix.startVec(i);
    double* diagonal = nullptr;
    double sum = 0.0;
    const auto insert_diagonal = [&] { diagonal = &matrix.insertBack(i, i); };
    for (std::size_t e = graph_.offsets[row]; e < graph_.offsets[row + 1]; ++e) {
      const Index j = graph_.neighbors[e];
      if (j > i && diagonal == nullptr)
        insert_diagonal();
      const double squared = (u.col(i) - u.col(j)).squaredNorm();
      const double w = edgeWeight(EdgeWeights::Adaptive, graph_.lengths[e], std::sqrt(squared));
      matrix.insertBack(i, j) = -stiffness * w;
      sum += w * (stiffness + squared / 2.0);
    }
    if (diagonal == nullptr)
      insert_diagonal();
    // A node whose neighbours are all at its own place has no stiffness: it stays.
    *diagonal = sum > 0.0 ? sum : 1.0;
  }
  matrix.finalize();
  return matrix;
}

}  // namespace spherical_param::internal
