#include "spherical_param/sphere_map.h"

#include "core/parallel.h"
#include "core/progress.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"

#include <cmath>
#include <string>

namespace spherical_param {
namespace {

void checkOptions(const SphereMapOptions& options) {
  const std::string caller = "computeSphereMap: ";
  if (!(options.area_weight >= 0.0 && options.area_weight <= 1.0))
    throw InvalidInput(caller + "area_weight = " + std::to_string(options.area_weight) +
                       " is out of range; use 0 to 1");
  constexpr int most_sweeps = 1000;
  if (options.sweeps < 0 || options.sweeps > most_sweeps)
    throw InvalidInput(caller + "sweeps = " + std::to_string(options.sweeps) +
                       " is out of range; use 0 to " + std::to_string(most_sweeps));
  if (options.threads < 0 || options.threads > internal::kMostThreads)
    throw InvalidInput(caller + "threads = " + std::to_string(options.threads) +
                       " is out of range; use 0 (all) to " +
                       std::to_string(internal::kMostThreads));
}

void checkMesh(const Positions& points, const Triangles& triangles, const Positions& start,
               int threads) {
  const std::string caller = "computeSphereMap: ";
  if (points.cols() < 4)
    throw InvalidInput(caller + std::to_string(points.cols()) +
                       " vertices make no closed mesh; give at least 4");
  if (start.cols() != points.cols())
    throw InvalidInput(caller + "there are " + std::to_string(points.cols()) +
                       " vertices, but the start has " + std::to_string(start.cols()) +
                       "; give a unit vector for each");
  if (!points.allFinite())
    throw InvalidInput(caller + "a coordinate of a vertex is not finite; remove such points first");
  // Also what was rounded to float passes.
  constexpr double tolerance = 1e-3;
  for (Eigen::Index v = 0; v < start.cols(); ++v)
    if (!(std::abs(start.col(v).norm() - 1.0) <= tolerance))
      throw InvalidInput(caller + "the start of vertex " + std::to_string(v) + " has length " +
                         std::to_string(start.col(v).norm()) + "; normalise it");
  const MeshTopology topology =
      checkTopology(triangles, static_cast<std::size_t>(points.cols()), {threads});
  if (topology.isSphere())
    return;
  std::string fault = "it is no topological sphere";
  if (!topology.closed)
    fault = "it is not closed";
  else if (!topology.manifold())
    fault = "it is not manifold";
  else if (!topology.oriented)
    fault = "its triangles are not oriented consistently";
  else if (!topology.faults.unused_vertices.empty())
    fault = "vertex " + std::to_string(topology.faults.unused_vertices.front()) +
            " belongs to no triangle";
  else if (topology.components != 1)
    fault = "it has " + std::to_string(topology.components) + " pieces";
  else if (topology.genus)
    fault = "its genus is " + std::to_string(*topology.genus);
  throw InvalidInput(caller + "the mesh does not map to a sphere: " + fault +
                     "; give a closed manifold mesh of genus 0 in one piece, each vertex used");
}

}  // namespace

SphereMap computeSphereMap(const Positions& points, const Triangles& triangles,
                           const Positions& start, const SphereMapOptions& options) {
  checkOptions(options);
  checkMesh(points, triangles, start, options.threads);
  const internal::ShareReport report = internal::cancellable(options.progress, "computeSphereMap");
  internal::tell(report, 0.0);
  SphereMap map;
  map.sphere = start.colwise().normalized();
  map.before = measureMapDistortion(points, triangles, map.sphere, options.threads);
  map.distortion = map.before;
  internal::tell(report, 1.0);
  return map;
}

}  // namespace spherical_param
