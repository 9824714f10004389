#include "surface_diagnosis.h"

#include "corner_table.h"
#include "graph_building.h"
#include "graph_cycles.h"
#include "indexed.h"
#include "rows.h"
#include "union_find.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

// The thresholds rest on measurements: raw, optimised and true meshes of 14 closed scans of very
// different sampling and of generated closed shapes, on none of which anything may be reported; on
// a torus and a pair of bodies of 1,000 to 50,000 points.

/// The thresholds hold for graphs of a mean degree of up to one and a half times this: local
/// Delaunay neighbourhoods have 5 to 6, the 8 nearest neighbours 8 to 9. Of others, that number of
/// shortest edges of each point are looked at: with the 25 nearest, no handle of a torus is found.
constexpr std::size_t kThinnedDegree = 8;

/// The least number of torn neighbours of a handle. A cut with 9 points around it tears 18. The
/// torus has 76, 191 and 1,796 in one place at 1,000, 5,000 and 50,000 points, one of 395
/// points 28.
constexpr std::size_t kMinTornEdges = 12;

/// {lower, higher}
using Edge = std::array<Index, 2>;

Edge edgeOf(Index a, Index b) {
  return {std::min(a, b), std::max(a, b)};
}

/// The edges that the mesh has and the graph has not, and the other way round.
struct Differences {
  /// Edges of the mesh whose ends are more than two steps apart in the graph.
  std::size_t outside_graph = 0;
  /// The triangles at these, some more than once.
  std::vector<Index> triangles;
  /// Edges of the graph whose ends are more than two steps apart on the mesh, ascending.
  std::vector<Edge> apart;

  void operator+=(const Differences& more) {
    outside_graph += more.outside_graph;
    triangles.insert(triangles.end(), more.triangles.begin(), more.triangles.end());
    apart.insert(apart.end(), more.apart.begin(), more.apart.end());
  }
};

/// The mesh and the graph of the points, with queries on both.
class MeshAndGraph {
public:
  MeshAndGraph(const Positions& points, const Triangles& triangles, const Graph& graph, int threads)
      : points_(points), triangles_(triangles), graph_(graph), threads_(threads),
        corners_(triangles, graph.size(), threads) {}

  std::size_t vertexCount() const { return graph_.size(); }
  std::size_t triangleCount() const { return internal::columnCount(triangles_); }
  Eigen::Vector3d point(Index v) const { return points_.col(v); }

  /// Calls visit(triangle, next, previous) for the triangles around v, with their other vertices in
  /// order.
  template <typename Visit>
  void forEachTriangle(Index v, const Visit& visit) const {
    corners_.forEachCorner(v, [&](Index t, Index k) {
      visit(t, triangles_(internal::nextCorner(k), t), triangles_(internal::previousCorner(k), t));
    });
  }

  /// Unit normal of the mesh: the mean of those of the triangles around v. By area, the wide
  /// triangles over a cut would outweigh the surface beside it.
  Eigen::Vector3d normal(Index v) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    forEachTriangle(v, [&](Index, Index next, Index previous) {
      sum += (point(next) - point(v)).cross(point(previous) - point(v)).normalized();
    });
    return sum.normalized();
  }

  Positions pointsOf(const std::vector<Index>& vertices) const {
    return points_(Eigen::all, vertices);
  }

  /// Distance of the points around v in the graph.
  double spacing(Index v) const { return internal::nodeSpacing(graph_, v); }

  Differences differences() const {
    return internal::accumulate(graph_.size(), threads_, Differences{},
                                [&](Index v, Differences& found) { collectAt(v, found); });
  }

private:
  /// Compares the edges from `a`, each of them once.
  void collectAt(Index a, Differences& found) const {
    std::vector<Index> ring;
    forEachTriangle(a, [&](Index t, Index b, Index) {
      ring.push_back(b);
      if (isNearInGraph(a, b))
        return;
      found.triangles.push_back(t);
      found.outside_graph += a < b ? 1 : 0;
    });
    // Vertices that were taken out are not torn apart.
    if (ring.empty())
      return;
    const auto is_around = [&](Index v) {
      return std::find(ring.begin(), ring.end(), v) != ring.end();
    };
    for (const Index b : graph_.row(a)) {
      bool is_near = b < a || is_around(b) || corners_.countAt(b) == 0;
      // Nearly all others are the other diagonal of two triangles.
      if (!is_near)
        forEachTriangle(b, [&](Index, Index next, Index) {
          is_near = is_near || next == a || is_around(next);
        });
      if (!is_near)
        found.apart.push_back({a, b});
    }
  }

  /// Whether a and b are neighbours in the graph or have a common one.
  bool isNearInGraph(Index a, Index b) const {
    const auto of_a = graph_.row(a);
    const auto of_b = graph_.row(b);
    return of_a.contains(b) || std::any_of(of_a.begin(), of_a.end(), [&](Index c) {
             return std::binary_search(of_b.begin(), of_b.end(), c);
           });
  }

  const Positions& points_;
  const Triangles& triangles_;
  const Graph& graph_;
  int threads_;
  internal::CornerTable corners_;
};

// --- Handles -------------------------------------------------------------------------------------

/// The edges of the graph along the surface whose ends are far apart on the mesh.
///
/// \param apart those whose ends are more than two steps apart.
internal::Indexed<Edge> tornEdges(const MeshAndGraph& surface, const std::vector<Edge>& apart,
                                  const std::vector<Edge>& bridges) {
  if (apart.empty())
    return {};
  internal::IndexSet seen(surface.vertexCount());
  // Neighbours were torn apart that are more than 8 steps apart on the mesh.
  const auto are_torn = [&](const Edge& edge) {
    std::vector<Index> disc{edge[0]};
    seen.clear();
    seen.insert(edge[0]);
    std::size_t begin = 0;
    for (int step = 0; step < 8 && !seen.contains(edge[1]); ++step)
      for (const std::size_t end = disc.size(); begin < end; ++begin)
        surface.forEachTriangle(disc[begin], [&](Index, Index next, Index) {
          if (seen.insert(next))
            disc.push_back(next);
        });
    return !seen.contains(edge[1]);
  };
  internal::Indexed<Edge> torn;
  std::copy_if(apart.begin(), apart.end(), std::back_inserter(torn), [&](const Edge& edge) {
    // Neighbours with opposite normals are false, on the two sheets of a thin plate.
    return are_torn(edge) && !std::binary_search(bridges.begin(), bridges.end(), edge) &&
           surface.normal(edge[0]).dot(surface.normal(edge[1])) >= -0.8;
  });
  return torn;
}

/// Groups of torn edges that share an end, or whose ends are neighbours on the mesh; all ends are
/// listed.
std::vector<Handle> handlesOf(const MeshAndGraph& surface, const internal::Indexed<Edge>& torn) {
  std::map<Index, Index> edge_at;
  internal::UnionFind groups(torn.size());
  for (const Index e : internal::indicesOf(torn))
    for (const Index v : torn[e])
      groups.unite(edge_at.try_emplace(v, e).first->second, e);
  for (const auto& entry : edge_at)
    surface.forEachTriangle(entry.first, [&](Index, Index next, Index) {
      const auto other = edge_at.find(next);
      if (other != edge_at.end())
        groups.unite(entry.second, other->second);
    });
  std::map<Index, Handle> handles;
  for (const Index e : internal::indicesOf(torn)) {
    Handle& handle = handles[groups.find(e)];
    ++handle.edges;
    handle.vertices.insert(handle.vertices.end(), torn[e].begin(), torn[e].end());
  }
  std::vector<Handle> result;
  for (auto& [group, handle] : handles) {
    if (handle.edges < kMinTornEdges)
      continue;
    internal::sortUnique(handle.vertices);
    const Positions points = surface.pointsOf(handle.vertices);
    handle.center = points.rowwise().mean();
    handle.size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
    result.push_back(std::move(handle));
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Handle& a, const Handle& b) { return a.edges > b.edges; });
  return result;
}

/// The cycles of a graph, as far as known.
struct Cycles {
  std::optional<int> narrow;  ///< around gaps of more than 6 edges
  std::optional<int> wide;    ///< around gaps of more than 9

  explicit Cycles(const Graph& graph)
      : narrow(internal::countCycles(graph, 2)),
        wide(narrow ? internal::countCycles(graph, 3) : std::nullopt) {}

  /// Number of handles of a surface with some openings. Empty if it depends on how wide a gap has
  /// to be.
  std::optional<int> genus(std::size_t openings) const {
    if (!wide || *narrow != *wide)
      return std::nullopt;
    const int of_handles = *wide - (openings > 1 ? static_cast<int>(openings) - 1 : 0);
    return of_handles >= 0 && of_handles % 2 == 0 ? std::optional(of_handles / 2) : std::nullopt;
  }
  /// Whether there may be handles where genus() is empty. The numbers of cycles differ by 1 on tori
  /// of 395 to 2,300 points; on closed scans whose sheets nearly touch, and their variants, by 8
  /// and more: 8 and 0, 12 and 3, 42 and 13.
  bool mayBeHandles() const { return wide && *narrow - *wide <= 1; }
};

/// Finds the handles of a surface in one part.
///
/// \param apart edges of the graph whose ends are more than two steps apart on the mesh.
/// \param genus of the mesh.
void findTornHandles(const MeshAndGraph& surface, const Graph& graph,
                     const std::vector<Edge>& apart, const std::vector<Edge>& bridges,
                     const std::vector<Opening>& openings, bool count_cycles, int genus,
                     SurfaceDiagnosis& result) {
  // A mesh that is folded tears neighbours apart without handles as well.
  if (result.isFolded()) {
    const bool is_open = std::any_of(openings.begin(), openings.end(),
                                     [](const Opening& opening) { return opening.isCertain(); });
    if (count_cycles && !is_open)
      result.genus = Cycles(graph).genus(0);
    return;
  }
  result.handles = handlesOf(surface, tornEdges(surface, apart, bridges));
  if (result.handles.empty() || !count_cycles)
    return;
  const Cycles cycles(graph);
  result.genus = cycles.genus(openings.size());
  // Without handles, neighbours are torn apart where the mesh is folded.
  if (result.genus ? *result.genus <= genus : !cycles.mayBeHandles())
    result.handles.clear();
}

// --- Parts ---------------------------------------------------------------------------------------

/// The edges of the graph that join its parts, ascending.
std::vector<Edge> edgesOf(const std::vector<Bridge>& bridges) {
  std::vector<Edge> edges;
  edges.reserve(bridges.size());
  for (const Bridge& bridge : bridges)
    edges.push_back(edgeOf(bridge.from, bridge.to));
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Pairs of parts with a gap of at least 4 times the distance of the points there; all ends are
/// listed.
///
/// \param edges of the bridges, ascending.
std::vector<PartBridge> findBridges(const MeshAndGraph& surface, const Graph& graph,
                                    const std::vector<Bridge>& bridges,
                                    const std::vector<Edge>& edges) {
  if (bridges.empty())
    return {};
  // There are no bridges within a part.
  internal::UnionFind parts(graph.size());
  for (const Index a : graph.nodes())
    for (const Index b : graph.row(a))
      if (a < b && !std::binary_search(edges.begin(), edges.end(), Edge{a, b}))
        parts.unite(a, b);
  const internal::Indexed<Index> part = internal::representatives(parts, graph.size());
  const internal::Indexed<std::size_t> sizes = internal::setSizes(part);
  std::map<Edge, PartBridge> joints;
  for (const auto& [from, to, length] : bridges) {
    PartBridge& joint = joints[edgeOf(part[from], part[to])];
    joint.gap = joint.vertices.empty() ? length : std::min(joint.gap, length);
    joint.vertices.insert(joint.vertices.end(), {from, to});
  }
  std::vector<PartBridge> result;
  for (auto& [pair, joint] : joints) {
    std::vector<double> spacings;
    for (const Index v : joint.vertices)
      spacings.push_back(surface.spacing(v));
    internal::sortUnique(joint.vertices);
    std::sort(spacings.begin(), spacings.end());
    joint.spacing = spacings[(spacings.size() - 1) / 2];
    if (pair[0] == pair[1] || joint.gap < 4.0 * joint.spacing)
      continue;
    joint.center = surface.pointsOf(joint.vertices).rowwise().mean();
    joint.points = std::min(sizes[pair[0]], sizes[pair[1]]);
    joint.other_points = std::max(sizes[pair[0]], sizes[pair[1]]);
    result.push_back(std::move(joint));
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const PartBridge& a, const PartBridge& b) { return a.points > b.points; });
  return result;
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
  return internal::graphOfEdges(graph.size(), edges);
}

/// The marks of all findings.
///
/// \param outside_graph triangles at edges outside the graph.
std::vector<std::uint8_t> marksOf(const MeshAndGraph& surface, const SurfaceDiagnosis& diagnosis,
                                  const std::vector<Opening>& openings,
                                  const std::vector<Index>& outside_graph) {
  std::vector<std::uint8_t> marks(surface.triangleCount(), 0);
  const auto mark = [&](Index t, std::uint8_t bit) { marks[static_cast<std::size_t>(t)] |= bit; };
  const auto mark_around = [&](const std::vector<Index>& vertices, std::uint8_t bit) {
    for (const Index v : vertices)
      surface.forEachTriangle(v, [&](Index t, Index, Index) { mark(t, bit); });
  };
  for (const Opening& opening : openings)
    if (opening.isCertain())
      for (const Index t : opening.triangles)
        mark(t, triangle_mark::filled_hole);
  for (const Handle& handle : diagnosis.handles)
    mark_around(handle.vertices, triangle_mark::handle);
  for (const PartBridge& bridge : diagnosis.bridges)
    mark_around(bridge.vertices, triangle_mark::part_bridge);
  for (const Index t : outside_graph)
    mark(t, triangle_mark::outside_graph);
  return marks;
}

SurfaceKind kindOf(const SurfaceDiagnosis& diagnosis, const std::vector<Opening>& openings,
                   const DiagnosisOptions& options) {
  if (!diagnosis.bridges.empty())
    return SurfaceKind::SeveralParts;
  const bool is_torn = !diagnosis.handles.empty();
  if (diagnosis.isFolded() ? diagnosis.genus.value_or(0) > 0 : is_torn && options.count_cycles)
    return SurfaceKind::Handles;
  if (diagnosis.isFolded() || is_torn)
    return SurfaceKind::Unclear;
  if (options.genus > 0)
    return SurfaceKind::Handles;
  const bool is_open = std::any_of(openings.begin(), openings.end(), [](const Opening& opening) {
    return !opening.is_filled || opening.isCertain();
  });
  return is_open ? SurfaceKind::Open : SurfaceKind::ClosedGenus0;
}

/// Leaves at most `count` of the vertices, spread over their order.
void shorten(std::vector<Index>& vertices, std::size_t count) {
  if (vertices.size() <= count)
    return;
  for (std::size_t i = 0; i < count; ++i)
    vertices[i] = vertices[i * vertices.size() / count];
  vertices.resize(count);
}

}  // namespace

bool SurfaceDiagnosis::isFolded() const {
  // Closed scans have up to 0.05, optimised meshes of scans from one side 0.04, of the torus 0.06
  // and of closed shapes with noise of half the distance of neighbours less still; noise twice as
  // strong has 0.11 and more, and the torus 0.28 and more as long as its mesh is folded.
  return edges_outside_graph > 0.1;
}

SurfaceDiagnosis diagnoseSurface(const Positions& points, const Triangles& triangles,
                                 const Graph& graph, const std::vector<Bridge>& bridges,
                                 const std::vector<Opening>& openings,
                                 const DiagnosisOptions& options, int threads) {
  const std::vector<Edge> bridge_edges = edgesOf(bridges);
  const bool is_dense = 2 * graph.neighbors.size() > 3 * kThinnedDegree * graph.size();
  const Graph thin = is_dense ? thinned(graph, bridges) : Graph();
  const Graph& sparse = is_dense ? thin : graph;
  const MeshAndGraph surface(points, triangles, sparse,
                             internal::threadCount(threads, graph.size()));
  const Differences differences = surface.differences();
  SurfaceDiagnosis result;
  result.edges_outside_graph = static_cast<double>(differences.outside_graph) /
                               (1.5 * static_cast<double>(triangles.cols()));
  result.bridges = findBridges(surface, graph, bridges, bridge_edges);
  // A mesh that was squeezed through a bridge tears neighbours apart without handles.
  if (result.bridges.empty())
    findTornHandles(surface, sparse, differences.apart, bridge_edges, openings,
                    options.count_cycles, options.genus, result);
  if (options.mark_triangles)
    result.triangle_marks = marksOf(surface, result, openings, differences.triangles);
  result.kind = kindOf(result, openings, options);
  for (Handle& handle : result.handles)
    shorten(handle.vertices, options.max_vertices);
  for (PartBridge& bridge : result.bridges)
    shorten(bridge.vertices, options.max_vertices);
  return result;
}

}  // namespace spherical_param
