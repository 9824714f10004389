#include "mesh_quality.h"

#include "spherical_param/self_intersection.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace spherical_param::benchmark {
namespace {

using Eigen::Vector3d;

std::array<Vector3d, 3> cornersOf(const Mesh& mesh, Eigen::Index t) {
  return {mesh.points.col(mesh.triangles(0, t)), mesh.points.col(mesh.triangles(1, t)),
          mesh.points.col(mesh.triangles(2, t))};
}

/// [degrees]
double leastAngle(const std::array<Vector3d, 3>& corners) {
  constexpr double half_turn = 180.0;
  const double pi = std::acos(-1.0);
  double least = half_turn;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d a = corners[(k + 1) % 3] - corners[k];
    const Vector3d b = corners[(k + 2) % 3] - corners[k];
    least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)) * half_turn / pi);
  }
  return least;
}

double areaOf(const std::array<Vector3d, 3>& corners) {
  return 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
}

}  // namespace

TriangleShapes measureTriangleShapes(const Mesh& mesh) {
  TriangleShapes shapes;
  std::vector<double> angles;
  angles.reserve(static_cast<std::size_t>(mesh.triangles.cols()));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const std::array<Vector3d, 3> corners = cornersOf(mesh, t);
    const double angle = leastAngle(corners);
    angles.push_back(angle);
    shapes.min_angle_mean += angle;
    shapes.share_below_10 += angle < 10.0 ? 1.0 : 0.0;
    shapes.share_below_1 += angle < 1.0 ? 1.0 : 0.0;
    shapes.zero_area_triangles += areaOf(corners) > 0.0 ? 0 : 1;
  }
  const auto count = static_cast<double>(angles.size());
  shapes.min_angle_mean /= count;
  shapes.share_below_10 /= count;
  shapes.share_below_1 /= count;
  const auto twentieth = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 20);
  std::nth_element(angles.begin(), twentieth, angles.end());
  shapes.min_angle_p05 = *twentieth;
  return shapes;
}

SelfIntersectionCount countSelfIntersections(const Mesh& mesh) {
  const auto pairs = findSelfIntersections(mesh.points, mesh.triangles);
  std::vector<char> involved(static_cast<std::size_t>(mesh.triangles.cols()), 0);
  for (const auto& [a, b] : pairs)
    involved[static_cast<std::size_t>(a)] = involved[static_cast<std::size_t>(b)] = 1;
  return {static_cast<Count>(pairs.size()), std::count(involved.begin(), involved.end(), 1)};
}

double surfaceArea(const Mesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    sum += areaOf(cornersOf(mesh, t));
  return sum;
}

double signedVolume(const Mesh& mesh, const Vector3d& apex) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto [a, b, c] = cornersOf(mesh, t);
    sum += (a - apex).dot((b - apex).cross(c - apex));
  }
  return sum / 6.0;
}

Bounds boundsOf(const Mesh& mesh) {
  return {mesh.points.rowwise().minCoeff(), mesh.points.rowwise().maxCoeff()};
}

}  // namespace spherical_param::benchmark
