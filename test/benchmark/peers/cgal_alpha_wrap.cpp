#include "cgal_peer.h"

#include <CGAL/alpha_wrap_3.h>
#include <CGAL/compute_average_spacing.h>

#include <string>
#include <vector>

namespace spherical_param::benchmark {

PeerResult cgalAlphaWrap(const Positions& points) {
  // Fine enough to be compared. With less, the wrap gets in between the points of many clouds.
  constexpr double alpha_per_spacing = 4.0;
  constexpr double alpha_per_offset = 30.0;  // as in the examples of CGAL's manual
  const std::vector<Kernel::Point_3> vertices = toCgal(points);
  const double alpha = alpha_per_spacing * CGAL::compute_average_spacing<CGAL::Sequential_tag>(
                                               vertices, kSpacingNeighbors);
  SurfaceMesh mesh;
  CGAL::alpha_wrap_3(vertices, alpha, alpha / alpha_per_offset, mesh);
  return {fromCgal(mesh), "alpha 4 average spacings of " + std::to_string(kSpacingNeighbors) +
                              " neighbours, offset alpha / 30; 1 thread"};
}

}  // namespace spherical_param::benchmark
