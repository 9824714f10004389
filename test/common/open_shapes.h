#pragma once

#include "helpers.h"

/// Clouds of surfaces with openings, and checks of their meshes.
namespace spherical_param::test {

inline Positions pointsWhere(const Positions& points,
                             const std::function<bool(const Eigen::Vector3d&)>& condition) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (condition(points.col(i)))
      kept.push_back(i);
  return points(Eigen::all, kept);
}

/// A sphere of about n points without discs around the points of a sparse spiral.
///
/// \param radius of the discs [radius of the sphere].
inline Positions sphereWithHoles(Index n, Index holes, double radius) {
  const Positions centers = spiralSphere(holes);
  return pointsWhere(spiralSphere(n), [&](const Eigen::Vector3d& point) {
    return (centers.colwise() - point).colwise().norm().minCoeff() > radius;
  });
}

inline Positions hemisphere(Index n) {
  return pointsWhere(spiralSphere(2 * n), [](const Eigen::Vector3d& p) { return p.z() < 0.0; });
}

/// A tube of radius 1 without ends: rings of points, each turned by half a step.
inline Positions tube(int rings, int around) {
  const double step = 2.0 * kPi / around;
  return gridOf(rings, around,
                [=](int r, int a) { return onCircle(step * (a + 0.5 * r), 1.0, step * r); });
}

/// Random points of the square [0, side]^2 at z = 0, a unit apart.
inline Positions flatPatch(int side) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> jitter(0.0, 0.3);
  return gridOf(side, side, [&](int x, int y) {
    return Eigen::Vector3d{x + jitter(random), y + jitter(random), 0.0};
  });
}

/// Points of a plane, a unit apart, of which no four are on a circle.
inline Positions patchOf(int columns, int rows) {
  return gridOf(columns, rows, [=](int x, int y) {
    const int i = x * rows + y;
    return Eigen::Vector3d(x + 0.01 * (i * i % 7), y + 0.01 * (i * i % 5), 0.0);
  });
}

/// The boundary of a mesh, found edge by edge from the triangles alone: each vertex on it and the
/// next one, with the surface on the left. A vertex that is twice on it has -2.
inline std::map<Index, Index> boundaryOf(const Triangles& triangles) {
  const std::vector<std::pair<Index, Index>> all = sidesOf(triangles);
  const std::set<std::pair<Index, Index>> sides(all.begin(), all.end());
  std::map<Index, Index> next;
  for (const auto& [v, w] : sides)
    if (sides.count({w, v}) == 0)
      next[v] = next.count(v) == 0 ? w : -2;
  return next;
}

/// The boundary loops of a mesh, as lists of vertices; nothing if they are not apart.
inline std::optional<std::vector<std::vector<Index>>> loopsOf(const Triangles& triangles) {
  std::map<Index, Index> next = boundaryOf(triangles);
  std::vector<std::vector<Index>> loops;
  while (!next.empty()) {
    const Index first = next.begin()->first;
    std::vector<Index>& loop = loops.emplace_back();
    for (auto step = next.begin(); step != next.end(); step = next.find(loop.back())) {
      if (step->second < 0)
        return std::nullopt;
      loop.push_back(step->second);
      next.erase(step);
    }
    if (loop.back() != first)
      return std::nullopt;
  }
  return loops;
}

/// A field of 18 x 18 points, of which 3 x 3 each are 0, 2.5 or 5 high, without walls.
inline Positions terraces() {
  return gridOf(18, 18, [](int i, int j) {
    const double x = j + 0.5 * (i % 2);
    const double y = std::sqrt(0.75) * i;
    const int column = std::min(static_cast<int>(x / 3.0), 5);
    const int row = static_cast<int>(y / 3.0);
    return Eigen::Vector3d(x, y, 2.5 * ((column * column + 2 * row * row + column * row) % 3));
  });
}

}  // namespace spherical_param::test
