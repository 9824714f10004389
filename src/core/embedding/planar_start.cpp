#include "planar_start.h"

#include "median.h"
#include "pi.h"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Nodes far from each other by which central nodes are found. With 1 the 25 awkward clouds of
/// local_delaunay_graph.cpp have 1,377,940 self-intersections instead of 61,815, with 4, 58,590.
constexpr int kLandmarks = 12;
/// Logarithm of the factor by which conductances fall with each edge of distance. With 0 these
/// clouds have 77,309.
constexpr double kDrift = 0.5;
/// Largest argument of exp(), with room for products.
constexpr double kMaxExponent = 300.0;

/// Lengths of the shortest paths from a node (E. W. Dijkstra, 1959).
std::vector<double> pathLengths(const Graph& graph, Index source) {
  std::vector<double> distances(graph.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  distances[static_cast<std::size_t>(source)] = 0.0;
  queue.emplace(0.0, source);
  while (!queue.empty()) {
    const auto [distance, node] = queue.top();
    queue.pop();
    const auto i = static_cast<std::size_t>(node);
    if (distance > distances[i])
      continue;
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(graph.neighbors[e]);
      const double through = distance + graph.lengths[e];
      if (through < distances[j]) {
        distances[j] = through;
        queue.emplace(through, static_cast<Index>(j));
      }
    }
  }
  return distances;
}

/// Length of the edge between two nodes; infinite if there is none.
double lengthBetween(const Graph& graph, Index i, Index j) {
  const auto begin = graph.neighbors.begin() +
                     static_cast<std::ptrdiff_t>(graph.offsets[static_cast<std::size_t>(i)]);
  const auto end = graph.neighbors.begin() +
                   static_cast<std::ptrdiff_t>(graph.offsets[static_cast<std::size_t>(i) + 1]);
  const auto place = std::lower_bound(begin, end, j);
  return place != end && *place == j
             ? graph.lengths[static_cast<std::size_t>(place - graph.neighbors.begin())]
             : std::numeric_limits<double>::infinity();
}

/// The centre and two of its neighbours, joined to each other if there are such.
std::array<Index, 3> outerFace(const Graph& graph, Index center) {
  const auto c = static_cast<std::size_t>(center);
  std::vector<Index> around(graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[c]),
                            graph.neighbors.begin() +
                                static_cast<std::ptrdiff_t>(graph.offsets[c + 1]));
  // The triangle of the least perimeter: not one that depends on the numbering of the nodes.
  std::array<Index, 3> face{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < around.size(); ++a)
    for (std::size_t b = a + 1; b < around.size(); ++b) {
      const double across = lengthBetween(graph, around[a], around[b]);
      const double perimeter =
          graph.lengths[graph.offsets[c] + a] + graph.lengths[graph.offsets[c] + b] + across;
      if (perimeter < least) {
        least = perimeter;
        face = {center, around[a], around[b]};
      }
    }
  if (least < std::numeric_limits<double>::infinity())
    return face;
  if (around.size() >= 2)
    return {center, around[0], around[1]};
  // A path of two edges, or any three nodes.
  const Index next = around.empty() ? (center + 1) % static_cast<Index>(graph.size()) : around[0];
  Index third = 0;
  while (third == center || third == next)
    ++third;
  return {center, next, third};
}

/// Edges on a shortest path from each node to the nearest of some others.
std::vector<int> hopsFrom(const Graph& graph, const std::array<Index, 3>& sources) {
  std::vector<int> hops(graph.size(), -1);
  std::vector<Index> queue(sources.begin(), sources.end());
  for (const Index source : sources)
    hops[static_cast<std::size_t>(source)] = 0;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const auto i = static_cast<std::size_t>(queue[head]);
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(graph.neighbors[e]);
      if (hops[j] < 0) {
        hops[j] = hops[i] + 1;
        queue.push_back(static_cast<Index>(j));
      }
    }
  }
  return hops;
}

/// Moves the centroid of unit vectors towards the origin by conformal maps of the sphere, which
/// fold nothing: v = (1 - |c|^2) (u - c) / |u - c|^2 - c takes the point c of the ball to its
/// centre.
void centerConformally(Positions& directions) {
  constexpr int max_steps = 30;
  constexpr double centered = 0.05;
  for (int step = 0; step < max_steps; ++step) {
    const Eigen::Vector3d centroid = directions.rowwise().mean();
    const double squared = centroid.squaredNorm();
    if (!(squared > centered * centered) || !(squared < 1.0))
      return;
    for (Eigen::Index i = 0; i < directions.cols(); ++i) {
      const Eigen::Vector3d offset = directions.col(i) - centroid;
      directions.col(i) = ((1.0 - squared) / offset.squaredNorm() * offset - centroid).normalized();
    }
  }
}

/// The points of the plane where each node but those of the outer face is the mean of its
/// neighbours (W. T. Tutte, 1963), with conductances g_i g_j / length. g falls by a constant factor
/// with each edge of distance from the outer face: without, nodes far from it crowd in one place.
/// The matrix is scaled to ones on the diagonal, where g no longer occurs.
Eigen::MatrixX2d drawInPlane(const Graph& graph, const std::array<Index, 3>& outer) {
  std::vector<Eigen::Index> unknown(graph.size(), 0);
  for (const Index node : outer)
    unknown[static_cast<std::size_t>(node)] = -1;
  Eigen::Index unknowns = 0;
  for (Eigen::Index& index : unknown)
    if (index == 0)
      index = unknowns++;

  Eigen::MatrixX2d plane(static_cast<Eigen::Index>(graph.size()), 2);
  const double third = 2.0 * kPi / 3.0;
  for (int k = 0; k < 3; ++k)
    plane.row(outer[static_cast<std::size_t>(k)]) << std::cos(third * k), std::sin(third * k);
  if (unknowns == 0)
    return plane;
  const std::vector<int> hops = hopsFrom(graph, outer);
  const int max_hops = *std::max_element(hops.begin(), hops.end());
  const double drift = std::min(kDrift, kMaxExponent / std::max(max_hops, 1));
  std::vector<double> stiffness(graph.size(), 0.0);
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      const int deeper = hops[static_cast<std::size_t>(graph.neighbors[e])] - hops[i];
      stiffness[i] += std::exp(-drift * deeper) / graph.lengths[e];
    }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right_side = Eigen::MatrixX2d::Zero(unknowns, 2);
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (unknown[i] < 0)
      continue;
    entries.emplace_back(unknown[i], unknown[i], 1.0);
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(graph.neighbors[e]);
      const double root = std::sqrt(stiffness[i]);
      if (unknown[j] < 0)
        // Next to the outer face, where g_j is 1.
        right_side.row(unknown[i]) +=
            plane.row(static_cast<Eigen::Index>(j)) / (graph.lengths[e] * root);
      else
        entries.emplace_back(unknown[i], unknown[j],
                             -1.0 / (graph.lengths[e] * root * std::sqrt(stiffness[j])));
    }
  }
  Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian);
  const Eigen::MatrixX2d inner = solver.solve(right_side);
  for (std::size_t i = 0; i < graph.size(); ++i)
    if (unknown[i] >= 0)
      plane.row(static_cast<Eigen::Index>(i)) =
          inner.row(unknown[i]) * (std::exp(drift * hops[i]) / std::sqrt(stiffness[i]));
  return plane;
}

/// Stereographic projection, with half of the points on each side of the equator.
Positions projectOnSphere(Eigen::MatrixX2d plane) {
  const Eigen::Index n = plane.rows();
  std::vector<double> x(plane.col(0).data(), plane.col(0).data() + n);
  std::vector<double> y(plane.col(1).data(), plane.col(1).data() + n);
  plane.rowwise() -= Eigen::RowVector2d(medianOf(x), medianOf(y));
  const Eigen::VectorXd norms = plane.rowwise().norm();
  std::vector<double> distances(norms.data(), norms.data() + n);
  const double scale = std::max(medianOf(distances), std::numeric_limits<double>::min());
  Positions directions(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d q = plane.row(i).transpose() / scale;
    const double squared = q.squaredNorm();
    directions.col(i) << 2.0 * q / (1.0 + squared), (squared - 1.0) / (squared + 1.0);
    directions.col(i).normalize();
  }
  return directions;
}

}  // namespace

std::vector<Index> centralNodes(const Graph& graph) {
  const std::size_t n = graph.size();
  std::vector<double> eccentricity(n, 0.0);
  std::vector<double> nearest(n, std::numeric_limits<double>::infinity());
  // The node of the longest edges, whatever the numbering.
  std::vector<double> reach(n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      reach[i] += graph.lengths[e];
  auto landmark = static_cast<Index>(std::max_element(reach.begin(), reach.end()) - reach.begin());
  for (int count = 0; count <= kLandmarks; ++count) {
    const std::vector<double> distances = pathLengths(graph, landmark);
    for (std::size_t i = 0; i < n; ++i) {
      // The first one is anywhere: it only serves to find one that is far.
      if (count > 0)
        eccentricity[i] = std::max(eccentricity[i], distances[i]);
      nearest[i] = count > 0 ? std::min(nearest[i], distances[i]) : distances[i];
    }
    landmark =
        static_cast<Index>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    if (count == 0)
      std::fill(nearest.begin(), nearest.end(), std::numeric_limits<double>::infinity());
  }
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::pair(eccentricity[static_cast<std::size_t>(a)], a) <
           std::pair(eccentricity[static_cast<std::size_t>(b)], b);
  });
  return order;
}

Positions planarStart(const Graph& graph, Index center) {
  Positions directions = projectOnSphere(drawInPlane(graph, outerFace(graph, center)));
  centerConformally(directions);
  return directions;
}

}  // namespace spherical_param::internal
