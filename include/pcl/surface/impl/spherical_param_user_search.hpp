#pragma once

#include <pcl/pcl_exports.h>
#include <pcl/point_cloud.h>
#include <pcl/search/organized.h>
#include <pcl/search/search.h>
#include <pcl/types.h>

#include "spherical_param/errors.h"
#include "spherical_param/types.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace pcl {
namespace detail {

/** \brief Whether a search object on a subset of a cloud answers with positions in the subset, or
 * with indices of the cloud: PCL 1.13 has both kinds, in FlannSearch and KdTree. Asks for the
 * nearest neighbours of points of the subset, which are the points themselves. */
template <typename PointInT>
bool findsPositions(const pcl::search::Search<PointInT>& search,
                    const pcl::PointCloud<PointInT>& cloud, const pcl::Indices& subset) {
  // An approximate search may miss a few, but not a thousand times.
  int probes_left = 1000;
  pcl::Indices found;
  std::vector<float> distances;
  for (std::size_t i = 0; i < subset.size() && probes_left > 0; ++i) {
    const auto position = static_cast<pcl::index_t>(i);
    if (subset[i] == position)
      continue;
    --probes_left;
    if (search.nearestKSearch(cloud[static_cast<std::size_t>(subset[i])], 1, found, distances) < 1)
      continue;
    if (found.at(0) == subset[i] || found.at(0) == position)
      return found.at(0) == position;
  }
  throw spherical_param::ComputeError(
      "the search object does not find the points it was given; use a pcl::search::KdTree");
}

/** \brief Gives access to the camera model of an OrganizedNeighbor. Its own projectPoint() needs
 * members that a custom point type need not have. */
template <typename PointInT>
struct OrganizedCamera : public pcl::search::OrganizedNeighbor<PointInT> {
  /** \brief Get the homogeneous pixel coordinates of a point. */
  static Eigen::Vector3f project(const pcl::search::OrganizedNeighbor<PointInT>& search,
                                 const Eigen::Vector3f& point) {
    return search.*(&OrganizedCamera::KR_) * point +
           (search.*(&OrganizedCamera::projection_matrix_)).col(3);
  }
};

/** \brief Rejects a camera model of an OrganizedNeighbor that does not hold for some points of the
 * cloud: with it, it would find few or wrong neighbours, or not return. */
template <typename PointInT>
void checkCameraModel(const pcl::search::OrganizedNeighbor<PointInT>& search,
                      const pcl::PointCloud<PointInT>& cloud, const pcl::Indices& points) {
  // The search starts at the pixel that a point is projected to and looks at larger and larger
  // squares, hence a small error does no harm.
  const float tolerance = 0.05F * static_cast<float>(std::max(cloud.width, cloud.height));
  for (const pcl::index_t index : points) {
    const PointInT& point = cloud[static_cast<std::size_t>(index)];
    const Eigen::Vector2f pixel =
        OrganizedCamera<PointInT>::project(search, Eigen::Vector3f(static_cast<float>(point.x),
                                                                   static_cast<float>(point.y),
                                                                   static_cast<float>(point.z)))
            .hnormalized();
    const auto row = static_cast<pcl::uindex_t>(index) / cloud.width;
    const auto column = static_cast<pcl::uindex_t>(index) % cloud.width;
    // Written so that NaN fails.
    if (!(std::abs(pixel.x() - static_cast<float>(column)) <= tolerance &&
          std::abs(pixel.y() - static_cast<float>(row)) <= tolerance))
      throw spherical_param::InvalidInput(
          "the search object is an OrganizedNeighbor, but the cloud is not the depth image of a "
          "pinhole camera; use a pcl::search::KdTree");
  }
}

/** \brief Gives some points of a cloud to a search object.
 * \return the point that each answer stands for; -1: none */
template <typename PointInT>
std::vector<spherical_param::Index>
fillUserSearch(pcl::search::Search<PointInT>& search,
               const typename pcl::PointCloud<PointInT>::ConstPtr& cloud,
               const pcl::Indices& used_indices,
               const std::vector<spherical_param::Index>& points) {
  const auto* organized = dynamic_cast<const pcl::search::OrganizedNeighbor<PointInT>*>(&search);
  if (organized && (cloud->height <= 1 || cloud->width <= 1))
    throw spherical_param::InvalidInput(
        "the search object is an OrganizedNeighbor, but the cloud is not organized; use a "
        "pcl::search::KdTree");
  pcl::IndicesPtr subset(new pcl::Indices);
  subset->reserve(points.size());
  for (const spherical_param::Index point : points)
    subset->push_back(used_indices[static_cast<std::size_t>(point)]);
  search.setInputCloud(cloud, subset);
  if (organized)
    checkCameraModel(*organized, *cloud, *subset);

  const bool is_whole_cloud =
      subset->size() == cloud->size() && std::is_sorted(subset->begin(), subset->end());
  if (!is_whole_cloud && findsPositions(search, *cloud, *subset))
    return points;
  std::vector<spherical_param::Index> point_of_index(cloud->size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i)
    point_of_index[static_cast<std::size_t>((*subset)[i])] = points[i];
  return point_of_index;
}

/** \brief A search of the core by the search object of the user, among some points, which are
 * positions in used_indices, the indices in the cloud. Both must outlive it. Queries come one after
 * the other: it need not support concurrent queries. */
template <typename PointInT>
spherical_param::NeighborSearch useSearch(pcl::search::Search<PointInT>& search,
                                          const typename pcl::PointCloud<PointInT>::ConstPtr& cloud,
                                          const pcl::Indices& used_indices,
                                          const std::vector<spherical_param::Index>& points) {
  return [&search, cloud, &used_indices, size = points.size(),
          point_of_answer = fillUserSearch(search, cloud, used_indices, points)](
             const std::vector<spherical_param::Index>& queries, int count) {
    const auto wanted = std::min(static_cast<std::size_t>(std::max(count, 0)) + 1, size);
    spherical_param::NeighborLists lists;
    pcl::Indices indices;
    std::vector<float> distances;
    for (const spherical_param::Index query : queries) {
      const auto index = static_cast<std::size_t>(used_indices[static_cast<std::size_t>(query)]);
      const int answers =
          search.nearestKSearch((*cloud)[index], static_cast<int>(wanted), indices, distances);
      const std::size_t found =
          std::min({static_cast<std::size_t>(std::max(answers, 0)), indices.size(), wanted});
      for (std::size_t i = 0; i < found; ++i) {
        const auto answer = static_cast<std::size_t>(indices[i]);
        if (answer >= point_of_answer.size() || point_of_answer[answer] < 0)
          throw spherical_param::ComputeError(
              "the search object returned index " + std::to_string(indices[i]) +
              ", which is not among the points it was given; use a pcl::search::KdTree");
        lists.indices.push_back(point_of_answer[answer]);
      }
      lists.offsets.push_back(lists.indices.size());
    }
    return lists;
  };
}

}  // namespace detail
}  // namespace pcl
