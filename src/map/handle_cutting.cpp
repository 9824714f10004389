#include "spherical_param/map/handle_cutting.h"

#include "corner_table.h"
#include "index_loops.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "union_find.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <utility>

namespace spherical_param {
namespace {

using internal::CornerTable;
using internal::entry;
using internal::indexCount;
using internal::Indexed;
using internal::UnionFind;

/// Sides are numbered: 3 t + k runs from corner k of triangle t to the next one.
Index sideAfter(Index side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}
Index sideBefore(Index side) {
  return side % 3 == 0 ? side + 2 : side - 1;
}

/// The side of another triangle along each side; -1 on the boundary.
Indexed<Index> sidesAcross(const Triangles& triangles) {
  std::vector<std::array<Index, 3>> ends;  // the lower one, the higher one, the side
  for (Index side = 0; side < triangles.size(); ++side) {
    const Index from = triangles.data()[side];
    const Index to = triangles.data()[sideAfter(side)];
    ends.push_back({std::min(from, to), std::max(from, to), side});
  }
  std::sort(ends.begin(), ends.end());
  Indexed<Index> across(ends.size(), -1);
  for (std::size_t i = 1; i < ends.size(); ++i)
    if (ends[i][0] == ends[i - 1][0] && ends[i][1] == ends[i - 1][1]) {
      across[ends[i][2]] = ends[i - 1][2];
      across[ends[i - 1][2]] = ends[i][2];
    }
  return across;
}

/// A closed walk along edges.
struct Loop {
  std::vector<Index> sides;  ///< of each edge one
  Index opposite = 0;        ///< vertex, about half way from the one it was searched from
  double length = std::numeric_limits<double>::infinity();
};

class HandleCutter {
public:
  HandleCutter(const Positions& points, const Triangles& triangles)
      : original_(triangles), across_(sidesAcross(triangles)), cut_{points, triangles, {}} {
    for (Index v = 0; v < points.cols(); ++v)
      cut_.vertex_of.push_back(v);
  }

  void cutOne() {
    Loop loop = shortestLoop(0);
    for (Loop other = shortestLoop(loop.opposite); other.length < loop.length;
         other = shortestLoop(loop.opposite))
      loop = std::move(other);
    for (const Index side : loop.sides) {
      if (across_[side] < 0)
        continue;
      cuts_.push_back({side, across_[side]});
      across_[across_[side]] = -1;
      across_[side] = -1;
    }
    joinPieces();
    numberVertices();
  }

  CutMesh take() { return std::move(cut_); }

private:
  Index start(Index side) const { return cut_.triangles.data()[side]; }
  Index end(Index side) const { return start(sideAfter(side)); }
  double length(Index side) const {
    return (cut_.points.col(start(side)) - cut_.points.col(end(side))).norm();
  }

  /// The shortest ways from a vertex (Dijkstra 1959).
  struct Ways {
    Indexed<double> distance;
    Indexed<Index> last;  ///< the side along which each vertex is reached, in either direction
  };

  Ways waysFrom(Index root) const {
    const std::size_t n = cut_.vertex_of.size();
    const CornerTable corners(cut_.triangles, n, 1);
    Ways ways{Indexed<double>(n, std::numeric_limits<double>::infinity()), Indexed<Index>(n, -1)};
    std::priority_queue<std::pair<double, Index>, std::vector<std::pair<double, Index>>,
                        std::greater<>>
        queue;
    ways.distance[root] = 0.0;
    queue.emplace(0.0, root);
    while (!queue.empty()) {
      const auto [distance, v] = queue.top();
      queue.pop();
      if (distance > ways.distance[v])
        continue;
      corners.forEachCorner(v, [&](Index t, Index k) {
        for (const Index side : {3 * t + k, sideBefore(3 * t + k)}) {
          const Index w = otherEnd(side, v);
          const double to_w = ways.distance[v] + length(side);
          if (to_w < ways.distance[w]) {
            ways.distance[w] = to_w;
            ways.last[w] = side;
            queue.emplace(to_w, w);
          }
        }
      });
    }
    return ways;
  }

  Index otherEnd(Index side, Index v) const { return start(side) == v ? end(side) : start(side); }

  /// Triangles, and a further node for each boundary loop, as sets of one element each.
  UnionFind dualNodes(Indexed<Index>& node_across) const {
    Indexed<Index> leaving(cut_.vertex_of.size(), -1);  // the boundary's node at each vertex
    auto nodes = static_cast<Index>(cut_.triangles.cols());
    for (Index side = 0; side < across_.count(); ++side) {
      node_across[side] = across_[side] < 0 ? nodes++ : across_[side] / 3;
      if (across_[side] < 0)
        leaving[start(side)] = node_across[side];
    }
    UnionFind sets(static_cast<std::size_t>(nodes));
    for (Index side = 0; side < across_.count(); ++side)
      if (across_[side] < 0)
        sets.unite(node_across[side], leaving[end(side)]);
    return sets;
  }

  /// The shortest of the loops through a vertex that do not divide the surface, its openings being
  /// closed.
  Loop shortestLoop(Index root) const {
    const Ways ways = waysFrom(root);
    Indexed<char> is_used(across_.size(), 0);
    for (const Index side : ways.last)
      if (side >= 0) {
        is_used[side] = 1;
        if (across_[side] >= 0)
          is_used[across_[side]] = 1;
      }
    std::vector<std::pair<double, Index>> edges;
    for (Index side = 0; side < across_.count(); ++side)
      if (across_[side] < side && is_used[side] == 0)
        edges.emplace_back(ways.distance[start(side)] + length(side) + ways.distance[end(side)],
                           side);
    // A tree of the dual of the other edges: those of the longest loops first.
    std::sort(edges.begin(), edges.end(), std::greater<>());
    Indexed<Index> node_across(across_.size());
    UnionFind sets = dualNodes(node_across);
    Loop loop;
    for (const auto& [length, side] : edges)
      if (!sets.unite(side / 3, node_across[side])) {
        loop.length = length;
        loop.sides.assign(1, side);
      }
    if (loop.sides.empty())
      return loop;
    const Index side = loop.sides.front();
    loop.opposite = start(side);
    std::vector<Index> there = wayBack(ways, start(side));
    std::vector<Index> back = wayBack(ways, end(side));
    while (!there.empty() && !back.empty() && there.back() == back.back()) {
      there.pop_back();
      back.pop_back();
    }
    loop.sides.insert(loop.sides.end(), there.begin(), there.end());
    loop.sides.insert(loop.sides.end(), back.begin(), back.end());
    return loop;
  }

  std::vector<Index> wayBack(const Ways& ways, Index v) const {
    std::vector<Index> sides;
    for (; ways.last[v] >= 0; v = otherEnd(sides.back(), v))
      sides.push_back(ways.last[v]);
    return sides;
  }

  /// A loop that touches openings may divide the surface: takes back what joins its pieces.
  void joinPieces() {
    UnionFind pieces(static_cast<std::size_t>(cut_.triangles.cols()));
    for (Index side = 0; side < across_.count(); ++side)
      if (across_[side] >= 0)
        pieces.unite(side / 3, across_[side] / 3);
    for (const auto& [a, b] : cuts_)
      if (pieces.unite(a / 3, b / 3)) {
        across_[a] = b;
        across_[b] = a;
      }
    cuts_.erase(std::remove_if(cuts_.begin(), cuts_.end(),
                               [&](const auto& cut) { return across_[cut[0]] >= 0; }),
                cuts_.end());
  }

  /// Gives each fan of triangles around a vertex a copy of it, the first one the vertex itself.
  void numberVertices() {
    cut_.vertex_of.resize(static_cast<std::size_t>(original_.maxCoeff()) + 1);
    Indexed<char> is_taken(cut_.vertex_of.size(), 0);
    Indexed<char> is_numbered(across_.size(), 0);
    for (Index side = 0; side < across_.count(); ++side) {
      if (is_numbered[side] != 0)
        continue;
      const Index v = original_.data()[side];
      Index copy = v;
      if (std::exchange(is_taken[v], 1) != 0) {
        copy = indexCount(cut_.vertex_of);
        cut_.vertex_of.push_back(v);
      }
      // The corner at the start of each side: first to the one end of the fan, then to the other.
      for (Index s = side; s >= 0 && is_numbered[s] == 0; s = across_[sideBefore(s)]) {
        is_numbered[s] = 1;
        cut_.triangles.data()[s] = copy;
      }
      for (Index s = across_[side]; s >= 0 && is_numbered[sideAfter(s)] == 0;
           s = across_[sideAfter(s)]) {
        is_numbered[sideAfter(s)] = 1;
        cut_.triangles.data()[sideAfter(s)] = copy;
      }
    }
    const Positions vertices = cut_.points.leftCols(is_taken.count());
    cut_.points = internal::columnsOf(vertices, cut_.vertex_of);
  }

  const Triangles& original_;
  Indexed<Index> across_;
  std::vector<std::array<Index, 2>> cuts_;  ///< both sides of each edge
  CutMesh cut_;
};

/// Closes the cuts of an atlas.
class CutJoiner {
public:
  CutJoiner(TextureAtlas atlas, const CutMesh& cut)
      : atlas_(std::move(atlas)), cut_(cut), copies_(indexCount(cut.vertex_of)),
        added_(static_cast<std::size_t>(atlas_.triangles.size())), same_(atlas_.vertices.size()) {
    for (Index i = 0; i < same_.count(); ++i)
      same_[i] = i < copies_ ? entry(cut.vertex_of, i) : i;
    for (CutVertex& vertex : atlas_.vertices)
      for (Index& v : vertex.vertices)
        v = cut.vertex_of[static_cast<std::size_t>(v)];
  }

  TextureAtlas run() {
    for (const auto& [edge, chains] : chainsOfEdges())
      if (chains.size() == 2)
        match(edge[1], chains[0], chains[1]);
    divideTriangles();
    numberVertices();
    return std::move(atlas_);
  }

private:
  /// What an edge of the mesh is divided into on one side of a cut, from its lower end.
  struct Chain {
    std::vector<Index> sides;     ///< of triangles of the atlas
    std::vector<Index> vertices;  ///< of the atlas: one more
    bool is_reversed = false;     ///< the sides run from the higher end
  };
  struct Corner {
    Index vertex;
    Index column;
  };
  struct Added {
    Index vertex;
    double fraction;  ///< of the side
  };
  using EdgeOfMesh = std::array<Index, 2>;  // {lower, higher}

  /// The chains of the edges on the boundary of the atlas.
  std::map<EdgeOfMesh, std::vector<Chain>> chainsOfEdges() const {
    const Indexed<Index> across = sidesAcross(atlas_.triangles);
    Indexed<Index> leaving(atlas_.vertices.size(), -1);  // the side of the boundary at each vertex
    for (Index side = 0; side < across.count(); ++side)
      if (across[side] < 0)
        leaving[atlas_.triangles.data()[side]] = side;
    std::map<EdgeOfMesh, std::vector<Chain>> chains;
    for (Index v = 0; v < copies_; ++v) {
      if (leaving[v] < 0)
        continue;
      Chain chain;
      chain.vertices.push_back(v);
      do {
        chain.sides.push_back(leaving[chain.vertices.back()]);
        chain.vertices.push_back(atlas_.triangles.data()[sideAfter(chain.sides.back())]);
      } while (chain.vertices.back() >= copies_);
      EdgeOfMesh edge{same_[v], same_[chain.vertices.back()]};
      chain.is_reversed = edge[0] > edge[1];
      if (chain.is_reversed) {
        std::swap(edge[0], edge[1]);
        std::reverse(chain.sides.begin(), chain.sides.end());
        std::reverse(chain.vertices.begin(), chain.vertices.end());
      }
      chains[edge].push_back(std::move(chain));
    }
    return chains;
  }

  /// Adds the vertices of each of two chains to the sides of the other.
  void match(Index higher, const Chain& one, const Chain& other) {
    const std::vector<double> of_one = places(higher, one);
    const std::vector<double> of_other = places(higher, other);
    std::size_t i = 1;
    std::size_t j = 1;
    while (i < one.sides.size() || j < other.sides.size()) {
      if (i < one.sides.size() && j < other.sides.size() && of_one[i] == of_other[j]) {
        same_[other.vertices[j]] = one.vertices[i];
        ++i;
        ++j;
      } else if (j == other.sides.size() || (i < one.sides.size() && of_one[i] < of_other[j])) {
        add(other, j - 1, of_other, one.vertices[i], of_one[i]);
        ++i;
      } else {
        add(one, i - 1, of_one, other.vertices[j], of_other[j]);
        ++j;
      }
    }
  }

  /// Where the vertices of a chain are on their edge, ascending in [0, 1].
  std::vector<double> places(Index higher, const Chain& chain) const {
    std::vector<double> result = {0.0};
    for (std::size_t i = 1; i < chain.sides.size(); ++i) {
      const CutVertex& vertex = entry(atlas_.vertices, chain.vertices[i]);
      double place = 0.0;
      for (Index k = 0; k < 3; ++k)
        place += entry(vertex.vertices, k) == higher ? vertex.weights[k] : 0.0;
      result.push_back(std::clamp(place, result.back(), 1.0));
    }
    result.push_back(1.0);
    return result;
  }

  void add(const Chain& chain, std::size_t piece, const std::vector<double>& places_of_chain,
           Index vertex, double place) {
    const double from = places_of_chain[piece];
    const double to = places_of_chain[piece + 1];
    const double fraction = to > from ? (place - from) / (to - from) : 0.5;
    std::vector<Added>& list = added_[chain.sides[piece]];
    if (chain.is_reversed)
      list.insert(list.begin(), {vertex, 1.0 - fraction});
    else
      list.push_back({vertex, fraction});
  }

  void divideTriangles() {
    std::vector<std::array<Corner, 3>> parts;
    std::vector<Index> source;
    std::vector<Eigen::Vector2d> columns;
    for (Index t = 0; t < atlas_.triangles.cols(); ++t) {
      std::array<Corner, 3> corners{};
      for (Index k = 0; k < 3; ++k)
        entry(corners, k) = {atlas_.triangles(k, t), atlas_.coordinate_triangles(k, t)};
      divide(corners, {added_[3 * t], added_[3 * t + 1], added_[3 * t + 2]}, columns, parts);
      source.resize(parts.size(), entry(atlas_.source, t));
    }
    const Eigen::Index count = atlas_.coordinates.cols();
    atlas_.coordinates.conservativeResize(2, count + indexCount(columns));
    for (Index i = 0; i < indexCount(columns); ++i)
      atlas_.coordinates.col(count + i) = entry(columns, i);
    atlas_.triangles.resize(3, indexCount(parts));
    atlas_.coordinate_triangles.resize(3, indexCount(parts));
    for (Index t = 0; t < indexCount(parts); ++t)
      for (Index k = 0; k < 3; ++k) {
        atlas_.triangles(k, t) = entry(entry(parts, t), k).vertex;
        atlas_.coordinate_triangles(k, t) = entry(entry(parts, t), k).column;
      }
    atlas_.source = std::move(source);
  }

  /// Divides a triangle along one side after the other.
  ///
  /// \param added vertices on each side.
  void divide(const std::array<Corner, 3>& corners, const std::array<std::vector<Added>, 3>& added,
              std::vector<Eigen::Vector2d>& columns, std::vector<std::array<Corner, 3>>& parts) {
    std::size_t k = 0;
    while (k < 3 && added[k].empty())
      ++k;
    if (k == 3) {
      parts.push_back(corners);
      return;
    }
    const Corner& last = corners[(k + 1) % 3];
    const Corner& apex = corners[(k + 2) % 3];
    const Eigen::Vector2d from = atlas_.coordinates.col(corners[k].column);
    const Eigen::Vector2d to = atlas_.coordinates.col(last.column);
    Corner previous = corners[k];
    for (std::size_t i = 0; i <= added[k].size(); ++i) {
      Corner next = last;
      if (i < added[k].size()) {
        const double fraction = added[k][i].fraction;
        next = {added[k][i].vertex,
                static_cast<Index>(atlas_.coordinates.cols()) + indexCount(columns)};
        columns.emplace_back((1.0 - fraction) * from + fraction * to);
      }
      std::array<std::vector<Added>, 3> left;
      if (i == 0)
        left[2] = added[(k + 2) % 3];
      if (i == added[k].size())
        left[1] = added[(k + 1) % 3];
      divide({previous, next, apex}, left, columns, parts);
      previous = next;
    }
  }

  /// Leaves out the copies.
  void numberVertices() {
    Indexed<Index> number(same_.size(), -1);
    std::vector<CutVertex> vertices;
    const Index count = *std::max_element(cut_.vertex_of.begin(), cut_.vertex_of.end()) + 1;
    for (Index i = 0; i < same_.count(); ++i)
      if (same_[i] == i && (i < count || i >= copies_)) {
        number[i] = indexCount(vertices);
        vertices.push_back(entry(atlas_.vertices, i));
      }
    for (Index& v : atlas_.triangles.reshaped())
      v = number[same_[v]];
    atlas_.vertices = std::move(vertices);
  }

  TextureAtlas atlas_;
  const CutMesh& cut_;
  Index copies_;  ///< the first vertices of the atlas, all those of the cut mesh
  Indexed<std::vector<Added>> added_;  ///< to each side, in its direction
  Indexed<Index> same_;  ///< the vertex that each is in the joined atlas, before it is renumbered
};

}  // namespace

CutMesh cutHandles(const Positions& points, const Triangles& triangles) {
  const MeshTopology topology = checkTopology(triangles, internal::columnCount(points));
  if (!topology.isSurface())
    throw InvalidInput("cutHandles: the triangles are not an oriented manifold in one piece over "
                       "all vertices; give a mesh as reconstruct() makes it");
  if (!points.allFinite())
    throw InvalidInput("cutHandles: a coordinate of a vertex is not finite; remove such points "
                       "first");
  HandleCutter cutter(points, triangles);
  for (long long g = topology.genus.value_or(0); g > 0; --g)
    cutter.cutOne();
  return cutter.take();
}

TextureAtlas joinCuts(TextureAtlas atlas, const CutMesh& cut) {
  const std::size_t vertices = internal::columnCount(cut.points);
  const bool fits =
      cut.vertex_of.size() == vertices && atlas.vertices.size() >= vertices &&
      std::all_of(atlas.vertices.begin(), atlas.vertices.end(), [&](const auto& v) {
        return *std::min_element(v.vertices.begin(), v.vertices.end()) >= 0 &&
               static_cast<std::size_t>(*std::max_element(v.vertices.begin(), v.vertices.end())) <
                   vertices;
      });
  if (!fits)
    throw InvalidInput("joinCuts: the atlas is not that of the mesh that was cut; give the one "
                       "that makeTextureAtlas() makes of its triangles");
  if (cut.triangles.cols() == 0 || vertices == static_cast<std::size_t>(*std::max_element(
                                                   cut.vertex_of.begin(), cut.vertex_of.end())) +
                                                   1)
    return atlas;
  return CutJoiner(std::move(atlas), cut).run();
}

}  // namespace spherical_param
