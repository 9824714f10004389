#include "boundary_loops.h"
#include "corner_table.h"
#include "index_loops.h"
#include "sphere_mesh.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using internal::CornerTable;
using internal::Indexed;
using internal::SphereMesh;

constexpr int kMaxRounds = 100;
constexpr int kSweepsOfRound = 5;

using Pairs = std::vector<std::array<Index, 2>>;

/// The vertices of triangles, ascending.
std::vector<Index> verticesOf(const std::vector<Index>& zone, const Triangles& triangles) {
  std::vector<Index> vertices;
  for (const Index t : zone)
    for (const Index v : triangles.col(t))
      vertices.push_back(v);
  internal::sortUnique(vertices);
  return vertices;
}

/// The triangles at vertices, ascending.
std::vector<Index> trianglesAt(const std::vector<Index>& vertices, const CornerTable& corners) {
  std::vector<Index> zone;
  for (const Index v : vertices)
    corners.forEachCorner(v, [&](Index t, Index) { zone.push_back(t); });
  internal::sortUnique(zone);
  return zone;
}

/// The triangles of pairs and of a number of rings around them.
std::vector<Index> zoneAround(const Pairs& pairs, int rings, const Triangles& triangles,
                              const CornerTable& corners) {
  std::vector<Index> zone;
  for (const auto& pair : pairs)
    zone.insert(zone.end(), pair.begin(), pair.end());
  for (int ring = 0; ring < rings; ++ring)
    zone = trianglesAt(verticesOf(zone, triangles), corners);
  return zone;
}

/// Slides vertices of a mesh along its surface.
class Sliding {
public:
  Sliding(const SphereSurface& surface, ResampledMesh& mesh, int threads)
      : surface_(surface), mesh_(mesh), threads_(threads),
        corners_(mesh.triangles, internal::columnCount(mesh.points), threads),
        is_fixed_(internal::columnCount(mesh.points), 0) {
    if (surface.isOpen())
      for (const std::vector<Index>& loop :
           internal::boundaryLoops(mesh.triangles, is_fixed_.size()))
        for (const Index v : loop)
          is_fixed_[v] = 1;
  }

  /// \param pairs that intersect, at the end those that still do.
  UntanglingReport run(Pairs& pairs) {
    UntanglingReport report;
    report.before = pairs.size();
    const Positions start = mesh_.directions;
    ResampledMesh best = mesh_;
    Pairs best_pairs = pairs;
    for (; !pairs.empty() && report.rounds < kMaxRounds; ++report.rounds) {
      // Two rings around the triangles that intersect, and one more after every ten rounds.
      const std::vector<Index> zone = verticesOf(
          zoneAround(pairs, 2 + report.rounds / 10, mesh_.triangles, corners_), mesh_.triangles);
      for (int sweep = 0; sweep < kSweepsOfRound; ++sweep)
        for (const Index v : zone)
          slide(v);
      // Pairs that were there are among those of the zone.
      pairs = findSelfIntersectionsOf(mesh_.points, mesh_.triangles, trianglesAt(zone, corners_),
                                      Execution{threads_});
      if (pairs.size() < best_pairs.size()) {
        best = mesh_;
        best_pairs = pairs;
      }
    }
    mesh_ = std::move(best);
    pairs = std::move(best_pairs);
    for (Index v = 0; v < start.cols(); ++v)
      report.moved += mesh_.directions.col(v) != start.col(v) ? 1 : 0;
    return report;
  }

private:
  /// Moves a vertex towards its neighbours on the sphere, towards those that are far in space most,
  /// as far as no triangle is flipped.
  void slide(Index v) {
    if (is_fixed_[v] != 0)
      return;
    Vector3d sum = Vector3d::Zero();
    double weights = 0.0;
    corners_.forEachCorner(v, [&](Index t, Index k) {
      const Index neighbor = mesh_.triangles(internal::nextCorner(k), t);
      const double weight = (mesh_.points.col(neighbor) - mesh_.points.col(v)).squaredNorm();
      sum += weight * mesh_.directions.col(neighbor);
      weights += weight;
    });
    if (!(weights > 0.0))
      return;
    const Vector3d from = mesh_.directions.col(v);
    for (const double step : {0.5, 0.25, 0.125, 0.0625}) {
      const Vector3d to = ((1.0 - step) * from + step / weights * sum).normalized();
      if (!to.allFinite() || !internal::fitsAt(to, v, mesh_.directions, mesh_.triangles, corners_))
        continue;
      const SurfaceSample sample = surface_.evaluate(to);
      mesh_.directions.col(v) = to;
      mesh_.points.col(v) = sample.position;
      mesh_.normals.col(v) = sample.normal;
      return;
    }
  }

  const SphereSurface& surface_;
  ResampledMesh& mesh_;
  int threads_;
  CornerTable corners_;
  Indexed<char> is_fixed_;  ///< on the boundary
};

/// Whether the angles opposite to the side of a diamond become smaller if it is flipped, and the
/// new triangles are outward on the sphere.
bool isBetterFlipped(const SphereMesh::Diamond& at, const ResampledMesh& mesh) {
  const auto angle_at = [&](Index v, Index from, Index to) {
    const Vector3d a = mesh.points.col(from) - mesh.points.col(v);
    const Vector3d b = mesh.points.col(to) - mesh.points.col(v);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  const auto is_outward = [&](Index i, Index j, Index k) {
    return internal::isOutward(mesh.directions.col(i), mesh.directions.col(j),
                               mesh.directions.col(k));
  };
  // Rounding must not flip an edge forth and back.
  constexpr double least_gain = 1e-9;
  return angle_at(at.a, at.c, at.d) + angle_at(at.b, at.c, at.d) <
             angle_at(at.c, at.a, at.b) + angle_at(at.d, at.a, at.b) - least_gain &&
         is_outward(at.c, at.a, at.d) && is_outward(at.c, at.d, at.b);
}

/// Flips sides of some triangles as long as that makes angles smaller; returns how often.
std::size_t flipSidesOf(const std::vector<Index>& triangles, const ResampledMesh& mesh,
                        SphereMesh& flippable) {
  constexpr int most_sweeps = 20;
  std::size_t flips = 0;
  bool is_changed = true;
  for (int sweep = 0; sweep < most_sweeps && is_changed; ++sweep) {
    is_changed = false;
    for (const Index t : triangles)
      for (int k = 0; k < 3; ++k)
        if (isBetterFlipped(flippable.diamond(t, k), mesh) && flippable.flip(t, k)) {
          is_changed = true;
          ++flips;
          break;
        }
  }
  return flips;
}

/// Flips edges around triangles that intersect, farther and farther from what is left; returns how
/// often.
std::size_t flipAround(Pairs& pairs, ResampledMesh& mesh, int threads) {
  const std::size_t count = internal::columnCount(mesh.points);
  SphereMesh flippable(mesh.triangles, count, threads);
  std::size_t all = 0;
  constexpr int most_rounds = 6;
  for (int round = 1; round <= most_rounds && !pairs.empty(); ++round) {
    const CornerTable corners(mesh.triangles, count, threads);
    const std::size_t flips =
        flipSidesOf(zoneAround(pairs, round, mesh.triangles, corners), mesh, flippable);
    if (flips == 0)
      continue;
    all += flips;
    mesh.triangles = flippable.triangles();
    pairs = findSelfIntersections(mesh.points, mesh.triangles, Execution{threads});
  }
  return all;
}

}  // namespace

UntanglingReport untangle(const SphereSurface& surface, ResampledMesh& mesh, int requested) {
  const Eigen::Index n = mesh.points.cols();
  if (mesh.normals.cols() != n || mesh.directions.cols() != n)
    throw InvalidInput("untangle: " + std::to_string(n) + " points, " +
                       std::to_string(mesh.normals.cols()) + " normals and " +
                       std::to_string(mesh.directions.cols()) +
                       " directions; give a mesh of resampleSurface()");
  internal::checkTriangles("untangle", mesh.triangles, n);
  const std::size_t count = internal::columnCount(mesh.points);
  const int threads = internal::threadCount(requested, count);
  Pairs pairs = findSelfIntersections(mesh.points, mesh.triangles, Execution{threads});
  UntanglingReport report = Sliding(surface, mesh, threads).run(pairs);
  if (!pairs.empty() && checkTopology(mesh.triangles, count, threads).isSphere())
    report.flips = flipAround(pairs, mesh, threads);
  report.after = pairs.size();
  return report;
}

}  // namespace spherical_param
