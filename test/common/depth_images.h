#pragma once

#include "helpers.h"

#include <functional>

namespace spherical_param::test {

/// Depth along z of what a ray through (x, y, 1) hits.
using Depth = std::function<double(double, double)>;

/// What a camera at the origin sees along z, with an image plane of [-0.5, 0.5].
inline Positions depthImage(int columns, int rows, const Depth& depth) {
  return gridOf(rows, columns, [&](int row, int column) {
    const double x = (column + 0.5) / columns - 0.5;
    const double y = (row + 0.5) / rows - 0.5;
    return Eigen::Vector3d(depth(x, y) * Eigen::Vector3d(x, y, 1.0));
  });
}

/// A box before a wall.
inline double boxBeforeWall(double x, double y) {
  return std::abs(x) < 0.2 && std::abs(y) < 0.15 ? 2.0 : 3.0;
}

/// A room: a wall, a floor, and a ball on it.
inline double ballInRoom(double x, double y) {
  const double depth = y > 0.1 ? std::min(3.0, 0.6 / y) : 3.0;
  // The ball |p - (0, 0.3, 2)| = 0.3.
  const Eigen::Vector3d ray(x, y, 1.0);
  const double along = ray.dot(Eigen::Vector3d(0.0, 0.3, 2.0)) / ray.squaredNorm();
  const double missed = (along * ray - Eigen::Vector3d(0.0, 0.3, 2.0)).squaredNorm();
  return missed < 0.09 ? along - std::sqrt((0.09 - missed) / ray.squaredNorm()) : depth;
}

/// Noise along the rays from the origin.
inline Positions withDepthNoise(Positions points, double sigma, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  for (auto point : points.colwise())
    point *= 1.0 + noise(random);
  return points;
}

/// Turned and moved.
inline Positions elsewhere(const Positions& points) {
  const Eigen::AngleAxisd turn(2.0, Eigen::Vector3d(1.0, -2.0, 0.5).normalized());
  return (turn.toRotationMatrix() * points).colwise() + Eigen::Vector3d(5.0, -3.0, 8.0);
}

}  // namespace spherical_param::test
