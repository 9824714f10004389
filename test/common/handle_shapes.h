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
  const auto corner = [&](int i, int j, int k) -> Eigen::Vector3d {
    return cell * (Eigen::Vector3d(i, j, k) - cells.cast<double>() / 2.0);
  };
  const Eigen::Vector3i nodes = cells.array() + 1;
  const auto number = [&](int i, int j, int k) {
    return static_cast<std::size_t>((i * nodes.y() + j) * nodes.z() + k);
  };
  std::vector<double> values(static_cast<std::size_t>(nodes.prod()));
  for (int i = 0; i < nodes.x(); ++i)
    for (int j = 0; j < nodes.y(); ++j)
      for (int k = 0; k < nodes.z(); ++k)
        values[number(i, j, k)] = f(corner(i, j, k));
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < cells.x(); ++i)
    for (int j = 0; j < cells.y(); ++j)
      for (int k = 0; k < cells.z(); ++k) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        int crossings = 0;
        for (int a = 0; a < 8; ++a)
          for (const int bit : {1, 2, 4}) {
            const int b = a | bit;
            const auto at = [&](int c) {
              return std::array<int, 3>{i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1)};
            };
            const auto [ai, aj, ak] = at(a);
            const auto [bi, bj, bk] = at(b);
            const double u = values[number(ai, aj, ak)];
            const double v = values[number(bi, bj, bk)];
            if (a == b || (u < 0.0) == (v < 0.0))
              continue;
            sum += corner(ai, aj, ak) + u / (u - v) * (corner(bi, bj, bk) - corner(ai, aj, ak));
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
    const double r = radius + tube * std::cos(v);
    return Eigen::Vector3d(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
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

/// A closed curve as segments.
inline std::vector<std::array<Eigen::Vector3d, 2>>
segmentsOf(const std::function<Eigen::Vector3d(double)>& curve, int count) {
  std::vector<std::array<Eigen::Vector3d, 2>> segments;
  for (int i = 0; i < count; ++i)
    segments.push_back({curve(2.0 * kPi * i / count), curve(2.0 * kPi * (i + 1) / count)});
  return segments;
}

/// A tube along a trefoil: genus 1, knotted.
inline Positions trefoil(double spacing) {
  const auto curve = [](double t) {
    return Eigen::Vector3d(std::sin(t) + 2.0 * std::sin(2.0 * t),
                           std::cos(t) - 2.0 * std::cos(2.0 * t), -1.5 * std::sin(3.0 * t));
  };
  return netOf(tubesAround(segmentsOf(curve, 80), 0.45), {7.5, 7.5, 4.5}, spacing);
}

/// Tubes along the edges of a 3 x 3 x 3 grid of nodes: 54 - 27 + 1 = 28 handles.
inline Positions latticeOfTubes(double spacing) {
  std::vector<std::array<Eigen::Vector3d, 2>> segments;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k)
        for (int axis = 0; axis < 3; ++axis) {
          const Eigen::Vector3d a(i, j, k);
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
    return Eigen::Vector3d((3.0 + x) * std::cos(u), (3.0 + x) * std::sin(u), z);
  });
}

/// A band that is turned by half: one side, one boundary.
inline Positions moebiusBand(int rings, int across) {
  return gridOf(rings, across, [=](int i, int j) {
    const double u = 2.0 * kPi * (i + 0.5 * (j % 2)) / rings;
    const double v = 0.1 * (j - (across - 1) / 2.0);
    const double radius = 2.5 + v * std::cos(u / 2.0);
    return Eigen::Vector3d(radius * std::cos(u), radius * std::sin(u), v * std::sin(u / 2.0));
  });
}

}  // namespace spherical_param::test
