#pragma once

#include "graph_hierarchy.h"

namespace spherical_param::internal {

/// The energy of an embedding u of a graph, \see embed. A barrier -b log(1 - |c|^2) may be added,
/// which keeps u from collapsing; c = sum m_i u_i is the centroid with masses m.
class EmbeddingEnergy {
public:
  /// \param graph   must outlive the energy.
  /// \param threads number of threads.
  EmbeddingEnergy(const Graph& graph, int threads);

  /// Adds the barrier: b is the energy of u, and the mass of a node is its mean squared edge in u.
  /// With equal masses, limbs of tiny area on the sphere would fold.
  void addBarrier(const Positions& u);

  double value(const Positions& u) const;

  /// How far an embedding is from a critical point: means over the nodes.
  struct Residual {
    /// Length of the tangential Laplacian, including the barrier [radius].
    double absolute = 0.0;
    /// The same in [mean edge of the node on the sphere], in [0, 1], which shows small parts of the
    /// embedding as well as large ones.
    double relative = 0.0;

    Residual& operator+=(const Residual& other) {
      absolute += other.absolute;
      relative += other.relative;
      return *this;
    }
  };
  /// \param gradient 3 x n, tangent at u.
  Residual gradient(const Positions& u, Positions& gradient) const;

  /// Second derivatives along geodesics: product = Hessian at u * x.
  ///
  /// \param x, product 3 x n, tangent at u.
  void multiplyHessian(const Positions& u, const Positions& x, Positions& product) const;

  /// The Laplacian of the weights, n x n, plus a term for the curvature of the sphere: on each
  /// coordinate of tangent vectors about the Hessian, without the barrier. Positive definite.
  SparseRows laplacian(const Positions& u) const;

private:
  const Graph& graph_;
  int threads_;
  double barrier_ = 0.0;
  Eigen::VectorXd masses_;  ///< n entries of sum 1; 0 without a barrier
};

}  // namespace spherical_param::internal
