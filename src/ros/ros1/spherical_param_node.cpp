// Meshes clouds of a topic, or of a service. See doc/guide.md.

#include "ros1/reconstruction_server.h"

#include <ros/ros.h>

#include <exception>

int main(int argc, char** argv) {
  ros::init(argc, argv, "spherical_param");
  // Without one left, ROS would shut down before the last message.
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
