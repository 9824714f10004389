// Meshes clouds of a topic with ROS 2: the same worker, parameters and messages as with ROS 1.

#include "spherical_param/errors.h"
#include "spherical_param_ros/reconstruction_worker.h"

#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <diagnostic_updater/diagnostic_updater.hpp>
#include <geometry_msgs/msg/point.hpp>
#include <pcl_conversions/pcl_conversions.h>
#include <pcl_msgs/msg/polygon_mesh.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <shape_msgs/msg/mesh.hpp>
#include <std_msgs/msg/color_rgba.hpp>
#include <std_msgs/msg/header.hpp>
#include <visualization_msgs/msg/marker.hpp>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace spherical_param_ros {
namespace {

using std_msgs::msg::Header;

rclcpp::ParameterValue ros2Value(const Value& value) {
  if (const auto* truth = std::get_if<bool>(&value))
    return rclcpp::ParameterValue(*truth);
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return rclcpp::ParameterValue(*integer);
  if (const auto* number = std::get_if<double>(&value))
    return rclcpp::ParameterValue(*number);
  return rclcpp::ParameterValue(std::get<std::string>(value));
}

/// \throw spherical_param::InvalidInput
Value neutralValue(const std::string& name, const rclcpp::ParameterValue& value) {
  switch (value.get_type()) {
  case rclcpp::ParameterType::PARAMETER_BOOL:
    return value.get<bool>();
  case rclcpp::ParameterType::PARAMETER_INTEGER:
    return value.get<std::int64_t>();
  case rclcpp::ParameterType::PARAMETER_DOUBLE:
    return value.get<double>();
  case rclcpp::ParameterType::PARAMETER_STRING:
    return value.get<std::string>();
  default:
    throw spherical_param::InvalidInput(name + " is a list; use a single value");
  }
}

/// Its description has the range, too: not every range of ours is one of ROS. setParameter() checks
/// the type: an integer will do for a number, and a number for the text of `outliers`.
rcl_interfaces::msg::ParameterDescriptor descriptorOf(const ParameterInfo& info) {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.description = info.description;
  descriptor.dynamic_typing = true;
  return descriptor;
}

pcl_msgs::msg::PolygonMesh polygonMeshOf(const Mesh& mesh, const Header& header) {
  pcl_msgs::msg::PolygonMesh message;
  pcl_conversions::fromPCL(mesh.cloud, message.cloud);
  message.header = header;
  message.cloud.header = header;
  message.polygons.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    message.polygons[t].vertices.assign(mesh.triangles[t].begin(), mesh.triangles[t].end());
  return message;
}

geometry_msgs::msg::Point pointOf(const Mesh& mesh, std::size_t vertex) {
  geometry_msgs::msg::Point point;
  point.x = mesh.vertices[vertex][0];
  point.y = mesh.vertices[vertex][1];
  point.z = mesh.vertices[vertex][2];
  return point;
}

shape_msgs::msg::Mesh shapeOf(const Mesh& mesh) {
  shape_msgs::msg::Mesh message;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    message.vertices.push_back(pointOf(mesh, i));
  message.triangles.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner)
      message.triangles[t].vertex_indices[corner] = mesh.triangles[t][corner];
  return message;
}

visualization_msgs::msg::Marker markerOf(const Mesh& mesh, const Header& header) {
  visualization_msgs::msg::Marker marker;
  marker.header = header;
  marker.ns = "spherical_param";
  marker.type = visualization_msgs::msg::Marker::TRIANGLE_LIST;
  marker.action = visualization_msgs::msg::Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color.r = marker.color.g = marker.color.b = 0.8F;
  marker.color.a = 1.0F;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      marker.points.push_back(pointOf(mesh, vertex));
      if (!mesh.colors.empty()) {
        const auto& rgba = mesh.colors[vertex];
        std_msgs::msg::ColorRGBA color;
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

class ReconstructionNode : public rclcpp::Node {
public:
  /// \throw spherical_param::InvalidInput for a parameter that cannot be used.
  ReconstructionNode() : rclcpp::Node("spherical_param"), diagnostics_(this) {
    Settings settings;
    for (const ParameterInfo& info : parameters())
      setParameter(
          settings, info.name,
          neutralValue(info.name, declare_parameter(info.name, ros2Value(info.default_value),
                                                    descriptorOf(info))));
    // As latched topics of ROS 1: RViz shows the last mesh also if it is started later.
    const auto last_one = rclcpp::QoS(1).transient_local();
    mesh_publisher_ = create_publisher<pcl_msgs::msg::PolygonMesh>("~/mesh", last_one);
    shape_publisher_ = create_publisher<shape_msgs::msg::Mesh>("~/shape", last_one);
    marker_publisher_ = create_publisher<visualization_msgs::msg::Marker>("~/marker", last_one);
    worker_ = std::make_unique<ReconstructionWorker>(settings);
    parameter_callback_ = add_on_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter>& changed) { return onParameters(changed); });
    diagnostics_.setHardwareID("none");
    diagnostics_.add("reconstruction", this, &ReconstructionNode::diagnose);
    subscription_ = create_subscription<sensor_msgs::msg::PointCloud2>(
        "~/cloud", rclcpp::SensorDataQoS(),
        [this](const sensor_msgs::msg::PointCloud2::ConstSharedPtr message) { onCloud(*message); });
  }

  ~ReconstructionNode() override { worker_->stop(); }

  ReconstructionNode(const ReconstructionNode&) = delete;
  ReconstructionNode& operator=(const ReconstructionNode&) = delete;

private:
  void onCloud(const sensor_msgs::msg::PointCloud2& message) {
    auto cloud = std::make_shared<pcl::PCLPointCloud2>();
    pcl_conversions::toPCL(message, *cloud);
    worker_->submit(cloud, [this, header = message.header](const Outcome& outcome) {
      publish(outcome, header);
    });
  }

  rcl_interfaces::msg::SetParametersResult
  onParameters(const std::vector<rclcpp::Parameter>& changed) {
    rcl_interfaces::msg::SetParametersResult result;
    result.successful = true;
    Settings settings = worker_->settings();
    try {
      for (const rclcpp::Parameter& parameter : changed)
        if (isOurs(parameter.get_name()))
          setParameter(settings, parameter.get_name(),
                       neutralValue(parameter.get_name(), parameter.get_parameter_value()));
      worker_->setSettings(settings);
    } catch (const spherical_param::InvalidInput& error) {
      result.successful = false;
      result.reason = error.what();
    }
    return result;
  }

  /// Others, such as use_sim_time, are ROS's own.
  static bool isOurs(const std::string& name) {
    for (const ParameterInfo& info : parameters())
      if (info.name == name)
        return true;
    return false;
  }

  void publish(const Outcome& outcome, const Header& header) {
    if (outcome.status == Status::Failed)
      RCLCPP_WARN(get_logger(), "A cloud of %zu points in frame '%s' cannot be meshed: %s",
                  outcome.points, header.frame_id.c_str(), outcome.message.c_str());
    if (!outcome.mesh)
      return;
    mesh_publisher_->publish(polygonMeshOf(*outcome.mesh, header));
    shape_publisher_->publish(shapeOf(*outcome.mesh));
    marker_publisher_->publish(markerOf(*outcome.mesh, header));
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using Level = diagnostic_msgs::msg::DiagnosticStatus;
    const Statistics statistics = worker_->statistics();
    const Outcome& last = statistics.last;
    const std::string state = statistics.is_working ? "working" : "idle";
    if (statistics.has_last && last.status == Status::Failed)
      status.summary(Level::WARN, "the last cloud could not be meshed");
    else if (last.has_faults)
      status.summary(Level::WARN, "the last mesh has faults");
    else
      status.summary(Level::OK, state);
    status.add("state", state);
    status.add("last result", std::string(statistics.has_last ? nameOf(last.status) : "none"));
    status.add("last message", last.message);
    status.add("last time [s]", last.seconds);
    status.add("last cloud [points]", last.points);
    status.add("last parts", last.parts);
    status.add("last outliers [points]", last.outliers);
    status.add("last other parts [points]", last.other_points);
    status.add("last self-intersections", last.self_intersections);
    status.add("received clouds", statistics.received);
    status.add("done clouds", statistics.done);
    status.add("failed clouds", statistics.failed);
    status.add("dropped clouds", statistics.dropped);
    status.add("cancelled clouds", statistics.cancelled);
    status.add("waiting clouds", statistics.queued);
  }

  rclcpp::Publisher<pcl_msgs::msg::PolygonMesh>::SharedPtr mesh_publisher_;
  rclcpp::Publisher<shape_msgs::msg::Mesh>::SharedPtr shape_publisher_;
  rclcpp::Publisher<visualization_msgs::msg::Marker>::SharedPtr marker_publisher_;
  std::unique_ptr<ReconstructionWorker> worker_;
  diagnostic_updater::Updater diagnostics_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr parameter_callback_;
  rclcpp::Subscription<sensor_msgs::msg::PointCloud2>::SharedPtr subscription_;
};

}  // namespace
}  // namespace spherical_param_ros

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  int code = 0;
  try {
    rclcpp::spin(std::make_shared<spherical_param_ros::ReconstructionNode>());
  } catch (const std::exception& error) {
    RCLCPP_FATAL(rclcpp::get_logger("spherical_param"), "The node cannot run: %s", error.what());
    code = 1;
  }
  rclcpp::shutdown();
  return code;
}
