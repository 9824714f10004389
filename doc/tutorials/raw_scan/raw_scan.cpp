// From a raw scan to a textured surface: the program of the tutorial beside this file.
#include <pcl/PolygonMesh.h>
#include <pcl/TextureMesh.h>
#include <pcl/conversions.h>
#include <pcl/io/obj_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/io/png_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/spherical_param_reconstruction.h>
#include <pcl/surface/spherical_param_texture.h>
#include <spherical_param/outliers.h>

#include <cstddef>
#include <iostream>
#include <vector>

using Point = pcl::PointXYZRGB;
using Cloud = pcl::PointCloud<Point>;

// The points that belong to the surface of the others.
Cloud::Ptr withoutOutliers(const Cloud::Ptr& scan) {
  pcl::search::KdTree<Point> tree(false);
  tree.setInputCloud(scan);
  spherical_param::NeighborLists lists;
  pcl::Indices found;
  std::vector<float> squared_distances;
  for (const Point& point : *scan) {
    tree.nearestKSearch(point, 33, found, squared_distances);
    lists.indices.insert(lists.indices.end(), found.begin(), found.end());
    lists.offsets.push_back(lists.indices.size());
  }

  const auto size = static_cast<Eigen::Index>(scan->size());
  const spherical_param::Positions points =
      scan->getMatrixXfMap().topRows(3).leftCols(size).cast<double>();
  const spherical_param::Outliers outliers = spherical_param::findOutliers(points, lists);
  std::cout << outliers.indices.size() << " outliers in " << outliers.rounds << " rounds\n";

  Cloud::Ptr kept(new Cloud);
  std::size_t next = 0;
  for (std::size_t i = 0; i < scan->size(); ++i) {
    if (next < outliers.indices.size() && outliers.indices[next] == static_cast<int>(i))
      ++next;
    else
      kept->push_back((*scan)[i]);
  }
  return kept;
}

// The mesh with its points where the smoothing put them.
pcl::PolygonMesh moved(const pcl::PolygonMesh& mesh, const pcl::PointCloud<pcl::PointXYZ>& places) {
  Cloud points;
  pcl::fromPCLPointCloud2(mesh.cloud, points);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].getVector3fMap() = places[i].getVector3fMap();
  pcl::PolygonMesh result = mesh;
  pcl::toPCLPointCloud2(points, result.cloud);
  return result;
}

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "Usage: raw_scan scan.ply\n";
    return 2;
  }

  Cloud::Ptr scan(new Cloud);
  if (pcl::io::loadPLYFile(argv[1], *scan) < 0)
    return 1;
  std::cout << scan->size() << " points\n";

  const Cloud::Ptr cloud = withoutOutliers(scan);

  pcl::SphericalParamReconstruction<Point> reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  if (mesh.polygons.empty()) {
    std::cerr << reconstruction.getErrorMessage() << '\n';
    return 1;
  }
  std::cout << mesh.polygons.size() << " triangles, "
            << reconstruction.getSelfIntersections().size() << " self-intersections\n"
            << reconstruction.getDiagnosis().summary << '\n';
  pcl::io::savePLYFileBinary("mesh.ply", mesh);

  reconstruction.setSmoothingSteps(5);
  reconstruction.reconstruct(mesh);
  const spherical_param::SmoothingReport& smoothing = reconstruction.getResult().smoothing;
  std::cout << "points moved by " << smoothing.mean_displacement << " on average, "
            << smoothing.self_intersections << " self-intersections\n";
  pcl::io::savePLYFileBinary("smooth.ply", moved(mesh, *reconstruction.getSmoothedPoints()));

  pcl::TextureMesh textured;
  spherical_param::TextureImage image;
  pcl::SphericalParamTextureOptions options;
  options.image_file = "model.png";
  if (!pcl::textureSphericalParam(reconstruction, textured, image, options))
    return 1;
  pcl::io::saveOBJFile("model.obj", textured);
  pcl::io::saveRgbPNGFile("model.png", image.pixels.data(), image.width, image.height);
  std::cout << "texture of " << image.width << " x " << image.height << " pixels\n";
  return 0;
}
