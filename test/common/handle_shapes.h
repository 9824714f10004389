#pragma once

#include "helpers.h"

/// Clouds of surfaces with handles.
namespace spherical_param::test {

/// Where a function is 0; below, it is inside.
using Implicit = std::function<double(const Eigen::Vector3d&)>;

/// A point in each cell of a grid that the surface of an implicit function passes (surface nets,
/// Gibson 1998).
///
/// \param size of the box around the origin.
/// \param cell its cells, nearly the distance of the points.
inline Positions netOf(const Implicit& f, const Eigen::Vector3d& size, double cell) {
  const Eigen::Vector3i cells = (size / cell).array().ceil().cast<int>();
  const Eigen::Vector3i nodes = cells.array() + 1;
  const auto corner = [&](const Eigen::Vector3i& node) -> Eigen::Vector3d {
    return cell * (node.cast<double>() - cells.cast<double>() / 2.0);
  };
  std::vector<double> values;
  for (const Eigen::Vector3i& node : latticeOf(nodes))
    values.push_back(f(corner(node)));
  const auto value = [&](const Eigen::Vector3i& node) {
    return values[static_cast<std::size_t>((node.x() * nodes.y() + node.y()) * nodes.z() +
                                           node.z())];
  };
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3i& place : latticeOf(cells)) {
    const auto node = [&](int c) -> Eigen::Vector3i {
      return place + Eigen::Vector3i(c & 1, c >> 1 & 1, c >> 2 & 1);
    };
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int crossings = 0;
    for (int a = 0; a < 8; ++a)
      for (const int bit : {1, 2, 4}) {
        const int b = a | bit;
        const double u = value(node(a));
        const double v = value(node(b));
        if (a == b || (u < 0.0) == (v < 0.0))
          continue;
        sum += corner(node(a)) + u / (u - v) * (corner(node(b)) - corner(node(a)));
        ++crossings;
      }
    if (crossings > 0)
      points.emplace_back(sum / crossings);
  }
  return positionsOf(points);
}

/// A torus around the z axis.
inline Implicit torusAt(const Eigen::Vector3d& center, double radius, double tube) {
  return [=](const Eigen::Vector3d& p) {
    const Eigen::Vector3d q = p - center;
    return std::hypot(std::hypot(q.x(), q.y()) - radius, q.z()) - tube;
  };
}

/// Tubes around segments.
inline Implicit tubesAround(std::vector<std::array<Eigen::Vector3d, 2>> segments, double tube) {
  return [segments = std::move(segments), tube](const Eigen::Vector3d& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : segments) {
      const Eigen::Vector3d d = b - a;
      const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (a + t * d - p).squaredNorm());
    }
    return std::sqrt(least) - tube;
  };
}

/// A torus of the grid, each ring turned by half a step.
inline Positions torusCloud(int rings, int around, double radius = 1.0, double tube = 0.4) {
  return gridOf(rings, around, [=](int i, int j) {
    const double u = 2.0 * kPi * i / rings;
    const double v = 2.0 * kPi * (j + 0.5 * (i % 2)) / around;
    return onCircle(u, radius + tube * std::cos(v), tube * std::sin(v));
  });
}

/// Two tori side by side that share a part: genus 2.
inline Positions doubleTorus(double spacing) {
  const Implicit left = torusAt({-1.1, 0.0, 0.0}, 1.0, 0.35);
  const Implicit right = torusAt({1.1, 0.0, 0.0}, 1.0, 0.35);
  return netOf([=](const Eigen::Vector3d& p) { return std::min(left(p), right(p)); },
               {5.2, 3.0, 1.2}, spacing);
}

/// A plate with five round holes: genus 5.
inline Positions plateWithHoles(double spacing) {
  return netOf(
      [](const Eigen::Vector3d& p) {
        double f = std::max({std::abs(p.x()) - 2.0, std::abs(p.y()) - 1.4, std::abs(p.z()) - 0.3});
        for (const auto& [x, y] : {std::pair(-1.2, -0.6), std::pair(-1.2, 0.7), std::pair(0.0, 0.1),
                                   std::pair(1.2, -0.7), std::pair(1.1, 0.7)})
          f = std::max(f, 0.4 - std::hypot(p.x() - x, p.y() - y));
        return f;
      },
      {4.5, 3.3, 1.1}, spacing);
}

/// A wheel of twelve teeth with a hole in the middle: genus 1, with sharp edges.
inline Positions gear(double spacing) {
  return netOf(
      [](const Eigen::Vector3d& p) {
        const double r = p.head<2>().norm();
        const double tooth = std::clamp(2.0 * std::cos(12.0 * std::atan2(p.y(), p.x())), -0.5, 0.5);
        return std::max({std::abs(p.z()) - 0.25, r - 1.0 - 0.12 * tooth, 0.4 - r});
      },
      {2.4, 2.4, 0.8}, spacing);
}

/// Tubes along the edges of a 3 x 3 x 3 grid of nodes: 54 - 27 + 1 = 28 handles.
inline Positions latticeOfTubes(double spacing) {
  std::vector<std::array<Eigen::Vector3d, 2>> segments;
  for (const Eigen::Vector3i& place : latticeOf({3, 3, 3}))
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d a = place.cast<double>().array() - 1.0;
      const Eigen::Vector3d b = a + Eigen::Vector3d::Unit(axis);
      if (b[axis] < 1.5)
        segments.push_back({a, b});
    }
  return netOf(tubesAround(segments, 0.19), {2.6, 2.6, 2.6}, spacing);
}

/// A Klein bottle in the shape of a figure 8 that is turned by half; it passes through itself.
inline Positions kleinBottle(int rings, int around) {
  return gridOf(rings, around, [=](int i, int j) {
    const double u = 2.0 * kPi * i / rings;
    const double v = 2.0 * kPi * (j + 0.5 * (i % 2)) / around;
    const double x = std::cos(u / 2.0) * std::sin(v) - std::sin(u / 2.0) * std::sin(2.0 * v);
    const double z = std::sin(u / 2.0) * std::sin(v) + std::cos(u / 2.0) * std::sin(2.0 * v);
    return onCircle(u, 3.0 + x, z);
  });
}

/// A band that is turned by half: one side, one boundary.
inline Positions moebiusBand(int rings, int across) {
  return gridOf(rings, across, [=](int i, int j) {
    const double u = 2.0 * kPi * (i + 0.5 * (j % 2)) / rings;
    const double v = 0.1 * (j - (across - 1) / 2.0);
    return onCircle(u, 2.5 + v * std::cos(u / 2.0), v * std::sin(u / 2.0));
  });
}

}  // namespace spherical_param::test
