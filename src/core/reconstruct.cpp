#include "spherical_param/reconstruct.h"

#include "core/neighbor_lists.h"
#include "spherical_param/errors.h"
#include "spherical_param/point_set.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

/// Above this share of edges beyond the graph's 2-ring the mesh is not to be trusted. Unfolded
/// embeddings of closed surfaces have a share of 0.0005 and less, folded limbs 0.003 and more, the
/// lid over the opening of a bowl of some thousand points 0.002.
constexpr double kSuspiciousEdges = 0.001;

/// Areas and volumes of larger clouds leave the range of double.
constexpr double kLargestCoordinate = 1e100;

EmbeddingOptions embeddingOptions(const Options& options) {
  EmbeddingOptions embedding;
  embedding.weights = options.weights;
  embedding.lambda = options.lambda;
  embedding.max_iterations = options.max_iterations;
  embedding.tolerance = options.tolerance;
  embedding.stagnation_window = options.stagnation_window;
  embedding.threads = options.threads;
  return embedding;
}

/// Times the stages and tells the callback of their beginning and end.
class StageLog {
public:
  StageLog(const Options& options, Result& result) : options_(options), result_(result) {}

  template <typename Work>
  auto run(const char* stage, const Work& work) {
    report(stage, 0.0);
    const auto begin = std::chrono::steady_clock::now();
    auto outcome = work();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    result_.stages.push_back({stage, time.count()});
    report(stage, 1.0);
    return outcome;
  }

  void report(const char* stage, double fraction, int iteration = 0, double residual = 0.0) {
    if (options_.progress && !options_.progress({stage, fraction, iteration, residual}))
      throw Cancelled("reconstruct: cancelled by the progress callback");
  }

private:
  const Options& options_;
  Result& result_;
};

/// The distinct points, scaled by a power of two to an extent of about 1: exact, so distinct points
/// stay distinct, and no product in later stages overflows.
Positions distinctScaled(const Positions& points, const std::vector<Index>& input_of_vertex,
                         int& exponent) {
  Positions result(3, static_cast<Eigen::Index>(input_of_vertex.size()));
  for (Eigen::Index v = 0; v < result.cols(); ++v)
    result.col(v) = points.col(input_of_vertex[static_cast<std::size_t>(v)]);
  // Halves, so that the difference of two huge coordinates stays finite.
  const Eigen::Vector3d half_extent =
      result.rowwise().maxCoeff() / 2.0 - result.rowwise().minCoeff() / 2.0;
  std::frexp(half_extent.maxCoeff(), &exponent);
  result = result.unaryExpr([&](double x) { return std::ldexp(x, -exponent); });
  return result;
}

/// Neighbour lists between vertices; a vertex has the entries of all its input points.
NeighborLists listsOfVertices(const NeighborLists& lists, const DistinctPoints& distinct) {
  const std::size_t n = distinct.vertex_of_input.size();
  const std::size_t v = distinct.input_of_vertex.size();
  NeighborLists result;
  result.offsets.assign(v + 1, 0);
  result.indices.resize(lists.indices.size());
  const auto count = [&](std::size_t i) { return lists.offsets[i + 1] - lists.offsets[i]; };
  for (std::size_t i = 0; i < n; ++i)
    result.offsets[static_cast<std::size_t>(distinct.vertex_of_input[i]) + 1] += count(i);
  for (std::size_t i = 0; i < v; ++i)
    result.offsets[i + 1] += result.offsets[i];
  std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e)
      result.indices[next[static_cast<std::size_t>(distinct.vertex_of_input[i])]++] =
          distinct.vertex_of_input[static_cast<std::size_t>(lists.indices[e])];
  return result;
}

/// The paper's embedding, or a start that is not collapsed where the iteration collapses.
Positions embed(const Graph& graph, const Positions& points, const Options& options, StageLog& log,
                EmbeddingReport& report) {
  EmbeddingOptions embedding = embeddingOptions(options);
  if (options.progress)
    embedding.progress = [&](int iteration, double residual) {
      // Below 1, which is told once, at the end of the stage.
      const double share = iteration / (options.max_iterations + 1.0);
      log.report("embedding", share, iteration, residual);
      return true;
    };
  Embedding outcome = embedOnSphere(graph, points, embedding);
  report.stop_reason = outcome.stop_reason;
  report.iterations = outcome.iterations;
  report.residual = outcome.residual;
  report.residuals = std::move(outcome.residuals);
  report.centroid_norm = outcome.centroid_norm;
  if (outcome.stop_reason != StopReason::Collapsed)
    return std::move(outcome.directions);
  report.fallback_start = true;
  Positions start = projectByRank(points);
  report.residual = meanTangentialLaplacian(graph, start, options.weights);
  report.centroid_norm = start.rowwise().mean().norm();
  return start;
}

/// Share of the edges whose ends are neither neighbours nor have a common neighbour.
double shareOutsideGraph(const Graph& graph, const Triangles& triangles) {
  std::size_t outside = 0;
  std::size_t edges = 0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(triangles(k, t));
      const auto b = static_cast<std::size_t>(triangles((k + 1) % 3, t));
      if (a > b)
        continue;  // each edge is seen from both sides
      ++edges;
      auto i = graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[a]);
      auto j = graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[b]);
      const auto i_end =
          graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[a + 1]);
      const auto j_end =
          graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[b + 1]);
      bool near = std::binary_search(i, i_end, static_cast<Index>(b));
      while (!near && i != i_end && j != j_end) {
        near = *i == *j;
        *i < *j ? ++i : ++j;
      }
      outside += near ? 0 : 1;
    }
  return edges == 0 ? 0.0 : static_cast<double>(outside) / static_cast<double>(edges);
}

std::string percent(double share) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f %%", 100.0 * share);
  return text.data();
}

void collectWarnings(Result& result) {
  const auto warn = [&](const std::string& text) { result.warnings.push_back(text); };
  if (result.duplicates > 0)
    warn(std::to_string(result.duplicates) +
         " points repeat an earlier point exactly; each place became one vertex.");
  if (result.graph.components > 1)
    warn("The neighbour graph was in " + std::to_string(result.graph.components) +
         " pieces, joined by their shortest bridges: the cloud may show several objects, or "
         "parts farther apart than their points; a larger k joins them if it is one.");
  if (result.embedding.fallback_start)
    warn("The embedding collapsed to one place; the mesh comes from a start without iteration and "
         "is likely to be folded.");
  else if (result.embedding.stop_reason == StopReason::IterationLimit)
    warn("The embedding has not converged within the limit of iterations.");
  else if (result.embedding.stop_reason == StopReason::Stagnated)
    warn("The embedding has not converged: its residual no longer changes.");
  if (result.edges_outside_graph > kSuspiciousEdges)
    warn(percent(result.edges_outside_graph) +
         " of the mesh's edges join points that are not near each other in the cloud: the "
         "embedding is folded, or the cloud is not a closed surface without holes through it.");
}

}  // namespace

void checkOptions(const Options& options) {
  // The stages check the ranges, k first and the others without a graph to work on.
  buildNeighborGraph(Positions(3, 0), NeighborLists(), {options.k});
  embedOnSphere(Graph(), Positions(3, 0), embeddingOptions(options));
}

Result reconstruct(const Positions& points, const NeighborLists& lists, const Options& options) {
  checkOptions(options);
  Result result;
  StageLog log(options, result);

  int exponent = 0;
  Positions vertices;
  NeighborGraph graph = log.run("graph", [&] {
    internal::checkNeighborLists("reconstruct", lists, static_cast<std::size_t>(points.cols()));
    DistinctPoints distinct = findDistinctPoints(points);
    const std::size_t count = distinct.input_of_vertex.size();
    if (points.cols() > 0 && points.cwiseAbs().maxCoeff() > kLargestCoordinate)
      throw InvalidInput("reconstruct: a coordinate is beyond 1e100; scale the points down");
    if (count < 4)
      throw InvalidInput("reconstruct: " + std::to_string(count) +
                         " distinct points; a closed surface needs at least 4");
    vertices = distinctScaled(points, distinct.input_of_vertex, exponent);
    if (areCoplanar(vertices))
      throw InvalidInput("reconstruct: all points lie in one plane; a closed surface needs points "
                         "outside of it");
    // Without duplicates the lists are those of the vertices already: no copy of the largest input.
    const bool merged = count < distinct.vertex_of_input.size();
    NeighborGraph built =
        merged ? buildNeighborGraph(vertices, listsOfVertices(lists, distinct), {options.k})
               : buildNeighborGraph(vertices, lists, {options.k});
    result.vertex_of_input = std::move(distinct.vertex_of_input);
    result.input_of_vertex = std::move(distinct.input_of_vertex);
    result.duplicates = result.vertex_of_input.size() - count;
    return built;
  });
  result.graph.edges = graph.graph.edgeCount();
  result.graph.components = graph.components;
  result.graph.bridges = std::move(graph.bridges);
  for (Bridge& bridge : result.graph.bridges)
    bridge.length = std::ldexp(bridge.length, exponent);

  result.sphere = log.run(
      "embedding", [&] { return embed(graph.graph, vertices, options, log, result.embedding); });

  result.triangles = log.run("triangulation", [&] {
    SphereTriangulation triangulation = triangulateSphere(result.sphere);
    result.triangulation.hull_vertices = triangulation.hull_vertices;
    result.triangulation.reinserted = triangulation.reinserted;
    result.triangulation.coincident = triangulation.coincident;
    result.triangulation.hull_rejected = triangulation.hull_rejected;
    return std::move(triangulation.triangles);
  });

  result.topology = log.run("check", [&] {
    double volume = signedVolume(vertices, result.triangles);
    if (volume < 0.0) {
      // The embedding is a mirror image: turn mesh and sphere inside out together, so that the
      // triangles face outward on both.
      flipOrientation(result.triangles);
      result.sphere = -result.sphere;
      volume = -volume;
    }
    result.volume = std::ldexp(volume, 3 * exponent);
    result.area = std::ldexp(surfaceArea(vertices, result.triangles), 2 * exponent);
    result.edges_outside_graph = shareOutsideGraph(graph.graph, result.triangles);
    return checkTopology(result.triangles, result.vertexCount());
  });
  if (!result.topology.isSphere())
    throw ComputeError("reconstruct: the mesh is not a closed genus-0 manifold; please report "
                       "this cloud as a defect of the library");
  collectWarnings(result);
  return result;
}

}  // namespace spherical_param
