#include "surface_diagnosis.h"

#include "corner_table.h"
#include "graph_building.h"
#include "indexed.h"
#include "rows.h"
#include "union_find.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

bool spherical_param::SurfaceDiagnosis::isFolded() const {
  // Sound meshes have at most 0.06. With noise of a spacing it is at least 0.11, and the mesh of a
  // torus has at least 0.28 as long as it is folded.
  return edges_outside_graph > 0.1;
}

namespace spherical_param::internal {
namespace {

/// The thresholds hold for graphs with a mean degree of at most 1.5 times this: tangent Delaunay
/// graphs have 5 to 6, the 8 nearest neighbours 8 to 9. Of denser graphs only this number of
/// shortest edges of each point is used.
constexpr std::size_t kThinnedDegree = 8;

/// {lower, higher}
using Edge = std::array<Index, 2>;

Edge edgeOf(Index a, Index b) {
  return {std::min(a, b), std::max(a, b)};
}

/// The edges of the mesh that are not in the graph.
struct Differences {
  /// Edges whose ends are more than two steps apart in the graph.
  std::size_t outside_graph = 0;
  /// The triangles at these, some more than once.
  std::vector<Index> triangles;

  void operator+=(const Differences& more) {
    outside_graph += more.outside_graph;
    triangles.insert(triangles.end(), more.triangles.begin(), more.triangles.end());
  }
};

/// The mesh and the graph of the points, with queries on both.
struct MeshAndGraph {
  const Positions& points;
  const Triangles& triangles;
  const Graph& graph;
  CornerTable corners;

  /// Calls visit(triangle, next) for the triangles around v, with the vertex after it.
  template <typename Visit>
  void forEachTriangle(Index v, const Visit& visit) const {
    corners.forEachCorner(v, [&](Index t, Index k) { visit(t, triangles(nextCorner(k), t)); });
  }

  /// Whether a and b are neighbours in the graph or have a common one.
  bool areNearInGraph(Index a, Index b) const {
    const auto of_a = graph.row(a);
    const auto of_b = graph.row(b);
    return of_a.contains(b) || std::any_of(of_a.begin(), of_a.end(), [&](Index c) {
             return std::binary_search(of_b.begin(), of_b.end(), c);
           });
  }

  /// Compares the edges from `a`, each of them once.
  void compareAt(Index a, Differences& found) const {
    forEachTriangle(a, [&](Index t, Index b) {
      if (areNearInGraph(a, b))
        return;
      found.triangles.push_back(t);
      found.outside_graph += a < b ? 1 : 0;
    });
  }
};

// --- Parts ---------------------------------------------------------------------------------------

/// Finds the pairs of parts with a gap of at least 4 times the distance of the points there, and
/// counts these parts. Lists the ends of all their bridges.
///
/// \param edges of the bridges, ascending.
void findBridges(const MeshAndGraph& surface, const Graph& graph,
                 const std::vector<Bridge>& bridges, const std::vector<Edge>& edges,
                 SurfaceDiagnosis& result) {
  if (bridges.empty())
    return;
  // A part is what edges other than bridges connect.
  UnionFind parts(graph.size());
  for (const Index a : graph.nodes())
    for (const Index b : graph.row(a))
      if (a < b && !std::binary_search(edges.begin(), edges.end(), Edge{a, b}))
        parts.unite(a, b);
  const auto [part, sizes] = Partition(parts);
  std::map<Edge, PartBridge> joints;
  for (const auto& [from, to, length] : bridges) {
    PartBridge& joint = joints[edgeOf(part[from], part[to])];
    joint.gap = joint.vertices.empty() ? length : std::min(joint.gap, length);
    joint.vertices.insert(joint.vertices.end(), {from, to});
  }
  std::vector<Edge> apart;
  for (auto& [pair, joint] : joints) {
    std::vector<double> spacings;
    for (const Index v : joint.vertices)
      spacings.push_back(nodeSpacing(surface.graph, v));
    sortUnique(joint.vertices);
    std::sort(spacings.begin(), spacings.end());
    joint.spacing = spacings[(spacings.size() - 1) / 2];
    if (pair[0] == pair[1] || joint.gap < 4.0 * joint.spacing) {
      parts.unite(pair[0], pair[1]);
      continue;
    }
    apart.push_back(pair);
    const Positions ends = surface.points(Eigen::all, joint.vertices);
    joint.center = ends.rowwise().mean();
    joint.points = std::min(sizes[pair[0]], sizes[pair[1]]);
    joint.other_points = std::max(sizes[pair[0]], sizes[pair[1]]);
    result.bridges.push_back(std::move(joint));
  }
  std::stable_sort(result.bridges.begin(), result.bridges.end(),
                   [](const PartBridge& a, const PartBridge& b) { return a.points > b.points; });
  std::set<Index> separate;
  for (const auto& [a, b] : apart)
    separate.insert({parts.find(a), parts.find(b)});
  // The parts beside a gap may be joined elsewhere: the gap still counts as two parts.
  result.joined_parts = apart.empty() ? 0 : std::max<std::size_t>(2, separate.size());
}

// --- One side ------------------------------------------------------------------------------------

/// Whether the mesh, which is oriented, is torn where the surface turns over: edges of the graph
/// that lie in the surface join vertices with opposite normals, far from each other on the mesh.
bool isTorn(const MeshAndGraph& surface) {
  // A shorter tear may be chance.
  constexpr std::size_t min_edges = 10;
  constexpr double min_cosine = 0.9;
  constexpr double max_slope = 0.3;
  Positions normals = Positions::Zero(3, surface.points.cols());
  for (const Index v : surface.graph.nodes()) {
    surface.forEachTriangle(v, [&](Index t, Index) {
      normals.col(v) += areaNormal(surface.points, surface.triangles, t);
    });
    normals.col(v).stableNormalize();
  }
  // Whether two vertices are neighbours on the mesh, or have a common neighbour.
  const auto are_near = [&](Index v, Index w) {
    const auto ring_of = [&](Index of) {
      std::vector<Index> ring{of};
      surface.forEachTriangle(of, [&](Index, Index next) { ring.push_back(next); });
      sortUnique(ring);
      return ring;
    };
    const std::vector<Index> of_v = ring_of(v);
    const std::vector<Index> of_w = ring_of(w);
    return std::any_of(of_v.begin(), of_v.end(),
                       [&](Index x) { return std::binary_search(of_w.begin(), of_w.end(), x); });
  };
  std::size_t edges = 0;
  for (const Index v : surface.graph.nodes())
    for (const Index w : surface.graph.row(v)) {
      const auto a = normals.col(v);
      const auto b = normals.col(w);
      const Eigen::Vector3d d = (surface.points.col(w) - surface.points.col(v)).stableNormalized();
      const double slope = std::max(std::abs(a.dot(d)), std::abs(b.dot(d)));
      if (v < w && a.dot(b) < -min_cosine && slope < max_slope && !are_near(v, w))
        ++edges;
    }
  return edges >= min_edges;
}

// --- All together --------------------------------------------------------------------------------

/// The edges of a graph that are among the kThinnedDegree shortest of one of their ends, and the
/// bridges.
Graph thinned(const Graph& graph, const std::vector<Bridge>& bridges) {
  std::vector<Bridge> edges = bridges;
  for (const Index v : graph.nodes()) {
    std::vector<Bridge> row;
    for (const std::size_t e : graph.entries(v))
      row.push_back({v, graph.neighbors[e], graph.lengths[e]});
    const auto end =
        row.begin() + std::min<std::ptrdiff_t>(kThinnedDegree, row.end() - row.begin());
    std::partial_sort(row.begin(), end, row.end(),
                      [](const Bridge& a, const Bridge& b) { return a.length < b.length; });
    edges.insert(edges.end(), row.begin(), end);
  }
  return withEdges({}, edges, graph.size());
}

/// Marks the triangles at bridges and at edges outside the graph.
///
/// \param outside_graph triangles at these edges.
std::vector<std::uint8_t> marksOf(const MeshAndGraph& surface,
                                  const std::vector<PartBridge>& bridges,
                                  const std::vector<Index>& outside_graph) {
  std::vector<std::uint8_t> marks(columnCount(surface.triangles), 0);
  const auto mark = [&](Index t, std::uint8_t bit) { marks[static_cast<std::size_t>(t)] |= bit; };
  for (const PartBridge& bridge : bridges)
    for (const Index v : bridge.vertices)
      surface.forEachTriangle(v, [&](Index t, Index) { mark(t, triangle_mark::part_bridge); });
  for (const Index t : outside_graph)
    mark(t, triangle_mark::outside_graph);
  return marks;
}

/// Leaves at most `count` vertices of each bridge, spread over their order.
void shorten(std::vector<PartBridge>& bridges, std::size_t count) {
  for (PartBridge& bridge : bridges) {
    std::vector<Index>& vertices = bridge.vertices;
    for (std::size_t i = 0; vertices.size() > count && i < count; ++i)
      vertices[i] = vertices[i * vertices.size() / count];
    vertices.resize(std::min(count, vertices.size()));
  }
}

}  // namespace

SurfaceDiagnosis diagnoseSurface(const Positions& points, const Triangles& triangles,
                                 const Graph& graph, const std::vector<Bridge>& bridges,
                                 const DiagnosisOptions& options, int threads) {
  std::vector<Edge> bridge_edges;
  bridge_edges.reserve(bridges.size());
  for (const Bridge& bridge : bridges)
    bridge_edges.push_back(edgeOf(bridge.from, bridge.to));
  std::sort(bridge_edges.begin(), bridge_edges.end());
  const bool is_dense = 2 * graph.neighbors.size() > 3 * kThinnedDegree * graph.size();
  const Graph thin = is_dense ? thinned(graph, bridges) : Graph();
  const int thread_count = threadCount(threads, graph.size());
  const MeshAndGraph surface{points, triangles, is_dense ? thin : graph,
                             CornerTable(triangles, graph.size(), thread_count)};
  const Differences differences =
      accumulate(graph.size(), thread_count, Differences{},
                 [&](Index v, Differences& found) { surface.compareAt(v, found); });
  SurfaceDiagnosis result;
  result.edges_outside_graph = static_cast<double>(differences.outside_graph) /
                               (1.5 * static_cast<double>(triangles.cols()));
  findBridges(surface, graph, bridges, bridge_edges, result);
  result.is_one_sided = options.may_be_one_sided && isTorn(surface);
  if (options.mark_triangles)
    result.triangle_marks = marksOf(surface, result.bridges, differences.triangles);
  shorten(result.bridges, options.max_vertices);
  return result;
}

}  // namespace spherical_param::internal
