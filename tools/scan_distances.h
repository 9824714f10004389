#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace spherical_param::tools {

/// Negative inside; near the surface, about the signed distance to it.
using Distance = std::function<double(const Eigen::Vector3d&)>;

Distance ball(const Eigen::Vector3d& center, double radius);

/// Convex hull of two spheres, neither of which contains the other.
Distance cone(const Eigen::Vector3d& a, double radius_a, const Eigen::Vector3d& b, double radius_b);

/// Tube with round ends around an arc of a circle, which extends `reach` [rad] to both sides of its
/// middle. Directions are of any length, at right angles.
Distance arc(const Eigen::Vector3d& center, const Eigen::Vector3d& middle,
             const Eigen::Vector3d& side, double radius, double tube, double reach);

/// Ellipsoid whose first axis has the direction `forward`, in the plane y = 0.
Distance ellipsoid(const Eigen::Vector3d& center, const Eigen::Vector3d& radii,
                   const Eigen::Vector3d& forward = {1.0, 0.0, 0.0});

/// Box with edges parallel to the coordinate axes, rounded by less than each of `half_size`.
Distance box(const Eigen::Vector3d& center, const Eigen::Vector3d& half_size, double rounding);

/// Height of regular bumps within a ball: waves along three oblique axes, multiplied with each
/// other and with (1 - d^2 / R^2)^2.
Distance bumps(const Eigen::Vector3d& center, double radius, double period, double amplitude);

constexpr double carved = -1.0;

struct Part {
  Distance distance;
  double blend = 0.0;  ///< size of the fillet, about
  double sign = 1.0;   ///< or carved
};

/// Joins the parts of the middle one after the other, then those of either side, given for y > 0.
Distance body(const std::vector<Part>& middle, const std::vector<Part>& sides = {});

Eigen::Vector3d gradientAt(const Eigen::Vector3d& p, const Distance& distance);

/// Calls work(i) for each i in [0, count), on several threads.
void forEach(std::size_t count, const std::function<void(std::size_t)>& work);

/// Uniform in [0, 1), of random bits.
inline double uniform(std::uint64_t bits) {
  return static_cast<double>(bits >> 11U) * 0x1p-53;
}
/// The distributions of the standard library differ between implementations.
inline double uniform(std::mt19937_64& random) {
  return uniform(random());
}

}  // namespace spherical_param::tools
