// The parts of SphericalParamReconstruction that do not depend on the type of the points.

#include <pcl/surface/impl/spherical_param_reconstruction.hpp>
#include <pcl/surface/spherical_param_map.h>

#include "spherical_param/errors.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

namespace pcl {
namespace detail {
namespace {

using spherical_param::Index;
using spherical_param::InvalidInput;
using spherical_param::Positions;

}  // namespace

void checkCloud(std::size_t points, std::size_t width, std::size_t height) {
  if (points == 0)
    throw InvalidInput("the input cloud is empty; at least 4 points are needed");
  // PCL allows both to be 0 for "not organized".
  if ((width != 0 || height != 0) && width * height != points)
    throw InvalidInput("the input cloud has " + std::to_string(points) +
                       " points, but its width is " + std::to_string(width) + " and its height " +
                       std::to_string(height) +
                       "; set width to the number of points and height to 1");
}

void rejectIndex(std::size_t entry, pcl::index_t index, std::size_t points) {
  throw InvalidInput("entry " + std::to_string(entry) + " of the indices is " +
                     std::to_string(index) + ", but the cloud has " + std::to_string(points) +
                     " points; indices must be from 0 to the number of points less one");
}

void requireSphere(const spherical_param::Surface& surface) {
  if (surface.sphere.cols() > 0)
    return;
  if (surface.has_certain_triangles_only)
    throw InvalidInput("the mesh has no map to one sphere: it is a tangle; call "
                       "setTopology(TopologyMode::Sphere), which maps it as it is");
  const std::size_t handles = surface.genus();
  throw InvalidInput(
      "the mesh has no map to one sphere: it " +
      (handles > 0 ? "has " + std::to_string(handles) + (handles == 1 ? " handle" : " handles")
                   : std::string("was glued from several")) +
      "; call setHandles(HandleMode::None), which cuts them");
}

pcl::PointCloud<pcl::PointXYZ>::Ptr cloudOfNothing(std::size_t points) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->resize(points);
  std::fill(cloud->begin(), cloud->end(), pcl::PointXYZ(nan, nan, nan));
  return cloud;
}

void placeVertices(const Positions& vertices, const std::vector<Index>& vertex_of_used,
                   const pcl::Indices& used_points, pcl::PointCloud<pcl::PointXYZ>& cloud) {
  for (std::size_t i = 0; i < used_points.size(); ++i)
    cloud[static_cast<std::size_t>(used_points[i])].getVector3fMap() =
        vertices.col(vertex_of_used[i]).cast<float>();
}

void appendPolygons(const spherical_param::Triangles& triangles,
                    const pcl::Indices& point_of_vertex, std::vector<pcl::Vertices>& polygons) {
  const auto point = [&](Index vertex) {
    return point_of_vertex[static_cast<std::size_t>(vertex)];
  };
  polygons.reserve(polygons.size() + static_cast<std::size_t>(triangles.cols()));
  for (const auto triangle : triangles.colwise()) {
    polygons.emplace_back();
    polygons.back().vertices = {point(triangle[0]), point(triangle[1]), point(triangle[2])};
  }
}

}  // namespace detail
}  // namespace pcl
