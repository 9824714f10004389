#include "scan_data.h"

#include "scan_shapes.h"
#include "spherical_param/mesh_optimization.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/point_set.h"
#include "spherical_param/smoothing.h"
#include "spherical_param/sphere_embedding.h"
#include "spherical_param/sphere_triangulation.h"

#include <pcl/surface/impl/spherical_param_reconstruction.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace spherical_param::stages {
namespace {

/// The value, made first if there is none.
template <typename T, typename Make>
T& made(std::optional<T>& value, const Make& make) {
  if (!value)
    value.emplace(make());
  return *value;
}

}  // namespace

/// The search of the PCL class, which would scale points of another extent first.
struct NeighborFinder::Tree {
  pcl::detail::KdTreeSearch search;
  std::vector<Index> all;  ///< 0 ... n - 1
};

NeighborFinder::NeighborFinder(const Positions& points)
    : tree_(new Tree{pcl::detail::KdTreeSearch(points),
                     std::vector<Index>(static_cast<std::size_t>(points.cols()))}) {
  std::iota(tree_->all.begin(), tree_->all.end(), Index{0});
}

NeighborFinder::~NeighborFinder() = default;

NeighborLists NeighborFinder::allLists(int neighbors, int threads) const {
  return search(threads)(tree_->all, neighbors);
}

NeighborSearch NeighborFinder::search(int threads) const {
  return [tree = tree_->search, threads](const std::vector<Index>& points, int neighbors) {
    return tree.findNeighbors(points, neighbors, threads, [](double) {});
  };
}

Data& Data::of(Index points, double noise) {
  static std::map<std::pair<Index, double>, Data> all;
  return all.try_emplace({points, noise}, points, noise).first->second;
}

const Positions& Data::scan() {
  return made(scan_, [&] {
    tools::ScanOptions options;
    options.shape = tools::Shape::Hand;
    options.points = static_cast<std::size_t>(size_);
    options.noise = noise_;
    // Rounded as by a file or a cloud of PCL.
    return tools::generateScan(options).points.cast<float>().cast<double>().eval();
  });
}

const NeighborFinder& Data::scanFinder() {
  if (!scan_finder_)
    scan_finder_.emplace(scan());
  return *scan_finder_;
}

const NeighborLists& Data::scanLists() {
  return made(scan_lists_, [&] { return scanFinder().allLists(kLocalDelaunayNeighbors, 0); });
}

const Positions& Data::points() {
  return made(points_, [&] { return scan()(Eigen::all, spatialOrder(scan())).eval(); });
}

const NeighborFinder& Data::finder() {
  if (!finder_)
    finder_.emplace(points());
  return *finder_;
}

const NeighborLists& Data::lists() {
  return made(lists_, [&] { return finder().allLists(kLocalDelaunayNeighbors, 0); });
}

const NeighborLists& Data::longLists() {
  return made(long_lists_, [&] { return finder().allLists(kNearestNeighbors, 0); });
}

const NeighborGraph& Data::graph() {
  return made(graph_, [&] {
    LocalDelaunayOptions options;
    options.search = finder().search(0);
    return buildLocalDelaunayGraph(points(), lists(), options);
  });
}

const GraphHierarchy& Data::hierarchy() {
  return made(hierarchy_, [&] { return buildGraphHierarchy(graph().graph); });
}

const Positions& Data::sphere() {
  return made(sphere_, [&] { return embedMultilevel(graph().graph, hierarchy()).directions; });
}

const Triangles& Data::sphereTriangles() {
  return made(sphere_triangles_, [&] {
    Triangles triangles = triangulateSphere(sphere()).triangles;
    if (signedVolume(points(), triangles) < 0.0)
      flipOrientation(triangles);
    return triangles;
  });
}

const Triangles& Data::triangles() {
  return made(triangles_, [&] {
    OptimizationOptions options;
    options.smoother = smootherOf(points(), 0);
    return optimizeMesh(points(), sphereTriangles(), graph().graph, options).triangles;
  });
}

std::function<Positions(const Triangles&, int)> smootherOf(const Positions& points, int threads) {
  return [&points, threads](const Triangles& triangles, int steps) {
    SmoothingOptions smoothing;
    smoothing.method = SmoothingMethod::Umbrella;
    smoothing.steps = steps;
    smoothing.restore_volume = false;
    smoothing.threads = threads;
    return smoothSurface(points, triangles, smoothing).points;
  };
}

int allThreads() {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;
#endif
}

}  // namespace spherical_param::stages
