#include "ros1/reconstruction_server.h"

#include <pcl_msgs/PolygonMesh.h>
#include <shape_msgs/Mesh.h>
#include <visualization_msgs/Marker.h>

#include <boost/make_shared.hpp>

#include <cstdint>
#include <functional>
#include <utility>

namespace spherical_param_ros {
namespace {

/// Older versions of roscpp wait for running service calls when they shut down. So the work on a
/// cloud ends when the shutdown begins.
Outcome meshUnlessShuttingDown(const pcl::PCLPointCloud2& cloud, const Settings& settings,
                               const std::function<bool()>& is_wanted) {
  return meshCloud(cloud, settings, [&] { return is_wanted() && !ros::isShuttingDown(); });
}

}  // namespace

ReconstructionServer::ReconstructionServer(const ros::NodeHandle& node,
                                           const ros::NodeHandle& private_node,
                                           const std::string& name)
    : private_node_(private_node), name_(name), diagnostics_(node, private_node, name) {
  const Settings settings = readSettings(private_node_);
  // Latched: RViz shows the last mesh also if it is started later.
  mesh_publisher_ = private_node_.advertise<pcl_msgs::PolygonMesh>("mesh", 1, true);
  shape_publisher_ = private_node_.advertise<shape_msgs::Mesh>("shape", 1, true);
  marker_publisher_ = private_node_.advertise<visualization_msgs::Marker>("marker", 1, true);
  worker_ = std::make_unique<ReconstructionWorker>(settings, meshUnlessShuttingDown);

  diagnostics_.setHardwareID("none");
  diagnostics_.add("reconstruction", this, &ReconstructionServer::onDiagnostics);
  // The updater itself waits in ROS's time, which may be simulated, and stand still.
  timer_ = private_node_.createWallTimer(
      ros::WallDuration(diagnostics_.getPeriod()),
      [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });

  parameter_server_ = std::make_unique<ParameterServer>(
      private_node_, settings, [this](const Settings& changed) { worker_->setSettings(changed); });

  ros::NodeHandle request_node(private_node_);
  request_node.setCallbackQueue(&request_queue_);
  service_ = request_node.advertiseService("reconstruct", &ReconstructionServer::onRequest, this);
  // A thread for the request that is worked on, one for each that waits, and one that refuses all
  // others: they would pile up in the queue of ROS.
  constexpr auto request_threads =
      static_cast<std::uint32_t>(ReconstructionWorker::max_requests + 2);
  request_spinner_ = std::make_unique<ros::AsyncSpinner>(request_threads, &request_queue_);
  request_spinner_->start();
  // The worker's queue is the one that drops clouds: this one is emptied at once, and long enough
  // for when the processors are busy.
  subscriber_ = private_node_.subscribe("cloud", 100, &ReconstructionServer::onCloud, this);
}

ReconstructionServer::~ReconstructionServer() {
  // The worker answers all requests when it stops, so that the threads of the spinner can end.
  worker_->stop();
  subscriber_.shutdown();
  timer_.stop();
  service_.shutdown();
  request_spinner_->stop();
}

void ReconstructionServer::onCloud(const sensor_msgs::PointCloud2ConstPtr& message) {
  worker_->submit(neutralCloud(*message), [this, header = message->header](const Outcome& outcome) {
    publish(outcome, header);
  });
}

bool ReconstructionServer::onRequest(Request& request, Response& response) {
  const Outcome outcome = worker_->process(neutralCloud(request.cloud));
  response.success = static_cast<unsigned char>(outcome.status == Status::Done);
  response.message = outcome.message;
  if (outcome.mesh)
    response.mesh = polygonMeshOf<pcl_msgs::PolygonMesh>(*outcome.mesh, request.cloud.header);
  else
    ROS_WARN_STREAM_NAMED(name_, "A request cannot be answered with a mesh: " << outcome.message);
  // With false the caller would not receive the message.
  return true;
}

void ReconstructionServer::publish(const Outcome& outcome, const std_msgs::Header& header) {
  if (outcome.status == Status::Failed)
    ROS_WARN_STREAM_NAMED(name_, "A cloud of " << outcome.points << " points in frame '"
                                               << header.frame_id
                                               << "' cannot be meshed: " << outcome.message);
  if (outcome.status == Status::Dropped)
    ROS_DEBUG_STREAM_THROTTLE_NAMED(5.0, name_, "A cloud was dropped: " << outcome.message);
  if (!outcome.mesh)
    return;
  for (const std::string& warning : outcome.warnings)
    ROS_DEBUG_STREAM_NAMED(name_, warning);
  // As shared pointers, which nodelets take without a copy.
  const Mesh& mesh = *outcome.mesh;
  const auto send = [](const ros::Publisher& publisher, auto message) {
    publisher.publish(boost::make_shared<decltype(message)>(std::move(message)));
  };
  send(mesh_publisher_, polygonMeshOf<pcl_msgs::PolygonMesh>(mesh, header));
  send(shape_publisher_, shapeOf<shape_msgs::Mesh>(mesh));
  send(marker_publisher_, markerOf<visualization_msgs::Marker>(mesh, header));
}

void ReconstructionServer::onDiagnostics(diagnostic_updater::DiagnosticStatusWrapper& status) {
  diagnose(worker_->state(), status);
}

}  // namespace spherical_param_ros
