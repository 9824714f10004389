#include "paper_method.h"

#include "graph_building.h"
#include "neighbor_search.h"
#include "progress.h"
#include "qhull.h"
#include "spherical_param/sphere_triangulation.h"
#include "tangential_laplacian.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal::paper {
namespace {

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
  for (const Index i : indicesOf(lists))
    for (const NearPoint& near :
         nearestOthers(points, i, listOf(lists, i), static_cast<std::size_t>(k)))
      edges.push_back({i, near.point, edgeLength(points, i, near.point)});
  NeighborGraph result;
  result.graph = withEdges({}, edges, lists.size());
  UnionFind parts = connectedComponents(result.graph);
  result.bridges = shortestBridges(points, parts, 1);
  result.graph = withEdges(result.graph, result.bridges);
  return result;
}

Embedding embed(const Graph& graph, const Positions& points, const PaperOptions& options,
                double tolerance, const Execution& execution) {
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
  return result;
}

Triangles convexHull(const Positions& directions, const Execution& execution) {
  reportFraction(reportOf(execution, "triangulation"), 0.0);
  Triangles hull = hullByQhull(directions);
  return hull.cols() > 0 ? hull : triangulateSphere(directions, execution);
}

}  // namespace spherical_param::internal::paper
