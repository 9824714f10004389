// benchmark_peer_cgal: the surface reconstruction of the Computational Geometry Algorithms Library.

#include "peer.h"

#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <CGAL/compute_average_spacing.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>
#include <CGAL/version.h>

#include <array>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::benchmark;
using spherical_param::Index;
using spherical_param::tools::Point;
using spherical_param::tools::PointData;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using TriangleSoup = std::vector<std::array<std::size_t, 3>>;
using PointWithNormal = std::pair<Kernel::Point_3, Kernel::Vector_3>;
namespace PMP = CGAL::Polygon_mesh_processing;

// As in the examples of CGAL's manual.
constexpr unsigned spacing_neighbors = 6;
constexpr unsigned normal_neighbors = 18;
constexpr double alpha_per_offset = 30.0;

const std::string front_parameters = "radius ratio bound 5, beta 0.52 (defaults)";
const std::string spacing_parameters = "of " + std::to_string(spacing_neighbors) + " neighbours";

std::vector<Kernel::Point_3> toCgal(const PointData& cloud) {
  std::vector<Kernel::Point_3> converted;
  converted.reserve(cloud.points.size());
  for (const Point& point : cloud.points)
    converted.emplace_back(point[0], point[1], point[2]);
  return converted;
}

/// The mesh must hold no removed elements, which would shift the indices.
PeerResult fromCgal(const SurfaceMesh& surface, const std::string& parameters) {
  PeerResult result;
  result.parameters = parameters;
  result.resize(surface.number_of_vertices(), surface.number_of_faces());
  for (const auto vertex : surface.vertices()) {
    const Kernel::Point_3& point = surface.point(vertex);
    result.points.col(vertex.idx()) << point.x(), point.y(), point.z();
  }
  for (const auto face : surface.faces()) {
    int corner = 0;
    for (const auto vertex : surface.vertices_around_face(surface.halfedge(face)))
      result.triangles(corner++, face.idx()) = static_cast<Index>(vertex.idx());
  }
  return result;
}

TriangleSoup advanceFront(const std::vector<Kernel::Point_3>& points) {
  TriangleSoup triangles;
  CGAL::advancing_front_surface_reconstruction(points.begin(), points.end(),
                                               std::back_inserter(triangles));
  return triangles;
}

PeerResult advancingFront(const PointData& cloud) {
  const TriangleSoup triangles = advanceFront(toCgal(cloud));
  PeerResult result;
  result.parameters = front_parameters + "; 1 thread";
  result.resize(0, triangles.size());
  result.points = positionsOf(cloud);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      result.triangles(static_cast<int>(k), static_cast<Eigen::Index>(t)) =
          static_cast<Index>(triangles[t][k]);
  return result;
}

PeerResult advancingFrontFilled(const PointData& cloud) {
  std::vector<Kernel::Point_3> vertices = toCgal(cloud);
  TriangleSoup triangles = advanceFront(vertices);
  // Splits vertices where sheets touch in one point, because the mesh cannot hold those.
  PMP::orient_polygon_soup(vertices, triangles);
  SurfaceMesh mesh;
  PMP::polygon_soup_to_polygon_mesh(vertices, triangles, mesh);
  std::vector<SurfaceMesh::Halfedge_index> holes;
  PMP::extract_boundary_cycles(mesh, std::back_inserter(holes));
  for (const SurfaceMesh::Halfedge_index hole : holes) {
    std::vector<SurfaceMesh::Face_index> patch;
    PMP::triangulate_hole(mesh, hole, std::back_inserter(patch));
  }
  return fromCgal(mesh, front_parameters + "; then triangulate_hole() for every hole; 1 thread");
}

PeerResult alphaWrap(const PointData& cloud) {
  const std::vector<Kernel::Point_3> vertices = toCgal(cloud);
  // Fine enough to be compared. With less, the wrap gets in between the points of many clouds.
  const double alpha =
      4.0 * CGAL::compute_average_spacing<CGAL::Sequential_tag>(vertices, spacing_neighbors);
  SurfaceMesh mesh;
  CGAL::alpha_wrap_3(vertices, alpha, alpha / alpha_per_offset, mesh);
  return fromCgal(mesh, "alpha 4 average spacings " + spacing_parameters +
                            ", offset alpha / 30; 1 thread");
}

PeerResult poisson(const PointData& cloud) {
  const auto point_map = CGAL::First_of_pair_property_map<PointWithNormal>();
  const auto normal_map = CGAL::Second_of_pair_property_map<PointWithNormal>();
  const auto maps = CGAL::parameters::point_map(point_map).normal_map(normal_map);
  std::vector<PointWithNormal> oriented;
  for (const Kernel::Point_3& point : toCgal(cloud))
    oriented.emplace_back(point, CGAL::NULL_VECTOR);
  CGAL::pca_estimate_normals<CGAL::Parallel_if_available_tag>(oriented, normal_neighbors, maps);
  // Points that it cannot orient come last. The manual leaves them out, too.
  oriented.erase(CGAL::mst_orient_normals(oriented, unsigned{kOrientationNeighbors}, maps),
                 oriented.end());
  const double spacing = CGAL::compute_average_spacing<CGAL::Parallel_if_available_tag>(
      oriented, spacing_neighbors, CGAL::parameters::point_map(point_map));
  SurfaceMesh mesh;
  if (!CGAL::poisson_surface_reconstruction_delaunay(oriented.begin(), oriented.end(), point_map,
                                                     normal_map, mesh, spacing))
    throw std::runtime_error("it found no surface");
#ifdef CGAL_LINKED_WITH_TBB
  const std::string threads = "normals and spacing on all cores (TBB), else 1 thread";
#else
  const std::string threads = "1 thread";
#endif
  return fromCgal(mesh, "pca_estimate_normals k " + std::to_string(normal_neighbors) +
                            ", mst_orient_normals k " + std::to_string(kOrientationNeighbors) +
                            "; poisson_surface_reconstruction_delaunay, average spacing " +
                            spacing_parameters +
                            ", angle 20, radius 30, distance 0.375 (defaults); " + threads);
}

}  // namespace

int main(int argc, char** argv) {
  return runPeer(argc, argv, "CGAL " CGAL_VERSION_STR,
                 {{"advancing_front", advancingFront},
                  {"advancing_front_filled", advancingFrontFilled},
                  {"poisson", poisson},
                  {"alpha_wrap", alphaWrap}});
}
