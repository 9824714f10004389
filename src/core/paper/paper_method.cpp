#include "paper_method.h"

#include "collapse.h"
#include "embedding_starts.h"
#include "graph_building.h"
#include "progress.h"
#include "qhull.h"
#include "spherical_param/sphere_triangulation.h"
#include "tangential_laplacian.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal::paper {
namespace {

/// The k nearest neighbours of a point in a list.
std::vector<Index> nearestOf(const Positions& points, const NeighborLists& lists, std::size_t i,
                             int k) {
  const auto point = static_cast<Index>(i);
  std::vector<std::pair<double, Index>> candidates;
  for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e)
    if (const Index j = lists.indices[e]; j != point)
      candidates.emplace_back((points.col(j) - points.col(point)).squaredNorm(), j);
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  candidates.resize(std::min(candidates.size(), static_cast<std::size_t>(k)));
  std::vector<Index> nearest(candidates.size());
  std::transform(candidates.begin(), candidates.end(), nearest.begin(),
                 [](const auto& candidate) { return candidate.second; });
  return nearest;
}

/// Centres the points so that their sum is zero, and projects them on the sphere.
void center(Positions& u) {
  const Eigen::Vector3d mean = u.rowwise().mean();
  for (auto point : u.colwise())
    if (const Eigen::Vector3d centered = point - mean; centered.norm() > 0.0)
      point = centered.normalized();
}

}  // namespace

NeighborGraph nearestNeighborGraph(const Positions& points, const NeighborLists& lists, int k) {
  // Two points are joined if one of them is among the k nearest of the other.
  std::vector<Bridge> edges;
  for (std::size_t i = 0; i < lists.size(); ++i)
    for (const Index j : nearestOf(points, lists, i, k)) {
      const auto [from, to] = std::minmax({static_cast<Index>(i), j});
      edges.push_back({from, to, edgeLength(points, from, to)});
    }
  Graph no_edges;
  no_edges.offsets.assign(lists.size() + 1, 0);
  NeighborGraph result;
  result.graph = withEdges(no_edges, edges);
  UnionFind parts = connectedComponents(result.graph);
  result.bridges = shortestBridges(points, parts, 1);
  result.graph = withEdges(result.graph, result.bridges);
  return result;
}

Embedding embed(const Graph& graph, const Positions& points, const PaperOptions& options,
                double tolerance, const EmbeddingObserver& observer, const Execution& execution) {
  const FractionReport progress = reportOf(execution, "embedding");
  const int threads = threadCount(execution.threads, graph.size());
  Embedding result;
  EmbeddingReport& report = result.report;
  Positions& u = result.directions;
  u = projectFromCentroid(points);
  Positions moved(3, u.cols());
  for (report.stop_reason = StopReason::IterationLimit;; ++report.iterations) {
    // Equations 1 and 2: the step, and the residual before it.
    report.residual = sweep(graph, options.weights, options.damping, u, moved, threads);
    report.residuals.push_back(report.residual);
    reportFraction(progress, report.iterations / (options.max_iterations + 1.0));
    if (observer)
      observer({0, graph.size(), EmbeddingStep::Iteration, report.iterations, report.residual,
                [&] { return u; }});
    if (report.residual <= tolerance)
      report.stop_reason = StopReason::Converged;
    if (report.residual <= tolerance || report.iterations >= options.max_iterations)
      break;
    std::swap(u, moved);
    center(u);
  }
  const Eigen::Vector3d centroid = u.rowwise().mean();
  report.centroid_norm = centroid.norm();
  // Judged at the end only: centring undoes a passing collapse within a few steps.
  if (isCollapsed(centroid))
    report.stop_reason = StopReason::Collapsed;
  if (observer)
    observer({0, graph.size(), EmbeddingStep::End, report.iterations, report.residual,
              [&] { return u; }});
  return result;
}

Triangles convexHull(const Positions& directions, const Execution& execution) {
  reportFraction(reportOf(execution, "triangulation"), 0.0);
  Triangles hull = hullByQhull(directions);
  return hull.cols() > 0 ? hull : triangulateSphere(directions, execution);
}

}  // namespace spherical_param::internal::paper
