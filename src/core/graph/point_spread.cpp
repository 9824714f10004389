#include "point_spread.h"

#include "indexed.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Some columns of a matrix, evenly spread over it.
Positions someOf(const Positions& points, Eigen::Index count) {
  const Eigen::Index taken = std::min(count, points.cols());
  Positions some(3, taken);
  for (Eigen::Index i = 0; i < taken; ++i)
    some.col(i) = points.col(i * points.cols() / taken);
  return some;
}

}  // namespace

std::vector<Index> withinTwoSteps(const Graph& graph, Index node) {
  std::vector<Index> near(graph.row(node).begin(), graph.row(node).end());
  for (const Index v : graph.row(node))
    near.insert(near.end(), graph.row(v).begin(), graph.row(v).end());
  sortUnique(near);
  near.erase(std::remove(near.begin(), near.end(), node), near.end());
  return near;
}

bool fillVolume(const Positions& points) {
  constexpr Eigen::Index min_points = 500;
  // Surfaces have 1.7 to 2.3, with noise of twice the spacing 2.4; solids have 2.6 to 2.8.
  constexpr double min_dimension = 2.55;
  if (points.cols() < min_points)
    return false;
  const Positions centers = someOf(points, 100);
  const Positions others = someOf(points, 4096);
  const auto nth = [&](Eigen::VectorXd& distances, Eigen::Index n) {
    std::nth_element(distances.begin(), distances.begin() + n, distances.end());
    return distances[n];
  };
  std::vector<double> dimensions;
  for (const auto& center : centers.colwise()) {
    Eigen::VectorXd distances = (others.colwise() - center).colwise().norm();
    const double far = nth(distances, distances.size() / 8);
    const double near = nth(distances, distances.size() / 64);
    dimensions.push_back(near > 0.0 && far > near ? std::log(8.0) / std::log(far / near) : 0.0);
  }
  return medianOf(dimensions) > min_dimension;
}

bool areOnLines(const Positions& points, const Graph& graph) {
  // The ratio of the squared spreads of the four nearest points across and along is 0.25 and more
  // of surfaces, 0.001 of contours five times as far apart as the points on them.
  constexpr double max_ratio = 0.02;
  constexpr std::size_t neighbors = 4;
  constexpr std::size_t min_points = 100;
  std::vector<double> ratios;
  const auto step = static_cast<Index>(graph.size() / 1000 + 1);
  for (Index v = 0; v < points.cols(); v += step) {
    std::vector<Index> near = withinTwoSteps(graph, v);
    if (near.size() < neighbors)
      continue;
    const auto distance = [&](Index w) { return (points.col(w) - points.col(v)).norm(); };
    std::partial_sort(near.begin(), near.begin() + neighbors, near.end(),
                      [&](Index a, Index b) { return distance(a) < distance(b); });
    near.resize(neighbors);
    const Eigen::Matrix3Xd offsets = points(Eigen::all, near).colwise() - points.col(v);
    const Eigen::Vector3d squares =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(offsets * offsets.transpose()).eigenvalues();
    ratios.push_back(squares[2] > 0.0 ? squares[1] / squares[2] : 1.0);
  }
  return ratios.size() >= min_points && medianOf(ratios) < max_ratio;
}

bool areOnGrid(const Positions& points) {
  // Of the points of the grid that are seen along the third axis.
  constexpr double min_taken = 0.5;
  std::array<double, 3> counts{};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values(points.row(axis).begin(), points.row(axis).end());
    sortUnique(values);
    counts[static_cast<std::size_t>(axis)] = static_cast<double>(values.size());
  }
  std::sort(counts.begin(), counts.end());
  return min_taken * counts[0] * counts[1] <= static_cast<double>(points.cols());
}

}  // namespace spherical_param::internal
