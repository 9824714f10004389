#include "spherical_param/reconstruct.h"

#include "core/neighbor_lists.h"
#include "core/space_filling_curve.h"
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

/// A share of the points that deserves a warning.
constexpr double kManyPoints = 0.01;

/// Areas and volumes of larger clouds leave the range of double.
constexpr double kLargestCoordinate = 1e100;

/// Neighbours of each point of the paper, and those that certify most local Delaunay cells.
constexpr int kNearestNeighbors = 25;
constexpr int kLocalDelaunayNeighbors = 12;

EmbeddingOptions iterativeOptions(const Options& options) {
  EmbeddingOptions embedding;
  embedding.weights = options.weights;
  embedding.lambda = options.lambda;
  embedding.max_iterations = options.max_iterations;
  embedding.tolerance = options.tolerance.value_or(embedding.tolerance);
  embedding.stagnation_window = options.stagnation_window;
  embedding.threads = options.threads;
  return embedding;
}

MultilevelOptions multilevelOptions(const Options& options) {
  MultilevelOptions embedding;
  embedding.weights = options.weights;
  embedding.exponent = options.exponent;
  embedding.lambda = options.lambda;
  embedding.tolerance = options.tolerance;
  embedding.starts = options.starts;
  embedding.threads = options.threads;
  return embedding;
}

LocalDelaunayOptions localDelaunayOptions(const Options& options) {
  LocalDelaunayOptions graph;
  graph.threads = options.threads;
  return graph;
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

/// The stages work on the vertices in the order of a space-filling curve, called nodes, so that
/// neighbours are near in memory.
struct Nodes {
  Positions points;                   ///< 3 x v, column i = node i, scaled
  std::vector<Index> vertex_of_node;  ///< v entries
  std::vector<Index> input_of_node;   ///< v entries, first input point
  std::vector<Index> node_of_input;   ///< n entries
};

Nodes orderedNodes(const Positions& vertices, const DistinctPoints& distinct) {
  Nodes nodes;
  nodes.vertex_of_node = internal::mortonOrder(vertices);
  const std::size_t v = nodes.vertex_of_node.size();
  nodes.points.resize(3, vertices.cols());
  nodes.input_of_node.resize(v);
  std::vector<Index> node_of_vertex(v);
  for (std::size_t node = 0; node < v; ++node) {
    const Index vertex = nodes.vertex_of_node[node];
    nodes.points.col(static_cast<Eigen::Index>(node)) = vertices.col(vertex);
    nodes.input_of_node[node] = distinct.input_of_vertex[static_cast<std::size_t>(vertex)];
    node_of_vertex[static_cast<std::size_t>(vertex)] = static_cast<Index>(node);
  }
  nodes.node_of_input.reserve(distinct.vertex_of_input.size());
  for (const Index vertex : distinct.vertex_of_input)
    nodes.node_of_input.push_back(node_of_vertex[static_cast<std::size_t>(vertex)]);
  return nodes;
}

/// Neighbour lists between nodes; a node has the entries of all its input points.
NeighborLists listsOfNodes(const NeighborLists& lists, const Nodes& nodes) {
  const std::size_t n = nodes.node_of_input.size();
  const std::size_t v = nodes.vertex_of_node.size();
  NeighborLists result;
  result.offsets.assign(v + 1, 0);
  result.indices.resize(lists.indices.size());
  const auto count = [&](std::size_t i) { return lists.offsets[i + 1] - lists.offsets[i]; };
  for (std::size_t i = 0; i < n; ++i)
    result.offsets[static_cast<std::size_t>(nodes.node_of_input[i]) + 1] += count(i);
  for (std::size_t i = 0; i < v; ++i)
    result.offsets[i + 1] += result.offsets[i];
  std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e)
      result.indices[next[static_cast<std::size_t>(nodes.node_of_input[i])]++] =
          nodes.node_of_input[static_cast<std::size_t>(lists.indices[e])];
  return result;
}

/// The search in terms of nodes instead of input points.
NeighborSearch searchOfNodes(const NeighborSearch& search, const Nodes& nodes) {
  if (!search)
    return {};
  return [&search, &nodes](const std::vector<Index>& queries, int count) {
    std::vector<Index> inputs(queries.size());
    for (std::size_t i = 0; i < queries.size(); ++i)
      inputs[i] = nodes.input_of_node[static_cast<std::size_t>(queries[i])];
    NeighborLists lists = search(inputs, count);
    internal::checkIndices("reconstruct: the search's answer", lists, queries.size(),
                           nodes.node_of_input.size());
    for (Index& neighbor : lists.indices)
      neighbor = nodes.node_of_input[static_cast<std::size_t>(neighbor)];
    return lists;
  };
}

/// Gives the result, computed on nodes, the numbers of the vertices.
void renumber(const std::vector<Index>& vertex_of_node, Result& result) {
  const auto vertex = [&](Index node) { return vertex_of_node[static_cast<std::size_t>(node)]; };
  result.triangles = result.triangles.unaryExpr(vertex).eval();
  Positions sphere(3, result.sphere.cols());
  for (Eigen::Index node = 0; node < sphere.cols(); ++node)
    sphere.col(vertex(static_cast<Index>(node))) = result.sphere.col(node);
  result.sphere = std::move(sphere);
  for (Bridge& bridge : result.graph.bridges) {
    bridge.from = vertex(bridge.from);
    bridge.to = vertex(bridge.to);
  }
  for (Index& node : result.graph.without_tangent_plane)
    node = vertex(node);
  std::sort(result.graph.without_tangent_plane.begin(), result.graph.without_tangent_plane.end());
}

NeighborGraph buildGraph(const Positions& points, const NeighborLists& lists,
                         const Options& options, const NeighborSearch& search) {
  if (options.graph == GraphMethod::NearestNeighbors)
    return buildNeighborGraph(points, lists, {neighborsToSearch(options)});
  LocalDelaunayOptions graph = localDelaunayOptions(options);
  graph.search = search;
  return buildLocalDelaunayGraph(points, lists, graph);
}

Positions embedIteratively(const Graph& graph, const Positions& points, const Options& options,
                           StageLog& log, EmbeddingReport& report) {
  EmbeddingOptions embedding = iterativeOptions(options);
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
  return std::move(outcome.directions);
}

Positions embedByLevels(const Graph& graph, const Options& options, StageLog& log,
                        EmbeddingReport& report) {
  MultilevelOptions embedding = multilevelOptions(options);
  if (options.progress)
    embedding.progress = [&](double share, double residual) {
      // Below 1, which is told once, at the end of the stage.
      log.report("embedding", std::min(share, 0.999), 0, residual);
      return true;
    };
  HierarchyOptions hierarchy;
  hierarchy.seed = options.seed;
  MultilevelEmbedding outcome =
      embedMultilevel(graph, buildGraphHierarchy(graph, hierarchy), embedding);
  report.stop_reason = outcome.stop_reason;
  report.residual = outcome.residual;
  report.residuals = std::move(outcome.residuals);
  report.iterations = report.residuals.empty() ? outcome.levels.front().newton_iterations
                                               : static_cast<int>(report.residuals.size()) - 1;
  report.centroid_norm = outcome.centroid_norm;
  report.energy = outcome.energy;
  report.levels = std::move(outcome.levels);
  report.starts = outcome.starts;
  report.collapsed_starts = outcome.collapsed_starts;
  report.added_barrier = outcome.added_barrier;
  return std::move(outcome.directions);
}

/// The embedding, or a start that is not collapsed where the solver collapses.
Positions embed(const Graph& graph, const Positions& points, const Options& options, StageLog& log,
                EmbeddingReport& report) {
  Positions directions = options.solver == EmbeddingMethod::Iterative
                             ? embedIteratively(graph, points, options, log, report)
                             : embedByLevels(graph, options, log, report);
  if (report.stop_reason != StopReason::Collapsed)
    return directions;
  report.fallback_start = true;
  directions = projectByRank(points);
  report.residual = meanTangentialLaplacian(graph, directions, options.weights, options.exponent);
  report.centroid_norm = directions.rowwise().mean().norm();
  return directions;
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
         "parts farther apart than their points; the graph of nearest neighbours with a larger k "
         "joins them if it is one.");
  const auto vertices = static_cast<double>(result.vertexCount());
  if (static_cast<double>(result.graph.without_tangent_plane.size()) > kManyPoints * vertices)
    warn(std::to_string(result.graph.without_tangent_plane.size()) +
         " points have no trustworthy tangent plane: the cloud is too coarse or too noisy there, "
         "and the mesh may be folded.");
  if (static_cast<double>(result.graph.uncertified) > kManyPoints * vertices)
    warn(
        std::to_string(result.graph.uncertified) +
        " points may have neighbours that were not found: the cloud is open or very uneven there.");
  if (result.embedding.fallback_start)
    warn("The embedding collapsed to one place; the mesh comes from a start without iteration and "
         "is likely to be folded.");
  else if (result.embedding.added_barrier)
    warn("The embedding collapsed until it was held by a barrier: the cloud is too coarse for its "
         "shape, or has wide gaps.");
  else if (result.embedding.stop_reason == StopReason::IterationLimit)
    warn("The embedding has not converged within the limit of iterations.");
  else if (result.embedding.stop_reason == StopReason::Stagnated)
    warn("The embedding has not converged: its residual no longer changes.");
  if (static_cast<double>(result.triangulation.coincident) > kManyPoints * vertices)
    warn(std::to_string(result.triangulation.coincident) +
         " points cannot be told from others on the sphere: long thin parts shrink below the "
         "rounding of numbers there, and their mesh is arbitrary.");
  if (result.edges_outside_graph > kSuspiciousEdges)
    warn(percent(result.edges_outside_graph) +
         " of the mesh's edges join points that are not near each other in the cloud: the "
         "embedding is folded" +
         (result.embedding.stop_reason == StopReason::Unfinished ? " (a tolerance may unfold it)"
                                                                 : "") +
         ", or the cloud is not a closed surface without holes through it.");
}

}  // namespace

int neighborsToSearch(const Options& options) {
  return options.k.value_or(
      options.graph == GraphMethod::NearestNeighbors ? kNearestNeighbors : kLocalDelaunayNeighbors);
}

void checkOptions(const Options& options) {
  // The stages check the ranges, k first and the others without a graph to work on.
  buildNeighborGraph(Positions(3, 0), NeighborLists(), {neighborsToSearch(options)});
  buildLocalDelaunayGraph(Positions(3, 0), NeighborLists(), localDelaunayOptions(options));
  embedOnSphere(Graph(), Positions(3, 0), iterativeOptions(options));
  embedMultilevel(Graph(), GraphHierarchy(), multilevelOptions(options));
  if (options.solver == EmbeddingMethod::Iterative && options.exponent != 3.0)
    throw InvalidInput("reconstruct: the iterative solver knows exponent = 3 alone; use the "
                       "multilevel solver for others");
}

Result reconstruct(const Positions& points, const NeighborLists& lists, const Options& options,
                   const NeighborSearch& search) {
  checkOptions(options);
  Result result;
  StageLog log(options, result);

  int exponent = 0;
  Nodes nodes;
  NeighborGraph graph = log.run("graph", [&] {
    internal::checkNeighborLists("reconstruct", lists, static_cast<std::size_t>(points.cols()));
    DistinctPoints distinct = findDistinctPoints(points);
    const std::size_t count = distinct.input_of_vertex.size();
    if (points.cols() > 0 && points.cwiseAbs().maxCoeff() > kLargestCoordinate)
      throw InvalidInput("reconstruct: a coordinate is beyond 1e100; scale the points down");
    if (count < 4)
      throw InvalidInput("reconstruct: " + std::to_string(count) +
                         " distinct points; a closed surface needs at least 4");
    const Positions vertices = distinctScaled(points, distinct.input_of_vertex, exponent);
    if (areCoplanar(vertices))
      throw InvalidInput("reconstruct: all points lie in one plane; a closed surface needs points "
                         "outside of it");
    nodes = orderedNodes(vertices, distinct);
    result.vertex_of_input = std::move(distinct.vertex_of_input);
    result.input_of_vertex = std::move(distinct.input_of_vertex);
    result.duplicates = result.vertex_of_input.size() - count;
    return buildGraph(nodes.points, listsOfNodes(lists, nodes), options,
                      searchOfNodes(search, nodes));
  });
  result.graph.without_tangent_plane = std::move(graph.without_tangent_plane);
  result.graph.searched_again = graph.searched_again;
  result.graph.uncertified = graph.uncertified;
  result.graph.weak = graph.weak;
  result.graph.edges = graph.graph.edgeCount();
  result.graph.components = graph.components;
  result.graph.bridges = std::move(graph.bridges);
  for (Bridge& bridge : result.graph.bridges)
    bridge.length = std::ldexp(bridge.length, exponent);

  result.sphere = log.run("embedding", [&] {
    return embed(graph.graph, nodes.points, options, log, result.embedding);
  });

  result.triangles = log.run("triangulation", [&] {
    SphereTriangulation triangulation = triangulateSphere(result.sphere, options.hull);
    result.triangulation.hull_vertices = triangulation.hull_vertices;
    result.triangulation.reinserted = triangulation.reinserted;
    result.triangulation.coincident = triangulation.coincident;
    result.triangulation.hull_rejected = triangulation.hull_rejected;
    return std::move(triangulation.triangles);
  });

  result.topology = log.run("check", [&] {
    double volume = signedVolume(nodes.points, result.triangles);
    if (volume < 0.0) {
      // The embedding is a mirror image: turn mesh and sphere inside out together, so that the
      // triangles face outward on both.
      flipOrientation(result.triangles);
      result.sphere = -result.sphere;
      volume = -volume;
    }
    result.volume = std::ldexp(volume, 3 * exponent);
    result.area = std::ldexp(surfaceArea(nodes.points, result.triangles), 2 * exponent);
    result.edges_outside_graph = shareOutsideGraph(graph.graph, result.triangles);
    MeshTopology topology = checkTopology(result.triangles, result.vertexCount());
    renumber(nodes.vertex_of_node, result);
    return topology;
  });
  if (!result.topology.isSphere())
    throw ComputeError("reconstruct: the mesh is not a closed genus-0 manifold; please report "
                       "this cloud as a defect of the library");
  collectWarnings(result);
  return result;
}

}  // namespace spherical_param
