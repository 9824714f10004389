#pragma once

#include "map_shapes.h"
#include "spherical_param/map/texture_atlas.h"

#include <gtest/gtest.h>

namespace spherical_param::test {

using Eigen::Vector2d;

/// A test of each chart.
class EachChart : public testing::TestWithParam<SphereChart> {
protected:
  TextureAtlasOptions options() const { return {GetParam(), 0.1}; }
  bool isEquirectangular() const { return GetParam() == SphereChart::Equirectangular; }
  bool isCubeMap() const { return GetParam() == SphereChart::CubeMap; }

  TextureAtlas atlasOf(const Mapped& mesh) const {
    return makeTextureAtlas(mesh.triangles, mesh.sphere, options());
  }
};

inline std::string chartName(const testing::TestParamInfo<SphereChart>& info) {
  const std::array<const char*, 3> names = {"Equirectangular", "Octahedral", "CubeMap"};
  return names[static_cast<std::size_t>(info.param)];
}

inline const auto kEachChart =
    testing::Values(SphereChart::Equirectangular, SphereChart::Octahedral, SphereChart::CubeMap);

inline std::array<Vector2d, 3> placesOf(const TextureAtlas& atlas, Eigen::Index t) {
  std::array<Vector2d, 3> places;
  for (std::size_t k = 0; k < 3; ++k)
    places[k] = atlas.coordinates.col(atlas.coordinate_triangles(static_cast<Eigen::Index>(k), t));
  return places;
}

inline double doubledArea(const std::array<Vector2d, 3>& p) {
  const Vector2d b = p[1] - p[0];
  const Vector2d c = p[2] - p[0];
  return b.x() * c.y() - b.y() * c.x();
}

/// The inverse of the charts, written down anew.
inline Vector3d directionAt(const TextureAtlasOptions& options, const Vector2d& place) {
  if (options.chart == SphereChart::Equirectangular) {
    const double longitude = (2.0 * place.x() - 1.0) * kPi;
    const double latitude = (place.y() - 0.5) * kPi;
    return onCircle(longitude, std::cos(latitude), std::sin(latitude));
  }
  if (options.chart == SphereChart::Octahedral) {
    Vector3d d(2.0 * place.x() - 1.0, 2.0 * place.y() - 1.0, 0.0);
    d.z() = 1.0 - std::abs(d.x()) - std::abs(d.y());
    if (d.z() < 0.0)
      d.head<2>() = Vector2d(std::copysign(1.0 - std::abs(d.y()), d.x()),
                             std::copysign(1.0 - std::abs(d.x()), d.y()));
    return d.normalized();
  }
  const int column = std::min(2, static_cast<int>(3.0 * place.x()));
  const bool is_upper = place.y() > 0.5;
  const auto spread = [&](double value) {
    return 2.0 * (value - options.margin) / (1.0 - 2.0 * options.margin) - 1.0;
  };
  const double s = spread(3.0 * place.x() - column);
  const double t = spread(2.0 * place.y() - (is_upper ? 1.0 : 0.0));
  const std::array<Vector3d, 6> faces = {Vector3d(1, s, t),  Vector3d(-1, -s, t),
                                         Vector3d(-s, 1, t), Vector3d(s, -1, t),
                                         Vector3d(-t, s, 1), Vector3d(t, s, -1)};
  return faces[static_cast<std::size_t>(column + (is_upper ? 0 : 3))].normalized();
}

/// All vertices but two near a great circle, so that triangles are long and thin.
inline Mapped rim(Index n, double height, const Matrix3d& rotation) {
  Positions points = randomPositions(n + 2, 7);
  points.row(2).array() *= height;
  points.col(n) << 0.1, 0.2, 0.9;
  points.col(n + 1) << -0.2, 0.1, -0.9;
  points.leftCols(n).topRows<2>().colwise().normalize();
  return mapped((rotation * points).colwise().normalized());
}

inline Matrix3d someRotation() {
  return rotationBy(1.1, {1, 2, -0.7});
}

}  // namespace spherical_param::test
