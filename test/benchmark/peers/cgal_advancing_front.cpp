#include "cgal_peer.h"

#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <array>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

namespace spherical_param::benchmark {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;

using TriangleSoup = std::vector<std::array<std::size_t, 3>>;

const std::string parameters = "radius ratio bound 5, beta 0.52 (defaults)";

TriangleSoup advanceFront(const std::vector<Kernel::Point_3>& points) {
  TriangleSoup triangles;
  CGAL::advancing_front_surface_reconstruction(points.begin(), points.end(),
                                               std::back_inserter(triangles));
  return triangles;
}

}  // namespace

PeerResult cgalAdvancingFront(const Positions& points) {
  const TriangleSoup triangles = advanceFront(toCgal(points));
  PeerResult result{{points, Triangles(3, triangles.size())}, parameters + "; 1 thread"};
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      result.mesh.triangles(static_cast<int>(k), static_cast<Eigen::Index>(t)) =
          static_cast<Index>(triangles[t][k]);
  return result;
}

PeerResult cgalAdvancingFrontFilled(const Positions& points) {
  std::vector<Kernel::Point_3> vertices = toCgal(points);
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
  return {fromCgal(mesh), parameters + "; then triangulate_hole() for every hole; 1 thread"};
}

}  // namespace spherical_param::benchmark
