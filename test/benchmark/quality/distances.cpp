#include "mesh_quality.h"

#include <Eigen/Geometry>

#include <unsupported/Eigen/BVH>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace spherical_param::benchmark {
namespace {

using Eigen::Vector3d;

/// Triangles that are thinner than this fraction of their length, needles, have no plane in double
/// precision. They are left out: their neighbours along the longest side are as near.
constexpr double kNeedle = 1e-9;

/// The area of each triangle, its longest side and its unit normal, zero where there is no area.
struct Faces {
  explicit Faces(const Mesh& mesh)
      : areas(mesh.triangles.cols()), lengths(mesh.triangles.cols()),
        normals(3, mesh.triangles.cols()) {
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const Vector3d a = mesh.points.col(mesh.triangles(0, t));
      const Vector3d b = mesh.points.col(mesh.triangles(1, t));
      const Vector3d c = mesh.points.col(mesh.triangles(2, t));
      const Vector3d normal = (b - a).cross(c - a);
      const double length = normal.norm();
      areas[t] = 0.5 * length;
      lengths[t] = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
      normals.col(t).setZero();
      if (length > 0.0)
        normals.col(t) = normal / length;
    }
  }

  bool isNeedle(Eigen::Index t) const {
    return !(2.0 * areas[t] > kNeedle * lengths[t] * lengths[t]);
  }
  bool allNeedles() const {
    for (Eigen::Index t = 0; t < areas.size(); ++t)
      if (!isNeedle(t))
        return false;
    return true;
  }

  Eigen::VectorXd areas;
  Eigen::VectorXd lengths;
  Eigen::Matrix3Xd normals;
};

/// Points of a mesh, and the triangles that they are on.
struct Samples {
  Positions points;
  std::vector<Eigen::Index> triangles;
};

/// Evenly distributed in [0, 1), the same with any standard library.
double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11U) * 0x1p-53;
}

/// One sample in each of `count` parts of equal area; in its triangle at random (R. Osada et al.,
/// "Shape Distributions", 2002, equation 1).
Samples spread(const Mesh& mesh, const Eigen::VectorXd& areas, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const double part = areas.sum() / static_cast<double>(count);
  Samples samples{Positions(3, count), {}};
  samples.triangles.reserve(static_cast<std::size_t>(count));
  Eigen::Index t = 0;
  double before = 0.0;  // area of the triangles before t
  for (int i = 0; i < count; ++i) {
    const double place = (static_cast<double>(i) + uniform(random)) * part;
    while (t + 1 < areas.size() && before + areas[t] <= place)
      before += areas[t++];
    const double from_apex = std::sqrt(uniform(random));
    const double across = uniform(random);
    samples.points.col(i) = (1.0 - from_apex) * mesh.points.col(mesh.triangles(0, t)) +
                            from_apex * (1.0 - across) * mesh.points.col(mesh.triangles(1, t)) +
                            from_apex * across * mesh.points.col(mesh.triangles(2, t));
    samples.triangles.push_back(t);
  }
  return samples;
}

/// The nearest point of a mesh.
struct Nearest {
  double squared_distance = std::numeric_limits<double>::infinity();
  Eigen::Index triangle = 0;
};

/// The nearest point of a triangle that is no needle (C. Ericson, "Real-Time Collision Detection",
/// 2005, section 5.1.5). Signs of products tell the corner, the side or the inside.
Vector3d nearestPoint(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a;
  const Vector3d ac = c - a;
  const double a_along_ab = ab.dot(p - a);
  const double a_along_ac = ac.dot(p - a);
  if (a_along_ab <= 0.0 && a_along_ac <= 0.0)
    return a;
  const double b_along_ab = ab.dot(p - b);
  const double b_along_ac = ac.dot(p - b);
  if (b_along_ab >= 0.0 && b_along_ac <= b_along_ab)
    return b;
  const double c_along_ab = ab.dot(p - c);
  const double c_along_ac = ac.dot(p - c);
  if (c_along_ac >= 0.0 && c_along_ab <= c_along_ac)
    return c;
  const double at_c = a_along_ab * b_along_ac - b_along_ab * a_along_ac;
  if (at_c <= 0.0 && a_along_ab >= 0.0 && b_along_ab <= 0.0)
    return a + a_along_ab / (a_along_ab - b_along_ab) * ab;
  const double at_b = c_along_ab * a_along_ac - a_along_ab * c_along_ac;
  if (at_b <= 0.0 && a_along_ac >= 0.0 && c_along_ac <= 0.0)
    return a + a_along_ac / (a_along_ac - c_along_ac) * ac;
  const double at_a = b_along_ab * c_along_ac - c_along_ab * b_along_ac;
  const double from_b = b_along_ac - b_along_ab;
  const double from_c = c_along_ab - c_along_ac;
  if (at_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0)
    return b + from_b / (from_b + from_c) * (c - b);
  return a + at_b / (at_a + at_b + at_c) * ab + at_c / (at_a + at_b + at_c) * ac;
}

using Tree = Eigen::KdBVH<double, 3, Eigen::Index>;

/// Finds nearest points with Eigen's tree of bounding boxes.
class Surface {
public:
  Surface(const Mesh& mesh, const Faces& faces) : mesh_(mesh) {
    std::vector<Eigen::Index> triangles;
    std::vector<Tree::Volume> boxes;
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      if (faces.isNeedle(t))
        continue;
      triangles.push_back(t);
      Tree::Volume box;
      for (int k = 0; k < 3; ++k)
        box.extend(mesh.points.col(mesh.triangles(k, t)));
      boxes.push_back(box);
    }
    tree_.init(triangles.begin(), triangles.end(), boxes.begin(), boxes.end());
  }

  Nearest nearest(const Vector3d& query) const {
    Search search{mesh_, query, {}};
    Eigen::BVMinimize(tree_, search);
    return search.best;
  }

private:
  /// What Eigen asks while it walks over the tree. Names are Eigen's.
  struct Search {
    using Scalar = double;

    const Mesh& mesh;
    Vector3d query;
    Nearest best;

    double minimumOnVolume(const Tree::Volume& box) const {
      return box.squaredExteriorDistance(query);
    }
    double minimumOnObject(Eigen::Index t) {
      const Vector3d point = nearestPoint(query, mesh.points.col(mesh.triangles(0, t)),
                                          mesh.points.col(mesh.triangles(1, t)),
                                          mesh.points.col(mesh.triangles(2, t)));
      const double squared_distance = (point - query).squaredNorm();
      if (squared_distance < best.squared_distance)
        best = {squared_distance, t};
      return squared_distance;
    }
  };

  const Mesh& mesh_;
  Tree tree_;
};

/// What the samples of one mesh tell about the other.
struct OneWay {
  double largest = 0.0;
  double sum_of_squares = 0.0;
  double sum_of_angles = 0.0;  ///< [degrees]
  int angles = 0;
};

OneWay compare(const Mesh& from, const Faces& from_faces, const Mesh& to, const Faces& to_faces,
               int count, std::uint64_t seed) {
  const double degrees = 180.0 / std::acos(-1.0);
  const Surface surface(to, to_faces);
  const Samples samples = spread(from, from_faces.areas, count, seed);
  OneWay found;
  for (Eigen::Index i = 0; i < samples.points.cols(); ++i) {
    const Nearest nearest = surface.nearest(samples.points.col(i));
    found.largest = std::max(found.largest, nearest.squared_distance);
    found.sum_of_squares += nearest.squared_distance;
    const Vector3d normal = from_faces.normals.col(samples.triangles[static_cast<std::size_t>(i)]);
    const Vector3d other = to_faces.normals.col(nearest.triangle);
    if (normal.isZero(0.0) || other.isZero(0.0))
      continue;
    found.sum_of_angles += degrees * std::acos(std::min(1.0, std::abs(normal.dot(other))));
    ++found.angles;
  }
  std::vector<char> done(static_cast<std::size_t>(from.points.cols()), 0);
  for (const Index v : from.triangles.reshaped())
    if (done[static_cast<std::size_t>(v)]++ == 0)
      found.largest = std::max(found.largest, surface.nearest(from.points.col(v)).squared_distance);
  found.largest = std::sqrt(found.largest);
  return found;
}

}  // namespace

std::vector<double> distancesTo(const Mesh& mesh, const Positions& points) {
  const Surface surface(mesh, Faces(mesh));
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    distances.push_back(std::sqrt(surface.nearest(points.col(i)).squared_distance));
  return distances;
}

std::optional<Distances> measureDistances(const Mesh& mesh, const Mesh& truth, int samples,
                                          std::uint64_t seed) {
  const Faces faces(mesh);
  const Faces true_faces(truth);
  if (faces.allNeedles() || true_faces.allNeedles())
    return std::nullopt;
  const OneWay there = compare(mesh, faces, truth, true_faces, samples, seed);
  const OneWay back = compare(truth, true_faces, mesh, faces, samples, seed + 1);
  const double percent =
      100.0 / (truth.points.rowwise().maxCoeff() - truth.points.rowwise().minCoeff()).norm();
  return Distances{
      percent * std::max(there.largest, back.largest),
      percent * std::sqrt((there.sum_of_squares + back.sum_of_squares) / (2.0 * samples)),
      (there.sum_of_angles + back.sum_of_angles) / std::max(1, there.angles + back.angles)};
}

}  // namespace spherical_param::benchmark
