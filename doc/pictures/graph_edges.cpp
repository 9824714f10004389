// Writes the edges of both kinds of neighbour graph of a cloud, for the picture of that stage:
//   graph_edges CLOUD.xyz knn|delaunay K      two point numbers a line, on the standard output
#include <spherical_param/neighbor_graph.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <numeric>
#include <string>
#include <vector>

namespace sp = spherical_param;

// By trying all pairs: the pictures' clouds are small.
sp::NeighborLists nearest(const sp::Positions& points, int count) {
  sp::NeighborLists lists;
  std::vector<sp::Index> order(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const auto distance = [&](sp::Index j) {
      return (points.col(j) - points.col(i)).squaredNorm();
    };
    std::iota(order.begin(), order.end(), 0);
    std::partial_sort(order.begin(), order.begin() + count + 1, order.end(),
                      [&](sp::Index a, sp::Index b) { return distance(a) < distance(b); });
    lists.indices.insert(lists.indices.end(), order.begin(), order.begin() + count + 1);
    lists.offsets.push_back(lists.indices.size());
  }
  return lists;
}

int main(int argc, char** argv) {
  if (argc != 4)
    return 2;
  std::ifstream file(argv[1]);
  std::vector<double> numbers{std::istream_iterator<double>(file), {}};
  const sp::Positions points = Eigen::Map<const sp::Positions>(
      numbers.data(), 3, static_cast<Eigen::Index>(numbers.size() / 3));
  const int k = std::atoi(argv[3]);
  sp::Graph graph;
  if (argv[2] == std::string("knn")) {
    sp::NeighborGraphOptions options;
    options.k = k;
    graph = sp::buildNeighborGraph(points, nearest(points, k), options).graph;
  } else {
    graph = sp::buildLocalDelaunayGraph(points, nearest(points, 32)).graph;
  }
  for (std::size_t i = 0; i < graph.size(); ++i) {
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      if (static_cast<std::size_t>(graph.neighbors[e]) > i)
        std::cout << i << ' ' << graph.neighbors[e] << '\n';
    }
  }
  return 0;
}
