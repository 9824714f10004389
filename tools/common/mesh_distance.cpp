#include "common/mesh_distance.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace spherical_param::tools {
namespace {

double squaredDistanceFromSegment(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b) {
  const Eigen::Vector3d edge = b - a;
  const double length = edge.squaredNorm();
  const double fraction = length > 0.0 ? std::clamp((point - a).dot(edge) / length, 0.0, 1.0) : 0.0;
  return (a + fraction * edge - point).squaredNorm();
}

double squaredDistance(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                       const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double length = normal.squaredNorm();
  const auto is_inside = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return (to - from).cross(point - from).dot(normal) >= 0.0;
  };
  if (length > 0.0 && is_inside(a, b) && is_inside(b, c) && is_inside(c, a)) {
    const double height = (point - a).dot(normal);
    return height * height / length;
  }
  return std::min({squaredDistanceFromSegment(point, a, b), squaredDistanceFromSegment(point, b, c),
                   squaredDistanceFromSegment(point, c, a)});
}

/// The triangles at each vertex.
std::vector<std::vector<Index>> trianglesAt(const Triangles& triangles, Eigen::Index vertices) {
  std::vector<std::vector<Index>> stars(static_cast<std::size_t>(vertices));
  for (Eigen::Index i = 0; i < triangles.size(); ++i) {
    stars[static_cast<std::size_t>(triangles(i))].push_back(static_cast<Index>(i / 3));
  }
  return stars;
}

}  // namespace

DistanceStatistics distanceFromMesh(const Positions& points, const Positions& directions,
                                    const SphereSurface& mesh) {
  const Triangles& triangles = mesh.triangles();
  const Positions& corners = mesh.points();
  const std::vector<std::vector<Index>> stars = trianglesAt(triangles, corners.cols());
  const std::vector<SphereLocation> locations = mesh.evaluate(directions).locations;
  DistanceStatistics distances;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const auto from_triangle = [&](Index triangle) {
      const auto t = triangles.col(triangle);
      return squaredDistance(points.col(i), corners.col(t[0]), corners.col(t[1]),
                             corners.col(t[2]));
    };
    Index nearest = locations[static_cast<std::size_t>(i)].triangle;
    double least = from_triangle(nearest);
    for (bool came_nearer = true; came_nearer;) {
      came_nearer = false;
      const Eigen::Matrix<Index, 3, 1> center = triangles.col(nearest);
      for (const Index vertex : center) {
        for (const Index triangle : stars[static_cast<std::size_t>(vertex)]) {
          const double distance = from_triangle(triangle);
          if (distance < least) {
            least = distance;
            nearest = triangle;
            came_nearer = true;
          }
        }
      }
    }
    sum += std::sqrt(least);
    sum_of_squares += least;
    distances.max = std::max(distances.max, std::sqrt(least));
  }
  if (points.cols() > 0) {
    const auto count = static_cast<double>(points.cols());
    distances.mean = sum / count;
    distances.rms = std::sqrt(sum_of_squares / count);
  }
  return distances;
}

}  // namespace spherical_param::tools
