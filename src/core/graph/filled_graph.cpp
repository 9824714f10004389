#include "filled_graph.h"

#include "graph_building.h"
#include "neighbor_graph.h"
#include "pi.h"
#include "ringed_disc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace spherical_param::internal {
namespace {

class Filler {
public:
  Filler(const Positions& points, const Graph& graph) : points_(points) {
    count_ = static_cast<Index>(graph.size());
  }

  void fill(const Opening& opening) {
    const std::size_t rim = opening.loop.size();
    const RingedDisc disc = ringedDisc(anglesAround(opening));
    const auto node = [&](Index vertex) {
      const auto i = static_cast<std::size_t>(vertex);
      return i < rim ? opening.loop[i] : count_ + vertex - static_cast<Index>(rim);
    };
    // Between the radii of the discs of its area and of its length.
    const double radius =
        std::sqrt(std::sqrt(opening.area / kPi) * opening.boundary_length / (2.0 * kPi));
    for (Eigen::Index t = 0; t < disc.triangles.cols(); ++t)
      for (Eigen::Index k = 0; k < 3; ++k) {
        const Index v = disc.triangles(k, t);
        const Index w = disc.triangles((k + 1) % 3, t);
        if (std::max(v, w) >= static_cast<Index>(rim))
          add(node(v), node(w), radius * disc.distance(v, w));
      }
    for (std::size_t i = rim; i < disc.radii.size(); ++i)
      virtual_points_.push_back(placeOf(opening, disc.angles[i], disc.radii[i]));
    count_ += static_cast<Index>(disc.radii.size() - rim);
  }

  FilledGraph take(const Graph& graph) {
    FilledGraph filled;
    filled.points.resize(3, count_);
    filled.points.leftCols(points_.cols()) = points_;
    for (std::size_t i = 0; i < virtual_points_.size(); ++i)
      filled.points.col(points_.cols() + static_cast<Eigen::Index>(i)) = virtual_points_[i];
    // Each edge is in two triangles, and a node that the loop passes twice may be joined twice to
    // another.
    std::sort(edges_.begin(), edges_.end(), [](const Bridge& a, const Bridge& b) {
      return std::tuple(a.from, a.to, a.length) < std::tuple(b.from, b.to, b.length);
    });
    edges_.erase(std::unique(edges_.begin(), edges_.end(),
                             [](const Bridge& a, const Bridge& b) {
                               return a.from == b.from && a.to == b.to;
                             }),
                 edges_.end());
    Graph with_nodes = graph;
    with_nodes.offsets.resize(static_cast<std::size_t>(count_) + 1, graph.offsets.back());
    filled.graph = withEdges(with_nodes, edges_);
    return filled;
  }

private:
  /// The loop of an opening as a circle: the angle of each of its nodes.
  std::vector<double> anglesAround(const Opening& opening) const {
    std::vector<double> angles;
    double length = 0.0;
    for (std::size_t i = 0; i < opening.loop.size(); ++i) {
      angles.push_back(2.0 * kPi * length / opening.boundary_length);
      length +=
          (points_.col(opening.loop[(i + 1) % opening.loop.size()]) - points_.col(opening.loop[i]))
              .norm();
    }
    return angles;
  }

  /// Between the point of the rim at an angle and the centre.
  Eigen::Vector3d placeOf(const Opening& opening, double angle, double radius) const {
    const auto m = static_cast<double>(opening.loop.size());
    const auto i = static_cast<std::size_t>(angle / (2.0 * kPi) * m) % opening.loop.size();
    return opening.center + radius * (points_.col(opening.loop[i]) - opening.center);
  }

  void add(Index from, Index to, double length) {
    edges_.push_back({std::min(from, to), std::max(from, to),
                      std::max(length, std::numeric_limits<double>::min())});
  }

  const Positions& points_;
  Index count_ = 0;
  std::vector<Eigen::Vector3d> virtual_points_;
  std::vector<Bridge> edges_;
};

/// A graph without false edges.
Graph withoutFalseEdges(const Graph& graph, const std::vector<std::array<Index, 2>>& false_edges) {
  Graph rest;
  for (std::size_t v = 0; v < graph.size(); ++v) {
    for (std::size_t e = graph.offsets[v]; e < graph.offsets[v + 1]; ++e) {
      const auto i = static_cast<Index>(v);
      const Index w = graph.neighbors[e];
      if (std::binary_search(false_edges.begin(), false_edges.end(),
                             std::array<Index, 2>{std::min(i, w), std::max(i, w)}))
        continue;
      rest.neighbors.push_back(w);
      rest.lengths.push_back(graph.lengths[e]);
    }
    rest.offsets.push_back(rest.neighbors.size());
  }
  return rest;
}

/// A graph of the same nodes and more, with those of some edges that join its components.
Graph connected(const Graph& graph, const Positions& points,
                const std::vector<std::array<Index, 2>>& edges) {
  UnionFind parts = connectedComponents(graph);
  std::vector<Bridge> joints;
  for (const auto& [v, w] : edges)
    if (parts.unite(v, w))
      joints.push_back({v, w, edgeLength(points, v, w)});
  return joints.empty() ? graph : withEdges(graph, joints);
}

}  // namespace

FilledGraph fillOpenings(const Positions& points, const Graph& graph, const Openings& openings) {
  Filler filler(points, graph);
  for (const Opening& opening : openings.openings)
    filler.fill(opening);
  FilledGraph filled = filler.take(withoutFalseEdges(graph, openings.false_edges));
  filled.graph = connected(filled.graph, points, openings.false_edges);
  return filled;
}

}  // namespace spherical_param::internal
