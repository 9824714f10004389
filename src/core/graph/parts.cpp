#include "parts.h"

#include "caller_neighbors.h"
#include "graph_building.h"
#include "local_delaunay_graph.h"
#include "neighbor_graph.h"
#include "ordered_points.h"
#include "parallel.h"
#include "spherical_param/errors.h"
#include "surface_distance.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

/// A surface that encloses a volume has that many points.
constexpr int kFewestPoints = 4;

void checkArguments(const Positions& points, int min_points) {
  if (min_points < kFewestPoints)
    throw InvalidInput("findParts: min_points = " + std::to_string(min_points) +
                       " is out of range; use 4 or more");
  internal::checkFinite("findParts", points);
}

/// The part of each node: the lowest node of its component; -1: none.
std::vector<Index> partOfNodes(const Positions& points, const internal::AgreedGraph& agreed,
                               std::size_t min_points) {
  internal::UnionFind components = internal::connectedComponents(agreed.graph);
  std::vector<Index> part = internal::representatives(components, agreed.graph.size());
  const std::vector<std::size_t> sizes = internal::setSizes(part);
  std::vector<char> in_part(part.size());
  std::transform(part.begin(), part.end(), in_part.begin(), [&](Index component) {
    return sizes[static_cast<std::size_t>(component)] >= min_points ? 1 : 0;
  });
  const auto in_parts = std::count(in_part.begin(), in_part.end(), 1);
  if (in_parts == 0)
    std::fill(part.begin(), part.end(), Index{-1});
  if (in_parts == 0 || in_parts == static_cast<std::ptrdiff_t>(part.size()))
    return part;

  internal::SurfaceDistance distance(points, agreed.graph);
  distance.setSurfaces(in_part);
  const std::vector<char> in_star = agreed.in_stars_of(in_part);
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (in_part[i] != 0)
      continue;
    const auto node = static_cast<Index>(i);
    const bool is_beside = in_star[i] != 0 || distance.beyondNoise(node) == 0.0;
    part[i] = is_beside ? part[static_cast<std::size_t>(distance.nearest(node))] : -1;
  }
  return part;
}

Part partOf(const Positions& points, std::vector<Index> indices) {
  const Positions own = points(Eigen::all, indices);
  return {std::move(indices), own.rowwise().minCoeff(), own.rowwise().maxCoeff()};
}

}  // namespace

Parts findParts(const Positions& points, int min_points, const Execution& execution) {
  checkArguments(points, min_points);
  internal::checkThreads(execution.threads);
  const internal::OrderedPoints nodes = internal::orderPoints(points, execution.threads);
  const std::size_t count = nodes.input_of_node.size();
  const std::vector<Index> node_of_input = internal::nodesOfInput(nodes);
  Parts result;
  if (count < static_cast<std::size_t>(min_points)) {
    result.left_out.resize(node_of_input.size());
    std::iota(result.left_out.begin(), result.left_out.end(), Index{0});
    return result;
  }
  const internal::Neighbors neighbors =
      internal::nearestNeighbors(nodes, neighborsToSearch({}), execution);
  const std::vector<Index> part_of_node =
      partOfNodes(nodes.points,
                  internal::agreedGraph(nodes.points, neighbors.lists, neighbors.search, execution),
                  static_cast<std::size_t>(min_points));

  std::vector<std::vector<Index>> points_of(count);
  for (std::size_t i = 0; i < node_of_input.size(); ++i) {
    const Index part = part_of_node[static_cast<std::size_t>(node_of_input[i])];
    (part < 0 ? result.left_out : points_of[static_cast<std::size_t>(part)])
        .push_back(static_cast<Index>(i));
  }
  for (std::vector<Index>& indices : points_of)
    if (!indices.empty())
      result.parts.push_back(partOf(points, std::move(indices)));
  std::sort(result.parts.begin(), result.parts.end(), [](const Part& a, const Part& b) {
    return a.points.size() != b.points.size() ? a.points.size() > b.points.size()
                                              : a.points.front() < b.points.front();
  });
  return result;
}

}  // namespace spherical_param
