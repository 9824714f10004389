#pragma once

#include "graphs.h"
#include "open_shapes.h"
#include "spherical_param/sphere_triangulation.h"

/// Clouds to diagnose, with meshes that are spheres and graphs that show what the clouds are.
namespace spherical_param::test {

struct Scene {
  Positions points;
  Triangles triangles;
  NeighborGraph graph;
};

inline Triangles hullOf(const Positions& directions) {
  return triangulateSphere(directions);
}

/// A star-shaped cloud and its mesh: the convex hull of the directions.
inline Scene starShaped(const Positions& directions, const Positions& points) {
  return {points, hullOf(directions), localDelaunayGraph(points)};
}

/// A sphere without the cap beyond x = height.
inline Scene openSphere(Index n, double height) {
  const Positions open =
      pointsWhere(spiralSphere(n), [&](const Eigen::Vector3d& p) { return p.x() < height; });
  return starShaped(open, open);
}

/// A torus whose mesh is cut through the tube and closed by two flat discs there: a sphere. The
/// graph is that of the whole torus; 2 x ring of its edges cross the cut.
inline Scene cutTorus(int rings, int ring, double tube_radius) {
  const auto n = static_cast<Index>(rings * ring);
  Scene torus{{}, Triangles(3, 2 * n - 4), {}};
  torus.points = gridOf(rings, ring, [=](int r, int k) {
    const double around = 2.0 * kPi * r / rings;
    const double angle = 2.0 * kPi * k / ring;
    const double radius = 1.0 + tube_radius * std::cos(angle);
    return Eigen::Vector3d(radius * std::cos(around), radius * std::sin(around),
                           tube_radius * std::sin(angle));
  });
  const Triangles whole = torusTriangles(rings, ring);
  // The last ring of quads makes place for two polygons, cut in zigzag.
  const Index kept = 2 * (n - ring);
  torus.triangles.leftCols(kept) = whole.leftCols(kept);
  Eigen::Index t = kept;
  for (int low = 0, high = ring - 1; high - low >= 2;) {
    const Index next = low <= ring - 1 - high ? low + 1 : high - 1;
    torus.triangles.col(t++) << low, next, high;
    torus.triangles.col(t++) << n - ring + low, n - ring + high, n - ring + next;
    (next == low + 1 ? low : high) = next;
  }
  torus.graph.graph = graphOfMesh(torus.points, whole);
  return torus;
}

/// Two spheres, joined by a tube of six triangles.
inline Scene joinedSpheres(Index n, Index m, double distance) {
  const Triangles of_a = hullOf(spiralSphere(n));
  const Triangles of_b = hullOf(spiralSphere(m)).array() + n;
  Scene scene{horizontally(spiralSphere(n), movedTo(distance, spiralSphere(m))),
              Triangles(3, of_a.cols() + of_b.cols() + 4),
              {}};
  const Eigen::Vector3i p = of_a.col(of_a.cols() - 1);
  const Eigen::Vector3i q = of_b.col(of_b.cols() - 1);
  const Eigen::Index tube = of_a.cols() + of_b.cols() - 2;
  scene.triangles.leftCols(tube) << of_a.leftCols(of_a.cols() - 1), of_b.leftCols(of_b.cols() - 1);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    scene.triangles.col(tube + 2 * k) << p[k], p[next], q[(3 - k) % 3];
    scene.triangles.col(tube + 2 * k + 1) << p[next], q[(3 - next) % 3], q[(3 - k) % 3];
  }
  scene.graph = localDelaunayGraph(scene.points);
  return scene;
}

/// The same scene under a mesh of shuffled vertices.
inline Scene folded(Scene scene) {
  const std::vector<Index> shuffled = shuffledRange(scene.points.cols(), 3);
  scene.triangles =
      scene.triangles.unaryExpr([&](Index v) { return shuffled[static_cast<std::size_t>(v)]; })
          .eval();
  return scene;
}

}  // namespace spherical_param::test
