#include "stray_points.h"

#include "graph_building.h"
#include "median.h"
#include "surface_distance.h"

#include <algorithm>
#include <cstddef>

namespace spherical_param::internal {
namespace {

// The experiments are on 14 models, each as it is, as a random quarter, with noise of a quarter of
// an edge and sampled at random, without and with 1 % of points anywhere in its box; and on scans.

/// A piece of fewer points is a stray cluster. The base of one model is a piece of 55.
constexpr std::size_t kMinSurface = 32;
/// A piece that is coarser than the surface beside it by this factor, and holds no sheet, is a net
/// of stray points. Walls in a depth image have 0.5 to 0.9, nets 14 to 20.
constexpr double kMaxCoarseness = 5.0;

std::size_t slot(Index i) {
  return static_cast<std::size_t>(i);
}

/// Whether an edge has triangles on both sides: its ends have two neighbours in common.
bool isInSheet(const Graph& graph, Index i, Index j) {
  const auto row = [&](std::vector<std::size_t>::size_type k) {
    return graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[k]);
  };
  int common = 0;
  auto a = row(slot(i));
  auto b = row(slot(j));
  while (a != row(slot(i) + 1) && b != row(slot(j) + 1)) {
    common += *a == *b ? 1 : 0;
    const bool steps_a = *a <= *b;
    const bool steps_b = *b <= *a;
    a += steps_a ? 1 : 0;
    b += steps_b ? 1 : 0;
  }
  return common >= 2;
}

/// Marks the pieces of which kMinSurface points are joined by edges with triangles on both sides.
void markSheets(const Graph& agreed, const std::vector<Index>& piece,
                const std::vector<std::size_t>& sizes, std::vector<char>& is_surface) {
  const std::size_t n = piece.size();
  UnionFind joined(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (is_surface[slot(piece[i])] != 0 || sizes[slot(piece[i])] < kMinSurface)
      continue;
    const auto node = static_cast<Index>(i);
    for (std::size_t e = agreed.offsets[i]; e < agreed.offsets[i + 1]; ++e)
      if (agreed.neighbors[e] > node && isInSheet(agreed, node, agreed.neighbors[e]))
        joined.unite(node, agreed.neighbors[e]);
  }
  const std::vector<std::size_t> sheet_sizes = setSizes(representatives(joined, n));
  for (std::size_t i = 0; i < n; ++i)
    if (sheet_sizes[i] >= kMinSurface)
      is_surface[slot(piece[i])] = 1;
}

/// Marks the other large pieces that are no coarser than the surface beside them.
void markFinePieces(const SurfaceDistance& distance, const std::vector<Index>& piece,
                    const std::vector<std::size_t>& sizes, std::vector<char>& is_surface) {
  std::vector<std::vector<double>> coarseness(piece.size());
  for (std::size_t i = 0; i < piece.size(); ++i)
    if (is_surface[slot(piece[i])] == 0 && sizes[slot(piece[i])] >= kMinSurface)
      coarseness[slot(piece[i])].push_back(distance.coarseness(static_cast<Index>(i)));
  for (std::size_t k = 0; k < piece.size(); ++k) {
    std::vector<double>& values = coarseness[k];
    if (values.empty())
      continue;
    if (medianOf(values) <= kMaxCoarseness)
      is_surface[k] = 1;
  }
}

std::vector<char> pointsOf(const std::vector<Index>& piece, const std::vector<char>& is_surface) {
  std::vector<char> on_surface(piece.size());
  std::transform(piece.begin(), piece.end(), on_surface.begin(),
                 [&](Index of) { return is_surface[slot(of)]; });
  return on_surface;
}

}  // namespace

std::vector<StrayPoint> strayPoints(const Positions& points, const Graph& agreed,
                                    const Stars& stars) {
  UnionFind parts = connectedComponents(agreed);
  const std::vector<Index> piece = representatives(parts, agreed.size());
  const std::vector<std::size_t> sizes = setSizes(piece);
  const auto largest = std::max_element(sizes.begin(), sizes.end());
  if (*largest == agreed.size() || *largest < kMinSurface)
    return {};

  std::vector<char> is_surface(agreed.size(), 0);  // of the pieces
  is_surface[static_cast<std::size_t>(largest - sizes.begin())] = 1;
  markSheets(agreed, piece, sizes, is_surface);
  std::vector<char> on_surface = pointsOf(piece, is_surface);
  if (std::find(on_surface.begin(), on_surface.end(), 0) == on_surface.end())
    return {};
  SurfaceDistance distance(points, agreed);
  distance.setSurfaces(on_surface);
  markFinePieces(distance, piece, sizes, is_surface);

  on_surface = pointsOf(piece, is_surface);
  distance.setSurfaces(on_surface);
  const std::vector<char> in_star = stars.inStarsOf(on_surface);
  std::vector<StrayPoint> stray;
  for (std::size_t i = 0; i < agreed.size(); ++i) {
    if (on_surface[i] != 0 || in_star[i] != 0)
      continue;
    const auto point = static_cast<Index>(i);
    const double spacings = distance.beyondNoise(point);
    if (spacings > 0.0)
      stray.push_back({point, spacings});
  }
  return stray;
}

}  // namespace spherical_param::internal
