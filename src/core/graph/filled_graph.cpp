#include "filled_graph.h"

#include "graph_building.h"
#include "pi.h"
#include "spherical_param/neighbor_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Part of the nodes of a ring that the next one has.
constexpr double kRingRatio = 0.5;
/// Nodes of a ring inside which there is a pole.
constexpr std::size_t kMaxLastRing = 9;

/// Nodes around a circle of the disc.
struct Ring {
  std::vector<Index> nodes;
  std::vector<double> angles;  ///< ascending, from 0
  double radius = 0.0;

  std::size_t size() const { return nodes.size(); }
  /// Of node i, which may be one turn further.
  double angle(std::size_t i) const {
    return i < size() ? angles[i] : angles[i - size()] + 2.0 * kPi;
  }
};

class Filler {
public:
  Filler(const Positions& points, const Graph& graph) : points_(points) {
    count_ = static_cast<Index>(graph.size());
  }

  void fill(const Opening& opening) {
    Ring ring = rimOf(opening);
    const double rim_radius = ring.radius;
    while (ring.size() > kMaxLastRing) {
      Ring inner = ringInside(ring);
      for (std::size_t j = 0; j < inner.size(); ++j)
        place(opening, inner.angles[j], inner.radius / rim_radius);
      join(ring, inner);
      ring = std::move(inner);
    }
    for (const Index node : ring.nodes)
      add(node, count_, ring.radius);
    virtual_points_.push_back(opening.center);
    ++count_;
  }

  FilledGraph take(const Graph& graph) {
    FilledGraph filled;
    filled.points.resize(3, count_);
    filled.points.leftCols(points_.cols()) = points_;
    for (std::size_t i = 0; i < virtual_points_.size(); ++i)
      filled.points.col(points_.cols() + static_cast<Eigen::Index>(i)) = virtual_points_[i];
    // A node that the loop passes twice may be joined twice to another.
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
  /// The loop of an opening as a circle. Its radius is between those of the discs of its area and
  /// of its length.
  Ring rimOf(const Opening& opening) {
    Ring ring;
    ring.nodes = opening.loop;
    ring.radius = std::sqrt(std::sqrt(opening.area / kPi) * opening.boundary_length / (2.0 * kPi));
    double length = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      ring.angles.push_back(2.0 * kPi * length / opening.boundary_length);
      length +=
          (points_.col(ring.nodes[(i + 1) % ring.size()]) - points_.col(ring.nodes[i])).norm();
    }
    return ring;
  }

  /// The next ring: as far inside as half of its own and half of the outer ring's edges.
  Ring ringInside(const Ring& outer) {
    Ring ring;
    const auto m = static_cast<double>(outer.size());
    const auto size = static_cast<std::size_t>(std::ceil(kRingRatio * m));
    const double half_edge = kPi / static_cast<double>(size);
    ring.radius = outer.radius * (1.0 - kPi / m) / (1.0 + half_edge);
    for (std::size_t j = 0; j < size; ++j) {
      ring.nodes.push_back(count_++);
      ring.angles.push_back(2.0 * half_edge * static_cast<double>(j));
    }
    for (std::size_t j = 0; j < size; ++j)
      add(ring.nodes[j], ring.nodes[(j + 1) % size], 2.0 * ring.radius * std::sin(half_edge));
    return ring;
  }

  /// Puts a virtual node between the point of the rim at an angle and the centre.
  void place(const Opening& opening, double angle, double fraction) {
    const auto m = static_cast<double>(opening.loop.size());
    const auto i = static_cast<std::size_t>(angle / (2.0 * kPi) * m) % opening.loop.size();
    virtual_points_.emplace_back(opening.center +
                                 fraction * (points_.col(opening.loop[i]) - opening.center));
  }

  /// Joins two rings by triangles.
  void join(const Ring& outer, const Ring& inner) {
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < outer.size() || j < inner.size()) {
      const double angle = outer.angle(i) - inner.angle(j);
      const double squared = outer.radius * outer.radius + inner.radius * inner.radius -
                             2.0 * outer.radius * inner.radius * std::cos(angle);
      add(outer.nodes[i % outer.size()], inner.nodes[j % inner.size()],
          std::sqrt(std::max(squared, 0.0)));
      if (j == inner.size() || (i < outer.size() && outer.angle(i + 1) <= inner.angle(j + 1)))
        ++i;
      else
        ++j;
    }
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
