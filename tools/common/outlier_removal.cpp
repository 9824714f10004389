#include "common/outlier_removal.h"

#include "spherical_param/outliers.h"
#include "spherical_param/point_set.h"
#include "spherical_param/types.h"

// Instantiated here: to load PCL's library of filters, with all of them for all types of points,
// takes as long as to load everything else.
#include <pcl/filters/impl/filter.hpp>
#include <pcl/filters/impl/filter_indices.hpp>
#include <pcl/filters/impl/statistical_outlier_removal.hpp>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>

namespace spherical_param::tools {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/// Neighbours in each list of findOutliers(): so many more than it uses step in for outliers.
constexpr int list_size = 32;
/// Some milliseconds of search.
constexpr std::size_t points_between_questions = 1024;
/// Neighbours of pcl::StatisticalOutlierRemoval.
constexpr int statistical_neighbors = 16;

bool isFinite(const Point& point) {
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
}

/// The points as a cloud of PCL, scaled by a power of two (exactly): its squared distances in
/// single precision underflow for small clouds and overflow for large ones.
Cloud::Ptr scaledCloud(const Positions& points) {
  const int exponent = std::ilogb(points.cwiseAbs().maxCoeff());
  Cloud::Ptr cloud(new Cloud);
  cloud->reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const auto scaled = [&](Eigen::Index axis) {
      return static_cast<float>(std::ldexp(points(axis, i), -exponent));
    };
    cloud->emplace_back(scaled(0), scaled(1), scaled(2));
  }
  return cloud;
}

/// \throw Unwanted
NeighborLists nearestNeighbors(const Cloud::Ptr& cloud, const std::function<bool()>& is_wanted) {
  pcl::search::KdTree<pcl::PointXYZ> tree(false);
  tree.setInputCloud(cloud);
  NeighborLists lists;
  lists.offsets.reserve(cloud->size() + 1);
  pcl::Indices found;
  std::vector<float> distances;
  for (const pcl::PointXYZ& point : *cloud) {
    if (is_wanted && lists.offsets.size() % points_between_questions == 0 && !is_wanted())
      throw Unwanted();
    // One more, since a point is its own neighbour.
    tree.nearestKSearch(point, list_size + 1, found, distances);
    lists.indices.insert(lists.indices.end(), found.begin(), found.end());
    lists.offsets.push_back(lists.indices.size());
  }
  return lists;
}

std::vector<Index> statisticalOutliers(const Cloud::Ptr& cloud, double sigma) {
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter(true);
  filter.setInputCloud(cloud);
  // It reads as many distances as it asks for, found or not.
  filter.setMeanK(std::min(statistical_neighbors, static_cast<int>(cloud->size()) - 1));
  filter.setStddevMulThresh(sigma);
  pcl::Indices kept;
  filter.filter(kept);
  const pcl::Indices& removed = *filter.getRemovedIndices();
  return std::vector<Index>(removed.begin(), removed.end());
}

}  // namespace

OutlierRemoval findOutlierPoints(const std::vector<Point>& points, OutlierMethod method,
                                 double sigma, int threads,
                                 const std::function<bool()>& is_wanted) {
  std::vector<int> finite;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (isFinite(points[i])) {
      finite.push_back(static_cast<int>(i));
    }
  }
  Positions positions(3, static_cast<Eigen::Index>(finite.size()));
  for (std::size_t i = 0; i < finite.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) =
        Eigen::Vector3f(points[static_cast<std::size_t>(finite[i])].data()).cast<double>();
  }
  const DistinctPoints distinct = findDistinctPoints(positions);
  const std::size_t count = distinct.input_of_vertex.size();

  OutlierRemoval removal;
  std::vector<Index> outliers;
  // Fewer cannot be meshed anyway.
  if (count >= 4) {
    const Positions vertices = positions(Eigen::all, distinct.input_of_vertex);
    const Cloud::Ptr cloud = scaledCloud(vertices);
    if (method == OutlierMethod::Paper) {
      OutlierOptions options;
      options.sigma = sigma;
      options.threads = threads;
      const Outliers found = findOutliers(vertices, nearestNeighbors(cloud, is_wanted), options);
      outliers = found.indices;
      removal.threshold = found.threshold;
    } else {
      outliers = statisticalOutliers(cloud, sigma);
    }
  }

  std::vector<bool> is_outlier(count, false);
  for (const Index vertex : outliers) {
    is_outlier[static_cast<std::size_t>(vertex)] = true;
  }
  std::vector<bool> is_removed(points.size(), false);
  for (std::size_t i = 0; i < finite.size(); ++i) {
    is_removed[static_cast<std::size_t>(finite[i])] =
        is_outlier[static_cast<std::size_t>(distinct.vertex_of_input[i])];
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    (is_removed[i] ? removal.indices : removal.kept).push_back(static_cast<int>(i));
  }
  removal.kept_positions = count - outliers.size();
  return removal;
}

}  // namespace spherical_param::tools
