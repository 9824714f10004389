#pragma once

#include "graph_hierarchy.h"

namespace spherical_param::internal {

/// The energy of an embedding u of a graph, \see embed, plus a barrier -b log(1 - |c|^2) in the
/// centroid c = sum m_i u_i of masses where it alone does not keep u from collapsing.
class EmbeddingEnergy {
public:
  /// \param graph    must outlive the energy.
  /// \param threads  that share the work.
  EmbeddingEnergy(const Graph& graph, int threads);

  /// Adds the barrier: b is the energy of u, the mass of a node its mean squared edge in u. Equal
  /// masses would fold limbs of tiny area on the sphere.
  void addBarrier(const Positions& u);

  double value(const Positions& u) const;

  /// How far an embedding is from a critical point: means over the nodes.
  struct Residual {
    /// Length of the tangential Laplacian, including the barrier [radius].
    double absolute = 0.0;
    /// The same in units of the node's mean edge on the sphere, in [0, 1]: shows small parts of the
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

  /// The weights' Laplacian, n x n, with what the curvature of the sphere adds: on each coordinate
  /// of tangent vectors about the Hessian, without the barrier. Positive definite.
  SparseRows laplacian(const Positions& u) const;

private:
  const Graph& graph_;
  int threads_;
  double barrier_ = 0.0;
  Eigen::VectorXd masses_;  ///< n entries, sum 1; without a barrier 0
};

}  // namespace spherical_param::internal
