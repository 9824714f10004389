#pragma once

#include "spherical_param/graph_hierarchy.h"
#include "spherical_param/neighbor_graph.h"
#include "spherical_param/types.h"

#include <functional>
#include <memory>
#include <optional>
#include <vector>

/// What the stages are timed on: each works on what the stages before it make of a generated scan.
namespace spherical_param::stages {

/// Neighbours of each point for local Delaunay neighbourhoods, the default of reconstruct(), and
/// for the paper's graph.
constexpr int kLocalDelaunayNeighbors = 12;
constexpr int kNearestNeighbors = 25;

/// The nearest neighbours of points by a k-d tree, as the PCL class finds them.
class NeighborFinder {
public:
  /// \param points 3 x n, distinct, of extent about 1.
  explicit NeighborFinder(const Positions& points);
  ~NeighborFinder();
  NeighborFinder(const NeighborFinder&) = delete;
  NeighborFinder& operator=(const NeighborFinder&) = delete;

  /// The nearest neighbours of all points; threads 0: all.
  NeighborLists allLists(int neighbors, int threads) const;
  /// For longer lists of some points; valid as long as this object.
  NeighborSearch search(int threads) const;

private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// A scan and what comes of it, each part made when it is first asked for, with all threads.
class Data {
public:
  /// The only one of that many points and that noise, as of the scan tool.
  static Data& of(Index points, double noise);

  Data(Index points, double noise) : size_(points), noise_(noise) {}

  Index size() const { return size_; }
  const Positions& scan();  ///< 3 x n, in the order of the scan
  const NeighborLists& scanLists();
  const NeighborFinder& scanFinder();

  // In the order of a space-filling curve, as reconstruct() gives them to the stages.

  const Positions& points();           ///< 3 x n
  const NeighborFinder& finder();      ///< on points()
  const NeighborLists& lists();        ///< of kLocalDelaunayNeighbors
  const NeighborLists& longLists();    ///< of kNearestNeighbors
  const NeighborGraph& graph();        ///< of local Delaunay neighbourhoods
  const GraphHierarchy& hierarchy();   ///< of graph()
  const Positions& sphere();           ///< 3 x n, the multilevel embedding
  const Triangles& sphereTriangles();  ///< 3 x (2n - 4), of sphere(), outward on points()
  const Triangles& triangles();        ///< 3 x (2n - 4), sphereTriangles() optimised

private:
  Index size_;
  double noise_;
  std::optional<Positions> scan_;
  std::optional<NeighborLists> scan_lists_;
  std::optional<NeighborFinder> scan_finder_;
  std::optional<Positions> points_;
  std::optional<NeighborFinder> finder_;
  std::optional<NeighborLists> lists_;
  std::optional<NeighborLists> long_lists_;
  std::optional<NeighborGraph> graph_;
  std::optional<GraphHierarchy> hierarchy_;
  std::optional<Positions> sphere_;
  std::optional<Triangles> sphere_triangles_;
  std::optional<Triangles> triangles_;
};

/// Steps of smoothing for optimizeMesh() on noisy clouds, as reconstruct() does them.
std::function<Positions(const Triangles&, int)> smootherOf(const Positions& points, int threads);

/// OpenMP's number of threads where none is asked for.
int allThreads();

}  // namespace spherical_param::stages
