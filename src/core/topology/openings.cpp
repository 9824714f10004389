#include "openings.h"

#include "exact_predicates.h"
#include "pi.h"
#include "rows.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Minimum number of edges, width [spacing] and mean corner [rad] of a face that is an opening.
/// From the certain width on it is certainly one.
constexpr std::size_t kMinSteps = 7;
constexpr double kMinWidth = 3.0;
constexpr double kCertainWidth = 9.0;
constexpr double kMinCorner = 0.65 * kPi;

/// The least area of triangles over a loop (Barequet and Sharir 1995); over some vertices of a long
/// loop.
double leastArea(const Positions& points, const std::vector<Index>& loop) {
  constexpr Eigen::Index max_corners = 96;
  const auto all = static_cast<Eigen::Index>(loop.size());
  const Eigen::Index n = std::min(all, max_corners);
  const auto corner = [&](Eigen::Index i) {
    return points.col(loop[static_cast<std::size_t>(i * all / n)]);
  };
  Eigen::MatrixXd least = Eigen::MatrixXd::Zero(n, n);  // over the corners from i to j
  for (Eigen::Index steps = 2; steps < n; ++steps)
    for (Eigen::Index i = 0; i + steps < n; ++i) {
      const Eigen::Index j = i + steps;
      const Eigen::Vector3d edge = corner(j) - corner(i);
      least(i, j) = std::numeric_limits<double>::max();
      for (Eigen::Index k = i + 1; k < j; ++k)
        least(i, j) = std::min(least(i, j), least(i, k) + least(k, j) +
                                                edge.cross(corner(k) - corner(i)).norm() / 2.0);
    }
  return least(0, n - 1);
}

/// The edges of a graph across openings, and from a loop to another sheet.
std::vector<std::array<Index, 2>> falseEdges(const Graph& graph, const RotationSystem& rotation,
                                             const Openings& found) {
  Indexed<Index> loop_of(graph.size(), -1);
  for (std::size_t i = 0; i < found.openings.size(); ++i)
    for (const Index v : found.openings[i].loop)
      loop_of[v] = static_cast<Index>(i);
  std::vector<std::array<Index, 2>> edges;
  for (const Index v : graph.nodes())
    for (const std::size_t e : graph.entries(v)) {
      const Index w = graph.neighbors[e];
      if (w < v || (loop_of[v] < 0 && loop_of[w] < 0))
        continue;
      const bool is_across =
          loop_of[v] == loop_of[w] &&
          graph.lengths[e] > kMaxEdgeLength * std::max(found.spacing[v], found.spacing[w]);
      if (is_across || rotation.leavesSheet(v, w))
        edges.push_back({v, w});
    }
  return edges;
}

/// The face around a flat patch, which is the largest one; nothing for points on a line.
std::optional<Opening> outsideOf(const Positions& points, const Indexed<double>& spacing,
                                 const RotationSystem& rotation) {
  // Narrower patches are lines [spacing].
  constexpr double min_patch_width = 0.1;
  std::optional<Opening> outside;
  const NeighborRows faces = rotation.faces(3, 0.0);
  for (const Index i : faces.nodes()) {
    Opening face = measured(points, spacing, {faces.row(i).begin(), faces.row(i).end()});
    if (face.width >= min_patch_width * face.spacing && (!outside || face.area > outside->area))
      outside = std::move(face);
  }
  return outside;
}

/// The disc over the loop of an opening.
class LoopDisc {
public:
  LoopDisc(const Positions& points, const Opening& opening) : center_(opening.center) {
    const Eigen::Matrix3Xd loop = points(Eigen::all, opening.loop).colwise() - center_;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(loop * loop.transpose());
    normal_ = axes.eigenvectors().col(0);
    radius_ = loop.colwise().norm().maxCoeff();
  }

  bool isNear(const Eigen::Vector3d& point) const {
    return (point - center_).norm() <= 1.01 * radius_;
  }
  /// Signed height over the plane of the loop.
  double heightOf(const Eigen::Vector3d& point) const { return normal_.dot(point - center_); }

private:
  Eigen::Vector3d center_;
  Eigen::Vector3d normal_;
  double radius_ = 0.0;
};

/// Whether an opening is certainly the boundary of a sheet: the surface is within its loop, and low
/// over the plane of the loop.
bool isBoundaryOfSheet(const Positions& points, const Opening& opening) {
  constexpr double max_height = 0.25;  // [width]; a hemisphere has 0.5
  const LoopDisc disc(points, opening);
  return std::all_of(points.colwise().begin(), points.colwise().end(), [&](const auto& point) {
    return disc.isNear(point) && std::abs(disc.heightOf(point)) <= max_height * opening.width;
  });
}

/// Whether the surface is on one side of an opening, except for a bulge.
bool isBase(const Positions& points, const Opening& opening) {
  constexpr double max_height = 0.25;  // of the bulge [width]
  const LoopDisc disc(points, opening);
  double lowest = 0.0;
  double highest = 0.0;
  for (const auto& point : points.colwise()) {
    lowest = std::min(lowest, disc.heightOf(point));
    highest = std::max(highest, disc.heightOf(point));
  }
  return std::min(-lowest, highest) <= max_height * opening.width;
}

/// Finds the openings among the faces.
Openings openingsOf(const Positions& points, const Graph& graph, const Indexed<double>& spacing,
                    const RotationSystem& rotation) {
  Openings result;
  // A face less round than this is a slit, and must be wider [spacing]: it may be a seam of a
  // closed surface. A disc has a roundness of 1.
  constexpr double min_roundness = 0.2;
  constexpr double min_slit_width = 4.0;
  result.spacing = spacing;
  const NeighborRows faces = rotation.faces(kMinSteps, kMinCorner);
  for (const Index i : faces.nodes()) {
    Opening opening = measured(points, spacing, {faces.row(i).begin(), faces.row(i).end()});
    const double roundness = kPi * opening.width / opening.boundary_length;
    if (opening.width >= (roundness < min_roundness ? min_slit_width : kMinWidth) * opening.spacing)
      result.openings.push_back(std::move(opening));
  }
  if (result.openings.empty() && areCoplanar(points))
    if (std::optional<Opening> outside = outsideOf(points, spacing, rotation))
      result.openings.push_back(std::move(*outside));
  result.is_one_sided = rotation.isOneSided();
  result.false_edges = falseEdges(graph, rotation, result);
  std::stable_sort(
      result.openings.begin(), result.openings.end(),
      [](const Opening& a, const Opening& b) { return a.boundary_length > b.boundary_length; });
  if (!result.openings.empty()) {
    Opening& longest = result.openings.front();
    longest.is_base = isBase(points, longest);
    if (isBoundaryOfSheet(points, longest)) {
      longest.certainty = 1.0;
      longest.is_flat = false;
    }
  }
  return result;
}

}  // namespace

Opening measured(const Positions& points, const Indexed<double>& spacing, std::vector<Index> loop) {
  Opening opening;
  opening.loop = std::move(loop);
  const auto m = static_cast<double>(opening.loop.size());
  for (const Index v : opening.loop) {
    opening.center += points.col(v) / m;
    opening.spacing += spacing[v] / m;
  }
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < opening.loop.size(); ++i) {
    const Eigen::Vector3d p = points.col(opening.loop[i]) - opening.center;
    const Eigen::Vector3d q =
        points.col(opening.loop[i + 1 < opening.loop.size() ? i + 1 : 0]) - opening.center;
    opening.boundary_length += (q - p).norm();
    area += p.cross(q) / 2.0;
    moments += p * p.transpose() / m;
  }
  opening.area = area.norm();
  const double certain_area = kCertainWidth * opening.spacing * opening.boundary_length / 4.0;
  // A loop that curls has a small vector area, however large its opening is.
  if (const double least = opening.area < certain_area ? leastArea(points, opening.loop) : 0.0;
      least >= certain_area)
    opening.area = least;
  opening.width =
      std::min(4.0 * opening.area / opening.boundary_length, opening.boundary_length / kPi);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments, Eigen::EigenvaluesOnly);
  // Flat loops are within this RMS distance of a plane [spacing].
  constexpr double max_flat = 0.01;
  opening.is_flat = std::sqrt(std::max(0.0, axes.eigenvalues()[0])) < max_flat * opening.spacing;
  opening.certainty = std::clamp(
      (opening.width / opening.spacing - kMinWidth) / (kCertainWidth - kMinWidth), 0.0, 1.0);
  return opening;
}

Openings findOpenings(const Positions& points, const Graph& graph, const Indexed<double>& spacing,
                      RotationSystem& rotation) {
  Openings found = openingsOf(points, graph, spacing, rotation);
  if (found.openings.empty() || found.is_one_sided || !rotation.hasOpposite(graph))
    return found;
  rotation.separateOpposite();
  return openingsOf(points, graph, spacing, rotation);
}

std::vector<Index> pointsInOpenings(const Positions& points, const std::vector<Opening>& openings,
                                    const Positions& others) {
  // Near the plane is up to this height [spacing].
  constexpr double max_height = 2.0;
  std::vector<Index> found;
  for (const Opening& opening : openings) {
    const LoopDisc disc(points, opening);
    std::vector<Index> near;
    for (Eigen::Index i = 0; i < others.cols(); ++i)
      if (disc.isNear(others.col(i)))
        near.push_back(static_cast<Index>(i));
    if (std::all_of(near.begin(), near.end(), [&](Index i) {
          return std::abs(disc.heightOf(others.col(i))) <= max_height * opening.spacing;
        }))
      found.insert(found.end(), near.begin(), near.end());
  }
  sortUnique(found);
  return found;
}

}  // namespace spherical_param::internal
