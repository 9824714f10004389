#pragma once

#include "graph.h"
#include "spherical_param/options.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace spherical_param::internal {

/// Weight of an edge before the weights of a node are normalised (Zwicker and Gotsman 2004, section
/// 3, the first two kinds, and equation 4).
///
/// \param length    of the edge in space.
/// \param on_sphere its length on the sphere.
inline double edgeWeight(EdgeWeights weights, double length, double on_sphere) {
  constexpr double min_length = 1e-150;  // so that sums of weights stay finite
  switch (weights) {
  case EdgeWeights::Uniform:
    return 1.0;
  case EdgeWeights::InverseLength:
    return 1.0 / std::max(length, min_length);
  case EdgeWeights::Adaptive:
    break;
  }
  return on_sphere / std::max(length, min_length);
}

/// Tangential part of the Laplacian of a node (equations 1 and 2), with weights of sum 1.
///
/// \param u 3 x n, unit vectors.
inline Eigen::Vector3d tangentialLaplacian(const Graph& graph, EdgeWeights weights,
                                           const Positions& u, Index node) {
  const Eigen::Vector3d center = u.col(node);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double sum_of_weights = 0.0;
  for (const std::size_t e : graph.entries(node)) {
    const Eigen::Vector3d edge = u.col(graph.neighbors[e]) - center;
    const double weight = edgeWeight(weights, graph.lengths[e], edge.norm());
    sum += weight * edge;
    sum_of_weights += weight;
  }
  if (!(sum_of_weights > 0.0))
    return Eigen::Vector3d::Zero();  // all neighbours are at the same place
  return (sum - sum.dot(center) * center) / sum_of_weights;
}

/// The nodes' fractions of the area of a surface: the mean of square(i, e) over the entries e of
/// each node i, scaled to sum 1.
template <typename Square>
Eigen::VectorXd meanSquares(const Graph& graph, const Square& square) {
  Eigen::VectorXd means(graph.size());
  for (const Index i : graph.nodes()) {
    double sum = 0.0;
    for (const std::size_t e : graph.entries(i))
      sum += square(i, e);
    means[i] = sum / static_cast<double>(std::max<std::size_t>(graph.row(i).size(), 1));
  }
  return means / std::max(means.sum(), std::numeric_limits<double>::min());
}

/// A damped Jacobi step: moves all nodes at once by a fraction of their tangential Laplacian, then
/// back to the sphere.
///
/// \param u     3 x n, unit vectors.
/// \param moved 3 x n, receives the nodes after the step.
/// \return the mean length of the tangential Laplacian before it [radius].
inline double sweep(const Graph& graph, EdgeWeights weights, double damping, const Positions& u,
                    Positions& moved, int threads) {
  const double sum = accumulate(graph.size(), threads, 0.0, [&](Index i, double& lengths) {
    const Eigen::Vector3d step = tangentialLaplacian(graph, weights, u, i);
    moved.col(i) = (u.col(i) + damping * step).normalized();
    lengths += step.norm();
  });
  return sum / static_cast<double>(std::max<std::size_t>(graph.size(), 1));
}

}  // namespace spherical_param::internal
