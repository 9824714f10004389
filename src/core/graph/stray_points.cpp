#include "stray_points.h"

#include "graph_building.h"
#include "surface_distance.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {
namespace {

// The experiments are on 14 models, each as it is, as a random quarter, with noise of a quarter of
// an edge and sampled at random, without and with 1 % of points anywhere in its box; and on scans.

/// A piece of fewer points is a stray cluster. The base of one model is a piece of 55.
constexpr std::size_t kMinSurface = 32;

/// Whether an edge has triangles on both sides: its ends have two neighbours in common.
bool isInSheet(const Graph& graph, Index i, Index j) {
  const Row<Index> row = graph.row(i);
  return std::count_if(row.begin(), row.end(), [&](Index k) { return graph.row(j).contains(k); }) >=
         2;
}

/// Marks the pieces of which kMinSurface points are joined by edges with triangles on both sides.
void markSheets(const Graph& agreed, const Indexed<Index>& piece, const Indexed<std::size_t>& sizes,
                Indexed<char>& is_surface) {
  UnionFind joined(piece.size());
  for (const Index i : agreed.nodes()) {
    if (is_surface[piece[i]] != 0 || sizes[piece[i]] < kMinSurface)
      continue;
    for (const Index j : agreed.row(i))
      if (j > i && isInSheet(agreed, i, j))
        joined.unite(i, j);
  }
  const Indexed<std::size_t> sheet_sizes = setSizes(representatives(joined, piece.size()));
  for (const Index i : agreed.nodes())
    if (sheet_sizes[i] >= kMinSurface)
      is_surface[piece[i]] = 1;
}

/// Marks the other large pieces that are no coarser than the surface beside them.
void markFinePieces(const SurfaceDistance& distance, const Indexed<Index>& piece,
                    const Indexed<std::size_t>& sizes, Indexed<char>& is_surface) {
  // A piece that is coarser than the surface beside it by this factor, and holds no sheet, is a net
  // of stray points. Walls in a depth image have 0.5 to 0.9, nets 14 to 20.
  constexpr double max_coarseness = 5.0;
  Indexed<std::vector<double>> coarseness(piece.size());
  for (const Index i : indicesOf(piece))
    if (is_surface[piece[i]] == 0 && sizes[piece[i]] >= kMinSurface)
      coarseness[piece[i]].push_back(distance.coarseness(i));
  for (const Index k : indicesOf(piece))
    if (!coarseness[k].empty() && medianOf(coarseness[k]) <= max_coarseness)
      is_surface[k] = 1;
}

/// Marks the points of marked pieces.
Indexed<char> pointsOf(const Indexed<Index>& piece, const Indexed<char>& is_surface) {
  Indexed<char> on_surface(piece.size());
  std::transform(piece.begin(), piece.end(), on_surface.begin(),
                 [&](Index of) { return is_surface[of]; });
  return on_surface;
}

}  // namespace

std::vector<StrayPoint> strayPoints(const Positions& points, const Graph& agreed,
                                    const Stars& stars) {
  UnionFind parts = connectedComponents(agreed);
  const Indexed<Index> piece = representatives(parts, agreed.size());
  const Indexed<std::size_t> sizes = setSizes(piece);
  const auto largest = std::max_element(sizes.begin(), sizes.end());
  if (*largest == agreed.size() || *largest < kMinSurface)
    return {};

  Indexed<char> is_surface(agreed.size(), 0);  // of the pieces
  is_surface[static_cast<Index>(largest - sizes.begin())] = 1;
  markSheets(agreed, piece, sizes, is_surface);
  Indexed<char> on_surface = pointsOf(piece, is_surface);
  if (std::find(on_surface.begin(), on_surface.end(), 0) == on_surface.end())
    return {};
  SurfaceDistance distance(points, agreed);
  distance.setSurfaces(on_surface);
  markFinePieces(distance, piece, sizes, is_surface);

  on_surface = pointsOf(piece, is_surface);
  distance.setSurfaces(on_surface);
  const Indexed<char> in_star = stars.inStarsOf(on_surface);
  std::vector<StrayPoint> stray;
  for (const Index i : agreed.nodes()) {
    if (on_surface[i] != 0 || in_star[i] != 0)
      continue;
    const double spacings = distance.beyondNoise(i);
    if (spacings > 0.0)
      stray.push_back({i, spacings});
  }
  return stray;
}

}  // namespace spherical_param::internal
