#include "pcl_normals.h"

#include <pcl/common/io.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>

namespace spherical_param::benchmark {
namespace {

constexpr int normal_neighbors = 16;

using Cloud = pcl::PointCloud<pcl::PointNormal>;
using Adjacency = std::vector<std::vector<int>>;

Adjacency neighborGraph(const Cloud::Ptr& cloud) {
  pcl::search::KdTree<pcl::PointNormal> tree;
  tree.setInputCloud(cloud);
  Adjacency adjacency(cloud->size());
  pcl::Indices neighbors;
  std::vector<float> squared_distances;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    tree.nearestKSearch((*cloud)[i], orientation_neighbors, neighbors, squared_distances);
    for (const int neighbor : neighbors) {
      adjacency[i].push_back(neighbor);
      adjacency[static_cast<std::size_t>(neighbor)].push_back(static_cast<int>(i));
    }
  }
  return adjacency;
}

void flip(pcl::PointNormal& point) {
  point.getNormalVector3fMap() *= -1.0F;
}

/// Turns the normals to one side along the minimum spanning tree of the neighbour graph, where an
/// edge costs 1 - |n_i . n_j|, from the uppermost point on, whose normal points up (H. Hoppe et
/// al., Surface Reconstruction from Unorganized Points, 1992, section 3.3). PCL itself can only
/// turn normals to a viewpoint, which no closed surface has.
void orientNormals(const Cloud::Ptr& cloud) {
  const Adjacency adjacency = neighborGraph(cloud);
  std::vector<int> from_top(cloud->size());
  std::iota(from_top.begin(), from_top.end(), 0);
  const auto at = [&cloud](int i) -> pcl::PointNormal& {
    return (*cloud)[static_cast<std::size_t>(i)];
  };
  std::sort(from_top.begin(), from_top.end(), [&](int a, int b) { return at(a).z > at(b).z; });

  using Edge = std::tuple<float, int, int>;  // cost, from, to
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> edges;
  std::vector<bool> done(cloud->size(), false);
  const auto visit = [&](int i) {
    done[static_cast<std::size_t>(i)] = true;
    for (const int neighbor : adjacency[static_cast<std::size_t>(i)]) {
      if (!done[static_cast<std::size_t>(neighbor)]) {
        const float cosine = at(i).getNormalVector3fMap().dot(at(neighbor).getNormalVector3fMap());
        edges.emplace(1.0F - std::abs(cosine), i, neighbor);
      }
    }
  };
  for (const int top : from_top) {  // the first point of each connected part
    if (done[static_cast<std::size_t>(top)]) {
      continue;
    }
    if (at(top).normal_z < 0.0F) {
      flip(at(top));
    }
    visit(top);
    while (!edges.empty()) {
      const auto [cost, from, to] = edges.top();
      edges.pop();
      if (done[static_cast<std::size_t>(to)]) {
        continue;
      }
      if (at(from).getNormalVector3fMap().dot(at(to).getNormalVector3fMap()) < 0.0F) {
        flip(at(to));
      }
      visit(to);
    }
  }
}

}  // namespace

const std::string pcl_normals_parameters =
    "NormalEstimationOMP k " + std::to_string(normal_neighbors) +
    " on all cores, oriented along the minimum spanning tree of " +
    std::to_string(orientation_neighbors) + " neighbours on 1 thread";

Cloud::Ptr estimateNormals(const Points& points) {
  const auto positions = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  positions->reserve(points.size());
  for (const tools::Point& point : points) {
    positions->emplace_back(point[0], point[1], point[2]);
  }
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(positions);
  estimation.setSearchMethod(pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  estimation.setKSearch(normal_neighbors);
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);

  const auto cloud = pcl::make_shared<Cloud>();
  pcl::concatenateFields(*positions, normals, *cloud);
  cloud->erase(std::remove_if(cloud->begin(), cloud->end(),
                              [](const pcl::PointNormal& point) {
                                return !point.getNormalVector3fMap().allFinite();
                              }),
               cloud->end());
  orientNormals(cloud);
  return cloud;
}

}  // namespace spherical_param::benchmark
