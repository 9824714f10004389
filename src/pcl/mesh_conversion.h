#pragma once

#include <pcl/PCLPointCloud2.h>
#include <pcl/Vertices.h>

#include "spherical_param/types.h"

#include <vector>

namespace pcl {
namespace detail {

/// A cloud of points with normals, without a header.
///
/// \param points, normals 3 x n.
pcl::PCLPointCloud2 cloudOf(const spherical_param::Positions& points,
                            const spherical_param::Positions& normals);

/// Triangles as polygons of the same vertices.
std::vector<pcl::Vertices> polygonsOf(const spherical_param::Triangles& triangles);

}  // namespace detail
}  // namespace pcl
