// README's program, compiled by the line of doc/install.md.

#include <pcl/io/ply_io.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <cmath>

int main() {
  pcl::PointCloud<pcl::PointXYZ> points;
  for (int i = 0; i < 400; ++i) {
    const float z = 1.0F - (2.0F * static_cast<float>(i) + 1.0F) / 400.0F;
    const float r = std::sqrt(1.0F - z * z);
    const float angle = 2.4F * static_cast<float>(i);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  pcl::io::savePLYFileBinary("scan.ply", points);

  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  if (pcl::io::loadPLYFile("scan.ply", *cloud) < 0)
    return 1;
  pcl::SphericalParamReconstruction<pcl::PointXYZ> reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  if (mesh.polygons.size() != 2 * points.size() - 4)
    return 2;
  return pcl::io::savePLYFileBinary("mesh.ply", mesh);
}
