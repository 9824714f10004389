#pragma once

#include "messages.h"
#include "ros1/parameter_server.h"

#include <diagnostic_updater/diagnostic_updater.h>
#include <pcl_spherical_param/Reconstruct.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>

#include <memory>
#include <string>

namespace spherical_param_ros {

/// Topics, service, parameters and diagnostics of a worker, for node and nodelet.
class ReconstructionServer {
public:
  /// \throw spherical_param::InvalidInput for a parameter that cannot be used.
  ReconstructionServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                       const std::string& name);
  ~ReconstructionServer();

  ReconstructionServer(const ReconstructionServer&) = delete;
  ReconstructionServer& operator=(const ReconstructionServer&) = delete;

private:
  using Request = pcl_spherical_param::Reconstruct::Request;
  using Response = pcl_spherical_param::Reconstruct::Response;

  void onCloud(const sensor_msgs::PointCloud2ConstPtr& message);
  bool onRequest(Request& request, Response& response);
  void publish(const Outcome& outcome, const std_msgs::Header& header);
  void onDiagnostics(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle private_node_;
  std::string name_;
  ros::Publisher mesh_publisher_;
  ros::Publisher shape_publisher_;
  ros::Publisher marker_publisher_;
  /// Ends before the publishers.
  std::unique_ptr<ReconstructionWorker> worker_;
  diagnostic_updater::Updater diagnostics_;
  std::unique_ptr<ParameterServer> parameter_server_;
  ros::Subscriber subscriber_;
  ros::WallTimer timer_;
  // Requests wait for their mesh: in threads of their own, so that nothing else waits for them.
  ros::CallbackQueue request_queue_;
  ros::ServiceServer service_;
  std::unique_ptr<ros::AsyncSpinner> request_spinner_;
};

}  // namespace spherical_param_ros
