// The same by pcl::SphericalParamReconstruction.
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <iostream>

int main(int argc, char** argv) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  if (argc != 3 || pcl::io::loadPLYFile(argv[1], *cloud) < 0)
    return 1;

  pcl::SphericalParamReconstruction<pcl::PointXYZ> reconstruction;
  reconstruction.setInputCloud(cloud);

  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  std::cout << mesh.polygons.size() << " triangles, "
            << reconstruction.getSelfIntersections().size() << " self-intersections\n"
            << reconstruction.getDiagnosis().summary << '\n';
  return pcl::io::savePLYFileBinary(argv[2], mesh);
}
