#include "mesh_quality.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

namespace spherical_param::benchmark {
namespace {

/// Disjoint sets of [0, n).
class Sets {
public:
  explicit Sets(std::size_t n) : parents_(n) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }

  std::size_t find(std::size_t i) {
    while (parents_[i] != i)
      i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) { parents_[find(i)] = find(j); }

private:
  std::vector<std::size_t> parents_;
};

/// A side of a triangle. Corners are numbered 3 t + k.
struct Side {
  Index low;   ///< the lower of its vertices
  Index high;  ///< the other one
  std::size_t low_corner;
  std::size_t high_corner;

  std::size_t triangle() const { return low_corner / 3; }
  bool ascends() const { return (low_corner + 1) % 3 == high_corner % 3; }
  bool isAlong(const Side& other) const { return low == other.low && high == other.high; }
};

bool isDegenerate(const Triangles& triangles, Eigen::Index t) {
  return triangles(0, t) == triangles(1, t) || triangles(1, t) == triangles(2, t) ||
         triangles(2, t) == triangles(0, t);
}

/// The sides of the triangles that are not degenerate, those of an edge one after the other.
std::vector<Side> sidesByEdge(const Triangles& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * static_cast<std::size_t>(triangles.cols()));
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    if (isDegenerate(triangles, t))
      continue;
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      Side side{triangles(k, t), triangles(next, t), static_cast<std::size_t>(3 * t + k),
                static_cast<std::size_t>(3 * t + next)};
      if (side.low > side.high) {
        std::swap(side.low, side.high);
        std::swap(side.low_corner, side.high_corner);
      }
      sides.push_back(side);
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.low != b.low     ? a.low < b.low
           : a.high != b.high ? a.high < b.high
                              : a.low_corner < b.low_corner;
  });
  return sides;
}

std::vector<char> usedVertices(const Mesh& mesh) {
  std::vector<char> used(static_cast<std::size_t>(mesh.points.cols()), 0);
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    if (!isDegenerate(mesh.triangles, t))
      for (int k = 0; k < 3; ++k)
        used[static_cast<std::size_t>(mesh.triangles(k, t))] = 1;
  return used;
}

/// The positions of the used vertices.
Positions usedPositions(const Mesh& mesh) {
  const std::vector<char> used = usedVertices(mesh);
  Positions positions(3, std::count(used.begin(), used.end(), 1));
  Eigen::Index end = 0;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] != 0)
      positions.col(end++) = mesh.points.col(static_cast<Eigen::Index>(v));
  return positions;
}

Positions inSinglePrecision(const Positions& positions) {
  return positions.cast<float>().cast<double>();
}

/// The different places of points, numbered.
class Places {
public:
  explicit Places(const Positions& points) {
    places_.reserve(static_cast<std::size_t>(points.cols()));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      places_.push_back(keyOf(points.col(i)));
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
  }

  Count size() const { return static_cast<Count>(places_.size()); }
  bool contains(const Eigen::Vector3d& point) const {
    return std::binary_search(places_.begin(), places_.end(), keyOf(point));
  }
  /// The number of a place that is there.
  Count at(const Eigen::Vector3d& point) const {
    return std::lower_bound(places_.begin(), places_.end(), keyOf(point)) - places_.begin();
  }

private:
  using Key = std::array<double, 3>;

  static Key keyOf(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

  std::vector<Key> places_;  ///< ascending; -0 and 0 are equal
};

Count countIn(const Positions& points, const Places& places) {
  Count count = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    count += places.contains(points.col(i)) ? 1 : 0;
  return count;
}

Positions finiteOnes(const Positions& points) {
  Positions finite(3, points.cols());
  Eigen::Index end = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (points.col(i).allFinite())
      finite.col(end++) = points.col(i);
  return finite.leftCols(end);
}

/// Edges between places, ascending, each once.
std::vector<std::pair<Count, Count>> edgesBetween(const Places& places, const Positions& points,
                                                  const Triangles& triangles) {
  std::vector<Count> place_of(static_cast<std::size_t>(points.cols()));
  for (std::size_t v = 0; v < place_of.size(); ++v)
    place_of[v] = places.at(points.col(static_cast<Eigen::Index>(v)));
  std::vector<std::pair<Count, Count>> edges;
  for (const Side& side : sidesByEdge(triangles)) {
    const Count a = place_of[static_cast<std::size_t>(side.low)];
    const Count b = place_of[static_cast<std::size_t>(side.high)];
    edges.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// Walks over the edges and joins what hangs together.
class Surveyor {
public:
  explicit Surveyor(const Mesh& mesh)
      : mesh_(mesh), pieces_(vertexCount()), loops_(vertexCount()), on_boundary_(vertexCount(), 0),
        fans_(3 * triangleCount()), turns_(2 * triangleCount()) {}

  Connectivity survey();

private:
  using SideIterator = std::vector<Side>::const_iterator;

  std::size_t vertexCount() const { return static_cast<std::size_t>(mesh_.points.cols()); }
  std::size_t triangleCount() const { return static_cast<std::size_t>(mesh_.triangles.cols()); }

  void visitEdge(SideIterator begin, SideIterator end);
  void visitManifoldEdge(const Side& side, const Side& other);
  Count countNonmanifoldVertices();
  bool isOrientable();

  const Mesh& mesh_;
  Connectivity found_;
  Sets pieces_;  ///< of vertices: connected by edges
  Sets loops_;   ///< of vertices: connected by boundary edges
  std::vector<char> on_boundary_;
  Sets fans_;   ///< of corners: at the same vertex, connected across manifold edges
  Sets turns_;  ///< of triangles as they are (2 t) and turned over (2 t + 1): they fit each other
};

Connectivity Surveyor::survey() {
  const std::vector<Side> sides = sidesByEdge(mesh_.triangles);
  found_.triangles = static_cast<Count>(sides.size() / 3);
  found_.degenerate_triangles = mesh_.triangles.cols() - found_.triangles;
  found_.oriented = true;
  for (auto begin = sides.begin(); begin != sides.end();) {
    const auto end =
        std::find_if(begin, sides.end(), [&](const Side& side) { return !side.isAlong(*begin); });
    visitEdge(begin, end);
    begin = end;
  }
  const std::vector<char> used = usedVertices(mesh_);
  for (std::size_t v = 0; v < used.size(); ++v) {
    found_.vertices += used[v];
    found_.components += used[v] != 0 && pieces_.find(v) == v ? 1 : 0;
    found_.boundary_loops += on_boundary_[v] != 0 && loops_.find(v) == v ? 1 : 0;
  }
  found_.unreferenced_vertices = mesh_.points.cols() - found_.vertices;
  found_.nonmanifold_vertices = countNonmanifoldVertices();
  found_.orientable = isOrientable();
  found_.euler_characteristic = found_.vertices - found_.edges + found_.triangles;
  found_.closed =
      found_.triangles > 0 && found_.boundary_edges == 0 && found_.nonmanifold_edges == 0;
  if (found_.closed && found_.vertexManifold() && found_.degenerate_triangles == 0 &&
      found_.orientable)
    found_.genus = (2 * found_.components - found_.euler_characteristic) / 2;
  return found_;
}

void Surveyor::visitEdge(SideIterator begin, SideIterator end) {
  const auto low = static_cast<std::size_t>(begin->low);
  const auto high = static_cast<std::size_t>(begin->high);
  ++found_.edges;
  pieces_.join(low, high);
  const std::ptrdiff_t count = end - begin;
  const std::ptrdiff_t ascending =
      std::count_if(begin, end, [](const Side& side) { return side.ascends(); });
  if (ascending > 1 || count - ascending > 1)
    found_.oriented = false;
  if (count == 1) {
    ++found_.boundary_edges;
    loops_.join(low, high);
    on_boundary_[low] = on_boundary_[high] = 1;
  } else if (count == 2) {
    visitManifoldEdge(*begin, *(begin + 1));
  } else {
    ++found_.nonmanifold_edges;
  }
}

void Surveyor::visitManifoldEdge(const Side& side, const Side& other) {
  fans_.join(side.low_corner, other.low_corner);
  fans_.join(side.high_corner, other.high_corner);
  const std::size_t turned = side.ascends() == other.ascends() ? 1 : 0;
  turns_.join(2 * side.triangle(), 2 * other.triangle() + turned);
  turns_.join(2 * side.triangle() + 1, 2 * other.triangle() + 1 - turned);
}

Count Surveyor::countNonmanifoldVertices() {
  std::vector<Count> fans(vertexCount(), 0);
  for (Eigen::Index t = 0; t < mesh_.triangles.cols(); ++t) {
    if (isDegenerate(mesh_.triangles, t))
      continue;
    for (int k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(3 * t + k);
      if (fans_.find(corner) == corner)
        ++fans[static_cast<std::size_t>(mesh_.triangles(k, t))];
    }
  }
  return std::count_if(fans.begin(), fans.end(), [](Count count) { return count > 1; });
}

bool Surveyor::isOrientable() {
  for (std::size_t t = 0; t < triangleCount(); ++t)
    if (turns_.find(2 * t) == turns_.find(2 * t + 1))
      return false;
  return true;
}

}  // namespace

Connectivity measureConnectivity(const Mesh& mesh) {
  return Surveyor(mesh).survey();
}

Count countRepeatedVertices(const Mesh& mesh) {
  const Positions used = usedPositions(mesh);
  return used.cols() - Places(used).size();
}

CloudCoverage measureCloudCoverage(const Mesh& mesh, const Positions& cloud) {
  const Positions points = inSinglePrecision(finiteOnes(cloud));
  const Positions vertices = inSinglePrecision(usedPositions(mesh));
  CloudCoverage coverage;
  coverage.points = points.cols();
  coverage.points_used = countIn(points, Places(vertices));
  coverage.extra_vertices = vertices.cols() - countIn(vertices, Places(points));
  return coverage;
}

bool isOverCloud(const Mesh& mesh, const Positions& cloud) {
  const Positions vertices = inSinglePrecision(usedPositions(mesh));
  const Count at_points = countIn(vertices, Places(inSinglePrecision(finiteOnes(cloud))));
  return 100 * at_points >= 99 * vertices.cols();
}

EdgeAgreement compareEdges(const Mesh& mesh, const Mesh& truth) {
  const Positions points = inSinglePrecision(mesh.points);
  const Positions truth_points = inSinglePrecision(truth.points);
  Positions all(3, points.cols() + truth_points.cols());
  all << points, truth_points;
  const Places places(all);
  const auto edges = edgesBetween(places, points, mesh.triangles);
  const auto truth_edges = edgesBetween(places, truth_points, truth.triangles);
  std::vector<std::pair<Count, Count>> common;
  std::set_intersection(edges.begin(), edges.end(), truth_edges.begin(), truth_edges.end(),
                        std::back_inserter(common));
  const auto share = [&](std::size_t of) {
    return of == 0 ? 0.0 : static_cast<double>(common.size()) / static_cast<double>(of);
  };
  return {share(truth_edges.size()), share(edges.size())};
}

}  // namespace spherical_param::benchmark
