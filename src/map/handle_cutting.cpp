#include "spherical_param/map/handle_cutting.h"

#include "corner_table.h"
#include "index_loops.h"
#include "input_checks.h"
#include "shortest_paths.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "triangle_geometry.h"
#include "union_find.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <string>
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
  ends.reserve(static_cast<std::size_t>(triangles.size()));
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
  explicit HandleCutter(CutMesh mesh)
      : original_(mesh.triangles), vertex_count_(indexCount(mesh.vertex_of)),
        scaled_(internal::scaledToUnit(mesh.points)), across_(sidesAcross(original_)),
        cut_(std::move(mesh)) {}

  void cutOne() {
    // A loop is shortened at most so often: each time costs a search.
    constexpr int max_searches = 8;
    Loop loop = shortestLoop(0);
    for (int i = 1; i < max_searches; ++i) {
      Loop other = shortestLoop(loop.opposite);
      if (!(other.length < loop.length))
        break;
      loop = std::move(other);
    }
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
    return (scaled_.col(original_.data()[side]) - scaled_.col(original_.data()[sideAfter(side)]))
        .norm();
  }

  /// The shortest ways from a vertex.
  struct Ways {
    Indexed<double> distance;
    Indexed<Index> last;  ///< the side along which each vertex is reached, in either direction
  };

  Ways waysFrom(Index root) const {
    const std::size_t n = cut_.vertex_of.size();
    const CornerTable corners(cut_.triangles, n, 1);
    Ways ways{Indexed<double>(n, std::numeric_limits<double>::infinity()), Indexed<Index>(n, -1)};
    internal::shortestPaths(root, ways.distance, [&](Index v, const auto& go) {
      corners.forEachCorner(v, [&](Index t, Index k) {
        for (const Index side : {3 * t + k, sideBefore(3 * t + k)})
          if (const Index w = otherEnd(side, v); go(w, length(side)))
            ways.last[w] = side;
      });
    });
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
    cut_.vertex_of.resize(static_cast<std::size_t>(vertex_count_));
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
    cut_.points = Positions(cut_.points(Eigen::all, cut_.vertex_of));
  }

  Triangles original_;
  Index vertex_count_;  ///< of the mesh
  Positions scaled_;    ///< its vertices, of any unit
  Indexed<Index> across_;
  std::vector<std::array<Index, 2>> cuts_;  ///< both sides of each edge
  CutMesh cut_;
};

/// Closes the cuts of an atlas.
class CutJoiner {
public:
  CutJoiner(TextureAtlas atlas, const CutMesh& cut)
      : atlas_(std::move(atlas)), copies_(indexCount(cut.vertex_of)),
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
    for (Index i = 0; i < same_.count(); ++i)
      if (same_[i] == i) {
        number[i] = indexCount(vertices);
        vertices.push_back(entry(atlas_.vertices, i));
      }
    for (Index& v : atlas_.triangles.reshaped())
      v = number[same_[v]];
    atlas_.vertices = std::move(vertices);
  }

  TextureAtlas atlas_;
  Index copies_;  ///< the first vertices of the atlas, all those of the cut mesh
  Indexed<std::vector<Added>> added_;  ///< to each side, in its direction
  Indexed<Index> same_;  ///< the vertex that each is in the joined atlas, before it is renumbered
};

/// Sides are numbered by Index.
void checkSize(const char* function, const Triangles& triangles) {
  if (triangles.size() > std::numeric_limits<Index>::max())
    throw InvalidInput(std::string(function) + ": " + std::to_string(triangles.cols()) +
                       " triangles are too many; simplify the mesh");
}

/// Whether each vertex is one of the first ones, which are themselves.
bool areCopies(const std::vector<Index>& vertex_of) {
  const auto copies = std::adjacent_find(vertex_of.begin(), vertex_of.end(),
                                         [](Index v, Index w) { return w != v + 1; });
  if (vertex_of.empty() || vertex_of.front() != 0)
    return false;
  const auto first = copies == vertex_of.end() ? copies : copies + 1;
  return std::all_of(first, vertex_of.end(),
                     [&](Index v) { return v >= 0 && v < first - vertex_of.begin(); });
}

}  // namespace

CutMesh cutHandles(const Positions& points, const Triangles& triangles) {
  checkSize("cutHandles", triangles);
  const MeshTopology topology = checkTopology(triangles, internal::columnCount(points));
  if (!topology.isSurface())
    throw InvalidInput("cutHandles: the triangles are not an oriented manifold in one piece over "
                       "all vertices; give a mesh in one piece, of topology = sphere if need be");
  if (!points.allFinite())
    throw InvalidInput("cutHandles: a coordinate of a vertex is not finite; remove such points "
                       "first");
  CutMesh mesh{points, triangles, std::vector<Index>(internal::columnCount(points))};
  std::iota(mesh.vertex_of.begin(), mesh.vertex_of.end(), Index{0});
  if (topology.genus == 0)
    return mesh;
  HandleCutter cutter(std::move(mesh));
  for (long long g = *topology.genus; g > 0; --g)
    cutter.cutOne();
  return cutter.take();
}

TextureAtlas joinCuts(TextureAtlas atlas, const CutMesh& cut) {
  internal::checkAtlas("joinCuts", atlas);
  checkSize("joinCuts", atlas.triangles);
  const auto copies = static_cast<Index>(cut.vertex_of.size());
  const bool fits =
      areCopies(cut.vertex_of) && atlas.vertices.size() >= cut.vertex_of.size() &&
      atlas.source.size() == internal::columnCount(atlas.triangles) &&
      std::all_of(atlas.vertices.begin(), atlas.vertices.end(), [&](const CutVertex& vertex) {
        const auto [lowest, highest] =
            std::minmax_element(vertex.vertices.begin(), vertex.vertices.end());
        return *lowest >= 0 && *highest < copies;
      });
  if (!fits)
    throw InvalidInput("joinCuts: the atlas is not that of the mesh that was cut; give the one "
                       "that makeTextureAtlas() makes of its triangles");
  if (cut.vertex_of.back() == copies - 1)
    return atlas;
  if (!checkTopology(atlas.triangles, atlas.vertices.size()).isOpenSurface())
    throw InvalidInput("joinCuts: the triangles of the atlas are no cut surface; give the atlas "
                       "that makeTextureAtlas() makes of the triangles that cutHandles() made");
  return CutJoiner(std::move(atlas), cut).run();
}

}  // namespace spherical_param
