#include <spherical_param/reconstruct.h>
#include <spherical_param/version.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

namespace {

using spherical_param::Index;

// Points spread over an ellipsoid along a spiral.
spherical_param::Positions makePoints(Index count) {
  spherical_param::Positions points(3, count);
  for (Index i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double r = std::sqrt(1.0 - z * z);
    points.col(i) << 3.0 * r * std::cos(2.4 * i), 2.0 * r * std::sin(2.4 * i), z;
  }
  return points;
}

spherical_param::NeighborLists findNeighbors(const spherical_param::Positions& points, Index k) {
  spherical_param::NeighborLists lists;
  std::vector<Index> order(static_cast<std::size_t>(points.cols()));
  for (Index i = 0; i < points.cols(); ++i) {
    std::iota(order.begin(), order.end(), 0);
    std::partial_sort(order.begin(), order.begin() + k, order.end(), [&](Index a, Index b) {
      return (points.col(a) - points.col(i)).squaredNorm() <
             (points.col(b) - points.col(i)).squaredNorm();
    });
    lists.indices.insert(lists.indices.end(), order.begin(), order.begin() + k);
    lists.offsets.push_back(lists.indices.size());
  }
  return lists;
}

// Closed and oriented: every directed edge once, and its reverse once.
bool isClosed(const spherical_param::Triangles& triangles) {
  std::set<std::pair<Index, Index>> edges;
  for (Index t = 0; t < triangles.cols(); ++t) {
    for (Index c = 0; c < 3; ++c) {
      if (!edges.insert({triangles(c, t), triangles((c + 1) % 3, t)}).second) {
        return false;
      }
    }
  }
  return std::all_of(edges.begin(), edges.end(), [&edges](const std::pair<Index, Index>& edge) {
    return edges.count({edge.second, edge.first}) == 1;
  });
}

}  // namespace

int main() {
  const spherical_param::Positions points = makePoints(400);
  const spherical_param::Result result =
      spherical_param::reconstruct(points, findNeighbors(points, 26));
  const bool good = result.triangles.cols() == 2 * points.cols() - 4 && isClosed(result.triangles);
  std::cout << "spherical_param " << SPHERICAL_PARAM_VERSION << ": " << result.triangles.cols()
            << " triangles, " << (good ? "closed" : "NOT closed") << "\n";
  return good ? 0 : 1;
}
