#include "point_spread.h"

#include "indexed.h"
#include "neighbor_search.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace spherical_param::internal {
namespace {

/// The nearest others of some points, nearest first.
using Samples = std::vector<std::vector<NearPoint>>;

Samples nearestOfSome(const Positions& points, Index count) {
  constexpr Eigen::Index max_samples = 200;
  const std::vector<Index> nodes = sampleOf(points, max_samples);
  const NeighborLists lists =
      makeNeighborSearch(points)(nodes, std::min(count, static_cast<Index>(points.cols()) - 1));
  Samples samples;
  for (const Index i : indicesOf(nodes))
    samples.push_back(nearestOthers(points, nodes[static_cast<std::size_t>(i)], listOf(lists, i)));
  return samples;
}

/// Principal axes of a point and its nearest others.
struct Axes {
  Axes(const std::vector<NearPoint>& near, std::size_t count) {
    Eigen::Matrix3Xd offsets =
        Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(std::min(count, near.size()) + 1));
    for (Eigen::Index i = 1; i < offsets.cols(); ++i)
      offsets.col(i) = near[static_cast<std::size_t>(i) - 1].offset;
    offsets.colwise() -= offsets.rowwise().mean().eval();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(offsets * offsets.transpose());
    variances = solver.eigenvalues().cwiseMax(0.0);
    direction = solver.eigenvectors().col(2);
  }
  /// Ratio of the smallest to the middle variance: 0 in a plane.
  double flatness() const { return variances[1] > 0.0 ? variances[0] / variances[1] : 0.0; }
  /// Ratio of the middle to the largest variance: 0 on a line.
  double width() const { return variances[2] > 0.0 ? variances[1] / variances[2] : 0.0; }

  Eigen::Vector3d variances;  ///< ascending
  Eigen::Vector3d direction;  ///< of the largest one
};

/// The exponent d if the number of points within a distance r grows like r^d.
double dimensionOf(const Positions& points) {
  const Positions centers = points(Eigen::all, sampleOf(points, 100));
  const Positions others = points(Eigen::all, sampleOf(points, 4096));
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
  return medianOf(dimensions);
}

bool fillVolume(const Positions& points, const Samples& samples, bool are_voxels) {
  constexpr Eigen::Index min_points = 500;
  // Ratio of variances of the 64 nearest points: volumes have 0.55 to 0.9. Surfaces that fold
  // through space, like gyroids, have the dimension of a volume, but a ratio of at most 0.28.
  constexpr double min_flatness = 0.45;
  constexpr std::size_t patch = 64;
  // Surfaces have a dimension of 1.7 to 2.4; with noise of 3 spacings up to 2.67 from 2,000 points
  // on, and up to 2.91 of fewer. Solids have 2.55 to 2.8; if their density falls from the
  // middle, 2.9.
  constexpr double min_dimension = 2.55;
  constexpr double min_of_uneven = 2.85;
  constexpr Eigen::Index min_uneven_points = 2000;
  // Dimension minus the spread of the logarithm of the density, since noise thins out across a
  // surface: volumes have 1.8 to 2, small ones 1.4 to 1.8, noisy surfaces up to 1.51.
  constexpr double min_evenness = 1.6;
  constexpr std::size_t neighbors = 16;
  if (points.cols() < min_points)
    return false;
  std::vector<double> flatness;
  std::vector<double> densities;  // logarithms
  for (const std::vector<NearPoint>& near : samples) {
    flatness.push_back(Axes(near, patch).flatness());
    densities.push_back(1.5 * std::log(near[neighbors - 1].squared_distance));
  }
  if (!(medianOf(flatness) > min_flatness))
    return false;
  const double dimension = dimensionOf(points);
  const bool is_certain =
      are_voxels || (dimension > min_of_uneven && points.cols() >= min_uneven_points);
  std::sort(densities.begin(), densities.end());
  const double spread = densities[densities.size() * 9 / 10] - densities[densities.size() / 10];
  return dimension > min_dimension && (is_certain || dimension - spread > min_evenness);
}

/// Mean number of points among the 26 voxels around a point; 0 if the points are no voxels.
double voxelsAround(const Positions& points) {
  constexpr Eigen::Index max_samples = 1000;
  constexpr double max_ratio = 3.0;       // of the sides of a voxel; beyond, they are sheets
  constexpr std::size_t min_points = 16;  // with the same coordinate
  using Voxel = std::array<long long, 3>;
  std::vector<Voxel> voxels(columnCount(points));
  Eigen::Vector3d sides;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values(points.row(axis).begin(), points.row(axis).end());
    sortUnique(values);
    if (values.size() < 2 || min_points * values.size() > voxels.size())
      return 0.0;
    const double first = values.front();
    std::adjacent_difference(values.begin(), values.end(), values.begin());
    values.erase(values.begin());
    sides[axis] = medianOf(values);
    for (std::size_t i = 0; i < voxels.size(); ++i)
      voxels[i][static_cast<std::size_t>(axis)] =
          std::llround((points(axis, static_cast<Eigen::Index>(i)) - first) / sides[axis]);
  }
  if (sides.maxCoeff() > max_ratio * sides.minCoeff())
    return 0.0;
  std::vector<Voxel> sorted = voxels;
  sortUnique(sorted);
  const std::size_t step = voxels.size() / max_samples + 1;
  double around = 0.0;
  double samples = 0.0;
  for (std::size_t i = 0; i < voxels.size(); i += step) {
    const auto [x, y, z] = voxels[i];
    for (int n = 0; n < 27; ++n)
      around += std::binary_search(sorted.begin(), sorted.end(),
                                   Voxel{x + n / 9 - 1, y + n / 3 % 3 - 1, z + n % 3 - 1});
    samples += 1.0;
  }
  return around / samples - 1.0;
}

bool areOnCurves(const Positions& points, const Samples& samples) {
  // Centre lines with noise of a fifth of their spacing have 0.03. \see areOnLines
  constexpr double max_width = 0.035;
  constexpr std::size_t neighbors = 4;
  // At least this width shows points across the line.
  constexpr double min_width = 0.1;
  constexpr double min_flatness = 0.04;
  constexpr double min_turn = 0.04;
  std::vector<double> widths;
  Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
  for (const std::vector<NearPoint>& near : samples) {
    const Axes line(near, neighbors);
    widths.push_back(line.width());
    directions += line.direction * line.direction.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turn(
      directions / static_cast<double>(samples.size()), Eigen::EigenvaluesOnly);
  if (medianOf(widths) > max_width || turn.eigenvalues()[0] < min_turn)
    return false;
  std::vector<double> flatness;
  for (const std::vector<NearPoint>& near : nearestOfSome(points, 1024)) {
    std::size_t count = neighbors;
    while (count < near.size() && Axes(near, count).width() < min_width)
      count *= 2;
    flatness.push_back(count < near.size() ? Axes(near, 2 * count).flatness() : 1.0);
  }
  return medianOf(flatness) > min_flatness;
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

PointSpread spreadOf(const Positions& points) {
  constexpr Eigen::Index min_points = 100;
  // Of the 26 voxels around one, 19 to 25 are taken in three or more layers and in solids; 17 in
  // two layers, 14 in the boundary of a solid, 10 in one layer.
  constexpr double min_voxels = 17.8;
  if (points.cols() < min_points)
    return PointSpread::Surface;
  const Samples samples = nearestOfSome(points, 64);
  const double voxels = voxelsAround(points);
  if (fillVolume(points, samples, voxels > min_voxels))
    return PointSpread::Volume;
  if (voxels > min_voxels)
    return PointSpread::Layers;
  return areOnCurves(points, samples) ? PointSpread::Curves : PointSpread::Surface;
}

Eigen::Vector3d coarseSteps(const Positions& points, double min_spacings) {
  constexpr Index neighbor = 6;
  constexpr int digits_lost = 23;  // binary digits of a number of single precision
  Eigen::Vector3d steps = Eigen::Vector3d::Zero();
  if (points.cols() <= neighbor)
    return steps;
  // Not even points on a line are nearer to each other.
  const double extent = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  const double finest = min_spacings * extent / static_cast<double>(points.cols());
  for (int axis = 0; axis < 3; ++axis) {
    const double least = points.row(axis).cwiseAbs().minCoeff();
    const double step = least > 0.0 ? std::ldexp(1.0, std::ilogb(least) - digits_lost) : 0.0;
    const auto are_multiples = [&](double of) {
      return std::all_of(points.row(axis).begin(), points.row(axis).end(),
                         [&](double value) { return std::fmod(value, of) == 0.0; });
    };
    if (step > finest && are_multiples(step) && !are_multiples(2.0 * step))
      steps[axis] = step;
  }
  if (steps.isZero(0.0))
    return steps;
  std::vector<double> distances;
  for (const std::vector<NearPoint>& near : nearestOfSome(points, neighbor))
    distances.push_back(std::sqrt(near.back().squared_distance));
  return (steps.array() > min_spacings * medianOf(distances)).select(steps, 0.0);
}

bool areScattered(const Positions& points, const Stars& stars) {
  constexpr Eigen::Index min_points = 20;
  constexpr Eigen::Index max_points = 100;
  // Random points in a cube have 0.09 to 0.2, clean shapes of 20 to 100 points up to 0.08.
  constexpr double min_disorder = 0.09;
  constexpr std::size_t neighbors = 10;
  if (points.cols() < min_points || points.cols() > max_points)
    return false;
  std::vector<double> flatness;
  for (const std::vector<NearPoint>& near : nearestOfSome(points, neighbors))
    flatness.push_back(Axes(near, neighbors).flatness());
  return medianOf(flatness) * oneSidedFraction(stars) > min_disorder;
}

bool areOnLines(const Positions& points, const Graph& graph) {
  // The ratio of the squared spreads of the four nearest points across and along is at least 0.25
  // on surfaces, and 0.001 on contours five times as far apart as their points.
  constexpr double max_ratio = 0.02;
  constexpr std::size_t neighbors = 4;
  constexpr std::size_t min_points = 100;
  std::vector<double> ratios;
  const auto step = static_cast<Index>(graph.size() / 250 + 1);
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
  // Fraction of the places of the grid, seen along the third axis.
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
