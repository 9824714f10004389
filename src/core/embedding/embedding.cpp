#include "embedding.h"

#include "edge_weights.h"
#include "embedding_history.h"
#include "embedding_starts.h"
#include "graph_hierarchy.h"
#include "iterative_embedding.h"
#include "multilevel_embedding.h"
#include "parallel.h"
#include "spherical_param/errors.h"

#include <cmath>
#include <functional>
#include <numeric>
#include <string>

namespace spherical_param {
namespace {

/// Replaces a collapsed embedding by a start that cannot collapse.
void fallBack(const Graph& graph, const Positions& points, const EmbeddingOptions& options,
              internal::EmbeddingRecorder& recorder, Embedding& embedding) {
  EmbeddingReport& report = embedding.report;
  embedding.directions = internal::projectByRank(points);
  report.fallback_start = true;
  report.residual =
      meanTangentialLaplacian(graph, embedding.directions, options.weights, options.exponent);
  report.centroid_norm = embedding.directions.rowwise().mean().norm();
  recorder({0, graph.size(), EmbeddingStep::End, 0, report.residual,
            [&] { return embedding.directions; }});
}

}  // namespace

Embedding embed(const Graph& graph, const Positions& points, const EmbeddingOptions& options,
                std::uint32_t seed, const Execution& execution, NodeMass mass) {
  Embedding embedding;
  if (graph.size() == 0) {
    embedding.directions = points;
    embedding.report.stop_reason = StopReason::Converged;
    return embedding;
  }
  internal::GraphHierarchy hierarchy;
  if (options.method == EmbeddingMethod::Multilevel)
    hierarchy =
        internal::buildGraphHierarchy(graph, seed, internal::kTypicalCoarsestSize, execution);
  internal::EmbeddingRecorder recorder(graph.size(), hierarchy, options);
  internal::EmbeddingObserver observer;
  if (options.history_vertices > 0)
    observer = std::ref(recorder);
  embedding = options.method == EmbeddingMethod::Multilevel
                  ? internal::embedByLevels(graph, hierarchy, options, mass, observer, execution)
                  : internal::embedIteratively(graph, points, options, observer, execution);
  if (embedding.report.stop_reason == StopReason::Collapsed)
    fallBack(graph, points, options, recorder, embedding);
  embedding.history = recorder.take();
  return embedding;
}

std::vector<double> tangentialLaplacianLengths(const Graph& graph, const Positions& directions,
                                               EdgeWeights weights, double exponent) {
  const internal::EdgeWeightLaw law(weights, exponent);
  std::vector<double> lengths(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const Eigen::Vector3d center = directions.col(static_cast<Eigen::Index>(i));
    Eigen::Vector3d laplacian = Eigen::Vector3d::Zero();
    double weight_sum = 0.0;
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      const Eigen::Vector3d edge = directions.col(graph.neighbors[e]) - center;
      const double weight = law.weight(law.factor(graph.lengths[e]), edge.norm());
      laplacian += weight * edge;
      weight_sum += weight;
    }
    if (weight_sum > 0.0)
      laplacian /= weight_sum;
    lengths[i] = (laplacian - laplacian.dot(center) * center).norm();
  }
  return lengths;
}

double meanTangentialLaplacian(const Graph& graph, const Positions& directions, EdgeWeights weights,
                               double exponent) {
  const std::vector<double> lengths =
      tangentialLaplacianLengths(graph, directions, weights, exponent);
  return lengths.empty() ? 0.0
                         : std::accumulate(lengths.begin(), lengths.end(), 0.0) /
                               static_cast<double>(lengths.size());
}

}  // namespace spherical_param
