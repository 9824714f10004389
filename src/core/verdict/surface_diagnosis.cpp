#include "surface_diagnosis.h"

#include "corner_table.h"
#include "cycle_labels.h"
#include "graph_building.h"
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
#include <set>
#include <utility>
#include <vector>

bool spherical_param::SurfaceDiagnosis::isFolded() const {
  // Closed scans have up to 0.05, optimised meshes of scans from one side 0.04, of the torus 0.06
  // and of closed shapes with noise of half the distance of neighbours less still; noise twice as
  // strong has 0.11 and more, and the torus 0.28 and more as long as its mesh is folded.
  return edges_outside_graph > 0.1;
}

namespace spherical_param::internal {
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

  /// Unit normal of the mesh: the mean of those of the triangles around v. By area, the wide
  /// triangles over a cut would outweigh the surface beside it.
  Eigen::Vector3d normal(Index v) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    corners.forEachCorner(v, [&](Index t, Index k) {
      const auto side_to = [&](Index corner) -> Eigen::Vector3d {
        return points.col(triangles(corner, t)) - points.col(v);
      };
      sum += side_to(nextCorner(k)).cross(side_to(previousCorner(k))).normalized();
    });
    return sum.normalized();
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
    std::vector<Index> ring;
    forEachTriangle(a, [&](Index t, Index b) {
      ring.push_back(b);
      if (areNearInGraph(a, b))
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
    for (const Index b : graph.row(a)) {
      bool is_near = b < a || is_around(b) || corners.countAt(b) == 0;
      // Nearly all others are the other diagonal of two triangles.
      if (!is_near)
        forEachTriangle(
            b, [&](Index, Index next) { is_near = is_near || next == a || is_around(next); });
      if (!is_near)
        found.apart.push_back({a, b});
    }
  }
};

// --- Handles -------------------------------------------------------------------------------------

/// The edges of the graph along the surface whose ends are far apart on the mesh.
///
/// \param apart those whose ends are more than two steps apart.
Indexed<Edge> tornEdges(const MeshAndGraph& surface, const std::vector<Edge>& apart,
                        const std::vector<Edge>& bridges) {
  if (apart.empty())
    return {};
  IndexSet seen(surface.graph.size());
  // Neighbours were torn apart that are more than 8 steps apart on the mesh.
  const auto are_torn = [&](const Edge& edge) {
    std::vector<Index> disc{edge[0]};
    seen.clear();
    seen.insert(edge[0]);
    std::size_t begin = 0;
    for (int step = 0; step < 8 && !seen.contains(edge[1]); ++step)
      for (const std::size_t end = disc.size(); begin < end; ++begin)
        surface.forEachTriangle(disc[begin], [&](Index, Index next) {
          if (seen.insert(next))
            disc.push_back(next);
        });
    return !seen.contains(edge[1]);
  };
  Indexed<Edge> torn;
  std::copy_if(apart.begin(), apart.end(), std::back_inserter(torn), [&](const Edge& edge) {
    // Neighbours with opposite normals are false, on the two sheets of a thin plate.
    return are_torn(edge) && !std::binary_search(bridges.begin(), bridges.end(), edge) &&
           surface.normal(edge[0]).dot(surface.normal(edge[1])) >= -0.8;
  });
  return torn;
}

/// Groups of torn edges that share an end, or whose ends are neighbours on the mesh; all ends are
/// listed.
std::vector<Handle> handlesOf(const MeshAndGraph& surface, const Indexed<Edge>& torn) {
  std::map<Index, Index> edge_at;
  UnionFind groups(torn.size());
  for (const Index e : indicesOf(torn))
    for (const Index v : torn[e])
      groups.unite(edge_at.try_emplace(v, e).first->second, e);
  for (const auto& entry : edge_at)
    surface.forEachTriangle(entry.first, [&](Index, Index next) {
      const auto other = edge_at.find(next);
      if (other != edge_at.end())
        groups.unite(entry.second, other->second);
    });
  std::map<Index, Handle> handles;
  for (const Index e : indicesOf(torn)) {
    Handle& handle = handles[groups.find(e)];
    ++handle.edges;
    handle.vertices.insert(handle.vertices.end(), torn[e].begin(), torn[e].end());
  }
  std::vector<Handle> result;
  for (auto& [group, handle] : handles) {
    if (handle.edges < kMinTornEdges)
      continue;
    sortUnique(handle.vertices);
    const Positions points = surface.points(Eigen::all, handle.vertices);
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
      : narrow(countCycles(graph, 2)), wide(narrow ? countCycles(graph, 3) : std::nullopt) {}

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
void findTornHandles(const MeshAndGraph& surface, const std::vector<Edge>& apart,
                     const std::vector<Edge>& bridges, const std::vector<Opening>& openings,
                     const DiagnosisOptions& options, SurfaceDiagnosis& result) {
  // A mesh that is folded tears neighbours apart without handles as well.
  if (result.isFolded()) {
    const bool is_open = std::any_of(openings.begin(), openings.end(),
                                     [](const Opening& opening) { return opening.isCertain(); });
    if (options.count_cycles && !is_open)
      result.genus = Cycles(surface.graph).genus(0);
    return;
  }
  result.handles = handlesOf(surface, tornEdges(surface, apart, bridges));
  if (result.handles.empty() || !options.count_cycles)
    return;
  const Cycles cycles(surface.graph);
  result.genus = cycles.genus(openings.size());
  // Without handles, neighbours are torn apart where the mesh is folded.
  if (result.genus ? *result.genus <= options.genus : !cycles.mayBeHandles())
    result.handles.clear();
}

// --- Parts ---------------------------------------------------------------------------------------

/// Pairs of parts with a gap of at least 4 times the distance of the points there, and the number
/// of parts that these are; all ends are listed.
///
/// \param edges of the bridges, ascending.
void findBridges(const MeshAndGraph& surface, const Graph& graph,
                 const std::vector<Bridge>& bridges, const std::vector<Edge>& edges,
                 SurfaceDiagnosis& result) {
  if (bridges.empty())
    return;
  // There are no bridges within a part.
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
  // A gap that is closed elsewhere joins two, too.
  result.joined_parts = apart.empty() ? 0 : std::max<std::size_t>(2, separate.size());
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

/// The marks of all findings.
///
/// \param outside_graph triangles at edges outside the graph.
std::vector<std::uint8_t> marksOf(const MeshAndGraph& surface, const SurfaceDiagnosis& diagnosis,
                                  const std::vector<Opening>& openings,
                                  const std::vector<Index>& outside_graph) {
  std::vector<std::uint8_t> marks(columnCount(surface.triangles), 0);
  const auto mark = [&](Index t, std::uint8_t bit) { marks[static_cast<std::size_t>(t)] |= bit; };
  const auto mark_around = [&](const std::vector<Index>& vertices, std::uint8_t bit) {
    for (const Index v : vertices)
      surface.forEachTriangle(v, [&](Index t, Index) { mark(t, bit); });
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

/// Leaves at most `count` of the vertices of each finding, spread over their order.
template <typename Finding>
void shorten(std::vector<Finding>& findings, std::size_t count) {
  for (Finding& finding : findings) {
    std::vector<Index>& vertices = finding.vertices;
    for (std::size_t i = 0; vertices.size() > count && i < count; ++i)
      vertices[i] = vertices[i * vertices.size() / count];
    vertices.resize(std::min(count, vertices.size()));
  }
}

}  // namespace

SurfaceDiagnosis diagnoseSurface(const Positions& points, const Triangles& triangles,
                                 const Graph& graph, const std::vector<Bridge>& bridges,
                                 const std::vector<Opening>& openings,
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
  // A mesh that was squeezed through a bridge tears neighbours apart without handles.
  if (result.bridges.empty())
    findTornHandles(surface, differences.apart, bridge_edges, openings, options, result);
  if (options.mark_triangles)
    result.triangle_marks = marksOf(surface, result, openings, differences.triangles);
  result.kind = kindOf(result, openings, options);
  shorten(result.handles, options.max_vertices);
  shorten(result.bridges, options.max_vertices);
  return result;
}

}  // namespace spherical_param::internal
