#pragma once

#include "embedding_energy.h"
#include "embedding_newton.h"
#include "graph_hierarchy.h"
#include "progress.h"
#include "spherical_param/result.h"

#include <cstddef>
#include <functional>
#include <optional>
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
  /// How hard a barrier pulls at an embedding that it holds: the residual without it, in units of
  /// each node's mean edge; in [0, 1].
  double pull(std::size_t l, const Positions& u) const;

  /// Damped sweeps on a level. \return the mean length of the tangential Laplacian before the last
  double smooth(std::size_t l, int sweeps, const FractionReport& report, Positions& u) const;
  /// Unit vectors on a level between those of the next coarser one.
  Positions interpolated(std::size_t l, const Positions& coarse) const;

  /// When the solution of a level ends, and who sees it.
  struct Solution {
    double relative_tolerance;        ///< of the residual in units of each node's mean edge
    std::optional<double> tolerance;  ///< of the mean tangential Laplacian [radius]
    /// Sets the strength of a barrier that keeps the embedding from collapsing; nullptr: none.
    const Positions* barrier_of = nullptr;
    /// Called with (iteration, residual) before each step; throws to end the work.
    std::function<void(int, double)> progress;
  };
  /// Lowers the energy of an embedding that is not collapsed by Newton's method.
  ///
  /// \return the residuals, before each step and at the end.
  std::vector<double> solve(std::size_t l, const Solution& solution, Positions& u,
                            LevelReport& report) const;

private:
  const Graph& graph_;
  const GraphHierarchy& hierarchy_;
  int threads_;
  std::vector<Eigen::VectorXd> masses_;  ///< the fraction of the surface of each node of each level
};

}  // namespace spherical_param::internal
