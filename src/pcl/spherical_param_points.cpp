// The parts of SphericalParamReconstruction that do not depend on the type of the points.

#include <pcl/surface/impl/spherical_param_reconstruction.hpp>

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
using spherical_param::NeighborLists;
using spherical_param::Options;
using spherical_param::Positions;
using spherical_param::Surface;

/// Appends the neighbours of some points, one point after the other: a search object of the user
/// need not be ready for concurrent queries.
class SerialSearch {
public:
  SerialSearch(const UserSearch& search, const Options& options)
      : search_(search), options_(options) {}

  /// One list for each of `queries`, with `count` neighbours and the point itself, for the graph.
  NeighborLists find(const std::vector<Index>& queries, int count) const {
    NeighborLists lists;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      report("graph", i, queries.size());
      append(queries[i], count, lists);
    }
    return lists;
  }

  /// The lists of all of `size` points; those of points at the position of an earlier one are
  /// empty.
  NeighborLists findAll(std::size_t size, int count) const {
    NeighborLists lists;
    for (std::size_t i = 0; i < search_.points.size(); ++i) {
      report("neighbors", i, search_.points.size());
      lists.offsets.resize(static_cast<std::size_t>(search_.points[i]) + 1, lists.indices.size());
      append(search_.points[i], count, lists);
    }
    lists.offsets.resize(size + 1, lists.indices.size());
    return lists;
  }

private:
  void append(Index query, int count, NeighborLists& lists) const {
    const std::size_t wanted =
        std::min(static_cast<std::size_t>(std::max(count, 0)) + 1, search_.points.size());
    search_.query(query, static_cast<int>(wanted), lists.indices);
    lists.offsets.push_back(lists.indices.size());
  }

  void report(const char* stage, std::size_t done, std::size_t all) const {
    constexpr std::size_t reports = 32;
    if (options_.progress && done % (all / reports + 1) == 0 &&
        !options_.progress({stage, static_cast<double>(done) / static_cast<double>(all)}))
      throw spherical_param::Cancelled("cancelled by the progress callback");
  }

  const UserSearch& search_;
  const Options& options_;
};

}  // namespace

Surface reconstructPoints(const Positions& points, Options options, std::size_t ignored_points,
                         const UserSearch* search) {
  options.progress = guardProgress(options.progress);
  try {
    spherical_param::checkOptions(options);
    if (search == nullptr)
      return spherical_param::reconstruct(points, options);
    const SerialSearch serial(*search, options);
    return spherical_param::reconstruct(
        points,
        serial.findAll(static_cast<std::size_t>(points.cols()),
                       spherical_param::neighborsToSearch(options.graph)),
        options,
        [&](const std::vector<Index>& queries, int count) { return serial.find(queries, count); });
  } catch (const InvalidInput& error) {
    if (ignored_points == 0)
      throw;
    throw InvalidInput(std::string(error.what()) + " (of the cloud's points, " +
                       std::to_string(ignored_points) + " are not finite)");
  }
}

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

std::vector<spherical_param::Part> choosePoints(const Positions& points,
                                                spherical_param::PartsMode mode, int min_points,
                                                const Options& options) {
  spherical_param::checkOptions(options);
  spherical_param::Execution execution = options;
  execution.progress = guardProgress(options.progress);
  std::vector<spherical_param::Part> parts =
      spherical_param::findParts(points, min_points, execution).parts;
  if (parts.empty())
    throw InvalidInput("no part of the cloud has " + std::to_string(min_points) +
                       " points; set a smaller size with setMinPartSize(), or PartsMode::All");
  if (mode == spherical_param::PartsMode::Largest)
    parts.resize(1);
  return parts;
}

}  // namespace detail
}  // namespace pcl
