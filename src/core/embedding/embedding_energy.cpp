#include "embedding_energy.h"

#include "parallel.h"
#include "tangential_laplacian.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace spherical_param::internal {

std::vector<TangentBasis> tangentBases(const Positions& directions) {
  std::vector<TangentBasis> bases(static_cast<std::size_t>(directions.cols()));
  for (Eigen::Index i = 0; i < directions.cols(); ++i)
    bases[static_cast<std::size_t>(i)] = tangentBasis(directions.col(i));
  return bases;
}

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

void EmbeddingEnergy::buildPattern(BlockMatrix& matrix) const {
  matrix.offsets.assign(1, 0);
  matrix.columns.clear();
  matrix.columns.reserve(graph_.neighbors.size() + graph_.size());
  for (std::size_t i = 0; i < graph_.size(); ++i) {
    const auto begin = graph_.neighbors.begin() + static_cast<std::ptrdiff_t>(graph_.offsets[i]);
    const auto end = graph_.neighbors.begin() + static_cast<std::ptrdiff_t>(graph_.offsets[i + 1]);
    const auto after = std::lower_bound(begin, end, static_cast<Index>(i));
    matrix.columns.insert(matrix.columns.end(), begin, after);
    matrix.columns.push_back(static_cast<Index>(i));
    matrix.columns.insert(matrix.columns.end(), after, end);
    matrix.offsets.push_back(matrix.columns.size());
  }
  matrix.blocks.resize(matrix.columns.size());
}

void EmbeddingEnergy::hessian(const Positions& u, const std::vector<TangentBasis>& bases,
                              Hessian& result) const {
  const std::size_t n = graph_.size();
  BlockMatrix& matrix = result.matrix;
  if (matrix.size() != n)
    buildPattern(matrix);
  const bool has_barrier = masses_.size() > 0;
  Eigen::Vector3d pull = Eigen::Vector3d::Zero();
  result.masses = masses_;
  if (has_barrier) {
    const Eigen::Vector3d centroid = u * masses_;
    const double gap = 1.0 - centroid.squaredNorm();
    result.barrier = 2.0 * barrier_ / gap *
                     (Eigen::Matrix3d::Identity() + 2.0 / gap * centroid * centroid.transpose());
    pull = 2.0 * barrier_ / gap * centroid;
  }
  result.curvature.resize(static_cast<Eigen::Index>(n));
  forEachBlock(n, threads_, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d center = u.col(static_cast<Eigen::Index>(i));
      const TangentBasis& own = bases[i];
      Eigen::Matrix2d diagonal = Eigen::Matrix2d::Zero();
      std::size_t diagonal_place = 0;
      double curvature =
          has_barrier ? masses_[static_cast<Eigen::Index>(i)] * pull.dot(center) : 0.0;
      std::size_t e = graph_.offsets[i];
      for (std::size_t b = matrix.offsets[i]; b < matrix.offsets[i + 1]; ++b) {
        const auto j = static_cast<std::size_t>(matrix.columns[b]);
        if (j == i) {
          diagonal_place = b;
          continue;
        }
        const Eigen::Vector3d edge = center - u.col(static_cast<Eigen::Index>(j));
        const double squared = edge.squaredNorm();
        const double w = edgeWeight(EdgeWeights::Adaptive, graph_.lengths[e++], std::sqrt(squared));
        const Eigen::Vector2d along = own.transpose() * edge;
        const Eigen::Vector2d other_along = bases[j].transpose() * edge;
        const double second = squared > 0.0 ? w / squared : 0.0;
        diagonal += second * along * along.transpose();
        diagonal.diagonal().array() += w;
        curvature += w * squared / 2.0;
        matrix.blocks[b] =
            -w * (own.transpose() * bases[j]) - second * along * other_along.transpose();
      }
      matrix.blocks[diagonal_place] = diagonal;
      result.curvature[static_cast<Eigen::Index>(i)] = curvature;
    }
  });
}

}  // namespace spherical_param::internal
