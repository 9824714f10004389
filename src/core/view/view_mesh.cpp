#include "view_mesh.h"

#include "exact_predicates.h"
#include "incremental_delaunay.h"
#include "parallel.h"

#include <algorithm>
#include <cmath>

namespace spherical_param::internal {
namespace {

class Repair {
public:
  Repair(const Positions& points, const Eigen::Vector3d& place, SphereMesh& mesh)
      : points_(points), place_(place), mesh_(mesh) {}

  bool faces(Index a, Index b, Index c) const {
    return orientation3d(place_, points_.col(a), points_.col(b), points_.col(c)) > 0;
  }
  bool faces(Index t) const {
    const auto& v = mesh_.vertices(t);
    return v[0] < 0 || faces(v[0], v[1], v[2]);
  }

  /// Flips a side of a triangle if both then face.
  bool flipSide(Index t) {
    for (int k = 0; k < 3; ++k) {
      const auto [a, b, c, d] = mesh_.diamond(t, k);
      if (c != d && faces(c, a, d) && faces(c, d, b) && mesh_.flip(t, k))
        return true;
    }
    return false;
  }

  /// Takes a vertex out, if that leaves triangles that face only.
  bool takeOut(Index v) {
    while (mesh_.degree(v) > 3) {
      const auto cuts = [&](Index t, int corner) {
        const int k = (corner + 1) % 3;  // side from v to the next but one
        const auto [a, b, c, d] = mesh_.diamond(t, k);
        // v is a or b: the triangle without it has to face.
        const bool without = (a == v ? faces(c, d, b) : faces(c, a, d));
        if (!without)
          return false;
        // no other neighbour inside: the rest stays star-shaped if the other part faces, or is flat
        const int rest = a == v ? orientation3d(place_, points_.col(c), points_.col(a), points_.col(d))
                                : orientation3d(place_, points_.col(c), points_.col(d), points_.col(b));
        return rest >= 0 && mesh_.flip(t, k);
      };
      if (!mesh_.anyAround(v, cuts))
        return false;
    }
    const Index t = mesh_.merge(v);
    if (t < 0)
      return false;
    return true;
  }

private:
  const Positions& points_;
  const Eigen::Vector3d& place_;
  SphereMesh& mesh_;
};

}  // namespace

Positions directionsFrom(const Eigen::Vector3d& place, const Positions& points) {
  Positions directions = points.colwise() - place;
  for (Eigen::Index i = 0; i < directions.cols(); ++i)
    directions.col(i).normalize();
  return directions;
}

std::optional<ViewMesh> triangulateView(const Positions& points, const Eigen::Vector3d& place, const Execution&) {
  const Eigen::Index n = points.cols();
  Positions directions = directionsFrom(place, points);
  if (!directions.allFinite())
    return std::nullopt;
  ViewMesh result;
  const Eigen::Vector3d mean = directions.rowwise().mean();
  const bool in_front = mean.norm() > 0 && (mean.transpose() * directions).minCoeff() > 1e-3 * mean.norm();
  result.points = points;
  if (in_front) {
    result.points.conservativeResize(3, n + 1);
    directions.conservativeResize(3, n + 1);
    result.points.col(n) = place - mean.normalized();
    directions.col(n) = -mean.normalized();
    result.behind = static_cast<Index>(n);
  }
  const SphereDelaunay delaunay = incrementalDelaunay(directions, {});
  directions.resize(3, 0);
  SphereMesh mesh(delaunay.triangles, static_cast<std::size_t>(result.points.cols()));
  Repair repair(result.points, place, mesh);
  std::vector<Index> bad;
  for (Index t = 0; t < mesh.size(); ++t)
    if (!repair.faces(t))
      bad.push_back(t);
  fprintf(stderr, "behind %d coincident %d bad %zu", result.behind, delaunay.coincident, bad.size());
  std::size_t left = 0;
  for (int round = 0; round < 5 && !bad.empty(); ++round) {
    std::vector<Index> still;
    for (const Index t : bad)
      if (!repair.faces(t) && !repair.flipSide(t))
        still.push_back(t);
    bad.clear();
    for (const Index t : still)
      if (!repair.faces(t))
        bad.push_back(t);
  }
  left = bad.size();
  for (const Index t : bad) {
    if (repair.faces(t))
      continue;
    for (int k = 0; k < 3; ++k) {
      const Index v = mesh.vertex(t, k);
      if (v == result.behind)
        continue;
      if (repair.takeOut(v)) {
        result.hidden.push_back(v);
        break;
      }
    }
  }
  std::size_t still = 0;
  for (Index t = 0; t < mesh.size(); ++t)
    still += !repair.faces(t);
  fprintf(stderr, " unflippable %zu hidden %zu still %zu\n", left, result.hidden.size(), still);
  result.triangles = mesh.triangles();
  return result;
}

}  // namespace spherical_param::internal
