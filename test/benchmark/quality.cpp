// What the referee, suite/quality.py, leaves to C++. Arrays hold x, y and z of each point, or the
// corners of each triangle, one after the other.

#include "spherical_param/map/sphere_map.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"

#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace {

using namespace spherical_param;
using Eigen::Vector3d;

struct Mesh {
  Eigen::Map<const Positions> points;
  Eigen::Map<const Triangles> triangles;
};

double fromSegment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d edge = b - a;
  const double along = std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (a + along * edge - p).squaredNorm();
}

/// The square of the distance from a triangle: from its plane above it, else from a side.
double fromTriangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a).normalized();
  const auto is_inside = [&](const Vector3d& from, const Vector3d& to) {
    return (to - from).cross(p - from).dot(normal) >= 0.0;
  };
  if (is_inside(a, b) && is_inside(b, c) && is_inside(c, a)) {
    const double height = (p - a).dot(normal);
    return height * height;
  }
  return std::min({fromSegment(p, a, b), fromSegment(p, b, c), fromSegment(p, c, a)});
}

using Tree = Eigen::KdBVH<double, 3, Eigen::Index>;

/// What Eigen asks while it walks over the tree. Names are Eigen's.
struct Search {
  using Scalar = double;

  const Mesh& mesh;
  Vector3d query;
  double least = std::numeric_limits<double>::infinity();
  Eigen::Index nearest = 0;

  double minimumOnVolume(const Tree::Volume& box) const {
    return box.squaredExteriorDistance(query);
  }
  double minimumOnObject(Eigen::Index t) {
    const auto corner = [&](int k) { return mesh.points.col(mesh.triangles(k, t)); };
    const double distance = fromTriangle(query, corner(0), corner(1), corner(2));
    if (distance < least) {
      least = distance;
      nearest = t;
    }
    return distance;
  }
};

}  // namespace

extern "C" {

/// Whether a mesh is a manifold, oriented or not. The figures: components, boundary loops, Euler
/// characteristic, and the genus of an oriented manifold, else -1. Vertices without triangles do
/// not matter.
std::int64_t check_topology(const Index* triangles, std::int64_t count, std::int64_t vertices,
                            std::int64_t* figures) {
  const MeshTopology topology = checkTopology(Eigen::Map<const Triangles>(triangles, 3, count),
                                              static_cast<std::size_t>(vertices));
  figures[0] = static_cast<std::int64_t>(topology.components);
  figures[1] = static_cast<std::int64_t>(topology.boundary_loops);
  figures[2] = topology.euler_characteristic;
  figures[3] = topology.genus.value_or(-1);
  return topology.manifold() ? 1 : 0;
}

/// The number of pairs of triangles that intersect.
std::int64_t self_intersections(const double* points, std::int64_t vertices, const Index* triangles,
                                std::int64_t count) {
  return static_cast<std::int64_t>(
      findSelfIntersections(Eigen::Map<const Positions>(points, 3, vertices),
                            Eigen::Map<const Triangles>(triangles, 3, count))
          .size());
}

/// Of each query the nearest triangle, and the square of the distance from it. No triangle may be
/// without a plane.
void find_nearest(const double* points, std::int64_t vertices, const Index* triangles,
                  std::int64_t count, const double* queries, std::int64_t query_count,
                  double* squared_distances, std::int64_t* nearest) {
  const Mesh mesh{{points, 3, vertices}, {triangles, 3, count}};
  std::vector<Eigen::Index> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  std::vector<Tree::Volume> boxes(all.size());
  for (const Eigen::Index t : all)
    for (int k = 0; k < 3; ++k)
      boxes[static_cast<std::size_t>(t)].extend(mesh.points.col(mesh.triangles(k, t)));
  const Tree tree(all.begin(), all.end(), boxes.begin(), boxes.end());
  for (std::int64_t i = 0; i < query_count; ++i) {
    Search search{mesh, Eigen::Map<const Vector3d>(queries + 3 * i)};
    squared_distances[i] = Eigen::BVMinimize(tree, search);
    nearest[i] = search.nearest;
  }
}

/// The mean distortion of angles by a map to the sphere, and its flipped triangles.
void map_distortion(const double* points, std::int64_t vertices, const Index* triangles,
                    std::int64_t count, const double* sphere, double* figures) {
  const MapDistortion map =
      measureMapDistortion(Eigen::Map<const Positions>(points, 3, vertices),
                           Eigen::Map<const Triangles>(triangles, 3, count),
                           Eigen::Map<const Positions>(sphere, 3, vertices).colwise().normalized());
  figures[0] = map.angle.mean;
  figures[1] = map.flipped_triangles;
}

}  // extern "C"
