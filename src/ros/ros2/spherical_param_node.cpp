// Meshes clouds of a topic with ROS 2: the same worker, parameters and messages as with ROS 1.

#include "messages.h"
#include "spherical_param/errors.h"

#include <diagnostic_updater/diagnostic_updater.hpp>
#include <pcl_msgs/msg/polygon_mesh.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <shape_msgs/msg/mesh.hpp>
#include <std_msgs/msg/header.hpp>
#include <visualization_msgs/msg/marker.hpp>

#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace spherical_param_ros {
namespace {

using std_msgs::msg::Header;

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
rcl_interfaces::msg::ParameterDescriptor descriptorOf(const Parameter& parameter) {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.description = parameter.description;
  descriptor.dynamic_typing = true;
  return descriptor;
}

class ReconstructionNode : public rclcpp::Node {
public:
  /// \throw spherical_param::InvalidInput for a parameter that cannot be used.
  ReconstructionNode() : rclcpp::Node("spherical_param"), diagnostics_(this) {
    Settings settings;
    for (const Parameter& parameter : parameters()) {
      const auto value = std::visit([](const auto& known) { return rclcpp::ParameterValue(known); },
                                    parameter.default_value);
      parameter.set(settings,
                    neutralValue(parameter.name, declare_parameter(parameter.name, value,
                                                                   descriptorOf(parameter))));
    }
    // As latched topics of ROS 1: RViz shows the last mesh also if it is started later.
    const auto last_one = rclcpp::QoS(1).transient_local();
    mesh_publisher_ = create_publisher<pcl_msgs::msg::PolygonMesh>("~/mesh", last_one);
    shape_publisher_ = create_publisher<shape_msgs::msg::Mesh>("~/shape", last_one);
    marker_publisher_ = create_publisher<visualization_msgs::msg::Marker>("~/marker", last_one);
    worker_ = std::make_unique<ReconstructionWorker>(settings);
    parameter_callback_ = add_on_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter>& changed) { return onParameters(changed); });
    diagnostics_.setHardwareID("none");
    diagnostics_.add("reconstruction", this, &ReconstructionNode::onDiagnostics);
    subscription_ = create_subscription<sensor_msgs::msg::PointCloud2>(
        "~/cloud", rclcpp::SensorDataQoS(),
        [this](const sensor_msgs::msg::PointCloud2::ConstSharedPtr message) { onCloud(*message); });
  }

  ~ReconstructionNode() override { worker_->stop(); }

  ReconstructionNode(const ReconstructionNode&) = delete;
  ReconstructionNode& operator=(const ReconstructionNode&) = delete;

private:
  void onCloud(const sensor_msgs::msg::PointCloud2& message) {
    worker_->submit(neutralCloud(message), [this, header = message.header](const Outcome& outcome) {
      publish(outcome, header);
    });
  }

  rcl_interfaces::msg::SetParametersResult
  onParameters(const std::vector<rclcpp::Parameter>& changed) {
    rcl_interfaces::msg::SetParametersResult result;
    result.successful = true;
    Settings settings = worker_->settings();
    try {
      for (const rclcpp::Parameter& change : changed)
        // Others, such as use_sim_time, are ROS's own.
        for (const Parameter& parameter : parameters())
          if (parameter.name == change.get_name())
            parameter.set(settings, neutralValue(parameter.name, change.get_parameter_value()));
      worker_->setSettings(settings);
    } catch (const spherical_param::InvalidInput& error) {
      result.successful = false;
      result.reason = error.what();
    }
    return result;
  }

  void publish(const Outcome& outcome, const Header& header) {
    if (outcome.status == Status::Failed)
      RCLCPP_WARN(get_logger(), "A cloud of %zu points in frame '%s' cannot be meshed: %s",
                  outcome.points, header.frame_id.c_str(), outcome.message.c_str());
    if (!outcome.mesh)
      return;
    mesh_publisher_->publish(polygonMeshOf<pcl_msgs::msg::PolygonMesh>(*outcome.mesh, header));
    shape_publisher_->publish(shapeOf<shape_msgs::msg::Mesh>(*outcome.mesh));
    marker_publisher_->publish(markerOf<visualization_msgs::msg::Marker>(*outcome.mesh, header));
  }

  void onDiagnostics(diagnostic_updater::DiagnosticStatusWrapper& status) {
    diagnose(worker_->state(), status);
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
