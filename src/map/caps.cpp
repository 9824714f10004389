#include "caps.h"

#include "boundary_loops.h"
#include "index_loops.h"
#include "pi.h"
#include "ringed_disc.h"
#include "spherical_param/mesh_topology.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <functional>
#include <numeric>
#include <vector>

namespace spherical_param::internal {
namespace {

using Eigen::Vector3d;

/// Adds a cap to the coordinates and the corners of others.
void addCap(const Positions& points, const std::vector<Index>& loop, std::vector<double>& added,
            std::vector<Index>& corners) {
  std::vector<double> lengths(1, 0.0);  // from the first vertex to each
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vector3d a = points.col(loop[i]);
    const Vector3d b = points.col(loop[(i + 1) % loop.size()]);
    lengths.push_back(lengths.back() + (b - a).norm());
    moment += 0.5 * (lengths[i + 1] - lengths[i]) * (a + b);
  }
  Vector3d center = points.col(loop.front());
  if (lengths.back() > 0.0)
    center = moment / lengths.back();
  else
    std::iota(lengths.begin(), lengths.end(), 0.0);
  std::vector<double> angles(loop.size());
  for (std::size_t i = 0; i < loop.size(); ++i)
    angles[i] = 2.0 * kPi * (lengths[i] / lengths.back());
  const RingedDisc disc = ringedDisc(angles);

  const Index loop_size = indexCount(loop);
  const Index first = static_cast<Index>(points.cols()) + indexCount(added) / 3;
  for (const Index v : disc.triangles.reshaped())
    corners.push_back(v < loop_size ? entry(loop, v) : first + v - loop_size);
  // The last vertex of the loop before each angle; rings begin at angle 0.
  std::size_t before = 0;
  for (std::size_t i = loop.size(); i < disc.radii.size(); ++i) {
    const double angle = disc.angles[i];
    if (angle < angles[before])
      before = 0;
    while (before + 1 < angles.size() && angles[before + 1] <= angle)
      ++before;
    const double end = before + 1 < angles.size() ? angles[before + 1] : 2.0 * kPi;
    const double fraction = (angle - angles[before]) / (end - angles[before]);
    const Vector3d on_loop = (1.0 - fraction) * points.col(loop[before]) +
                             fraction * points.col(loop[(before + 1) % loop.size()]);
    const Vector3d point = center + disc.radii[i] * (on_loop - center);
    added.insert(added.end(), point.begin(), point.end());
  }
}

/// Where a vertex is, or will be moved to.
enum class Side : char { Open, Boundary, Surface };

/// A vertex that is nearer to the boundary than this fraction of an edge is moved to it.
constexpr double kNear = 0.3;

/// Halves an edge from the surface into an opening. \return the last fraction of it on the surface
double fractionOnSurface(const Vector3d& from, const Vector3d& to,
                         const std::function<bool(const Vector3d&)>& is_open) {
  constexpr int steps = 24;
  double inside = 0.0;
  double outside = 1.0;
  for (int step = 0; step < steps; ++step) {
    const double middle = 0.5 * (inside + outside);
    (is_open((1.0 - middle) * from + middle * to) ? outside : inside) = middle;
  }
  return inside;
}

/// Leaves out the triangles for which is_kept(their corners) is false.
template <typename IsKept>
void keepTriangles(Triangles& triangles, const IsKept& is_kept) {
  std::vector<Index> kept;
  for (Index t = 0; t < triangles.cols(); ++t)
    if (is_kept(triangles.col(t)))
      kept.push_back(t);
  triangles = Triangles(triangles(Eigen::all, kept));
}

/// Leaves out triangles at vertices whose triangles are not one fan.
void keepManifoldPart(Triangles& triangles, std::size_t vertices) {
  Eigen::Index before = 0;
  while (triangles.cols() != before) {
    before = triangles.cols();
    Indexed<char> is_fault(vertices, 0);
    for (const Index v : checkTopology(triangles, vertices, 1).nonmanifold_vertices)
      is_fault[v] = 1;
    keepTriangles(triangles, [&](const auto& corners) {
      return std::none_of(corners.begin(), corners.end(),
                          [&](Index v) { return is_fault[v] != 0; });
    });
  }
}

}  // namespace

CappedMesh capOpenings(const Positions& points, const Triangles& triangles) {
  std::vector<double> added;
  std::vector<Index> corners;
  for (const std::vector<Index>& loop : boundaryLoops(triangles, columnCount(points)))
    addCap(points, loop, added, corners);
  CappedMesh mesh;
  mesh.points.resize(3, points.cols() + indexCount(added) / 3);
  mesh.points << points, Eigen::Map<const Positions>(added.data(), 3, indexCount(added) / 3);
  mesh.triangles.resize(3, triangles.cols() + indexCount(corners) / 3);
  mesh.triangles << triangles,
      Eigen::Map<const Triangles>(corners.data(), 3, indexCount(corners) / 3);
  return mesh;
}

std::vector<Index> compact(Triangles& triangles, Eigen::Index vertex_count) {
  Indexed<Index> numbers(static_cast<std::size_t>(vertex_count), -1);
  for (const Index v : triangles.reshaped())
    numbers[v] = 0;
  std::vector<Index> used;
  for (Index v = 0; v < vertex_count; ++v)
    if (numbers[v] == 0) {
      numbers[v] = indexCount(used);
      used.push_back(v);
    }
  for (Index& v : triangles.reshaped())
    v = numbers[v];
  return used;
}

void cutOpenings(Positions& directions, Triangles& triangles,
                 const std::function<bool(const Vector3d&)>& is_open) {
  const std::size_t count = columnCount(directions);
  Indexed<Side> sides(count, Side::Surface);
  forEachIndex(count, 0, [&](Index i) {
    if (is_open(directions.col(i)))
      sides[i] = Side::Open;
  });
  Positions moved = directions;
  // How far each vertex moves to the nearest crossing: fractions of the edge.
  Indexed<double> moves(count, 1.0);
  const auto move = [&](Index v, double fraction, const Vector3d& place) {
    if (fraction < moves[v]) {
      moves[v] = fraction;
      moved.col(v) = place.normalized();
    }
  };
  // Calls visit(vertex on the surface, vertex in an opening, fraction, place) once for each edge
  // between the two.
  const auto for_each_crossing = [&](const auto& visit) {
    for (Eigen::Index t = 0; t < triangles.cols(); ++t)
      for (Eigen::Index k = 0; k < 3; ++k) {
        const Index u = triangles(k, t);
        const Index v = triangles((k + 1) % 3, t);
        if (sides[u] != Side::Surface || sides[v] != Side::Open)
          continue;
        const double fraction = fractionOnSurface(directions.col(u), directions.col(v), is_open);
        visit(u, v, fraction,
              Vector3d((1.0 - fraction) * directions.col(u) + fraction * directions.col(v)));
      }
  };
  for_each_crossing([&](Index u, Index, double fraction, const Vector3d& place) {
    if (fraction < kNear)
      move(u, fraction, place);
  });
  for (Index i = 0; i < directions.cols(); ++i)
    if (moves[i] < 1.0)
      sides[i] = Side::Boundary;
  for_each_crossing([&](Index, Index v, double fraction, const Vector3d& place) {
    move(v, 1.0 - fraction, place);
  });

  keepTriangles(triangles, [&](const auto& corners) {
    return std::any_of(corners.begin(), corners.end(),
                       [&](Index v) { return sides[v] == Side::Surface; });
  });
  keepManifoldPart(triangles, count);
  directions = moved(Eigen::all, compact(triangles, directions.cols()));
}

}  // namespace spherical_param::internal
