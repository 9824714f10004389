#include "cgal_advancing_front.h"

#include "cgal_methods.h"

#include <CGAL/Advancing_front_surface_reconstruction.h>

#include <iterator>

namespace spherical_param::benchmark {

const std::string cgal_advancing_front_parameters = "radius ratio bound 5, beta 0.52 (defaults)";

TriangleSoup advanceFront(const std::vector<Kernel::Point_3>& points) {
  TriangleSoup triangles;
  CGAL::advancing_front_surface_reconstruction(points.begin(), points.end(),
                                               std::back_inserter(triangles));
  return triangles;
}

PeerResult cgalAdvancingFront(const Points& points) {
  PeerResult result;
  result.mesh.vertices.points = points;
  for (const auto& triangle : advanceFront(toCgal(points))) {
    result.mesh.triangles.push_back({static_cast<std::int32_t>(triangle[0]),
                                     static_cast<std::int32_t>(triangle[1]),
                                     static_cast<std::int32_t>(triangle[2])});
  }
  result.parameters = cgal_advancing_front_parameters + "; 1 thread";
  return result;
}

}  // namespace spherical_param::benchmark
