#include "sphere_cutting.h"

#include "index_loops.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>

namespace spherical_param::internal {
namespace {

using Eigen::Vector3d;

constexpr std::array<std::array<int, 3>, kCutPlanes> plane_normals = {{
    {1, 0, 0},
    {0, 1, 0},
    {0, 0, 1},
    {1, -1, 0},
    {1, 1, 0},
    {1, 0, -1},
    {1, 0, 1},
    {0, 1, -1},
    {0, 1, 1},
}};

Vector3d normalOf(int plane) {
  const auto& n = entry(plane_normals, plane);
  return Vector3d(n[0], n[1], n[2]);
}

/// The direction that two planes have in common, one of its two; components are 1, 0 and -1.
Vector3d commonDirection(int plane, int other) {
  const Vector3d direction = normalOf(plane).cross(normalOf(other));
  return direction / direction.cwiseAbs().maxCoeff();
}

std::int8_t compare(double a, double b) {
  return static_cast<std::int8_t>((a > b) - (a < b));
}

int signAt(const PlaneSigns& signs, int plane) {
  return entry(signs, plane);
}

/// Moves a point onto the planes where its signs are 0, from which it is off by rounding alone.
Vector3d onPlanes(const Vector3d& point, const PlaneSigns& signs, const std::vector<int>& planes) {
  std::vector<int> touched;
  std::copy_if(planes.begin(), planes.end(), std::back_inserter(touched),
               [&](int plane) { return signAt(signs, plane) == 0; });
  if (touched.empty())
    return point;
  if (touched.size() == 1) {
    const Vector3d normal = normalOf(touched.front());
    Vector3d result = point;
    // Both coordinates of a diagonal plane end at the same number, or at one and its negative.
    Eigen::Index first = 0;
    normal.cwiseAbs().maxCoeff(&first);
    for (Eigen::Index other = first + 1; other < 3; ++other)
      if (normal[other] != 0.0) {
        const double sign = -normal[first] * normal[other];
        result[first] = (point[first] + sign * point[other]) / 2.0;
        result[other] = sign * result[first];
        return result;
      }
    result[first] = 0.0;
    return result;
  }
  const Vector3d direction = commonDirection(touched[0], touched[1]);
  return direction * (point.dot(direction) / direction.squaredNorm());
}

/// A corner of a polygon in a triangle of the mesh, by its origin.
struct Corner {
  enum class Kind { Vertex, OnEdge, Inside };

  Kind kind = Kind::Vertex;
  Index a = 0;                            ///< the vertex, or the lower end of the edge
  Index b = 0;                            ///< the upper end of the edge
  int plane = 0;                          ///< that cuts the edge
  Vector3d direction = Vector3d::Zero();  ///< of a point inside
  PlaneSigns signs{};                     ///< on which side of each plane it is
  int line = 0;  ///< of the side that begins here: 0, 1, 2 side of the triangle, then 3 + plane
};

using Polygon = std::vector<Corner>;

class Cutter {
public:
  Cutter(const Triangles& triangles, const Positions& sphere, const SphereCells& cells, int apex)
      : triangles_(triangles), sphere_(sphere), cells_(cells), apex_(apex) {
    std::array<bool, kCutPlanes> used{};
    for (const std::vector<CellSide>& cell : cells)
      for (const CellSide& side : cell)
        entry(used, side.plane) = true;
    for (int plane = 0; plane < kCutPlanes; ++plane)
      if (entry(used, plane))
        planes_.push_back(plane);
  }

  CutSphere run() {
    for (Index v = 0; v < sphere_.cols(); ++v) {
      signs_.push_back(planeSigns(sphere_.col(v)));
      result_.vertices.push_back({{v, v, v}, Vector3d::UnitX()});
      result_.points.emplace_back(sphere_.col(v));
    }
    result_.triangles.reserve(columnCount(triangles_));
    for (Index t = 0; t < triangles_.cols(); ++t)
      cutTriangle(t);
    return std::move(result_);
  }

private:
  void cutTriangle(Index t) {
    const std::array<Index, 3> corners = {triangles_(0, t), triangles_(1, t), triangles_(2, t)};
    for (Index c = 0; c < indexCount(cells_); ++c)
      if (std::all_of(corners.begin(), corners.end(),
                      [&](Index v) { return isInCell(signs_[v], cells_[c]); })) {
        add(corners, c, t);
        return;
      }
    triangle_ = t;
    inside_.clear();
    for (Index c = 0; c < indexCount(cells_); ++c) {
      Polygon polygon;
      for (const Index v : corners) {
        Corner corner;
        corner.a = v;
        corner.signs = signs_[v];
        corner.line = indexCount(polygon);
        polygon.push_back(corner);
      }
      for (const CellSide& side : cells_[c]) {
        polygon = clipped(polygon, side);
        if (polygon.empty())
          break;
      }
      addPolygon(polygon, c);
    }
  }

  /// The part of a polygon on one side of a plane, empty if it has no area. A strictly convex
  /// polygon stays strictly convex, so that the order of its corners is enough to describe it.
  Polygon clipped(const Polygon& polygon, const CellSide& side) const {
    const auto sign_of = [&](const Corner& corner) {
      return side.sign * signAt(corner.signs, side.plane);
    };
    if (std::none_of(polygon.begin(), polygon.end(),
                     [&](const Corner& corner) { return sign_of(corner) > 0; }))
      return {};
    Polygon result;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Corner& corner = polygon[i];
      const Corner& next = polygon[(i + 1) % polygon.size()];
      const int here = sign_of(corner);
      const int there = sign_of(next);
      if (here >= 0) {
        result.push_back(corner);
        if (here == 0 && there < 0)
          result.back().line = 3 + side.plane;
      }
      if (here * there < 0) {
        result.push_back(crossing(corner.line, side.plane));
        result.back().line = here > 0 ? 3 + side.plane : corner.line;
      }
    }
    return result;
  }

  /// The point where a plane crosses a line, which is within the triangle.
  Corner crossing(int line, int plane) const {
    return line < 3 ? pointOnEdge(line, plane) : pointInside(line - 3, plane);
  }

  Corner pointOnEdge(int side, int plane) const {
    Corner corner;
    corner.kind = Corner::Kind::OnEdge;
    corner.a = triangles_(side, triangle_);
    corner.b = triangles_((side + 1) % 3, triangle_);
    if (corner.b < corner.a)
      std::swap(corner.a, corner.b);
    const PlaneSigns& of_a = signs_[corner.a];
    const PlaneSigns& of_b = signs_[corner.b];
    for (int q = 0; q < kCutPlanes; ++q) {
      std::int8_t& sign = entry(corner.signs, q);
      if (q == plane) {
        sign = 0;
      } else if (signAt(of_a, q) * signAt(of_b, q) >= 0) {
        sign = static_cast<std::int8_t>(signAt(of_a, q) != 0 ? signAt(of_a, q) : signAt(of_b, q));
      } else {
        // The point is (p . a) b - (p . b) a up to its sign, and Lagrange's identity makes its
        // product with q the determinant of a, b and p x q.
        sign = static_cast<std::int8_t>(
            signAt(of_a, plane) * determinantSign(sphere_.col(corner.a), sphere_.col(corner.b),
                                                  normalOf(plane).cross(normalOf(q))));
      }
    }
    // Several planes may cross the edge in one point: it goes by the first of them.
    corner.plane = *std::find_if(planes_.begin(), planes_.end(), [&](int q) {
      return signAt(corner.signs, q) == 0 && signAt(of_a, q) * signAt(of_b, q) < 0;
    });
    return corner;
  }

  Corner pointInside(int plane, int other) const {
    Corner corner;
    corner.kind = Corner::Kind::Inside;
    corner.direction = commonDirection(plane, other);
    // Of the two directions, one is inside.
    for (int k = 0; k < 3; ++k) {
      const int sign =
          determinantSign(sphere_.col(triangles_(k, triangle_)),
                          sphere_.col(triangles_((k + 1) % 3, triangle_)), corner.direction);
      if (sign != 0) {
        corner.direction *= sign;
        break;
      }
    }
    corner.signs = planeSigns(corner.direction);
    return corner;
  }

  /// Cuts a convex polygon into triangles.
  void addPolygon(const Polygon& polygon, Index cell) {
    if (polygon.empty())
      return;
    std::size_t first = 0;
    for (std::size_t i = 0; apex_ >= 0 && i < polygon.size(); ++i)
      if (std::all_of(polygon[i].signs.begin(), polygon[i].signs.begin() + apex_ + 1,
                      [](std::int8_t sign) { return sign == 0; }))
        first = i;
    std::vector<Index> vertices;
    for (std::size_t i = 0; i < polygon.size(); ++i)
      vertices.push_back(vertexOf(polygon[(first + i) % polygon.size()]));
    for (std::size_t i = 1; i + 1 < vertices.size(); ++i)
      add({vertices[0], vertices[i], vertices[i + 1]}, cell, triangle_);
  }

  void add(const std::array<Index, 3>& triangle, Index cell, Index source) {
    result_.triangles.push_back(triangle);
    result_.cells.push_back(cell);
    result_.source.push_back(source);
  }

  Index vertexOf(const Corner& corner) {
    switch (corner.kind) {
    case Corner::Kind::OnEdge: {
      const auto [entry, is_new] =
          on_edges_.try_emplace({corner.a, corner.b, corner.plane}, nextVertex());
      if (is_new)
        addOnEdge(corner);
      return entry->second;
    }
    case Corner::Kind::Inside:
      for (const auto& [direction, vertex] : inside_)
        if (direction == corner.direction)
          return vertex;
      inside_.emplace_back(corner.direction, nextVertex());
      addInside(corner);
      return inside_.back().second;
    case Corner::Kind::Vertex:
      break;
    }
    return corner.a;
  }

  Index nextVertex() const { return indexCount(result_.vertices); }

  void addOnEdge(const Corner& corner) {
    const Vector3d a = sphere_.col(corner.a);
    const Vector3d b = sphere_.col(corner.b);
    const double from_a = std::abs(normalOf(corner.plane).dot(a));
    const double from_b = std::abs(normalOf(corner.plane).dot(b));
    const double fraction = from_a / (from_a + from_b);
    result_.vertices.push_back({{corner.a, corner.b, corner.b}, {1.0 - fraction, fraction, 0.0}});
    result_.points.push_back(onPlanes((1.0 - fraction) * a + fraction * b, corner.signs, planes_));
  }

  void addInside(const Corner& corner) {
    CutVertex vertex;
    for (int k = 0; k < 3; ++k) {
      entry(vertex.vertices, k) = triangles_(k, triangle_);
      // Rounding may make a tiny weight negative.
      vertex.weights[k] = std::max(
          0.0, corner.direction.dot(sphere_.col(triangles_((k + 1) % 3, triangle_))
                                        .cross(sphere_.col(triangles_((k + 2) % 3, triangle_)))));
    }
    vertex.weights = withSumOne(vertex.weights);
    const Vector3d point = blend(sphere_, triangles_, triangle_, vertex.weights);
    result_.vertices.push_back(vertex);
    result_.points.push_back(onPlanes(point, corner.signs, planes_));
  }

  const Triangles& triangles_;
  const Positions& sphere_;
  const SphereCells& cells_;
  int apex_;
  std::vector<int> planes_;  // of the cells
  Indexed<PlaneSigns> signs_;
  Index triangle_ = 0;                              // that is being cut
  std::vector<std::pair<Vector3d, Index>> inside_;  // vertices inside of it
  std::map<std::array<Index, 3>, Index> on_edges_;  // ends and plane -> vertex
  CutSphere result_;
};

}  // namespace

PlaneSigns planeSigns(const Vector3d& d) {
  return {compare(d.x(), 0.0),    compare(d.y(), 0.0),    compare(d.z(), 0.0),
          compare(d.x(), d.y()),  compare(d.x(), -d.y()), compare(d.x(), d.z()),
          compare(d.x(), -d.z()), compare(d.y(), d.z()),  compare(d.y(), -d.z())};
}

bool isInCell(const PlaneSigns& signs, const std::vector<CellSide>& cell) {
  return std::all_of(cell.begin(), cell.end(), [&](const CellSide& side) {
    return side.sign * signAt(signs, side.plane) >= 0;
  });
}

CutSphere cutSphere(const Triangles& triangles, const Positions& sphere, const SphereCells& cells,
                    int apex) {
  return Cutter(triangles, sphere, cells, apex).run();
}

}  // namespace spherical_param::internal
