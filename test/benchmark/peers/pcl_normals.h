#pragma once

#include "peer.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <string>

namespace spherical_param::benchmark {

/// Says how estimateNormals() does it.
extern const std::string pcl_normals_parameters;

/// The points with normals that all point to the same side, out of a closed surface. Points
/// without a normal are left out.
pcl::PointCloud<pcl::PointNormal>::Ptr estimateNormals(const Points& points);

}  // namespace spherical_param::benchmark
