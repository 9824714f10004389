#pragma once

#include "spherical_param_ros/parameters.h"

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>

#include <functional>
#include <string>

namespace spherical_param_ros {

/// The parameters that are set below a node; the others have their defaults.
///
/// \throw spherical_param::InvalidInput for one that cannot be used.
Settings readSettings(const ros::NodeHandle& node);

/// Lets clients of dynamic_reconfigure, such as rqt_reconfigure, change the parameters. The server
/// of dynamic_reconfigure itself needs a list at compile time; this one serves parameters().
class ParameterServer {
public:
  /// \param apply called with new settings, from the queue of `node`.
  ParameterServer(const ros::NodeHandle& node, const Settings& settings,
                  std::function<void(const Settings&)> apply);

  ParameterServer(const ParameterServer&) = delete;
  ParameterServer& operator=(const ParameterServer&) = delete;

private:
  bool onRequest(dynamic_reconfigure::Reconfigure::Request& request,
                 dynamic_reconfigure::Reconfigure::Response& response);
  /// Publishes the settings, and writes them to the server of parameters.
  void announce() const;

  ros::NodeHandle node_;
  Settings settings_;
  std::function<void(const Settings&)> apply_;
  ros::Publisher description_publisher_;
  ros::Publisher update_publisher_;
  ros::ServiceServer service_;
};

}  // namespace spherical_param_ros
