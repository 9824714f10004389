#pragma once

#include "embedding_newton.h"
#include "progress.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// The graphs of an embedding: level 0 is the graph itself, the others are coarser and coarser.
class EmbeddingLevels {
public:
  /// All arguments must outlive this.
  EmbeddingLevels(const Graph& graph, const GraphHierarchy& hierarchy, int threads);

  std::size_t coarsest() const { return hierarchy_.levels.size(); }
  const Graph& graph(std::size_t l) const {
    return l == 0 ? graph_ : hierarchy_.levels[l - 1].graph;
  }

  /// The mean direction, over the area of the surface.
  Eigen::Vector3d centroid(std::size_t l, const Positions& u) const;
  /// The energy, without a barrier.
  double energy(std::size_t l, const Positions& u) const;
  /// How hard a barrier pulls at an embedding that it holds: the relative residual without it, in
  /// [0, 1].
  double pull(std::size_t l, const Positions& u) const;

  /// Damped sweeps on a level. \return the mean length of the tangential Laplacian before the last
  double smooth(std::size_t l, int sweeps, const FractionReport& report, Positions& u) const;
  /// Unit vectors on a level between those of the next coarser one.
  Positions interpolated(std::size_t l, const Positions& coarse) const;

  /// Lowers the energy of an embedding that is not collapsed. \see minimizeByNewton
  ///
  /// \param barrier_of sets the strength of a barrier that keeps the embedding from collapsing;
  ///                   nullptr: there is no barrier, and the work ends if the embedding collapses.
  std::vector<double> solve(std::size_t l, const Positions* barrier_of, NewtonOptions options,
                            Positions& u, LevelReport& report) const;

private:
  const Graph& graph_;
  const GraphHierarchy& hierarchy_;
  int threads_;
  std::vector<Eigen::VectorXd> masses_;  ///< the fraction of the surface of each node of each level
};

}  // namespace spherical_param::internal
