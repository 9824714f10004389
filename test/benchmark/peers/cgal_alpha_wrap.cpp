#include "cgal_conversions.h"
#include "cgal_methods.h"

#include <CGAL/alpha_wrap_3.h>
#include <CGAL/compute_average_spacing.h>

#include <string>
#include <vector>

namespace spherical_param::benchmark {

PeerResult cgalAlphaWrap(const Points& points) {
  // Fine enough to be compared. With less, the wrap slips in between the points of many clouds.
  constexpr double alpha_per_spacing = 4.0;
  constexpr double alpha_per_offset = 30.0;  // as in the examples of CGAL's manual
  const std::vector<Kernel::Point_3> vertices = toCgal(points);
  const double alpha = alpha_per_spacing * CGAL::compute_average_spacing<CGAL::Sequential_tag>(
                                               vertices, cgal_spacing_neighbors);
  SurfaceMesh mesh;
  CGAL::alpha_wrap_3(vertices, alpha, alpha / alpha_per_offset, mesh);
  PeerResult result;
  result.mesh = fromCgal(mesh);
  result.parameters = "alpha 4 average spacings of " + std::to_string(cgal_spacing_neighbors) +
                      " neighbours, offset alpha / 30; 1 thread";
  return result;
}

}  // namespace spherical_param::benchmark
