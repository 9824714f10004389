#include <pcl/PolygonMesh.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>
#include <spherical_param/point_set.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>
#include <utility>

namespace {

// Points spread over an ellipsoid along a spiral.
pcl::PointCloud<pcl::PointXYZ>::Ptr makeCloud(int count) {
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double r = std::sqrt(1.0 - z * z);
    cloud->emplace_back(static_cast<float>(3.0 * r * std::cos(2.4 * i)),
                        static_cast<float>(2.0 * r * std::sin(2.4 * i)), static_cast<float>(z));
  }
  return cloud;
}

// Closed and oriented: every directed edge once, and its reverse once.
bool isClosed(const pcl::PolygonMesh& mesh) {
  std::set<std::pair<pcl::index_t, pcl::index_t>> edges;
  for (const pcl::Vertices& polygon : mesh.polygons) {
    const std::size_t corners = polygon.vertices.size();
    for (std::size_t c = 0; c < corners; ++c) {
      if (!edges.insert({polygon.vertices[c], polygon.vertices[(c + 1) % corners]}).second) {
        return false;
      }
    }
  }
  return std::all_of(edges.begin(), edges.end(), [&edges](const auto& edge) {
    return edges.count({edge.second, edge.first}) == 1;
  });
}

}  // namespace

int main() {
  const auto cloud = makeCloud(400);
  pcl::SphericalParamReconstruction<pcl::PointXYZ> reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  // The core's types and functions as well, from the same installation.
  const spherical_param::Result& result = reconstruction.getResult();
  const bool good = mesh.polygons.size() == 2 * cloud->size() - 4 && isClosed(mesh) &&
                    spherical_param::findDistinctPoints(result.sphere).input_of_vertex.size() > 0;
  std::cout << mesh.polygons.size() << " triangles, " << (good ? "closed" : "NOT closed") << "\n";
  return good ? 0 : 1;
}
