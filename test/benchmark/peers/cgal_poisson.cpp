#include "cgal_peer.h"

#include <CGAL/compute_average_spacing.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::benchmark {
namespace {

using PointWithNormal = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using PointMap = CGAL::First_of_pair_property_map<PointWithNormal>;
using NormalMap = CGAL::Second_of_pair_property_map<PointWithNormal>;

/// As in the examples of CGAL's manual.
constexpr unsigned normal_neighbors = 18;

std::vector<PointWithNormal> estimateNormals(const Positions& points) {
  std::vector<PointWithNormal> oriented;
  oriented.reserve(static_cast<std::size_t>(points.cols()));
  for (const Kernel::Point_3& point : toCgal(points))
    oriented.emplace_back(point, CGAL::NULL_VECTOR);
  const auto maps = CGAL::parameters::point_map(PointMap()).normal_map(NormalMap());
  CGAL::pca_estimate_normals<CGAL::Parallel_if_available_tag>(oriented, normal_neighbors, maps);
  // Points that it cannot orient come last. The manual leaves them out, too.
  oriented.erase(CGAL::mst_orient_normals(oriented, unsigned{kOrientationNeighbors}, maps),
                 oriented.end());
  return oriented;
}

}  // namespace

PeerResult cgalPoisson(const Positions& points) {
  PeerResult result;
  Stopwatch stopwatch;
  const std::vector<PointWithNormal> oriented = estimateNormals(points);
  result.normals_seconds = stopwatch.lap();

  const double spacing = CGAL::compute_average_spacing<CGAL::Parallel_if_available_tag>(
      oriented, kSpacingNeighbors, CGAL::parameters::point_map(PointMap()));
  SurfaceMesh mesh;
  if (!CGAL::poisson_surface_reconstruction_delaunay(oriented.begin(), oriented.end(), PointMap(),
                                                     NormalMap(), mesh, spacing))
    throw std::runtime_error("it found no surface");
  result.mesh = fromCgal(mesh);
  result.parameters = "pca_estimate_normals k " + std::to_string(normal_neighbors) +
                      ", mst_orient_normals k " + std::to_string(kOrientationNeighbors) +
                      "; poisson_surface_reconstruction_delaunay, average spacing of " +
                      std::to_string(kSpacingNeighbors) +
                      " neighbours, angle 20, radius 30, distance 0.375 (defaults); ";
#ifdef CGAL_LINKED_WITH_TBB
  result.parameters += "normals and spacing on all cores (TBB), else 1 thread";
#else
  result.parameters += "1 thread";
#endif
  return result;
}

}  // namespace spherical_param::benchmark
