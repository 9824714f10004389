#pragma once

#include "sensor_msgs/msg/point_cloud2.hpp"

#include <pcl/PCLPointCloud2.h>

namespace pcl_conversions {

void fromPCL(const pcl::PCLPointCloud2& pcl_pc2, sensor_msgs::msg::PointCloud2& pc2);
void toPCL(const sensor_msgs::msg::PointCloud2& pc2, pcl::PCLPointCloud2& pcl_pc2);

}  // namespace pcl_conversions
