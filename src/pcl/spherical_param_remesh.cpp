#include "mesh_conversion.h"

#include <pcl/surface/spherical_param_remesh.h>

#include "spherical_param/errors.h"

#include <cstddef>
#include <string>

namespace pcl {
namespace detail {

pcl::PolygonMesh remesh(const MappedMesh& mesh, const SphericalParamRemeshOptions& options,
                        int threads) {
  // The grid itself would accept as many as it can have.
  constexpr std::size_t max_points = std::size_t{1} << 29;
  if (options.points > max_points)
    throw spherical_param::InvalidInput("points = " + std::to_string(options.points) +
                                        " is out of range; use up to 2^29");
  const std::size_t wanted =
      options.points > 0 ? options.points : static_cast<std::size_t>(mesh.points.cols());
  const spherical_param::SphereSurface surface(mesh.points, mesh.triangles, mesh.map.sphere,
                                               {options.fit, threads, mesh.map.caps});
  spherical_param::ResampledMesh resampled = spherical_param::resampleSurface(
      surface, spherical_param::makeGridSphere(
                   options.grid, spherical_param::gridFrequency(options.grid, wanted, surface)));
  // Other edges may remove the intersections that sliding leaves.
  if (spherical_param::untangle(surface, resampled, threads).after > 0)
    spherical_param::removeIntersections(resampled, threads);
  pcl::PolygonMesh output;
  output.cloud = cloudOf(resampled.points, resampled.normals);
  output.polygons = polygonsOf(resampled.triangles);
  return output;
}

}  // namespace detail
}  // namespace pcl
