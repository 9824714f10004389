#include "ros1/mesh_messages.h"

#include <pcl_conversions/pcl_conversions.h>

#include <cstddef>
#include <cstdint>

namespace spherical_param_ros {

pcl_msgs::PolygonMesh polygonMeshOf(const Mesh& mesh, const std_msgs::Header& header) {
  pcl_msgs::PolygonMesh message;
  pcl_conversions::fromPCL(mesh.cloud, message.cloud);
  message.header = header;
  message.cloud.header = header;
  message.polygons.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    message.polygons[t].vertices.assign(mesh.triangles[t].begin(), mesh.triangles[t].end());
  return message;
}

shape_msgs::Mesh shapeOf(const Mesh& mesh) {
  shape_msgs::Mesh message;
  message.vertices.resize(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    message.vertices[i].x = mesh.vertices[i][0];
    message.vertices[i].y = mesh.vertices[i][1];
    message.vertices[i].z = mesh.vertices[i][2];
  }
  message.triangles.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner)
      message.triangles[t].vertex_indices[corner] = mesh.triangles[t][corner];
  return message;
}

visualization_msgs::Marker markerOf(const Mesh& mesh, const std_msgs::Header& header) {
  visualization_msgs::Marker marker;
  marker.header = header;
  marker.ns = "spherical_param";
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color.r = marker.color.g = marker.color.b = 0.8F;
  marker.color.a = 1.0F;
  marker.points.reserve(3 * mesh.triangles.size());
  marker.colors.reserve(mesh.colors.empty() ? 0 : 3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      geometry_msgs::Point point;
      point.x = mesh.vertices[vertex][0];
      point.y = mesh.vertices[vertex][1];
      point.z = mesh.vertices[vertex][2];
      marker.points.push_back(point);
      if (!mesh.colors.empty()) {
        std_msgs::ColorRGBA color;
        const auto& rgba = mesh.colors[vertex];
        color.r = static_cast<float>(rgba[0]) / 255.0F;
        color.g = static_cast<float>(rgba[1]) / 255.0F;
        color.b = static_cast<float>(rgba[2]) / 255.0F;
        // Many drivers leave alpha 0, and nothing would be seen.
        color.a = rgba[3] == 0 ? 1.0F : static_cast<float>(rgba[3]) / 255.0F;
        marker.colors.push_back(color);
      }
    }
  }
  return marker;
}

}  // namespace spherical_param_ros
