// The PCL class, and a function of the core from the same installation. With FILES, README's
// program.

#ifdef FILES
#include <pcl/io/ply_io.h>
#endif
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>
#include <spherical_param/mesh_topology.h>

#include <cmath>

int main() {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (int i = 0; i < 400; ++i) {
    const float z = 1.0F - (2.0F * static_cast<float>(i) + 1.0F) / 400.0F;
    const float r = std::sqrt(1.0F - z * z);
    const float angle = 2.4F * static_cast<float>(i);
    cloud->emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
#ifdef FILES
  if (pcl::io::savePLYFileBinary("scan.ply", *cloud) < 0 ||
      pcl::io::loadPLYFile("scan.ply", *cloud) < 0)
    return 1;
#endif
  pcl::SphericalParamReconstruction<pcl::PointXYZ> reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  const spherical_param::Surface& surface = reconstruction.getResult().surface();
  return mesh.polygons.size() == 796 &&
                 spherical_param::checkTopology(surface.triangles, 400).isSphere()
             ? 0
             : 2;
}
