#include "filled_graph.h"

#include "graph_building.h"
#include "pi.h"
#include "ringed_disc.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace spherical_param::internal {
namespace {

/// The angles of the nodes of an opening if its loop were a circle.
std::vector<double> anglesAround(const Positions& points, const Opening& opening) {
  std::vector<double> angles;
  double length = 0.0;
  for (std::size_t i = 0; i < opening.loop.size(); ++i) {
    angles.push_back(2.0 * kPi * length / opening.boundary_length);
    length +=
        (points.col(opening.loop[(i + 1) % opening.loop.size()]) - points.col(opening.loop[i]))
            .norm();
  }
  return angles;
}

/// Appends the virtual nodes of an opening, and their edges.
void fill(const Positions& points, const Opening& opening, std::vector<Eigen::Vector3d>& nodes,
          std::vector<Bridge>& edges) {
  const RingedDisc disc = ringedDisc(anglesAround(points, opening));
  const auto size = static_cast<Index>(opening.loop.size());
  const auto first = static_cast<Index>(points.cols()) + static_cast<Index>(nodes.size());
  const Indexed<Index> loop(opening.loop.begin(), opening.loop.end());
  const auto node = [&](Index vertex) {
    return vertex < size ? loop[vertex] : first + vertex - size;
  };
  // Between the radii of a disc of its area and a circle of its length.
  const double radius =
      std::sqrt(std::sqrt(opening.area / kPi) * opening.boundary_length / (2.0 * kPi));
  for (const auto& triangle : disc.triangles.colwise())
    for (Index k = 0; k < 3; ++k) {
      const Index v = triangle[k];
      const Index w = triangle[(k + 1) % 3];
      if (std::max(v, w) >= size)
        edges.push_back(
            {node(v), node(w),
             std::max(radius * disc.distance(v, w), std::numeric_limits<double>::min())});
    }
  // Each inner vertex is between the centre and the node of the loop at its angle.
  for (std::size_t i = opening.loop.size(); i < disc.radii.size(); ++i) {
    const auto at_angle = static_cast<Index>(disc.angles[i] / (2.0 * kPi) * size) % size;
    nodes.emplace_back(opening.center +
                       disc.radii[i] * (points.col(loop[at_angle]) - opening.center));
  }
}

}  // namespace

Graph withoutFalseEdges(const Positions& points, const Graph& graph,
                        const std::vector<std::array<Index, 2>>& false_edges) {
  Graph rest;
  for (const Index v : graph.nodes()) {
    for (const std::size_t e : graph.entries(v)) {
      const auto [low, high] = std::minmax(v, graph.neighbors[e]);
      if (std::binary_search(false_edges.begin(), false_edges.end(),
                             std::array<Index, 2>{low, high}))
        continue;
      rest.neighbors.push_back(graph.neighbors[e]);
      rest.lengths.push_back(graph.lengths[e]);
    }
    rest.endRow();
  }
  UnionFind parts = connectedComponents(rest);
  std::vector<Bridge> joints;
  for (const auto& [v, w] : false_edges)
    if (parts.unite(v, w))
      joints.push_back({v, w, edgeLength(points, v, w)});
  return joints.empty() ? std::move(rest) : withEdges(rest, joints);
}

FilledGraph fillOpenings(const Positions& points, const Graph& graph, const Openings& openings) {
  FilledGraph filled;
  std::vector<Eigen::Vector3d> nodes;  // the virtual ones
  std::vector<Bridge> edges;
  for (const Opening& opening : openings.openings) {
    fill(points, opening, nodes, edges);
    filled.ends.push_back(static_cast<Index>(points.cols()) + static_cast<Index>(nodes.size()));
  }
  filled.points.resize(3, points.cols() + static_cast<Eigen::Index>(nodes.size()));
  filled.points.leftCols(points.cols()) = points;
  std::copy(nodes.begin(), nodes.end(), filled.points.colwise().begin() + points.cols());
  const std::size_t count = graph.size() + nodes.size();
  filled.graph =
      openings.false_edges.empty()
          ? withEdges(graph, edges, count)
          : withEdges(withoutFalseEdges(points, graph, openings.false_edges), edges, count);
  return filled;
}

}  // namespace spherical_param::internal
