#include "spherical_param/reconstruct.h"

#include "exact_predicates.h"
#include "neighbor_lists.h"
#include "option_checks.h"
#include "ordered_points.h"
#include "spherical_param/errors.h"
#include "spherical_param/point_set.h"
#include "spherical_param/self_intersection.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

/// Above this share of edges beyond the graph's 2-ring the mesh is not to be trusted. Unfolded
/// embeddings of closed surfaces have a share of 0.0005 and less, folded limbs 0.003 and more, the
/// lid over the opening of a bowl of some thousand points 0.002.
constexpr double kSuspiciousEdges = 0.001;

/// Far more than what helps.
constexpr int kMostAttempts = 100;

/// Self-intersections for each triangle up to which further attempts are worth it even if the cloud
/// does not look like a closed surface.
constexpr double kFewIntersections = 0.001;

/// Steps of smoothing and optimising on the smoothed points, one after the other, until no
/// triangles intersect.
constexpr int kSmoothingRounds = 3;

/// Neighbours of the graph of an attempt, fewer than usual: no far ones.
constexpr int kFewNeighbors = 8;

/// A share of the points that deserves a warning.
constexpr double kManyPoints = 0.01;

/// Areas and volumes of larger clouds leave the range of double.
constexpr double kLargestCoordinate = 1e100;

/// Shares of stages that are done after their parts.
constexpr double kCheckedShare = 0.02;
constexpr double kOrderedShare = 0.1;
constexpr double kHierarchyShare = 0.39;
constexpr double kTriangulatedShare = 0.94;
constexpr double kSmoothedShare = 0.5;    // of a round
constexpr double kFirstRoundShare = 0.6;  // and so on: of what is left
constexpr double kMeasuredShare = 0.27;
constexpr double kDiagnosedShare = 0.53;
constexpr double kTopologyShare = 0.95;

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

DiagnosisOptions diagnosisOptions(const Options& options) {
  DiagnosisOptions diagnosis;
  diagnosis.threads = options.threads;
  diagnosis.mark_triangles = options.details;
  return diagnosis;
}

SmoothingOptions smoothingOptions(const Options& options) {
  SmoothingOptions smoothing;
  smoothing.steps = options.smoothing_steps;
  smoothing.threads = options.threads;
  return smoothing;
}

/// Times the stages, all attempts together, and tells the callback of their beginning and end.
class StageLog {
public:
  StageLog(const Options& options, Result& result) : options_(options), result_(result) {}

  template <typename Work>
  auto run(const char* stage, const Work& work) {
    report(stage, 0.0);
    const auto begin = std::chrono::steady_clock::now();
    auto outcome = work();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    const auto known = std::find_if(result_.stages.begin(), result_.stages.end(),
                                    [&](const StageTime& other) { return other.name == stage; });
    if (known == result_.stages.end())
      result_.stages.push_back({stage, time.count()});
    else
      known->seconds += time.count();
    tell({stage, 1.0, 0, 0.0});
    return outcome;
  }

  /// A callback for what is the share from `begin` to `end` of a stage; empty if nobody listens.
  std::function<bool(double)> part(const char* stage, double begin = 0.0, double end = 1.0) {
    if (!options_.progress)
      return {};
    return [=](double share) {
      report(stage, begin + (end - begin) * share);
      return true;
    };
  }

  /// \param fraction below 1, which is told once, at the end of the stage, by run().
  void report(const char* stage, double fraction, int iteration = 0, double residual = 0.0) {
    tell({stage, std::min(fraction, kMostBeforeEnd), iteration, residual});
  }

private:
  static constexpr double kMostBeforeEnd = 0.999;

  void tell(const Progress& progress) {
    if (options_.progress && !options_.progress(progress))
      throw Cancelled("reconstruct: cancelled by the progress callback");
  }

  const Options& options_;
  Result& result_;
};

/// The stages work on the distinct points in the order of a space-filling curve, called nodes.
using Nodes = internal::OrderedPoints;

/// What the graph is made of, in terms of nodes.
struct Neighbors {
  NeighborLists lists;
  NeighborSearch search;
};

/// The first neighbours are found once for each graph, and not kept: most clouds need one graph.
using FindNeighbors = std::function<Neighbors(const Nodes&, StageLog&)>;

std::vector<Index> nodesOfInput(const Nodes& nodes) {
  std::vector<Index> node_of_vertex(nodes.vertex_of_node.size());
  for (std::size_t node = 0; node < node_of_vertex.size(); ++node)
    node_of_vertex[static_cast<std::size_t>(nodes.vertex_of_node[node])] = static_cast<Index>(node);
  std::vector<Index> result(nodes.distinct.vertex_of_input.size());
  std::transform(nodes.distinct.vertex_of_input.begin(), nodes.distinct.vertex_of_input.end(),
                 result.begin(),
                 [&](Index vertex) { return node_of_vertex[static_cast<std::size_t>(vertex)]; });
  return result;
}

/// Neighbour lists between nodes; a node has the entries of all its input points.
NeighborLists listsOfNodes(const NeighborLists& lists, const std::vector<Index>& node_of_input,
                           std::size_t node_count) {
  const std::size_t n = node_of_input.size();
  NeighborLists result;
  result.offsets.assign(node_count + 1, 0);
  result.indices.resize(lists.indices.size());
  const auto count = [&](std::size_t i) { return lists.offsets[i + 1] - lists.offsets[i]; };
  for (std::size_t i = 0; i < n; ++i)
    result.offsets[static_cast<std::size_t>(node_of_input[i]) + 1] += count(i);
  for (std::size_t i = 0; i < node_count; ++i)
    result.offsets[i + 1] += result.offsets[i];
  std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e)
      result.indices[next[static_cast<std::size_t>(node_of_input[i])]++] =
          node_of_input[static_cast<std::size_t>(lists.indices[e])];
  return result;
}

/// The neighbours from lists of, and a search among, input points.
Neighbors neighborsFromLists(const NeighborLists& lists, const NeighborSearch& search,
                             const Nodes& nodes) {
  std::vector<Index> node_of_input = nodesOfInput(nodes);
  Neighbors result;
  result.lists = listsOfNodes(lists, node_of_input, nodes.input_of_node.size());
  if (search)
    result.search = [&search, &nodes, node_of_input = std::move(node_of_input)](
                        const std::vector<Index>& queries, int count) {
      std::vector<Index> inputs(queries.size());
      for (std::size_t i = 0; i < queries.size(); ++i)
        inputs[i] = nodes.input_of_node[static_cast<std::size_t>(queries[i])];
      NeighborLists found = search(inputs, count);
      internal::checkIndices("reconstruct: the search's answer", found, queries.size(),
                             node_of_input.size());
      for (Index& neighbor : found.indices)
        neighbor = node_of_input[static_cast<std::size_t>(neighbor)];
      return found;
    };
  return result;
}

/// The neighbours from a search that is made for the nodes.
Neighbors neighborsFromSearch(const NeighborSearchFactory& make_search, const Options& options,
                              const Nodes& nodes, StageLog& log) {
  Neighbors result;
  result.search = make_search(nodes.points, nodes.input_of_node);
  log.report("neighbors", kShareBeforeSearch);
  if (!result.search)
    throw InvalidInput("reconstruct: the factory made an empty search; return one that can be "
                       "called");
  std::vector<Index> all(nodes.input_of_node.size());
  std::iota(all.begin(), all.end(), Index{0});
  result.lists = result.search(all, neighborsToSearch(options));
  return result;
}

/// Gives the result, computed on scaled points, the unit of the input.
void scaleBack(int exponent, Result& result) {
  const auto scale = [exponent](double& value, int power = 1) {
    value = std::ldexp(value, power * exponent);
  };
  const auto scale_all = [exponent](auto& values, int power = 1) {
    values = values.unaryExpr([=](double x) { return std::ldexp(x, power * exponent); }).eval();
  };
  scale(result.measures.volume, 3);
  scale(result.measures.area, 2);
  scale(result.measures.mean_edge_length);
  scale_all(result.measures.box_min);
  scale_all(result.measures.box_max);
  scale_all(result.measures.centroid);
  scale_all(result.measures.inertia, 5);
  result.volume = result.measures.volume;
  result.area = result.measures.area;
  scale(result.optimization.energy);
  for (OptimizationPhase& phase : result.optimization.phases) {
    scale(phase.energy_before);
    scale(phase.energy);
  }
  if (result.smoothed.cols() > 0) {
    scale_all(result.smoothed);
    scale(result.smoothing.max_displacement);
    scale(result.smoothing.mean_displacement);
    scale(result.smoothing.rms_displacement);
    scale(result.smoothing.volume_before, 3);
    scale(result.smoothing.volume_after, 3);
  }
  for (Bridge& bridge : result.graph.bridges)
    scale(bridge.length);
  for (Lid& lid : result.diagnosis.lids) {
    scale(lid.area, 2);
    scale(lid.boundary_length);
    scale(lid.diameter);
    scale(lid.spacing);
    scale_all(lid.center);
  }
  for (CollapsedHandle& handle : result.diagnosis.handles) {
    scale(handle.size);
    scale_all(handle.center);
  }
  for (PartBridge& bridge : result.diagnosis.bridges) {
    scale(bridge.gap);
    scale(bridge.spacing);
    scale_all(bridge.center);
  }
  result.diagnosis.summary = summaryOf(result.diagnosis);
  result.edges_outside_graph = result.diagnosis.edges_outside_graph;
}

/// Gives the result, computed on nodes, the numbers of the vertices.
void renumber(const std::vector<Index>& vertex_of_node, Result& result) {
  const auto vertex = [&](Index node) { return vertex_of_node[static_cast<std::size_t>(node)]; };
  const auto renumber_all = [&](std::vector<Index>& nodes) {
    std::transform(nodes.begin(), nodes.end(), nodes.begin(), vertex);
    std::sort(nodes.begin(), nodes.end());
  };
  const auto permute = [&](Positions& of_nodes) {
    Positions of_vertices(3, of_nodes.cols());
    for (Eigen::Index node = 0; node < of_nodes.cols(); ++node)
      of_vertices.col(vertex(static_cast<Index>(node))) = of_nodes.col(node);
    of_nodes = std::move(of_vertices);
  };
  result.triangles = result.triangles.unaryExpr(vertex);
  permute(result.sphere);
  permute(result.smoothed);
  std::transform(result.history.vertices.begin(), result.history.vertices.end(),
                 result.history.vertices.begin(), vertex);
  std::vector<double> of_vertices(result.vertex_residuals.size());
  for (std::size_t node = 0; node < of_vertices.size(); ++node)
    of_vertices[static_cast<std::size_t>(vertex_of_node[node])] = result.vertex_residuals[node];
  result.vertex_residuals = std::move(of_vertices);
  for (Bridge& bridge : result.graph.bridges) {
    bridge.from = vertex(bridge.from);
    bridge.to = vertex(bridge.to);
  }
  renumber_all(result.graph.without_tangent_plane);
  for (Lid& lid : result.diagnosis.lids) {
    renumber_all(lid.vertices);
    for (std::vector<Index>& loop : lid.loops) {
      std::transform(loop.begin(), loop.end(), loop.begin(), vertex);
      std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    }
  }
  for (CollapsedHandle& handle : result.diagnosis.handles)
    renumber_all(handle.vertices);
  for (PartBridge& bridge : result.diagnosis.bridges)
    renumber_all(bridge.vertices);
}

/// What an attempt does.
struct Plan {
  std::string description;
  GraphMethod graph = GraphMethod::LocalDelaunay;
  StarAgreement agreement = StarAgreement::Both;
  int k = 0;  ///< of GraphMethod::NearestNeighbors
  std::uint32_t seed = 1;
  bool radial_start = false;  ///< instead of an embedding
};

/// The first attempt is what was asked for; others differ in one thing.
Plan planOf(int attempt, const Options& options) {
  Plan plan;
  plan.graph = options.graph;
  plan.k = neighborsToSearch(options);
  plan.seed = options.seed;
  if (attempt == 0) {
    plan.description = "as asked";
    return plan;
  }
  if (options.graph == GraphMethod::LocalDelaunay) {
    if (attempt == 1) {
      plan.description = "one star is enough";
      plan.agreement = StarAgreement::Either;
      return plan;
    }
    if (attempt == 2) {
      plan.description = std::to_string(kFewNeighbors) + " nearest neighbours";
      plan.graph = GraphMethod::NearestNeighbors;
      plan.k = kFewNeighbors;
      return plan;
    }
    attempt -= 2;
  }
  if (attempt == 2) {
    plan.description = "radial start";
    plan.radial_start = true;
    return plan;
  }
  plan.seed = options.seed + static_cast<std::uint32_t>(attempt);
  plan.description = "seed " + std::to_string(plan.seed);
  return plan;
}

NeighborGraph buildGraph(const Positions& points, const Neighbors& neighbors, const Plan& plan,
                         const Options& options, StageLog& log) {
  if (plan.graph == GraphMethod::NearestNeighbors)
    return buildNeighborGraph(points, neighbors.lists, {plan.k});
  LocalDelaunayOptions graph = localDelaunayOptions(options);
  graph.agreement = plan.agreement;
  graph.search = neighbors.search;
  graph.progress = log.part("graph");
  return buildLocalDelaunayGraph(points, neighbors.lists, graph);
}

/// An embedding, and how it came about.
struct Unfolding {
  Positions directions;
  EmbeddingReport report;
  EmbeddingHistory history;
};

/// Adds a state that no solver came to.
void endAt(const Positions& directions, const EmbeddingReport& report,
           EmbeddingRecorder& recorder) {
  recorder({0, static_cast<std::size_t>(directions.cols()), EmbeddingStep::End, 0, report.residual,
            [&] { return directions; }});
}

void embedIteratively(const Graph& graph, const Positions& points, const Options& options,
                      StageLog& log, EmbeddingRecorder& recorder, Unfolding& unfolding) {
  EmbeddingReport& report = unfolding.report;
  EmbeddingOptions embedding = iterativeOptions(options);
  if (options.history.vertices > 0)
    embedding.observer = std::ref(recorder);
  if (options.progress)
    embedding.progress = [&](int iteration, double residual) {
      log.report("embedding", iteration / (options.max_iterations + 1.0), iteration, residual);
      return true;
    };
  Embedding outcome = embedOnSphere(graph, points, embedding);
  report.stop_reason = outcome.stop_reason;
  report.iterations = outcome.iterations;
  report.residual = outcome.residual;
  report.residuals = std::move(outcome.residuals);
  report.centroid_norm = outcome.centroid_norm;
  unfolding.directions = std::move(outcome.directions);
}

void embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy, const Options& options,
                   StageLog& log, EmbeddingRecorder& recorder, Unfolding& unfolding) {
  EmbeddingReport& report = unfolding.report;
  MultilevelOptions embedding = multilevelOptions(options);
  if (options.history.vertices > 0)
    embedding.observer = std::ref(recorder);
  if (options.progress)
    embedding.progress = [&](double share, double residual) {
      log.report("embedding", kHierarchyShare + (1.0 - kHierarchyShare) * share, 0, residual);
      return true;
    };
  MultilevelEmbedding outcome = embedMultilevel(graph, hierarchy, embedding);
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
  unfolding.directions = std::move(outcome.directions);
}

/// The embedding, or a start that is not collapsed where the solver collapses.
Unfolding embed(const Graph& graph, const Positions& points, const Plan& plan,
                const Options& options, StageLog& log) {
  Unfolding unfolding;
  EmbeddingReport& report = unfolding.report;
  const auto use = [&](const Positions& directions, EmbeddingRecorder& recorder) {
    unfolding.directions = directions;
    report.residual = meanTangentialLaplacian(graph, directions, options.weights, options.exponent);
    report.centroid_norm = directions.rowwise().mean().norm();
    endAt(directions, report, recorder);
  };
  if (plan.radial_start) {
    EmbeddingRecorder recorder(graph.size(), options.history);
    report.stop_reason = StopReason::Unfinished;
    use(projectFromCentroid(points), recorder);
    unfolding.history = recorder.take();
    return unfolding;
  }
  GraphHierarchy hierarchy;
  if (options.solver == EmbeddingMethod::Multilevel) {
    HierarchyOptions coarsening;
    coarsening.seed = plan.seed;
    coarsening.threads = options.threads;
    coarsening.progress = log.part("embedding", 0.0, kHierarchyShare);
    hierarchy = buildGraphHierarchy(graph, coarsening);
  }
  EmbeddingRecorder recorder(graph.size(), hierarchy, options.history);
  if (options.solver == EmbeddingMethod::Iterative)
    embedIteratively(graph, points, options, log, recorder, unfolding);
  else
    embedByLevels(graph, hierarchy, options, log, recorder, unfolding);
  if (report.stop_reason == StopReason::Collapsed) {
    report.fallback_start = true;
    use(projectByRank(points), recorder);
  }
  unfolding.history = recorder.take();
  return unfolding;
}

std::string percent(double share) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f %%", 100.0 * share);
  return text.data();
}

void collectWarnings(const Options& options, Result& result) {
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
  if (!result.diagnosis.looksClosedGenus0())
    warn(result.diagnosis.summary + " The mesh is a closed surface without handles all the same.");
  if (result.edges_outside_graph > kSuspiciousEdges &&
      options.optimization == OptimizationMethod::None)
    warn(percent(result.edges_outside_graph) +
         " of the mesh's edges join points that are not near each other in the cloud: the "
         "embedding is folded" +
         (result.embedding.stop_reason == StopReason::Unfinished ? " (a tolerance may unfold it)"
                                                                 : "") +
         ", or the cloud is not a closed surface without holes through it.");
  if (result.optimization.noise_steps > 0 && result.smoothed.cols() == 0)
    warn("The cloud is noisy: the mesh was optimised on smoothed positions of its points; "
         "smoothing gives a surface without the noise.");
  if (!result.self_intersections.empty())
    warn(std::to_string(result.self_intersections.size()) + " pairs of triangles intersect" +
         (result.smoothed.cols() > 0 ? " (" + std::to_string(result.smoothing.self_intersections) +
                                           " on the smoothed points)"
                                     : std::string()) +
         ".");
}

/// One whole run, on nodes.
struct Attempt {
  Triangles triangles;
  Positions sphere;
  NeighborGraph graph;
  EmbeddingReport embedding;
  EmbeddingHistory history;
  TriangulationReport triangulation;
  MeshOptimization optimization;
  Positions smoothed;  ///< with Options::smoothing_steps
  SmoothingReport smoothing;

  /// Pairs of triangles on the points that were asked for.
  std::size_t intersections() const {
    return smoothed.cols() > 0 ? smoothing.self_intersections
                               : optimization.self_intersections.size();
  }
  /// Noise excuses them if there are none without it.
  bool isGood() const {
    return intersections() == 0 || (smoothed.cols() == 0 && optimization.smoothing_steps > 0 &&
                                    optimization.smoothed_self_intersections == 0);
  }
};

/// Mesh and sphere together, so that triangles that face outward on one do so on the other.
void turnInsideOut(Attempt& attempt) {
  flipOrientation(attempt.triangles);
  attempt.sphere = -attempt.sphere;
  for (HistoryFrame& frame : attempt.history.frames)
    frame.sphere = -frame.sphere;
}

std::vector<std::array<Index, 2>> findIntersections(const Positions& points,
                                                    const Triangles& triangles, int threads,
                                                    std::function<bool(double)> progress) {
  SelfIntersectionOptions options;
  options.threads = threads;
  options.progress = std::move(progress);
  return findSelfIntersections(points, triangles, options);
}

void optimize(const Positions& points, const Plan& plan, const Options& options, StageLog& log,
              Attempt& attempt) {
  OptimizationOptions optimization;
  optimization.method = options.optimization;
  optimization.seed = plan.seed;
  optimization.threads = options.threads;
  optimization.finish_on_points = options.smoothing_steps == 0;
  optimization.smoother = [&](const Triangles& triangles, int steps) {
    SmoothingOptions smoothing = smoothingOptions(options);
    smoothing.method = SmoothingMethod::Umbrella;
    smoothing.steps = steps;
    smoothing.restore_volume = false;
    return smoothSurface(points, triangles, smoothing).points;
  };
  if (options.progress)
    optimization.progress = [&](double share) { log.report("optimization", share); };
  attempt.optimization = optimizeMesh(points, attempt.triangles, attempt.graph.graph, optimization);
  attempt.triangles = attempt.optimization.triangles;
}

/// Smooths the points, and optimises the mesh on the smoothed ones. Where that leaves triangles
/// that intersect, the points are smoothed anew with the better mesh; the best round counts.
void smooth(const Positions& points, const Plan& plan, const Options& options, StageLog& log,
            Attempt& attempt) {
  Triangles triangles = attempt.triangles;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int round = 0; round < kSmoothingRounds && fewest > 0; ++round) {
    Smoothing smoothing = smoothSurface(points, triangles, smoothingOptions(options));
    // Mostly one round is enough.
    const double before = 1.0 - std::pow(1.0 - kFirstRoundShare, round);
    const double after = 1.0 - std::pow(1.0 - kFirstRoundShare, round + 1);
    const double smoothed = before + kSmoothedShare * (after - before);
    log.report("smoothing", smoothed);
    std::size_t count = findIntersections(smoothing.points, triangles, options.threads,
                                          log.part("smoothing", smoothed, after))
                            .size();
    if (count > 0 && options.optimization == OptimizationMethod::Full) {
      OptimizationOptions optimization;
      optimization.seed = plan.seed + static_cast<std::uint32_t>(round);
      optimization.threads = options.threads;
      if (options.progress)
        optimization.progress = [&](double share) {
          log.report("smoothing", after + kFirstRoundShare / 2.0 * (1.0 - after) * share);
        };
      MeshOptimization outcome =
          optimizeMesh(smoothing.points, triangles, attempt.graph.graph, optimization);
      triangles = std::move(outcome.triangles);
      count = outcome.self_intersections.size();
    }
    if (count < fewest) {
      fewest = count;
      attempt.triangles = triangles;
      attempt.smoothed = std::move(smoothing.points);
      attempt.smoothing = {smoothing.max_displacement, smoothing.mean_displacement,
                           smoothing.rms_displacement, smoothing.volume_before,
                           smoothing.volume_after,     count};
    }
    if (options.optimization != OptimizationMethod::Full)
      return;
  }
}

Attempt runAttempt(const Plan& plan, NeighborGraph graph, const Positions& points,
                   const Options& options, StageLog& log) {
  Attempt attempt;
  attempt.graph = std::move(graph);
  Unfolding unfolding =
      log.run("embedding", [&] { return embed(attempt.graph.graph, points, plan, options, log); });
  attempt.sphere = std::move(unfolding.directions);
  attempt.embedding = std::move(unfolding.report);
  attempt.history = std::move(unfolding.history);
  log.run("triangulation", [&] {
    TriangulationOptions by;
    by.method = options.hull;
    by.progress = log.part("triangulation", 0.0, kTriangulatedShare);
    SphereTriangulation triangulation = triangulateSphere(attempt.sphere, by);
    attempt.triangulation = {triangulation.hull_vertices, triangulation.reinserted,
                             triangulation.coincident, triangulation.hull_rejected};
    attempt.triangles = std::move(triangulation.triangles);
    if (internal::volumeSign(points, attempt.triangles) < 0) {
      // The embedding is a mirror image: turn mesh and sphere inside out together, so that the
      // triangles face outward on both.
      turnInsideOut(attempt);
    }
    return true;
  });
  log.run("optimization", [&] {
    optimize(points, plan, options, log, attempt);
    return true;
  });
  if (options.smoothing_steps > 0)
    log.run("smoothing", [&] {
      smooth(points, plan, options, log, attempt);
      return true;
    });
  return attempt;
}

/// What came of all attempts.
struct Attempts {
  Attempt best;
  /// The graph that was asked for, by which the cloud is judged, if the best attempt has another.
  std::optional<NeighborGraph> first_graph;

  const NeighborGraph& judge() const { return first_graph ? *first_graph : best.graph; }
};

/// Tells whether other attempts may come to a better mesh: not if the cloud is no closed surface,
/// unless little is wrong.
bool isWorthMore(const Attempt& first, const Positions& points, const Options& options) {
  return static_cast<double>(first.intersections()) <=
             kFewIntersections * static_cast<double>(first.triangles.cols()) ||
         diagnoseSurface(points, first.triangles, first.graph.graph, first.graph.bridges,
                         diagnosisOptions(options))
             .looksClosedGenus0();
}

/// More than one attempt only where the first mesh is bad although the cloud is as it should be.
Attempts runAttempts(NeighborGraph graph, const Nodes& nodes, const FindNeighbors& find_neighbors,
                     const Options& options, StageLog& log, Result& result) {
  const auto quality = [](const Attempt& attempt) {
    return std::pair(attempt.intersections(), attempt.optimization.energy);
  };
  Attempts attempts;
  Attempt& best = attempts.best;
  const auto run = [&](const Plan& plan, NeighborGraph of_plan) {
    const auto begin = std::chrono::steady_clock::now();
    Attempt attempt = runAttempt(plan, std::move(of_plan), nodes.points, options, log);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    const bool is_first = result.attempts.empty();
    result.attempts.push_back({plan.description, attempt.intersections(),
                               attempt.optimization.energy, time.count(), false});
    if (!is_first && quality(attempt) >= quality(best))
      return;
    if (!is_first && !attempts.first_graph)
      attempts.first_graph = std::move(best.graph);
    best = std::move(attempt);
    for (AttemptReport& report : result.attempts)
      report.chosen = &report == &result.attempts.back();
  };
  run(planOf(0, options), std::move(graph));
  if (options.optimization != OptimizationMethod::Full || best.isGood() || options.attempts == 1 ||
      !isWorthMore(best, nodes.points, options))
    return attempts;
  for (int i = 1; i < options.attempts && !best.isGood(); ++i) {
    const Plan plan = planOf(i, options);
    const Neighbors neighbors = log.run("neighbors", [&] { return find_neighbors(nodes, log); });
    run(plan,
        log.run("graph", [&] { return buildGraph(nodes.points, neighbors, plan, options, log); }));
  }
  return attempts;
}

/// Judges the mesh of the best attempt, and moves all there is into the result.
void takeOver(Attempts& attempts, const Positions& points, const Options& options, StageLog& log,
              Result& result) {
  Attempt& best = attempts.best;
  // Exactly: of a cloud that is nearly flat the measured volume may be all rounding.
  if (internal::volumeSign(points, best.triangles) < 0)
    turnInsideOut(best);
  result.measures = measureMesh(points, best.triangles, {options.threads});
  result.self_intersections = std::move(best.optimization.self_intersections);
  if (best.smoothed.cols() > 0)
    result.self_intersections = findIntersections(points, best.triangles, options.threads,
                                                  log.part("check", 0.0, kMeasuredShare));
  log.report("check", kMeasuredShare);
  result.diagnosis = diagnoseSurface(points, best.triangles, attempts.judge().graph,
                                     attempts.judge().bridges, diagnosisOptions(options));
  log.report("check", kDiagnosedShare);
  result.optimization = {std::move(best.optimization.phases),
                         best.optimization.energy,
                         best.optimization.rough,
                         best.optimization.smoothing_steps,
                         best.optimization.alignment,
                         best.optimization.unevenness};
  if (options.details) {
    result.vertex_residuals = tangentialLaplacianLengths(best.graph.graph, best.sphere,
                                                         options.weights, options.exponent);
    for (const auto& pair : result.self_intersections)
      for (const Index t : pair)
        result.diagnosis.triangle_marks[static_cast<std::size_t>(t)] |=
            TriangleMarks::self_intersection;
  }
  result.graph.edges = best.graph.graph.edgeCount();
  result.graph.components = best.graph.components;
  result.graph.bridges = std::move(best.graph.bridges);
  result.graph.without_tangent_plane = std::move(best.graph.without_tangent_plane);
  result.graph.searched_again = best.graph.searched_again;
  result.graph.uncertified = best.graph.uncertified;
  result.graph.weak = best.graph.weak;
  result.triangles = std::move(best.triangles);
  result.sphere = std::move(best.sphere);
  result.history = std::move(best.history);
  result.smoothed = std::move(best.smoothed);
  result.smoothing = best.smoothing;
  result.embedding = std::move(best.embedding);
  result.triangulation = best.triangulation;
}

/// Finds the nodes, of which there must be enough.
Nodes checkedNodes(const Positions& points, const Options& options, StageLog& log) {
  constexpr Eigen::Index most_points = Eigen::Index{1} << 30;
  if (points.cols() > most_points)
    throw InvalidInput("reconstruct: " + std::to_string(points.cols()) +
                       " points are more than 2^30; split or downsample the cloud");
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (!points.col(i).allFinite())
      throw InvalidInput("reconstruct: point " + std::to_string(i) +
                         " is not finite; remove such points first");
    if (points.col(i).cwiseAbs().maxCoeff() > kLargestCoordinate)
      throw InvalidInput("reconstruct: a coordinate is beyond 1e100; scale the points down");
  }
  log.report("neighbors", kCheckedShare);
  Nodes nodes = internal::orderPoints(points, options.threads);
  log.report("neighbors", kOrderedShare);
  const std::size_t count = nodes.input_of_node.size();
  if (count < 4)
    throw InvalidInput("reconstruct: at least 4 distinct finite points are needed, but there are " +
                       std::to_string(count));
  // As given: next to far larger ones, the least coordinates vanish when they are scaled.
  if (areCoplanar(points))
    throw InvalidInput("reconstruct: all points lie in one plane; a closed surface needs points "
                       "outside of it");
  return nodes;
}

Result run(const Positions& points, const Options& options, const FindNeighbors& find_neighbors) {
  checkOptions(options);
  Result result;
  StageLog log(options, result);
  Nodes nodes;
  NeighborGraph graph;
  {
    const Neighbors neighbors = log.run("neighbors", [&] {
      nodes = checkedNodes(points, options, log);
      return find_neighbors(nodes, log);
    });
    graph = log.run("graph", [&] {
      return buildGraph(nodes.points, neighbors, planOf(0, options), options, log);
    });
  }
  Attempts attempts = runAttempts(std::move(graph), nodes, find_neighbors, options, log, result);
  for (AttemptReport& report : result.attempts)
    report.energy = std::ldexp(report.energy, nodes.exponent);
  result.vertex_of_input = std::move(nodes.distinct.vertex_of_input);
  result.input_of_vertex = std::move(nodes.distinct.input_of_vertex);
  result.duplicates = result.vertex_of_input.size() - result.input_of_vertex.size();
  result.topology = log.run("check", [&] {
    takeOver(attempts, nodes.points, options, log, result);
    // Before the nodes get other numbers, while neighbours are near in memory: a sound mesh, the
    // only one that is handed out, has the same topology whatever the numbers.
    MeshTopology topology =
        checkTopology(result.triangles, result.vertexCount(), {options.threads});
    log.report("check", kTopologyShare);
    scaleBack(nodes.exponent, result);
    renumber(nodes.vertex_of_node, result);
    return topology;
  });
  if (!result.topology.isSphere())
    throw ComputeError("reconstruct: the mesh is not a closed genus-0 manifold; please report "
                       "this cloud as a defect of the library");
  collectWarnings(options, result);
  return result;
}

}  // namespace

int neighborsToSearch(const Options& options) {
  return options.k.value_or(
      options.graph == GraphMethod::NearestNeighbors ? kNearestNeighbors : kLocalDelaunayNeighbors);
}

void checkOptions(const Options& options) {
  internal::checkEnum("reconstruct: graph", options.graph, GraphMethod::LocalDelaunay);
  internal::checkEnum("reconstruct: solver", options.solver, EmbeddingMethod::Multilevel);
  internal::checkEnum("reconstruct: hull", options.hull, TriangulationMethod::Incremental);
  internal::checkEnum("reconstruct: optimization", options.optimization, OptimizationMethod::Full);
  // The stages check the ranges, k first and the others without a graph to work on.
  buildNeighborGraph(Positions(3, 0), NeighborLists(), {neighborsToSearch(options)});
  buildLocalDelaunayGraph(Positions(3, 0), NeighborLists(), localDelaunayOptions(options));
  embedOnSphere(Graph(), Positions(3, 0), iterativeOptions(options));
  embedMultilevel(Graph(), GraphHierarchy(), multilevelOptions(options));
  smoothSurface(Positions(3, 0), Triangles(3, 0), smoothingOptions(options));
  EmbeddingRecorder(0, options.history).take();
  if (options.attempts < 1 || options.attempts > kMostAttempts)
    throw InvalidInput("reconstruct: attempts = " + std::to_string(options.attempts) +
                       " is out of range; use 1 (no more than one) to " +
                       std::to_string(kMostAttempts));
  if (options.solver == EmbeddingMethod::Iterative && options.exponent != 3.0)
    throw InvalidInput("reconstruct: the iterative solver knows exponent = 3 alone; use the "
                       "multilevel solver for others");
}

Result reconstruct(const Positions& points, const NeighborLists& lists, const Options& options,
                   const NeighborSearch& search) {
  return run(points, options, [&](const Nodes& nodes, StageLog&) {
    internal::checkNeighborLists("reconstruct", lists, static_cast<std::size_t>(points.cols()));
    return neighborsFromLists(lists, search, nodes);
  });
}

Result reconstruct(const Positions& points, const NeighborSearchFactory& make_search,
                   const Options& options) {
  return run(points, options, [&](const Nodes& nodes, StageLog& log) {
    return neighborsFromSearch(make_search, options, nodes, log);
  });
}

}  // namespace spherical_param
