#include "embedding.h"

#include "graph_hierarchy.h"
#include "multilevel_embedding.h"
#include "tangential_laplacian.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace spherical_param {
namespace internal {

Positions projectFromCentroid(const Positions& points) {
  if (points.cols() == 0)
    return points;
  // Scaled first: neither the sum nor the squares may overflow.
  Positions directions =
      points / std::max(points.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  directions.colwise() -= Eigen::Vector3d(directions.rowwise().mean());
  for (auto direction : directions.colwise()) {
    const double length = direction.stableNorm();
    direction = length > 0.0 ? Eigen::Vector3d((direction / length).normalized())
                             : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  }
  return directions;
}

bool isCollapsed(const Eigen::Vector3d& centroid) {
  // The mean direction of a collapsed embedding is longer. Unfolded embeddings have means below
  // 0.5, or up to 0.9 after slipping along a tube towards one end.
  constexpr double max_centroid = 0.95;
  return !(centroid.norm() <= max_centroid);
}

}  // namespace internal

Embedding embed(const Graph& graph, const Positions& points, const EmbeddingOptions& options,
                std::uint32_t seed, const Execution& execution) {
  Embedding embedding;
  if (graph.size() == 0) {
    embedding.directions = points;
    embedding.report.stop_reason = StopReason::Converged;
    return embedding;
  }
  constexpr Index coarsest_size = 500;
  const internal::GraphHierarchy hierarchy =
      internal::buildGraphHierarchy(graph, seed, coarsest_size, execution);
  embedding = internal::embedByLevels(graph, hierarchy, options, execution);
  if (embedding.directions.cols() > 0)
    return embedding;
  EmbeddingReport& report = embedding.report;
  embedding.directions = internal::projectFromCentroid(points);
  report.fallback_start = true;
  report.residual = meanTangentialLaplacian(graph, embedding.directions, EdgeWeights::Adaptive);
  report.centroid_norm = embedding.directions.rowwise().mean().norm();
  return embedding;
}

std::vector<double> tangentialLaplacianLengths(const Graph& graph, const Positions& directions,
                                               EdgeWeights weights) {
  std::vector<double> lengths;
  lengths.reserve(graph.size());
  for (const Index i : graph.nodes())
    lengths.push_back(internal::tangentialLaplacian(graph, weights, directions, i).norm());
  return lengths;
}

double meanTangentialLaplacian(const Graph& graph, const Positions& directions,
                               EdgeWeights weights) {
  const std::vector<double> lengths = tangentialLaplacianLengths(graph, directions, weights);
  return lengths.empty() ? 0.0
                         : std::accumulate(lengths.begin(), lengths.end(), 0.0) /
                               static_cast<double>(lengths.size());
}

}  // namespace spherical_param
