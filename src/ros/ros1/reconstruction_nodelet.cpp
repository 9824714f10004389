// The node as a nodelet: clouds come from nodelets of the same manager without a copy.

#include "ros1/reconstruction_server.h"

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include <exception>
#include <memory>

namespace spherical_param_ros {

class ReconstructionNodelet : public nodelet::Nodelet {
private:
  void onInit() override {
    try {
      server_ = std::make_unique<ReconstructionServer>(getNodeHandle(), getPrivateNodeHandle(),
                                                       getName());
    } catch (const std::exception& error) {
      // The manager and its other nodelets go on.
      NODELET_FATAL_STREAM("The nodelet cannot run: " << error.what());
    }
  }

  std::unique_ptr<ReconstructionServer> server_;
};

}  // namespace spherical_param_ros

PLUGINLIB_EXPORT_CLASS(spherical_param_ros::ReconstructionNodelet, nodelet::Nodelet)
