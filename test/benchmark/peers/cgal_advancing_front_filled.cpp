#include "cgal_advancing_front.h"
#include "cgal_methods.h"

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <iterator>

namespace spherical_param::benchmark {

namespace PMP = CGAL::Polygon_mesh_processing;

PeerResult cgalAdvancingFrontFilled(const Points& points) {
  std::vector<Kernel::Point_3> vertices = toCgal(points);
  TriangleSoup triangles = advanceFront(vertices);
  // Splits vertices where sheets touch in one point: the mesh cannot hold those.
  PMP::orient_polygon_soup(vertices, triangles);
  SurfaceMesh mesh;
  PMP::polygon_soup_to_polygon_mesh(vertices, triangles, mesh);
  std::vector<SurfaceMesh::Halfedge_index> holes;
  PMP::extract_boundary_cycles(mesh, std::back_inserter(holes));
  for (const SurfaceMesh::Halfedge_index hole : holes) {
    std::vector<SurfaceMesh::Face_index> patch;
    PMP::triangulate_hole(mesh, hole, std::back_inserter(patch));
  }
  PeerResult result;
  result.mesh = fromCgal(mesh);
  result.parameters =
      cgal_advancing_front_parameters + "; then triangulate_hole() for every hole; 1 thread";
  return result;
}

}  // namespace spherical_param::benchmark
