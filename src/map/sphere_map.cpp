#include "spherical_param/map/sphere_map.h"

#include "caps.h"
#include "index_loops.h"
#include "input_checks.h"
#include "map_hierarchy.h"
#include "map_relaxation.h"
#include "pi.h"
#include "progress.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using internal::MapCorner;
using internal::MapEnergy;
using internal::MapHierarchy;
using internal::MapMesh;
using internal::MapRows;

/// Throws for a mesh that cannot be mapped; caps its openings.
/// \return what is mapped, if that is not the mesh itself
std::optional<internal::CappedMesh> checkMesh(const Positions& points, const Triangles& triangles,
                                              const Positions& start, int threads) {
  const std::string caller = "computeSphereMap: ";
  if (points.cols() < 4)
    throw InvalidInput(caller + std::to_string(points.cols()) +
                       " vertices make no closed mesh; give at least 4");
  constexpr Eigen::Index most_vertices = Eigen::Index{1} << 28;
  if (points.cols() > most_vertices)
    throw InvalidInput(caller + std::to_string(points.cols()) +
                       " vertices are more than 2^28; simplify the mesh");
  MeshTopology topology = checkTopology(triangles, internal::columnCount(points), threads);
  if (topology.components == 1 && topology.genus.value_or(0) > 0)
    throw InvalidInput(caller + "the mesh does not map to a sphere: its genus is " +
                       std::to_string(*topology.genus) +
                       "; cut its handles, by handles = none of reconstruct()");
  if (start.cols() > 0 && start.cols() != points.cols())
    throw InvalidInput(caller + "there are " + std::to_string(points.cols()) +
                       " vertices, but the start has " + std::to_string(start.cols()) +
                       "; give a unit vector for each");
  if (!points.allFinite())
    throw InvalidInput(caller + "a coordinate of a vertex is not finite; remove such points first");
  // Vectors that were rounded to float pass.
  internal::checkUnitVectors("computeSphereMap", start, 1e-3);
  if (topology.isSphere())
    return std::nullopt;
  if (topology.isOpenSurface()) {
    internal::CappedMesh capped = internal::capOpenings(points, triangles);
    topology = checkTopology(capped.triangles, internal::columnCount(capped.points), threads);
    if (topology.isSphere())
      return capped;
  }
  std::string fault = "it is not a topological sphere";
  if (!topology.manifold())
    fault = "it is not manifold";
  else if (!topology.oriented)
    fault = "its triangles are not oriented consistently";
  else if (!topology.unused_vertices.empty())
    fault =
        "vertex " + std::to_string(topology.unused_vertices.front()) + " belongs to no triangle";
  else if (topology.components != 1)
    fault = "it has " + std::to_string(topology.components) + " pieces";
  throw InvalidInput(caller + "the mesh does not map to a sphere: " + fault +
                     "; give a manifold mesh of genus 0 in one piece, each vertex used");
}

/// A point well inside the kernel of a spherical polygon, all of which the first of its vertices
/// sees: from there each edge runs counter-clockwise. Zero if rounding leaves none.
Vector3d kernelPoint(const Positions& sphere, const std::vector<MapCorner>& ring) {
  const std::size_t k = ring.size();
  const auto at = [&](std::size_t i) -> Vector3d { return sphere.col(ring[i % k].neighbor); };
  // Points are rays. The two edges at the first vertex bound a lune, from that vertex to its
  // antipode; the middles of its sides are at a right angle to both ends.
  const Vector3d apex = at(0);
  // The interior is to the left of the edge out, and to the left of the edge in.
  const Vector3d out = (at(1) - apex * apex.dot(at(1))).normalized();
  const Vector3d in = (at(k - 1) - apex * apex.dot(at(k - 1))).normalized();
  std::vector<Vector3d> polygon;
  std::vector<Vector3d> clipped;
  const bool is_reflex = apex.dot(out.cross(in)) < 0.0;
  if (is_reflex)
    polygon = {apex, Vector3d(-in), Vector3d(-apex), Vector3d(-out)};
  else
    polygon = {apex, out, Vector3d(-apex), in};
  for (std::size_t i = 1; i + 1 < k && !polygon.empty(); ++i) {
    const Vector3d a = at(i);
    // By the difference: the sides of the ring may be short.
    const Vector3d normal = a.cross(at(i + 1) - a).normalized();
    clipped.clear();
    for (std::size_t p = 0; p < polygon.size(); ++p) {
      const Vector3d& ray = polygon[p];
      const Vector3d& next = polygon[p + 1 == polygon.size() ? 0 : p + 1];
      // Likewise.
      const double here = normal.dot(ray - a * (a.dot(ray)));
      const double there = normal.dot(next - a * (a.dot(next)));
      if (here >= 0.0)
        clipped.push_back(ray);
      if ((here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0))
        clipped.push_back(((ray * std::abs(there) + next * std::abs(here))).normalized());
    }
    polygon.swap(clipped);
  }
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& ray : polygon)
    sum += ray;
  const double length = sum.norm();
  return length > 0.0 ? Vector3d(sum / length) : Vector3d(Vector3d::Zero());
}

/// Puts the vertex back into its ring.
///
/// \return false: there is no room for it.
bool insertVertex(const MapHierarchy& hierarchy, Index v, const MapEnergy& energy,
                  Positions& sphere) {
  const auto i = static_cast<std::size_t>(v) - 4;
  const std::size_t begin = hierarchy.ring_begin[i];
  const std::size_t end = hierarchy.ring_begin[i + 1];
  std::vector<MapCorner> corners;
  for (std::size_t r = begin; r < end; ++r) {
    const Index first = hierarchy.ring[r];
    const Index next = hierarchy.ring[r + 1 == end ? begin : r + 1];
    const Eigen::Vector3f cotangents = internal::mapCotangents(
        hierarchy.points.col(v), hierarchy.points.col(first), hierarchy.points.col(next));
    corners.push_back(
        {first, hierarchy.ring_masses[r], cotangents[0], cotangents[1], cotangents[2]});
  }
  const internal::MapRing ring(corners.data(), corners.data() + corners.size());
  const Vector3d point = kernelPoint(sphere, corners);
  if (!internal::isMapValid(sphere, ring, point))
    return false;
  sphere.col(v) = point;
  constexpr int steps = 4;
  for (int step = 0; step < steps; ++step)
    if (!(internal::relaxMapVertex(sphere, v, ring, energy) > 0.0))
      break;
  return true;
}

/// A regular tetrahedron, with the orientation of the triangles.
void placeTetrahedron(const MapMesh& mesh, Positions& sphere) {
  const double c = std::sqrt(1.0 / 3.0);
  sphere.leftCols<4>() << c, -c, -c, c, c, -c, c, -c, c, c, -c, -c;
  if (internal::isFlipped(sphere, mesh.triangles, 0))
    sphere.col(2).swap(sphere.col(3));
}

/// The rotation that brings the map as near to the start as can be, each vertex weighted by its
/// fraction of the area (W. Kabsch, 1976); the identity if no rotation is better than others.
Eigen::Matrix3d rotationTo(const Positions& start, const Positions& sphere, const Positions& points,
                           const Triangles& triangles) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const double scale = points.cwiseAbs().maxCoeff();
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Vector3d corner = points.col(triangles(0, t)) / scale;
    const Vector3d u = points.col(triangles(1, t)) / scale - corner;
    const Vector3d v = points.col(triangles(2, t)) / scale - corner;
    const double area = u.cross(v).norm();
    for (int k = 0; k < 3; ++k)
      sum += area * start.col(triangles(k, t)) * sphere.col(triangles(k, t)).transpose();
  }
  if (!sum.allFinite())
    return Eigen::Matrix3d::Identity();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d& singular = svd.singularValues();
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  constexpr double distinct = 1e-9;
  if (!(singular[1] + sign * singular[2] > distinct * singular[0]))
    return Eigen::Matrix3d::Identity();
  return svd.matrixU() * Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

/// From a tetrahedron to the finest mesh.
class Refinement {
public:
  Refinement(const MapHierarchy& hierarchy, const SphereMapOptions& options)
      : hierarchy_(hierarchy), options_(options), sphere_(3, hierarchy.points.cols()) {
    for (const double mass : hierarchy.meshes.front().masses)
      mass_ += mass;
    const double area = options.area_weight;
    const double angle = std::max(1.0 - area, kMinAngleWeight);
    const double area_of_mass = 4.0 * internal::kPi / mass_;
    final_ = {angle, (1.0 - kRatioFraction) * area, kRatioFraction * area, area_of_mass};
    const double mild_area = std::min(area, kMildAreaWeight);
    mild_ = {1.0 - mild_area, 0.0, mild_area, area_of_mass};
  }

  Positions run(std::vector<SphereMapLevel>& levels, const internal::FractionReport& report) {
    placeTetrahedron(hierarchy_.meshes.back(), sphere_);
    std::size_t batch = 0;
    for (std::size_t l = hierarchy_.meshes.size(); l-- > 0;) {
      const MapMesh& mesh = hierarchy_.meshes[l];
      while (hierarchy_.batches[batch] < mesh.vertex_count) {
        insert(hierarchy_.batches[batch], hierarchy_.batches[batch + 1]);
        ++batch;
      }
      levels.push_back(relax(mesh, report));
    }
    std::reverse(levels.begin(), levels.end());
    return std::move(sphere_);
  }

private:
  /// Areas alone do not determine the place of a vertex in its ring.
  static constexpr double kMinAngleWeight = 0.02;
  /// Fraction of the weight of areas for the ratio; the rest is for the logarithm. With a larger
  /// rest more triangles have exactly their areas, but others next to them are sheared more.
  static constexpr double kRatioFraction = 0.7;
  /// Largest weight of areas in the first sweeps after vertices were inserted: triangles that have
  /// their areas already leave each other no room to move.
  static constexpr double kMildAreaWeight = 0.7;
  static constexpr int kMildSweeps = 2;

  void insert(Index first, Index end) {
    std::atomic<Index> failed{0};
    internal::forEachIndex(static_cast<std::size_t>(end - first), options_.threads, [&](Index i) {
      if (!insertVertex(hierarchy_, first + i, mild_, sphere_))
        ++failed;
    });
    if (failed > 0)
      throw ComputeError("computeSphereMap: no room on the sphere for " + std::to_string(failed) +
                         " vertices; remesh the surface, its triangles are too thin");
  }

  SphereMapLevel relax(const MapMesh& mesh, const internal::FractionReport& report) {
    const MapRows rows = internal::makeMapRows(hierarchy_.points, mesh.triangles, mesh.masses,
                                               mesh.vertex_count, options_.threads);
    SphereMapLevel level;
    level.vertices = static_cast<std::size_t>(mesh.vertex_count);
    for (; level.sweeps < std::min(kMildSweeps, options_.sweeps); ++level.sweeps) {
      internal::reportFraction(report, 1.0 * level.sweeps / options_.sweeps);
      internal::sweepMap(sphere_, rows, mild_, options_.threads);
    }
    double value = internal::mapEnergy(sphere_, rows, final_, options_.threads);
    bool goes_on = true;
    for (; goes_on && level.sweeps < options_.sweeps; ++level.sweeps) {
      internal::reportFraction(report, 1.0 * level.sweeps / options_.sweeps);
      const double gain = internal::sweepMap(sphere_, rows, final_, options_.threads);
      value -= gain;
      goes_on = gain > kMinGain * value;
    }
    level.energy = value / mass_;
    return level;
  }

  /// A sweep that gains less, relative to the energy, is the last of its level.
  static constexpr double kMinGain = 1e-4;

  const MapHierarchy& hierarchy_;
  const SphereMapOptions& options_;
  Positions sphere_;
  MapEnergy mild_{};
  MapEnergy final_{};
  double mass_ = 0.0;
};

}  // namespace

SphereMap computeSphereMap(const Positions& points, const Triangles& triangles,
                           const Positions& start, const SphereMapOptions& options) {
  internal::checkRange("computeSphereMap: area_weight", options.area_weight, 0.0, 1.0);
  internal::checkRange("computeSphereMap: sweeps", options.sweeps, 0, 1000);
  const std::optional<internal::CappedMesh> capped =
      checkMesh(points, triangles, start, options.threads);
  const internal::FractionReport report = internal::reportOf(options, "map");
  internal::reportFraction(report, 0.0);
  const MapHierarchy hierarchy =
      internal::buildMapHierarchy(capped ? capped->points : points,
                                  capped ? capped->triangles : triangles, options.threads, report);
  SphereMap map;
  const Positions refined = Refinement(hierarchy, options).run(map.levels, report);
  Positions sphere(3, refined.cols());
  for (Index i = 0; i < refined.cols(); ++i)
    sphere.col(hierarchy.order[i]) = refined.col(i);
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (start.cols() > 0) {
    const Positions unit_start = start.colwise().normalized();
    map.before = measureMapDistortion(points, triangles, unit_start, options.threads);
    internal::reportFraction(report, 0.0);
    rotation = rotationTo(unit_start, sphere, points, triangles);
  }
  const auto take = [&](const Positions& all) {
    map.sphere = all.leftCols(points.cols());
    map.caps = all.rightCols(all.cols() - points.cols());
    map.distortion = measureMapDistortion(points, triangles, map.sphere, options.threads);
  };
  take((rotation * sphere).colwise().normalized());
  if (map.distortion.flipped_triangles > 0)
    take(sphere);  // only the rounding of the rotation flipped them
  internal::reportFraction(report, 1.0);
  return map;
}

}  // namespace spherical_param
