#include "embedding_energy.h"

#include "tangential_laplacian.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace spherical_param::internal {

EmbeddingEnergy::EmbeddingEnergy(const Graph& graph, int threads)
    : graph_(graph), threads_(threadCount(threads, graph.size())),
      masses_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(graph.size()))) {}

double EmbeddingEnergy::value(const Positions& u) const {
  const double sum = accumulate(graph_.size(), threads_, 0.0, [&](Index i, double& energy) {
    for (const std::size_t e : graph_.entries(i)) {
      const Index j = graph_.neighbors[e];
      if (j > i)
        break;  // each edge once
      const double squared = (u.col(j) - u.col(i)).squaredNorm();
      energy += edgeWeight(EdgeWeights::Adaptive, graph_.lengths[e], std::sqrt(squared)) * squared;
    }
  });
  return sum / 3.0 - barrier_ * std::log1p(-(u * masses_).squaredNorm());
}

void EmbeddingEnergy::addBarrier(const Positions& u) {
  barrier_ = value(u);
  masses_ = meanSquares(graph_, [&](Index i, std::size_t e) {
    return (u.col(graph_.neighbors[e]) - u.col(i)).squaredNorm();
  });
}

EmbeddingEnergy::Residual EmbeddingEnergy::gradient(const Positions& u, Positions& gradient) const {
  gradient.resize(3, u.cols());
  const Eigen::Vector3d centroid = u * masses_;
  const Eigen::Vector3d pull = 2.0 * barrier_ / (1.0 - centroid.squaredNorm()) * centroid;
  Residual residual = accumulate(graph_.size(), threads_, Residual(), [&](Index i, Residual& sums) {
    const Eigen::Vector3d center = u.col(i);
    Eigen::Vector3d sum = masses_[i] * pull;
    double weights = 0.0;
    double lengths = 0.0;
    for (const std::size_t e : graph_.entries(i)) {
      const Eigen::Vector3d edge = center - u.col(graph_.neighbors[e]);
      const double length = edge.norm();
      const double w = edgeWeight(EdgeWeights::Adaptive, graph_.lengths[e], length);
      sum += w * edge;
      weights += w;
      lengths += w * length;
    }
    sum -= sum.dot(center) * center;
    gradient.col(i) = sum;
    if (lengths > 0.0) {
      sums.absolute += sum.norm() / weights;
      sums.relative += sum.norm() / lengths;
    }
  });
  const auto n = static_cast<double>(std::max<std::size_t>(graph_.size(), 1));
  residual.absolute /= n;
  residual.relative /= n;
  return residual;
}

void EmbeddingEnergy::multiplyHessian(const Positions& u, const Positions& x,
                                      Positions& product) const {
  const Eigen::Vector3d centroid = u * masses_;
  const Eigen::Vector3d moved = x * masses_;
  const double gap = 1.0 - centroid.squaredNorm();
  const Eigen::Vector3d pull = 2.0 * barrier_ / gap * centroid;
  const Eigen::Vector3d change =  // of the pull along x
      2.0 * barrier_ / gap * (moved + 2.0 / gap * centroid.dot(moved) * centroid);
  product.resize(3, u.cols());
  forEachIndex(graph_.size(), threads_, {}, [&](Index i) {
    const Eigen::Vector3d center = u.col(i);
    const Eigen::Vector3d own = x.col(i);
    Eigen::Vector3d sum = masses_[i] * change;
    double curvature = masses_[i] * pull.dot(center);
    for (const std::size_t e : graph_.entries(i)) {
      const Eigen::Vector3d edge = center - u.col(graph_.neighbors[e]);
      const Eigen::Vector3d difference = own - x.col(graph_.neighbors[e]);
      const double squared = edge.squaredNorm();
      if (squared == 0.0)
        continue;
      const double w = edgeWeight(EdgeWeights::Adaptive, graph_.lengths[e], std::sqrt(squared));
      sum += w * difference + w / squared * edge.dot(difference) * edge;
      curvature += w * squared / 2.0;
    }
    product.col(i) = sum - sum.dot(center) * center - curvature * own;
  });
}

SparseRows EmbeddingEnergy::laplacian(const Positions& u) const {
  // The mean of 1 for turning an edge and 2 for stretching it.
  constexpr double stiffness = 1.5;
  std::vector<Eigen::Triplet<double, Index>> entries;
  entries.reserve(graph_.neighbors.size() + graph_.size());
  for (const Index i : graph_.nodes()) {
    double sum = 0.0;
    for (const std::size_t e : graph_.entries(i)) {
      const Index j = graph_.neighbors[e];
      const double squared = (u.col(i) - u.col(j)).squaredNorm();
      const double w = edgeWeight(EdgeWeights::Adaptive, graph_.lengths[e], std::sqrt(squared));
      entries.emplace_back(i, j, -stiffness * w);
      sum += w * (stiffness + squared / 2.0);
    }
    // A node with all neighbours at its own place has no stiffness, and does not move.
    entries.emplace_back(i, i, sum > 0.0 ? sum : 1.0);
  }
  SparseRows matrix(u.cols(), u.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace spherical_param::internal
