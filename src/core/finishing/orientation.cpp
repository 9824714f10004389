#include "orientation.h"

#include "corner_table.h"
#include "exact_predicates.h"

#include <cmath>

namespace spherical_param {
namespace internal {
namespace {

/// The mean of side(corners, normal) over the area of a surface, in [-1, 1].
///
/// \param side takes the corners, 3 x 1 indices, and the normal, of length 1.
template <typename Side>
double meanOver(const Positions& points, const Triangles& surface, const Side& side) {
  double sum = 0.0;
  double area = 0.0;
  for (Eigen::Index t = 0; t < surface.cols(); ++t) {
    const Eigen::Vector3d normal = areaNormal(points, surface, t);
    const double twice = normal.norm();
    if (!(twice > 0.0))
      continue;
    sum += twice * side(surface.col(t), normal / twice);
    area += twice;
  }
  return area > 0.0 ? sum / area : 0.0;
}

}  // namespace

double agreementWith(const Positions& normals, const Positions& points, const Triangles& surface) {
  return meanOver(points, surface, [&](const auto& corners, const Eigen::Vector3d& normal) {
    const double along =
        normal.dot(normals.col(corners[0]) + normals.col(corners[1]) + normals.col(corners[2]));
    return along > 0.0 ? 1.0 : along < 0.0 ? -1.0 : 0.0;
  });
}

void mirror(Embedding& embedding) {
  embedding.directions = -embedding.directions;
}

void orientOutward(const Positions& points, SphereMesh& mesh, Embedding& embedding) {
  // Exactly: the volume of a cloud that is nearly flat may be all rounding.
  if (volumeSign(points, mesh.triangles()) >= 0)
    return;
  mesh.turnOver();
  mirror(embedding);
}

FacedBy orient(const Positions& points, const CloudInfo& info, SphereMesh& mesh,
               Embedding& embedding) {
  const Triangles seen = mesh.surfaceTriangles();
  const bool is_open = mesh.hasOpen();
  const auto turns = [&](double agreement, double least) {
    if (agreement <= -least) {
      mesh.turnOver();
      mirror(embedding);
    }
    return std::abs(agreement) >= least;
  };
  // On three quarters of the area.
  constexpr double min_of_normals = 0.5;
  if (info.normals.cols() > 0 && turns(agreementWith(info.normals, points, seen), min_of_normals))
    return FacedBy::Normals;
  if (!is_open) {
    orientOutward(points, mesh, embedding);
    return FacedBy::Outward;
  }
  double seen_by_sensor = 0.0;
  if (info.viewpoint)
    seen_by_sensor =
        meanOver(points, seen, [&](const auto& corners, const Eigen::Vector3d& normal) {
          return normal.dot((*info.viewpoint - points.col(corners[0])).normalized());
        });
  // The means of cosines: a wall that a camera of 60 degrees sees from in front has 0.9, a terrain
  // of five times its height seen from below its middle 0.4; a hemisphere is 0.5 up, a terrain 0.9.
  constexpr double min_seen = 0.5;
  constexpr double min_up = 0.7;
  constexpr double min_hardly_seen = 0.05;
  if (turns(seen_by_sensor, min_seen))
    return FacedBy::Viewpoint;
  const auto up = [](const auto&, const Eigen::Vector3d& normal) { return normal.z(); };
  if (turns(meanOver(points, seen, up), min_up))
    return FacedBy::Up;
  if (turns(seen_by_sensor, min_hardly_seen))
    return FacedBy::Viewpoint;
  orientOutward(points, mesh, embedding);
  return FacedBy::Outward;
}

}  // namespace internal

std::optional<Eigen::Vector3d> viewpointOf(const Positions& points, const Eigen::Vector3d& sensor,
                                           bool has_rows) {
  Eigen::AlignedBox3d box;
  for (const auto& point : points.colwise())
    if (point.allFinite())
      box.extend(Eigen::Vector3d(point));
  const bool is_known = has_rows || !sensor.isZero(0.0) || !box.contains(sensor);
  return is_known && sensor.allFinite() ? std::optional<Eigen::Vector3d>(sensor) : std::nullopt;
}

}  // namespace spherical_param
