#include "planar_start.h"

#include "pi.h"
#include "shortest_paths.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace spherical_param::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Lengths of the shortest paths from a node.
Indexed<double> pathLengths(const Graph& graph, Index source) {
  Indexed<double> lengths(graph.size(), kInfinity);
  shortestPaths(source, lengths, [&](Index v, const auto& go) {
    for (const std::size_t e : graph.entries(v))
      go(graph.neighbors[e], graph.lengths[e]);
  });
  return lengths;
}

/// The centre and two of its neighbours, which are joined to each other if possible.
std::array<Index, 3> outerFace(const Graph& graph, Index center) {
  // The triangle of the least perimeter, which does not depend on the numbering of the nodes.
  std::array<Index, 3> face{};
  double least = kInfinity;
  Indexed<double> reach(graph.size(), kInfinity);  // lengths of the edges of the centre
  for (const std::size_t e : graph.entries(center))
    reach[graph.neighbors[e]] = graph.lengths[e];
  for (const Index a : graph.row(center))
    for (const std::size_t e : graph.entries(a)) {
      const Index b = graph.neighbors[e];
      const double perimeter = reach[a] + reach[b] + graph.lengths[e];
      if (a < b && perimeter < least) {
        least = perimeter;
        face = {center, a, b};
      }
    }
  if (least < kInfinity)
    return face;
  const Row<Index> around = graph.row(center);
  if (around.size() >= 2)
    return {center, around.begin()[0], around.begin()[1]};
  // A path of two edges, or any three nodes.
  const Index next =
      around.size() > 0 ? *around.begin() : (center + 1) % static_cast<Index>(graph.size());
  Index third = 0;
  while (third == center || third == next)
    ++third;
  return {center, next, third};
}

/// Number of edges between each node and the nearest source.
Indexed<int> hopsFrom(const Graph& graph, const std::array<Index, 3>& sources) {
  Indexed<int> hops(graph.size(), -1);
  std::vector<Index> queue(sources.begin(), sources.end());
  for (const Index source : sources)
    hops[source] = 0;
  for (std::size_t head = 0; head < queue.size(); ++head)
    for (const Index j : graph.row(queue[head]))
      if (hops[j] < 0) {
        hops[j] = hops[queue[head]] + 1;
        queue.push_back(j);
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

/// Places in the plane at which each node not on the outer face is the mean of its neighbours (W.
/// T. Tutte, 1963), with conductances g_i g_j / length. g falls by a constant factor with each edge
/// of distance from the outer face; otherwise nodes far from it would gather in one place. The
/// matrix is scaled to ones on the diagonal, which cancels g.
Eigen::MatrixX2d drawInPlane(const Graph& graph, const std::array<Index, 3>& outer) {
  Indexed<Index> unknown(graph.size(), 0);
  for (const Index node : outer)
    unknown[node] = -1;
  Index unknowns = 0;
  for (Index& index : unknown)
    if (index == 0)
      index = unknowns++;

  Eigen::MatrixX2d plane(graph.size(), 2);
  const double third = 2.0 * kPi / 3.0;
  double angle = 0.0;
  for (const Index node : outer) {
    plane.row(node) << std::cos(angle), std::sin(angle);
    angle += third;
  }
  if (unknowns == 0)
    return plane;
  const Indexed<int> hops = hopsFrom(graph, outer);
  const int max_hops = *std::max_element(hops.begin(), hops.end());
  // Logarithm of the factor by which g falls; bounded, so that products of exp() stay finite.
  const double drift = std::min(0.5, 300.0 / std::max(max_hops, 1));
  Indexed<double> roots(graph.size(), 0.0);
  for (const Index i : graph.nodes()) {
    for (const std::size_t e : graph.entries(i))
      roots[i] += std::exp(-drift * (hops[graph.neighbors[e]] - hops[i])) / graph.lengths[e];
    roots[i] = std::sqrt(roots[i]);
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right_side = Eigen::MatrixX2d::Zero(unknowns, 2);
  for (const Index i : graph.nodes()) {
    if (unknown[i] < 0)
      continue;
    entries.emplace_back(unknown[i], unknown[i], 1.0);
    for (const std::size_t e : graph.entries(i)) {
      const Index j = graph.neighbors[e];
      if (unknown[j] < 0)
        // Next to the outer face, where g_j is 1.
        right_side.row(unknown[i]) += plane.row(j) / (graph.lengths[e] * roots[i]);
      else
        entries.emplace_back(unknown[i], unknown[j],
                             -1.0 / (graph.lengths[e] * roots[i] * roots[j]));
    }
  }
  Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian);
  const Eigen::MatrixX2d inner = solver.solve(right_side);
  for (const Index i : graph.nodes())
    if (unknown[i] >= 0)
      plane.row(i) = inner.row(unknown[i]) * (std::exp(drift * hops[i]) / roots[i]);
  return plane;
}

/// Inverse stereographic projection, with half of the points on each side of the equator.
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
  // Number of nodes far from each other from which distances are measured.
  constexpr int landmarks = 12;
  // The search begins at the node with the longest edges, whatever the numbering.
  Indexed<double> reach(graph.size(), 0.0);
  for (const Index i : graph.nodes())
    for (const double length : graph.lengthsOf(i))
      reach[i] += length;
  const auto farthest = [](const Indexed<double>& distances) {
    return static_cast<Index>(std::max_element(distances.begin(), distances.end()) -
                              distances.begin());
  };
  Index landmark = farthest(pathLengths(graph, farthest(reach)));
  Indexed<double> eccentricity(graph.size(), 0.0);
  Indexed<double> nearest(graph.size(), kInfinity);
  for (int count = 0; count < landmarks; ++count) {
    const Indexed<double> distances = pathLengths(graph, landmark);
    for (const Index i : graph.nodes()) {
      eccentricity[i] = std::max(eccentricity[i], distances[i]);
      nearest[i] = std::min(nearest[i], distances[i]);
    }
    landmark = farthest(nearest);
  }
  std::vector<Index> order = firstIndices(graph.size());
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::pair(eccentricity[a], a) < std::pair(eccentricity[b], b);
  });
  return order;
}

Positions planarStart(const Graph& graph, Index center) {
  Positions directions = projectOnSphere(drawInPlane(graph, outerFace(graph, center)));
  centerConformally(directions);
  return directions;
}

}  // namespace spherical_param::internal
