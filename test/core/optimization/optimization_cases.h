#pragma once

#include "embedding.h"
#include "energy_mesh.h"
#include "graph.h"
#include "graphs.h"
#include "sphere_mesh.h"
#include "spherical_param/sphere_triangulation.h"
#include "surface_energy.h"

/// Meshes to optimise, and the energy from its definition.
namespace spherical_param::test {

using Bend = SurfaceEnergy::Bend;

/// A mesh, and the graph that its cloud has.
struct Case {
  Positions points;
  Triangles triangles;
  Graph graph;
};

/// Flips at random, whatever the shape.
inline Case scrambled(Case of, int flips, std::uint64_t seed) {
  SphereMesh mesh(of.triangles, columnCount(of.points));
  std::mt19937_64 random(seed);
  for (int i = 0; i < flips; ++i)
    mesh.flip(static_cast<Index>(random() % static_cast<std::uint64_t>(mesh.size())),
              static_cast<int>(random() % 3));
  of.triangles = mesh.triangles();
  return of;
}

/// Seen from the centroid: right for a star-shaped cloud, folded for others.
inline Case radialStart(const Positions& points) {
  return {points, triangulateSphere(projectFromCentroid(points)), localDelaunayGraph(points).graph};
}

/// An affine image of an even sphere, with its convex hull, which is the best mesh there is.
inline Case ellipsoid(Index n, double b, double c) {
  const Positions sphere = spiralSphere(n);
  const Triangles hull = triangulateSphere(sphere);
  const Positions points = Eigen::Vector3d(1.0, b, c).asDiagonal() * sphere;
  return {points, hull, graphOfMesh(points, hull)};
}

inline Case scrambledEllipsoid(Index n, double c, int flips, std::uint64_t seed) {
  return scrambled(ellipsoid(n, 0.8, c), flips, seed);
}

/// A cloud of a noisy sphere with the triangles of the sphere.
///
/// \param noise its standard deviation [distance of the points]
inline Case noisySphere(Index n, double noise, std::uint64_t seed) {
  const Positions sphere = spiralSphere(n);
  const Triangles hull = triangulateSphere(sphere);
  const Positions points = withNoise(sphere, noise * sphereSpacing(n), seed);
  return {points, hull, graphOfMesh(points, hull)};
}

/// Clouds on which all moves have something to do.
inline std::vector<Case> roughCases() {
  return {scrambledEllipsoid(300, 0.3, 400, 1), noisySphere(300, 0.5, 2),
          radialStart(withNoise(bentTube(12.0, 2.5, 10).points, 0.02, 3))};
}

inline EnergyMesh meshOf(const Case& of, Bend bend = Bend::Angle, double mu = 0.3) {
  EnergyMesh mesh(of.points, SphereMesh(of.triangles, columnCount(of.points)), of.graph, 1);
  mesh.setEnergy(bend, mu);
  return mesh;
}

/// Equation (1) of optimizeMesh(), or its variants.
inline double energyOf(const Positions& points, const Triangles& triangles, Bend bend = Bend::Angle,
                       double mu = 0.3) {
  std::map<std::pair<Index, Index>, Eigen::Vector3d> normal_left_of;
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = points.col(triangles(0, t));
    const Eigen::Vector3d b = points.col(triangles(1, t));
    const Eigen::Vector3d c = points.col(triangles(2, t));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const std::array<double, 3> sides{(b - a).norm(), (c - b).norm(), (a - c).norm()};
    const double bound = 4.0 * *std::max_element(sides.begin(), sides.end());
    sum += mu * std::min(bound, sides[0] * sides[1] * sides[2] / (2.0 * normal.norm()));
    for (int k = 0; k < 3; ++k)
      normal_left_of[{triangles(k, t), triangles((k + 1) % 3, t)}] = normal.normalized();
  }
  for (const auto& [edge, left] : normal_left_of) {
    const auto [v, w] = edge;
    if (v > w)
      continue;
    const Eigen::Vector3d& right = normal_left_of.at({w, v});
    const double angle = std::atan2(left.cross(right).norm(), left.dot(right));
    const double length = (points.col(v) - points.col(w)).norm();
    if (bend == Bend::Angle)
      sum += length * angle;
    else if (bend == Bend::Power)
      sum += length * std::pow(angle, 1.5);
    else
      sum += length * std::max(0.0, angle - kPi / 18.0);
  }
  return sum;
}

}  // namespace spherical_param::test
