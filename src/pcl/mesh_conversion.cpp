#include "mesh_conversion.h"

#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace pcl {
namespace detail {

pcl::PCLPointCloud2 cloudOf(const spherical_param::Positions& points,
                            const spherical_param::Positions& normals) {
  pcl::PointCloud<pcl::PointNormal> cloud;
  cloud.resize(static_cast<std::size_t>(points.cols()));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    cloud[i].getVector3fMap() = points.col(column).cast<float>();
    cloud[i].getNormalVector3fMap() = normals.col(column).cast<float>();
    // The curvature and what fills its place: PCL leaves these bytes as they are, and copies them.
    std::fill(std::begin(cloud[i].data_c), std::end(cloud[i].data_c), 0.0F);
  }
  pcl::PCLPointCloud2 result;
  pcl::toPCLPointCloud2(cloud, result);
  return result;
}

std::vector<pcl::Vertices> polygonsOf(const spherical_param::Triangles& triangles) {
  std::vector<pcl::Vertices> polygons(static_cast<std::size_t>(triangles.cols()));
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    const auto triangle = triangles.col(static_cast<Eigen::Index>(t));
    polygons[t].vertices = {triangle[0], triangle[1], triangle[2]};
  }
  return polygons;
}

}  // namespace detail
}  // namespace pcl
