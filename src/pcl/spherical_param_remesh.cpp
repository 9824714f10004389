#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_remesh.h>

#include "spherical_param/errors.h"

#include <cstddef>
#include <string>
#include <utility>

namespace pcl {
namespace detail {

bool remesh(const spherical_param::Positions& points, const spherical_param::Triangles& triangles,
            const spherical_param::Positions& sphere, const SphericalParamRemeshOptions& options,
            pcl::PolygonMesh& output) {
  pcl::PolygonMesh mesh;
  const bool is_done = runCore("remeshSphericalParam", [&] {
    mesh.header = output.header;
    // The grid itself would take as many as it can have.
    constexpr std::size_t most_points = std::size_t{1} << 29;
    if (options.points > most_points)
      throw spherical_param::InvalidInput("points = " + std::to_string(options.points) +
                                          " is out of range; use up to 2^29");
    const std::size_t wanted =
        options.points > 0 ? options.points : static_cast<std::size_t>(points.cols());
    const spherical_param::SphereSurface surface(points, triangles, sphere,
                                                 {options.fit, options.map.threads});
    spherical_param::ResampledMesh resampled = spherical_param::resampleSurface(
        surface, spherical_param::makeGridSphere(
                     options.grid, spherical_param::gridFrequency(options.grid, wanted)));

    // What sliding leaves, other edges may mend.
    if (spherical_param::untangle(surface, resampled, options.map.threads).after > 0)
      spherical_param::removeIntersections(resampled, options.map.threads);
    pcl::PointCloud<pcl::PointNormal> cloud;
    cloud.resize(static_cast<std::size_t>(resampled.points.cols()));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      cloud[i].getVector3fMap() = resampled.points.col(column).cast<float>();
      cloud[i].getNormalVector3fMap() = resampled.normals.col(column).cast<float>();
    }
    cloud.header = mesh.header;
    pcl::toPCLPointCloud2(cloud, mesh.cloud);
    mesh.polygons.resize(static_cast<std::size_t>(resampled.triangles.cols()));
    for (std::size_t t = 0; t < mesh.polygons.size(); ++t) {
      const auto triangle = resampled.triangles.col(static_cast<Eigen::Index>(t));
      mesh.polygons[t].vertices = {triangle[0], triangle[1], triangle[2]};
    }
  });
  if (is_done)
    output = std::move(mesh);
  return is_done;
}

}  // namespace detail
}  // namespace pcl
