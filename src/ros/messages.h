#pragma once

#include "spherical_param_ros/reconstruction_worker.h"

#include <pcl_conversions/pcl_conversions.h>

#include <algorithm>

/// Messages of ROS 1 and 2, whose types have the same fields.
namespace spherical_param_ros {

template <typename PointCloud2>
ReconstructionWorker::Cloud neutralCloud(const PointCloud2& message) {
  auto cloud = std::make_shared<pcl::PCLPointCloud2>();
  pcl_conversions::toPCL(message, *cloud);
  return cloud;
}

/// \param header of the message the cloud came in: PCL's has no nanoseconds.
template <typename PolygonMesh, typename Header>
PolygonMesh polygonMeshOf(const Mesh& mesh, const Header& header) {
  PolygonMesh message;
  pcl_conversions::fromPCL(mesh.cloud, message.cloud);
  message.header = header;
  message.cloud.header = header;
  for (const auto triangle : mesh.triangles.colwise()) {
    message.polygons.emplace_back();
    message.polygons.back().vertices.assign(triangle.begin(), triangle.end());
  }
  return message;
}

template <typename Point>
Point pointOf(const Eigen::Vector3d& vertex) {
  Point point;
  point.x = vertex[0];
  point.y = vertex[1];
  point.z = vertex[2];
  return point;
}

/// Has neither header nor colours: its receiver must know the frame.
template <typename Shape>
Shape shapeOf(const Mesh& mesh) {
  Shape message;
  for (const auto vertex : mesh.vertices.colwise())
    message.vertices.push_back(pointOf<typename decltype(message.vertices)::value_type>(vertex));
  for (const auto triangle : mesh.triangles.colwise()) {
    message.triangles.emplace_back();
    std::copy(triangle.begin(), triangle.end(), message.triangles.back().vertex_indices.begin());
  }
  return message;
}

template <typename Color>
Color colorOf(const std::array<std::uint8_t, 4>& rgba) {
  Color color;
  color.r = static_cast<float>(rgba[0]) / 255.0F;
  color.g = static_cast<float>(rgba[1]) / 255.0F;
  color.b = static_cast<float>(rgba[2]) / 255.0F;
  // Many drivers leave alpha 0, and nothing would be seen.
  color.a = rgba[3] == 0 ? 1.0F : static_cast<float>(rgba[3]) / 255.0F;
  return color;
}

/// A TRIANGLE_LIST with a colour for each corner where the mesh has colours.
template <typename Marker, typename Header>
Marker markerOf(const Mesh& mesh, const Header& header) {
  Marker marker;
  marker.header = header;
  marker.ns = "spherical_param";
  marker.type = Marker::TRIANGLE_LIST;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color.r = marker.color.g = marker.color.b = 0.8F;
  marker.color.a = 1.0F;
  using Point = typename decltype(marker.points)::value_type;
  using Color = typename decltype(marker.colors)::value_type;
  for (const spherical_param::Index vertex : mesh.triangles.reshaped()) {
    marker.points.push_back(pointOf<Point>(mesh.vertices.col(vertex)));
    if (!mesh.colors.empty())
      marker.colors.push_back(colorOf<Color>(mesh.colors[static_cast<std::size_t>(vertex)]));
  }
  return marker;
}

/// Writes the state of a worker into a status of ROS's diagnostics.
template <typename Wrapper>
void diagnose(const WorkerState& worker, Wrapper& status) {
  const std::string state = worker.is_working ? "working" : "idle";
  const Outcome last = worker.last.value_or(Outcome());
  if (worker.last && last.status == Status::Failed)
    status.summary(Wrapper::WARN, "the last cloud could not be meshed");
  else if (last.has_faults)
    status.summary(Wrapper::WARN, "the last mesh has faults");
  else
    status.summary(Wrapper::OK, state);
  status.add("state", state);
  status.add("waiting clouds", worker.waiting);
  status.add("last result", std::string(worker.last ? nameOf(last.status) : "none"));
  status.add("last message", last.message);
  status.add("last time [s]", last.seconds);
  status.add("last cloud [points]", last.points);
}

}  // namespace spherical_param_ros
