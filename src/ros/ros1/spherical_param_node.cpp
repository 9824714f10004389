// Meshes clouds of a topic, or of a service. See doc/guide.md.

#include "ros1/reconstruction_server.h"

#include <ros/ros.h>

#include <exception>

int main(int argc, char** argv) {
  ros::init(argc, argv, "spherical_param");
  // ROS shuts down with its last handle. This one lives until the last message is sent.
  const ros::NodeHandle node;
  try {
    const spherical_param_ros::ReconstructionServer server(node, ros::NodeHandle("~"),
                                                           ros::this_node::getName());
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM("The node cannot run: " << error.what());
    return 1;
  }
  return 0;
}
