#pragma once

#include "spherical_param/types.h"
#include "spherical_param_ros/parameters.h"

#include <pcl/PCLPointCloud2.h>

#include <array>
#include <functional>
#include <memory>

namespace spherical_param_ros {

/// A mesh without types of ROS: one surface, or those of several parts one after the other.
/// Vertices of a part have the order of their first points in the cloud.
struct Mesh {
  /// Header and every field of the cloud, one record a vertex; coordinates are moved ones after
  /// consolidation or smoothing.
  pcl::PCLPointCloud2 cloud;
  spherical_param::Positions vertices;  ///< 3 x v [unit of the cloud]
  /// 3 x t, indices of vertices, counter-clockwise from outside, or from one side of an open
  /// surface.
  spherical_param::Triangles triangles;
  /// Red, green, blue, alpha (255 if the cloud has none). Empty for clouds without colours.
  std::vector<std::array<std::uint8_t, 4>> colors;
};

/// How the work on a cloud ended.
enum class Status {
  Done,       ///< there is a mesh
  Failed,     ///< the cloud cannot be meshed; `message` has cause and remedy
  Cancelled,  ///< during the work a newer cloud arrived, or the worker ended
  Dropped,    ///< newer clouds pushed it out of the queue, or the worker ended
  Refused,    ///< too many requests were waiting, or the worker ended
};

/// The name of a status, in lower case.
const char* nameOf(Status status);

/// A mesh, or why there is none.
struct Outcome {
  Status status = Status::Failed;
  std::string message;               ///< the verdict on the mesh, or "cause; remedy"
  std::shared_ptr<const Mesh> mesh;  ///< of Status::Done
  bool has_faults = false;           ///< a finding is a fault, see spherical_param::Finding
  std::vector<std::string> warnings;
  std::size_t points = 0;  ///< of the cloud
  double seconds = 0.0;    ///< of the reconstruction, wall time
};

/// Meshes a cloud, in double precision. Throws nothing: failures are in the outcome.
///
/// \param is_wanted called at least every two seconds; false ends the work with
///                  Status::Cancelled. May be empty.
Outcome meshCloud(const pcl::PCLPointCloud2& cloud, const Settings& settings,
                  const std::function<bool()>& is_wanted);

}  // namespace spherical_param_ros
