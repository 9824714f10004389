#pragma once

#include "spherical_param_ros/cloud_mesh.h"

#include <pcl_msgs/PolygonMesh.h>
#include <shape_msgs/Mesh.h>
#include <std_msgs/Header.h>
#include <visualization_msgs/Marker.h>

namespace spherical_param_ros {

// The header is that of the message the cloud came in: PCL's has no nanoseconds.

pcl_msgs::PolygonMesh polygonMeshOf(const Mesh& mesh, const std_msgs::Header& header);

/// Has neither header nor colours: its receiver must know the frame.
shape_msgs::Mesh shapeOf(const Mesh& mesh);

/// A TRIANGLE_LIST with a colour for each corner where the mesh has colours.
visualization_msgs::Marker markerOf(const Mesh& mesh, const std_msgs::Header& header);

}  // namespace spherical_param_ros
