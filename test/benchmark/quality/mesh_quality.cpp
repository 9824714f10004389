#include "mesh_quality.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace spherical_param::benchmark {
namespace {

using Eigen::Vector3d;

/// Disjoint sets of [0, n).
class Sets {
public:
  explicit Sets(std::size_t n) : parents_(n), count_(n) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }

  void join(std::size_t i, std::size_t j) {
    i = find(i);
    j = find(j);
    count_ -= i != j ? 1 : 0;
    parents_[i] = j;
  }
  std::size_t count() const { return count_; }

private:
  std::size_t find(std::size_t i) {
    while (parents_[i] != i)
      i = parents_[i] = parents_[parents_[i]];
    return i;
  }

  std::vector<std::size_t> parents_;
  std::size_t count_;
};

/// A side of triangle t. Corner k of triangle t has the number 3 t + k.
struct Side {
  Index low;   ///< the lower of its vertices
  Index high;  ///< the other one
  std::size_t low_corner;
  std::size_t high_corner;
};

bool isDegenerate(const Triangles& triangles, Eigen::Index t) {
  return triangles(0, t) == triangles(1, t) || triangles(1, t) == triangles(2, t) ||
         triangles(2, t) == triangles(0, t);
}

std::vector<Side> sidesByEdge(const Triangles& triangles) {
  std::vector<Side> sides;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      Side side{triangles(k, t), triangles(next, t), static_cast<std::size_t>(3 * t + k),
                static_cast<std::size_t>(3 * t + next)};
      if (side.low > side.high)
        side = {side.high, side.low, side.high_corner, side.low_corner};
      sides.push_back(side);
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.low_corner) < std::tie(b.low, b.high, b.low_corner);
  });
  return sides;
}

/// A point in single precision.
using Place = std::array<float, 3>;

Place placeOf(const Vector3d& point) {
  // Adding 0 makes 0 of -0.
  return {static_cast<float>(point.x()) + 0.0F, static_cast<float>(point.y()) + 0.0F,
          static_cast<float>(point.z()) + 0.0F};
}

template <typename T>
std::vector<T> sortedOnce(std::vector<T> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

/// The places of the used vertices, ascending.
std::vector<Place> usedPlaces(const Mesh& mesh) {
  std::vector<Place> places;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    if (!isDegenerate(mesh.triangles, t))
      for (int k = 0; k < 3; ++k)
        places.push_back(placeOf(mesh.points.col(mesh.triangles(k, t))));
  return sortedOnce(places);
}

/// Edges between places, ascending, each once.
std::vector<std::pair<Place, Place>> edgesOf(const Mesh& mesh) {
  std::vector<std::pair<Place, Place>> edges;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int k = 0; k < 3 && !isDegenerate(mesh.triangles, t); ++k) {
      const Place a = placeOf(mesh.points.col(mesh.triangles(k, t)));
      const Place b = placeOf(mesh.points.col(mesh.triangles((k + 1) % 3, t)));
      edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  return sortedOnce(edges);
}

double percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

bool isClosedManifoldGenus0(const Mesh& mesh) {
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    if (isDegenerate(mesh.triangles, t))
      return false;
  const std::vector<Side> sides = sidesByEdge(mesh.triangles);
  const auto differ = [&](std::size_t i, std::size_t j) {
    return sides[i].low != sides[j].low || sides[i].high != sides[j].high;
  };
  const std::size_t triangles = sides.size() / 3;
  Sets fans(sides.size());     // of corners at the same vertex, joined across edges
  Sets components(triangles);  // of triangles, joined across edges
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    if (i + 1 == sides.size() || differ(i, i + 1) ||
        (i + 2 < sides.size() && !differ(i + 1, i + 2)))
      return false;
    fans.join(sides[i].low_corner, sides[i + 1].low_corner);
    fans.join(sides[i].high_corner, sides[i + 1].high_corner);
    components.join(sides[i].low_corner / 3, sides[i + 1].low_corner / 3);
  }
  const std::size_t vertices =
      sortedOnce(
          std::vector<Index>(mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size()))
          .size();
  // Euler's formula. Of the closed connected surfaces the sphere alone has 2.
  return fans.count() == vertices && components.count() == 1 &&
         vertices + triangles == sides.size() / 2 + 2;
}

double pointsUsedPercent(const Mesh& mesh, const Positions& cloud) {
  const std::vector<Place> places = usedPlaces(mesh);
  std::size_t points = 0;
  std::size_t used = 0;
  for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
    if (!cloud.col(i).allFinite())
      continue;
    ++points;
    used += std::binary_search(places.begin(), places.end(), placeOf(cloud.col(i))) ? 1 : 0;
  }
  return percent(used, points);
}

std::optional<double> edgesReproducedPercent(const Mesh& mesh, const Mesh& truth,
                                             const Positions& cloud) {
  std::vector<Place> points;
  for (Eigen::Index i = 0; i < cloud.cols(); ++i)
    if (cloud.col(i).allFinite())
      points.push_back(placeOf(cloud.col(i)));
  points = sortedOnce(points);
  const std::vector<Place> vertices = usedPlaces(truth);
  std::vector<Place> common;
  std::set_intersection(vertices.begin(), vertices.end(), points.begin(), points.end(),
                        std::back_inserter(common));
  if (percent(common.size(), vertices.size()) < 99.0)
    return std::nullopt;
  const auto edges = edgesOf(mesh);
  const auto true_edges = edgesOf(truth);
  std::vector<std::pair<Place, Place>> reproduced;
  std::set_intersection(edges.begin(), edges.end(), true_edges.begin(), true_edges.end(),
                        std::back_inserter(reproduced));
  return percent(reproduced.size(), true_edges.size());
}

TriangleShapes measureTriangleShapes(const Mesh& mesh) {
  const double degrees = 180.0 / std::acos(-1.0);
  double sum = 0.0;
  std::size_t below_10 = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    double smallest = 180.0;
    for (int k = 0; k < 3; ++k) {
      const Vector3d corner = mesh.points.col(mesh.triangles(k, t));
      const Vector3d a = mesh.points.col(mesh.triangles((k + 1) % 3, t)) - corner;
      const Vector3d b = mesh.points.col(mesh.triangles((k + 2) % 3, t)) - corner;
      smallest = std::min(smallest, degrees * std::atan2(a.cross(b).norm(), a.dot(b)));
    }
    sum += smallest;
    below_10 += smallest < 10.0 ? 1 : 0;
  }
  const auto count = static_cast<std::size_t>(mesh.triangles.cols());
  return {sum / static_cast<double>(count), percent(below_10, count)};
}

}  // namespace spherical_param::benchmark
