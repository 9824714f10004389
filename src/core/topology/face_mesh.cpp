#include "face_mesh.h"

#include "boundary_loops.h"
#include "corner_table.h"
#include "rotation_system.h"
#include "sphere_mesh.h"
#include "spherical_param/mesh_topology.h"
#include "union_find.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <unordered_set>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Larger faces may be openings, or beside a false edge. They are filled later.
constexpr std::size_t kMaxCorners = 12;

using TriangleList = std::vector<std::array<Index, 3>>;

Triangles matrixOf(const TriangleList& list) {
  Triangles triangles(3, static_cast<Eigen::Index>(list.size()));
  Eigen::Index column = 0;
  for (const auto& [a, b, c] : list)
    triangles.col(column++) << a, b, c;
  return triangles;
}

std::uint64_t keyOf(Index v, Index w) {
  const auto [low, high] = std::minmax(v, w);
  return static_cast<std::uint64_t>(low) << 32U | static_cast<std::uint64_t>(high);
}

/// The edges of a mesh, and those that are added to it.
class Edges {
public:
  /// \param are_joined whether the mesh has an edge between two vertices.
  explicit Edges(std::function<bool(Index, Index)> are_joined)
      : are_joined_(std::move(are_joined)) {}

  bool contains(Index v, Index w) const {
    return added_.count(keyOf(v, w)) > 0 || are_joined_(v, w);
  }
  /// Returns whether the edge is new.
  bool add(Index v, Index w) { return !are_joined_(v, w) && added_.insert(keyOf(v, w)).second; }
  void remove(Index v, Index w) { added_.erase(keyOf(v, w)); }

private:
  std::function<bool(Index, Index)> are_joined_;
  std::unordered_set<std::uint64_t> added_;
};

/// The triangles of the faces, and those that fill the loops around them.
struct Faces {
  Triangles triangles;
  Indexed<char> is_filling;  ///< of each triangle
};

/// Cuts a polygon into triangles, ear by ear, the shortest new edge first. No new edge is in the
/// mesh already.
///
/// \param loop of the polygon, counter-clockwise, each vertex once.
/// \param edges of the mesh; receives the new ones.
/// \return whether that was possible. If not, nothing has changed.
bool cutIntoTriangles(const Positions& points, const std::vector<Index>& loop, Edges& edges,
                      TriangleList& triangles) {
  const std::size_t count = loop.size();
  std::vector<std::size_t> next(count);
  std::vector<std::size_t> previous(count);
  std::vector<char> is_cut(count, 0);
  using Ear = std::tuple<double, std::size_t, std::size_t, std::size_t>;  // length, tip, ends
  std::priority_queue<Ear, std::vector<Ear>, std::greater<>> ears;
  const auto add = [&](std::size_t i) {
    const double length = (points.col(loop[next[i]]) - points.col(loop[previous[i]])).norm();
    ears.emplace(length, i, previous[i], next[i]);
  };
  for (std::size_t i = 0; i < count; ++i) {
    next[i] = i + 1 < count ? i + 1 : 0;
    previous[i] = i > 0 ? i - 1 : count - 1;
  }
  for (std::size_t i = 0; i < count; ++i)
    add(i);
  TriangleList found;
  while (!ears.empty() && found.size() + 2 < count) {
    const auto [length, tip, before, after] = ears.top();
    ears.pop();
    if (is_cut[tip] != 0 || previous[tip] != before || next[tip] != after)
      continue;
    const bool is_last = found.size() + 3 == count;
    if (!is_last && !edges.add(loop[before], loop[after]))
      continue;
    found.push_back({loop[before], loop[tip], loop[after]});
    is_cut[tip] = 1;
    next[before] = after;
    previous[after] = before;
    add(before);
    add(after);
  }
  if (found.size() + 2 < count) {
    for (const auto& [before, tip, after] : found)
      edges.remove(before, after);
    return false;
  }
  triangles.insert(triangles.end(), found.begin(), found.end());
  return true;
}

/// Cuts a polygon into triangles that bend least (Liepa 2003), by the angles at the edges times
/// their lengths, and by the longest sides. No new edge is in the mesh already.
///
/// \param loop, edges, triangles as for cutIntoTriangles().
/// \param beyond unit normals of the triangles beyond the sides of the loop.
bool cutIntoSmooth(const Positions& points, const std::vector<Index>& loop,
                   const std::vector<Eigen::Vector3d>& beyond, Edges& edges,
                   TriangleList& triangles) {
  constexpr double none = std::numeric_limits<double>::infinity();
  constexpr double mu = 0.3;
  const auto n = static_cast<Index>(loop.size());
  const auto point = [&](Index i) -> Eigen::Vector3d {
    return points.col(loop[static_cast<std::size_t>(i)]);
  };
  const auto bend = [](const Eigen::Vector3d& edge, const Eigen::Vector3d& normal,
                       const Eigen::Vector3d& other) {
    return edge.norm() * std::acos(std::clamp(normal.dot(other), -1.0, 1.0));
  };
  /// The best triangles over the corners from i to j.
  struct Best {
    double cost = none;
    Index tip = -1;
    Eigen::Vector3d normal;  ///< of the triangle at the side from i to j
  };
  std::vector<Best> all(loop.size() * loop.size());
  const auto best = [&](Index i, Index j) -> Best& {
    return all[static_cast<std::size_t>(i * n + j)];
  };
  for (Index i = 0; i + 1 < n; ++i)
    best(i, i + 1) = {0.0, -1, beyond[static_cast<std::size_t>(i)]};
  for (Index steps = 2; steps < n; ++steps)
    for (Index i = 0; i + steps < n; ++i) {
      const Index j = i + steps;
      if (steps + 1 < n &&
          edges.contains(loop[static_cast<std::size_t>(i)], loop[static_cast<std::size_t>(j)]))
        continue;
      const Eigen::Vector3d p = point(i);
      const Eigen::Vector3d edge = point(j) - p;
      Best& of = best(i, j);
      for (Index k = i + 1; k < j; ++k) {
        const Best& first = best(i, k);
        const Best& second = best(k, j);
        double cost = first.cost + second.cost;
        if (!(cost < of.cost))
          continue;
        const Eigen::Vector3d to = point(k) - p;
        const Eigen::Vector3d normal = to.cross(edge).normalized();
        const Eigen::Vector3d back = edge - to;
        cost += bend(to, normal, first.normal) + bend(back, normal, second.normal) +
                mu * std::max({to.norm(), edge.norm(), back.norm()});
        if (steps + 1 == n)
          cost += bend(edge, normal, beyond.back());
        if (cost < of.cost)
          of = {cost, k, normal};
      }
    }
  if (!(best(0, n - 1).cost < none))
    return false;
  std::vector<std::pair<Index, Index>> due{{0, n - 1}};
  while (!due.empty()) {
    const auto [i, j] = due.back();
    due.pop_back();
    if (j - i < 2)
      continue;
    const Index k = best(i, j).tip;
    const auto node = [&](Index at) { return loop[static_cast<std::size_t>(at)]; };
    triangles.push_back({node(i), node(k), node(j)});
    edges.add(node(i), node(j));
    due.insert(due.end(), {{i, k}, {k, j}});
  }
  return true;
}

/// The triangle of a face of three nodes. It begins as cutIntoTriangles() does, opposite to its
/// shortest edge.
std::array<Index, 3> triangleOf(const Positions& points, const Row<Index>& face) {
  std::array<double, 3> opposite{};
  for (std::size_t i = 0; i < 3; ++i)
    opposite[i] =
        (points.col(face.begin()[(i + 1) % 3]) - points.col(face.begin()[(i + 2) % 3])).norm();
  const auto tip = static_cast<std::size_t>(std::min_element(opposite.begin(), opposite.end()) -
                                            opposite.begin());
  return {face.begin()[(tip + 2) % 3], face.begin()[tip], face.begin()[(tip + 1) % 3]};
}

/// The triangles of the faces.
Faces facesOf(const Positions& points, const RotationSystem& rotation) {
  TriangleList triangles;
  const NeighborRows& graph = rotation.edges();
  Edges edges([&](Index v, Index w) { return graph.row(v).contains(w); });
  const NeighborRows faces = rotation.faces(3, 0.0);
  for (const Index i : faces.nodes()) {
    if (faces.row(i).size() == 3) {
      triangles.push_back(triangleOf(points, faces.row(i)));
      continue;
    }
    const std::vector<Index> face(faces.row(i).begin(), faces.row(i).end());
    std::vector<Index> nodes = face;
    sortUnique(nodes);
    if (face.size() <= kMaxCorners && nodes.size() == face.size())
      cutIntoTriangles(points, face, edges, triangles);
  }
  return {matrixOf(triangles), Indexed<char>(triangles.size(), 0)};
}

/// The fans of consecutive triangles around a vertex, without dropped ones; some lists are empty.
Indexed<std::vector<Index>> fansAt(const Triangles& triangles, const CornerTable& corners,
                                   const Indexed<char>& is_dropped, Index v) {
  Indexed<std::array<Index, 3>> wedges;  // first neighbour, last one, triangle
  corners.forEachCorner(v, [&](Index t, Index k) {
    if (is_dropped[t] == 0)
      wedges.push_back({triangles(nextCorner(k), t), triangles(previousCorner(k), t), t});
  });
  UnionFind sets(wedges.size());
  for (const Index i : indicesOf(wedges))
    for (const Index j : indicesOf(wedges))
      if (wedges[i][1] == wedges[j][0])
        sets.unite(i, j);
  Indexed<std::vector<Index>> fans(wedges.size());
  for (const Index i : indicesOf(wedges))
    fans[sets.find(i)].push_back(wedges[i][2]);
  return fans;
}

/// The triangles that meet a condition.
template <typename Condition>
Faces filtered(const Faces& faces, const Condition& stays) {
  std::vector<Eigen::Index> kept;
  Faces rest;
  for (Eigen::Index t = 0; t < faces.triangles.cols(); ++t)
    if (stays(t)) {
      kept.push_back(t);
      rest.is_filling.push_back(faces.is_filling[t]);
    }
  rest.triangles = faces.triangles(Eigen::all, kept);
  return rest;
}

/// Keeps only the largest fan of each vertex.
Faces withoutPinches(Faces faces, std::size_t vertices, int threads) {
  const Triangles& triangles = faces.triangles;
  std::vector<Index> due = checkTopology(triangles, vertices, threads).nonmanifold_vertices;
  if (due.empty())
    return faces;
  const CornerTable corners(triangles, vertices, 1);
  Indexed<char> is_dropped(columnCount(triangles), 0);
  while (!due.empty()) {
    std::vector<Index> dropped;
    for (const Index v : due) {
      const auto fans = fansAt(triangles, corners, is_dropped, v);
      if (fans.size() > 1)
        for (const std::vector<Index>& fan : withoutLargest(fans))
          dropped.insert(dropped.end(), fan.begin(), fan.end());
    }
    due.clear();
    for (const Index t : dropped) {
      is_dropped[t] = 1;
      due.insert(due.end(), {triangles(0, t), triangles(1, t), triangles(2, t)});
    }
    sortUnique(due);
  }
  return filtered(faces, [&](Eigen::Index t) { return is_dropped[t] == 0; });
}

/// Fills the boundary loops of a mesh; leaves out pieces with loops that cannot be filled.
Faces closed(const Positions& points, const Faces& faces, int threads) {
  // The time for the best triangles grows with the cube of a loop.
  constexpr std::size_t max_loop = 150;
  const Triangles& open = faces.triangles;
  const std::size_t vertices = columnCount(points);
  const CornerTable corners(open, vertices, threads);
  UnionFind pieces = piecesOf(open, vertices);
  Edges edges([&](Index v, Index w) {
    bool are_joined = false;
    corners.forEachCorner(v, [&](Index t, Index k) {
      are_joined = are_joined || open(nextCorner(k), t) == w || open(previousCorner(k), t) == w;
    });
    return are_joined;
  });
  // The normal of the triangle with the edge from v to w.
  const auto normal_at = [&](Index v, Index w) {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    corners.forEachCorner(v, [&](Index t, Index k) {
      if (open(nextCorner(k), t) == w)
        normal = areaNormal(points, open, t).normalized();
    });
    return normal;
  };
  TriangleList fillings;
  Indexed<char> is_left_out(vertices, 0);
  for (std::vector<Index>& loop : boundaryLoops(open, vertices, threads)) {
    std::vector<Eigen::Vector3d> beyond;
    std::reverse(loop.begin(), loop.end());
    for (std::size_t i = 0; i < loop.size(); ++i)
      beyond.push_back(normal_at(loop[(i + 1) % loop.size()], loop[i]));
    if (!(loop.size() <= max_loop && cutIntoSmooth(points, loop, beyond, edges, fillings)) &&
        !cutIntoTriangles(points, loop, edges, fillings))
      is_left_out[pieces.find(loop.front())] = 1;
  }
  Faces all{Triangles(3, open.cols() + static_cast<Eigen::Index>(fillings.size())),
            faces.is_filling};
  all.triangles << open, matrixOf(fillings);
  all.is_filling.resize(columnCount(all.triangles), 1);
  return filtered(
      all, [&](Eigen::Index t) { return is_left_out[pieces.find(all.triangles(0, t))] == 0; });
}

/// A tube between two triangles.
struct Tube {
  Index first = -1;  ///< -1: there is none
  Index last = -1;
  std::array<Index, 6> ends{};  ///< the corners of the first one, and those across from them
};

/// The shortest tube between two triangles that are not taken, at two vertices.
Tube shortestTube(const Positions& points, const Triangles& spheres, const CornerTable& corners,
                  const Indexed<char>& is_taken, Index v, Index w) {
  Tube best;
  double least = std::numeric_limits<double>::infinity();
  corners.forEachCorner(v, [&](Index t, Index k) {
    corners.forEachCorner(w, [&](Index u, Index l) {
      if (is_taken[t] != 0 || is_taken[u] != 0)
        return;
      const std::array<Index, 6> ends{
          spheres(k, t), spheres(nextCorner(k), t),     spheres(previousCorner(k), t),
          spheres(l, u), spheres(previousCorner(l), u), spheres(nextCorner(l), u)};
      double sum = 0.0;
      for (std::size_t i = 0; i < 3; ++i)
        sum += (points.col(ends[i]) - points.col(ends[i + 3])).norm() +
               (points.col(ends[i]) - points.col(ends[(i + 1) % 3 + 3])).norm();
      if (sum < least) {
        least = sum;
        best = {t, u, ends};
      }
    });
  });
  return best;
}

/// Joins closed pieces by tubes between triangles at the ends of edges of the graph, short edges
/// first. Returns the piece with the most triangles.
Faces joined(const Positions& points, const Graph& graph, Faces closed) {
  const Triangles& spheres = closed.triangles;
  UnionFind pieces = piecesOf(spheres, graph.size());
  const auto is_of_first = [&](Index v) { return pieces.find(v) == pieces.find(spheres(0, 0)); };
  if (std::all_of(spheres.row(0).begin(), spheres.row(0).end(), is_of_first))
    return closed;
  const CornerTable corners(spheres, graph.size(), 1);
  std::vector<std::tuple<double, Index, Index>> edges;
  for (const Index v : graph.nodes())
    for (const std::size_t e : graph.entries(v)) {
      const Index w = graph.neighbors[e];
      if (v < w && corners.countAt(v) > 0 && corners.countAt(w) > 0 &&
          pieces.find(v) != pieces.find(w))
        edges.emplace_back(graph.lengths[e], v, w);
    }
  std::sort(edges.begin(), edges.end());
  Indexed<char> is_taken(columnCount(spheres), 0);
  TriangleList triangles;
  for (const auto& [length, v, w] : edges) {
    if (pieces.find(v) == pieces.find(w))
      continue;
    const Tube tube = shortestTube(points, spheres, corners, is_taken, v, w);
    if (tube.first < 0)
      continue;
    is_taken[tube.first] = is_taken[tube.last] = 1;
    pieces.unite(v, w);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      triangles.push_back({tube.ends[i], tube.ends[j], tube.ends[j + 3]});
      triangles.push_back({tube.ends[i], tube.ends[j + 3], tube.ends[i + 3]});
    }
  }
  Indexed<char> is_filling(triangles.size(), 1);
  const Indexed<Index> sizes = sizesOf(spheres, graph.size(), pieces);
  const auto largest =
      static_cast<Index>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  for (Eigen::Index t = 0; t < spheres.cols(); ++t)
    if (is_taken[t] == 0) {
      triangles.push_back({spheres(0, t), spheres(1, t), spheres(2, t)});
      is_filling.push_back(closed.is_filling[t]);
    }
  const Faces all{matrixOf(triangles), std::move(is_filling)};
  return filtered(all, [&](Eigen::Index t) { return pieces.find(all.triangles(0, t)) == largest; });
}

/// A region of a closed mesh that grows triangle by triangle, triangles with short sides first, and
/// stays planar.
class PlanarRegion {
public:
  PlanarRegion(const Positions& points, const SphereMesh& mesh)
      : points_(points), mesh_(mesh), is_in_(mesh.slotCount(), 0), is_on_(columnCount(points), 0) {}

  bool contains(Eigen::Index t) const { return is_in_[t] != 0; }

  void grow(Index first) {
    add(first);
    std::vector<Index> touching;  // these triangles would join the region to itself
    while (!due_.empty() || !touching.empty()) {
      while (!due_.empty()) {
        const Index t = due_.top().second;
        due_.pop();
        if (contains(t))
          continue;
        if (touches(t))
          touching.push_back(t);
        else
          add(t);
      }
      for (const Index t : std::exchange(touching, {}))
        if (!contains(t) && !touches(t))
          add(t);
    }
  }

private:
  void add(Index t) {
    is_in_[t] = 1;
    for (int k = 0; k < 3; ++k) {
      is_on_[mesh_.vertex(t, k)] = 1;
      const Index next = mesh_.neighbor(t, k);
      if (!contains(next))
        due_.emplace(longestSide(next), next);
    }
  }

  double longestSide(Index t) const {
    const auto& [a, b, c] = mesh_.vertices(t);
    const auto length = [&](Index v, Index w) { return (points_.col(v) - points_.col(w)).norm(); };
    return std::max({length(a, b), length(b, c), length(c, a)});
  }

  /// The corner opposite to the only side next to the region; -1 if there are more such sides.
  int tipOf(Index t) const {
    int tip = -1;
    int sides = 0;
    for (int k = 0; k < 3; ++k)
      if (contains(mesh_.neighbor(t, k))) {
        tip = k;
        ++sides;
      }
    return sides == 1 ? tip : -1;
  }

  bool touches(Index t) const {
    const int tip = tipOf(t);
    return tip >= 0 && is_on_[mesh_.vertex(t, tip)] != 0;
  }

  const Positions& points_;
  const SphereMesh& mesh_;
  Indexed<char> is_in_;  ///< of each triangle
  Indexed<char> is_on_;  ///< of each vertex
  using Due = std::pair<double, Index>;
  std::priority_queue<Due, std::vector<Due>, std::greater<>> due_;
};

/// Puts a node into the nearest triangle around its neighbours. Returns whether a neighbour is in
/// the mesh.
bool insert(const Positions& points, const Graph& graph, Index v, SphereMesh& mesh) {
  Index nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const Index w : graph.row(v))
    if (mesh.triangleAt(w) >= 0)
      mesh.forEachAround(w, [&](Index t, int) {
        double distance = 0.0;
        for (const Index x : mesh.vertices(t))
          distance += (points.col(v) - points.col(x)).norm();
        if (distance < least) {
          least = distance;
          nearest = t;
        }
      });
  if (nearest >= 0)
    mesh.split(nearest, v);
  return nearest >= 0;
}

/// Closes a mesh of faces.
std::optional<SphereMesh> meshOf(const Positions& points, const Graph& graph, Faces open,
                                 int threads = 1) {
  const Faces faces =
      joined(points, graph,
             closed(points, withoutPinches(std::move(open), graph.size(), threads), threads));
  // One triangle and its filled boundary loop have three vertices: too few for a SphereMesh.
  if (faces.triangles.cols() < 4)
    return std::nullopt;
  SphereMesh mesh(faces.triangles, graph.size(), threads);
  for (Index t = 0; t < mesh.size(); ++t)
    mesh.setOpen(t, faces.is_filling[t] != 0);
  return mesh;
}

}  // namespace

std::optional<SphereMesh> meshFaces(const Positions& points, const Graph& graph,
                                    const RotationSystem& rotation) {
  return meshOf(points, graph, facesOf(points, rotation), rotation.threads());
}

std::optional<SphereMesh> withoutHandles(const Positions& points, const Graph& graph,
                                         SphereMesh mesh) {
  while (mesh.genus() > 0) {
    PlanarRegion region(points, mesh);
    region.grow(0);
    Faces faces{mesh.triangles(), {}};
    for (Index t = 0; t < mesh.size(); ++t)
      faces.is_filling.push_back(mesh.isOpen(t) ? 1 : 0);
    std::optional<SphereMesh> rest =
        meshOf(points, graph, filtered(faces, [&](Eigen::Index t) { return region.contains(t); }));
    if (!rest || rest->genus() >= mesh.genus())
      return std::nullopt;
    mesh = std::move(*rest);
  }
  return mesh;
}

SphereMesh withAllNodes(const Positions& points, const Graph& graph, const SphereMesh& faces) {
  SphereMesh mesh = faces;
  for (Index t = 0; t < mesh.size(); ++t)
    mesh.setOpen(t, false);
  Indexed<Index> due = firstIndices(graph.size());
  for (Index i = 0; i < due.count(); ++i) {
    const Index v = due[i];
    if (mesh.triangleAt(v) >= 0 || !insert(points, graph, v, mesh))
      continue;
    // These may have had no neighbour in the mesh before.
    for (const Index w : graph.row(v))
      if (mesh.triangleAt(w) < 0)
        due.push_back(w);
  }
  return mesh;
}

}  // namespace spherical_param::internal
