#include "level_solver.h"

#include "embedding.h"
#include "tangential_laplacian.h"

#include <utility>

namespace spherical_param::internal {

EmbeddingLevels::EmbeddingLevels(const Graph& graph, const GraphHierarchy& hierarchy, int threads)
    : graph_(graph), hierarchy_(hierarchy), threads_(threads),
      masses_(1, meanSquares(graph, [&graph](Index, std::size_t e) {
                return graph.lengths[e] * graph.lengths[e];
              })) {
  for (const HierarchyLevel& level : hierarchy.levels)
    masses_.emplace_back(level.prolongation.transpose() * masses_.back());
}

Eigen::Vector3d EmbeddingLevels::centroid(std::size_t l, const Positions& u) const {
  return u * masses_[l];
}

double EmbeddingLevels::energy(std::size_t l, const Positions& u) const {
  return EmbeddingEnergy(graph(l), threads_).value(u);
}

double EmbeddingLevels::pull(std::size_t l, const Positions& u) const {
  Positions gradient;
  return EmbeddingEnergy(graph(l), threads_).gradient(u, gradient).relative;
}

double EmbeddingLevels::smooth(std::size_t l, int sweeps, const FractionReport& report,
                               Positions& u) const {
  constexpr double damping = 0.5;
  const int threads = threadCount(threads_, graph(l).size());
  Positions moved(3, u.cols());
  double residual = 0.0;
  for (int i = 0; i < sweeps; ++i) {
    reportFraction(report, static_cast<double>(i) / sweeps);
    residual = sweep(graph(l), EdgeWeights::Adaptive, damping, u, moved, threads);
    std::swap(u, moved);
  }
  return residual;
}

Positions EmbeddingLevels::interpolated(std::size_t l, const Positions& coarse) const {
  const auto& weights = hierarchy_.levels[l].prolongation;
  Positions u(3, weights.rows());
  forEachIndex(graph(l).size(), threadCount(threads_, graph(l).size()), {}, [&](Index i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Index e = weights.outerIndexPtr()[i]; e < weights.outerIndexPtr()[i + 1]; ++e)
      sum += weights.valuePtr()[e] * coarse.col(weights.innerIndexPtr()[e]);
    u.col(i) = sum.normalized();
  });
  return u;
}

std::vector<double> EmbeddingLevels::solve(std::size_t l, const Positions* barrier_of,
                                           NewtonOptions options, Positions& u,
                                           LevelReport& report) const {
  EmbeddingEnergy energy(graph(l), threads_);
  if (barrier_of != nullptr)
    energy.addBarrier(*barrier_of);
  else
    options.collapses = [&](const Positions& directions) {
      return isCollapsed(centroid(l, directions));
    };
  // Linear systems of at most this number of nodes are solved directly, which is exact at all
  // scales.
  constexpr std::size_t max_direct_size = 10000;
  const bool is_direct = graph(l).size() <= max_direct_size;
  LaplacianCycle preconditioner(hierarchy_, is_direct ? coarsest() : l);
  return minimizeByNewton(energy, preconditioner, options, u, report);
}

}  // namespace spherical_param::internal
