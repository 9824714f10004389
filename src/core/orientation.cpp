#include "orientation.h"

#include "exact_predicates.h"

#include <Eigen/Geometry>

#include <cmath>

namespace spherical_param {
namespace internal {
namespace {

double signOf(double x) {
  return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0;
}

/// The mean over the area of a surface of what holds for a triangle, in [-1, 1].
///
/// \param side of the corners, 3 x 1 indices, and the normal, of length 1.
template <typename Side>
double meanOver(const Positions& points, const Triangles& surface, const Side& side) {
  double sum = 0.0;
  double area = 0.0;
  for (const auto& corners : surface.colwise()) {
    const Eigen::Vector3d a = points.col(corners[0]);
    const Eigen::Vector3d normal = (points.col(corners[1]) - a).cross(points.col(corners[2]) - a);
    const double twice = normal.norm();
    if (!(twice > 0.0))
      continue;
    sum += twice * side(corners, normal / twice);
    area += twice;
  }
  return area > 0.0 ? sum / area : 0.0;
}

}  // namespace

void mirror(Embedding& embedding) {
  embedding.directions = -embedding.directions;
  for (HistoryFrame& frame : embedding.history.frames)
    frame.sphere = -frame.sphere;
}

void orientOutward(const Positions& points, Triangles& triangles, Embedding& embedding) {
  // Exactly: the volume of a cloud that is nearly flat may be all rounding.
  if (volumeSign(points, triangles) >= 0)
    return;
  flipOrientation(triangles);
  mirror(embedding);
}

FacedBy orient(const Positions& points, const Facing& facing, const Triangles& surface,
               Triangles& triangles, Embedding& embedding) {
  const bool is_open = surface.cols() > 0;
  const Triangles& seen = is_open ? surface : triangles;
  const auto decides = [&](double agreement, double least) {
    if (agreement <= -least) {
      flipOrientation(triangles);
      mirror(embedding);
    }
    return std::abs(agreement) >= least;
  };
  // On three quarters of the area.
  constexpr double min_of_normals = 0.5;
  if (facing.normals.cols() > 0) {
    const auto side = [&](const auto& corners, const Eigen::Vector3d& normal) {
      return signOf(normal.dot(facing.normals.col(corners[0]) + facing.normals.col(corners[1]) +
                               facing.normals.col(corners[2])));
    };
    if (decides(meanOver(points, seen, side), min_of_normals))
      return FacedBy::Normals;
  }
  if (!is_open) {
    orientOutward(points, triangles, embedding);
    return FacedBy::Outward;
  }
  double seen_by_sensor = 0.0;
  if (facing.viewpoint)
    seen_by_sensor =
        meanOver(points, seen, [&](const auto& corners, const Eigen::Vector3d& normal) {
          return normal.dot((*facing.viewpoint - points.col(corners[0])).normalized());
        });
  // The means of cosines: a terrain is seen at a low angle from beside, an object from in front;
  // a hemisphere is 0.5 up.
  constexpr double min_seen = 0.5;
  constexpr double min_up = 0.7;
  constexpr double min_hardly_seen = 0.05;
  if (decides(seen_by_sensor, min_seen))
    return FacedBy::Viewpoint;
  if (decides(meanOver(points, seen, [](const auto&, const auto& normal) { return normal.z(); }),
              min_up))
    return FacedBy::Up;
  if (decides(seen_by_sensor, min_hardly_seen))
    return FacedBy::Viewpoint;
  orientOutward(points, triangles, embedding);
  return FacedBy::Outward;
}

}  // namespace internal

bool isWithinBox(const Positions& points, const Eigen::Vector3d& place) {
  Eigen::AlignedBox3d box;
  for (const auto& point : points.colwise())
    if (point.allFinite())
      box.extend(Eigen::Vector3d(point));
  return box.contains(place);
}

}  // namespace spherical_param
