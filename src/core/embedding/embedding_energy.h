#pragma once

#include "block_matrix.h"
#include "graph.h"
#include "spherical_param/types.h"
#include "tangent_basis.h"

#include <Eigen/Core>

#include <vector>

namespace spherical_param::internal {

/// \param directions 3 x n, unit vectors.
std::vector<TangentBasis> tangentBases(const Positions& directions);

/// The energy of an embedding u of a graph of points p,
///
///   E(u) = sum over edges  |u_i - u_j|^3 / (3 |p_i - p_j|)   +   barrier.
///
/// Its gradient in the tangent plane of u_i is minus the tangential Laplacian of Zwicker and
/// Gotsman 2004 with their adaptive weights (equations 2 and 4), times the sum of the weights at i.
///
/// Where the energy alone does not keep it from collapsing, a barrier -b log(1 - |c|^2) in the
/// centroid c = sum m_i u_i of masses does, \see embed.
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

  /// Second derivatives along geodesics, in tangent bases.
  struct Hessian {
    BlockMatrix matrix;         ///< positive semi-definite part, in the pattern of the graph
    Eigen::VectorXd curvature;  ///< n entries: matrix - diag(curvature) is the Hessian ...
    Eigen::Matrix3d barrier;    ///< ... with this in the centroid of the ambient vectors, if any
    Eigen::VectorXd masses;     ///< of that centroid; empty without barrier
  };
  void hessian(const Positions& u, const std::vector<TangentBasis>& bases, Hessian& result) const;

private:
  void buildPattern(BlockMatrix& matrix) const;

  const Graph& graph_;
  double barrier_ = 0.0;
  Eigen::VectorXd masses_;  ///< n entries, sum 1; empty without barrier
  int threads_;
};

}  // namespace spherical_param::internal
