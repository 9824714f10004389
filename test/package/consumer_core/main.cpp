#include <spherical_param/map/sphere_map.h>
#include <spherical_param/reconstruct.h>
#include <spherical_param/version.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>
#include <utility>

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
  const spherical_param::Result result = spherical_param::reconstruct(points);
  const spherical_param::SphereMap map =
      spherical_param::computeSphereMap(points, result.triangles, result.sphere);
  const bool good = result.triangles.cols() == 2 * points.cols() - 4 &&
                    isClosed(result.triangles) && map.distortion.flipped_triangles == 0;
  std::cout << "spherical_param " << SPHERICAL_PARAM_VERSION << ": " << result.triangles.cols()
            << " triangles, " << (good ? "closed" : "NOT closed") << "\n";
  return good ? 0 : 1;
}
