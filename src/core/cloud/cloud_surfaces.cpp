#include "cloud_surfaces.h"

#include "component_tree.h"
#include "graph_building.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace spherical_param::internal {
namespace {

/// A piece of fewer points is a stray cluster.
constexpr std::size_t kMinSurface = 32;

/// Mean length of the edges of a node, which must have some.
double spacingAt(const Graph& graph, Index i) {
  const Row<double> lengths = graph.lengthsOf(i);
  return std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
}

/// Root mean square distance of a node and those around it from their plane.
double roughnessAt(const Positions& points, const Graph& graph, Index i) {
  // Fewer points do not show the roughness of a surface.
  constexpr std::size_t min_patch = 12;
  std::vector<Index> patch{i};
  for (std::size_t done = 0; done < patch.size() && patch.size() < min_patch;)
    for (const std::size_t ring_end = patch.size(); done < ring_end; ++done)
      for (const Index j : graph.row(patch[done]))
        if (std::find(patch.begin(), patch.end(), j) == patch.end())
          patch.push_back(j);
  Eigen::Matrix3Xd offsets = points(Eigen::all, patch).colwise() - points.col(i);
  offsets.colwise() -= offsets.rowwise().mean().eval();
  const Eigen::Matrix3d covariance =
      offsets * offsets.transpose() / static_cast<double>(patch.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(axes.eigenvalues()[0], 0.0));
}

/// Distances of other points to the points on surfaces.
class SurfaceDistance {
public:
  /// \param points 3 x n, n >= 1.
  SurfaceDistance(const Positions& points, const Graph& agreed, const Stars& stars)
      : points_(points), agreed_(agreed), stars_(stars), tree_(points) {}

  /// \param piece      of each point.
  /// \param is_surface of each piece; not 0 for all.
  void setSurfaces(const Indexed<Index>& piece, const Indexed<char>& is_surface) {
    Indexed<Index> on_surface;
    for (const Index of : piece)
      on_surface.push_back(is_surface[of]);
    is_beside_.assign(on_surface.begin(), on_surface.end());
    for (const Index i : indicesOf(on_surface))
      if (on_surface[i] != 0)
        for (const Index j : stars_.of(i))
          is_beside_[j] = 1;
    tree_.setComponents(std::move(on_surface));
  }

  /// The nearest point on a surface. \param i not on a surface
  Index nearest(Index i) const {
    ComponentTree::Pair pair;
    tree_.findNearest(i, {}, pair);
    return pair.from == i ? pair.to : pair.from;
  }

  /// Distance of a point from the surface [mean length of edges there]; 0 on the surface and beside
  /// it, where noise may explain the distance.
  double ofStray(Index i) const {
    if (is_beside_[i] != 0)
      return 0.0;
    const Index j = nearest(i);
    const double distance = edgeLength(points_, i, j);
    const double spacing = spacingAt(agreed_, j);
    // Noise is within a spacing plus this number of times the roughness of the surface.
    constexpr double max_roughnesses = 6.0;
    const double noise = spacing + max_roughnesses * roughnessAt(points_, agreed_, j);
    return distance > noise ? distance / spacing : 0.0;
  }

  /// Length of edges at a point relative to those at the nearest surface.
  double coarseness(Index i) const {
    return spacingAt(agreed_, i) / spacingAt(agreed_, nearest(i));
  }

private:
  const Positions& points_;
  const Graph& agreed_;
  const Stars& stars_;
  ComponentTree tree_;
  Indexed<char> is_beside_;  ///< 1: on a surface, or in a star of one of its points
};

/// Whether an edge has triangles on both sides: its ends have at least two common neighbours.
bool isInSheet(const Graph& graph, Index i, Index j) {
  const Row<Index> row = graph.row(i);
  return std::count_if(row.begin(), row.end(), [&](Index k) { return graph.row(j).contains(k); }) >=
         2;
}

/// Marks the pieces in which edges with triangles on both sides join at least kMinSurface points.
void markSheets(const Graph& agreed, const Partition& pieces, Indexed<char>& is_surface) {
  UnionFind joined(agreed.size());
  for (const Index i : agreed.nodes()) {
    const Index piece = pieces.of[i];
    if (is_surface[piece] != 0 || pieces.sizes[piece] < kMinSurface)
      continue;
    for (const Index j : agreed.row(i))
      if (j > i && isInSheet(agreed, i, j))
        joined.unite(i, j);
  }
  const Partition sheets(joined);
  for (const Index i : agreed.nodes())
    if (sheets.sizes[i] >= kMinSurface)
      is_surface[pieces.of[i]] = 1;
}

/// Marks the other large pieces that are not coarser than the surface beside them.
void markFinePieces(const SurfaceDistance& distance, const Partition& pieces,
                    Indexed<char>& is_surface) {
  // A piece without a sheet that is coarser than the surface by this factor is a net of stray
  // points. Walls in a depth image have 0.5 to 0.9, nets 14 to 20.
  constexpr double max_coarseness = 5.0;
  Indexed<std::vector<double>> coarseness(pieces.of.size());
  for (const Index i : indicesOf(pieces.of))
    if (const Index k = pieces.of[i]; is_surface[k] == 0 && pieces.sizes[k] >= kMinSurface)
      coarseness[k].push_back(distance.coarseness(i));
  for (const Index k : indicesOf(coarseness))
    if (!coarseness[k].empty() && medianOf(coarseness[k]) <= max_coarseness)
      is_surface[k] = 1;
}

/// Joins small components to the nearest large one beside them, such as a base or the tip of an
/// ear.
void joinSmall(const Positions& points, const Graph& agreed, UnionFind& components) {
  // Small: up to this fraction of the points of the large one. Beside: within this number of
  // spacings of the coarser one.
  constexpr double max_fraction = 0.05;
  constexpr double max_gap = 4.0;
  const Partition parts(components);
  const Indexed<std::size_t>& sizes = parts.sizes;
  Indexed<char> is_surface(agreed.size(), 0);
  markSheets(agreed, parts, is_surface);
  UnionFind all = components;
  std::vector<Bridge> bridges = shortestBridges(points, all, 1);
  std::stable_sort(bridges.begin(), bridges.end(),
                   [](const Bridge& a, const Bridge& b) { return a.length < b.length; });
  // Each small one is joined once, so that two large ones beside it stay apart.
  Indexed<char> is_joined(agreed.size(), 0);
  for (const Bridge& bridge : bridges) {
    const auto [small, large] = std::minmax(parts.of[bridge.from], parts.of[bridge.to],
                                            [&](Index a, Index b) { return sizes[a] < sizes[b]; });
    if (is_surface[small] != 0 && is_surface[large] != 0 && is_joined[small] == 0 &&
        static_cast<double>(sizes[small]) <= max_fraction * static_cast<double>(sizes[large]) &&
        bridge.length <
            max_gap * std::max(nodeSpacing(agreed, bridge.from), nodeSpacing(agreed, bridge.to))) {
      components.unite(bridge.from, bridge.to);
      is_joined[small] = 1;
    }
  }
}

}  // namespace

Graph joinedAlongBoundaries(const Positions& points, Graph agreed, const Stars& stars) {
  // Points of a boundary are as near to each other as those across: 0.96 to 1 times on contours and
  // turned parts. Stray points in an object, whose stars reach it, are 2.2 to 22 times as far
  // apart.
  constexpr double max_coarseness = 1.5;
  UnionFind components = connectedComponents(agreed);
  const auto [component, sizes] = Partition(components);
  const auto shortest = [&](Index i) {
    const Row<double> lengths = agreed.lengthsOf(i);
    return *std::min_element(lengths.begin(), lengths.end());
  };
  struct Boundary {
    std::size_t points = 0;
    std::vector<Bridge> edges;
    std::vector<double> coarseness;
  };
  std::map<std::pair<Index, Index>, Boundary> boundaries;  // of one component, beside another
  for (const Index i : agreed.nodes())
    for (const Index j : stars.of(i)) {
      if (component[i] == component[j] ||
          std::min(sizes[component[i]], sizes[component[j]]) < kMinSurface)
        continue;
      Boundary& boundary = boundaries[{component[i], component[j]}];
      boundary.points += boundary.edges.empty() || boundary.edges.back().from != i ? 1 : 0;
      boundary.edges.push_back({i, j, edgeLength(points, i, j)});
      boundary.coarseness.push_back(shortest(i) / shortest(j));
    }
  std::vector<Bridge> edges;
  for (auto& [pair, boundary] : boundaries)
    // The boundary of a sheet of n points has about the root of n.
    if (boundary.points * boundary.points >= sizes[pair.first] &&
        medianOf(boundary.coarseness) <= max_coarseness)
      edges.insert(edges.end(), boundary.edges.begin(), boundary.edges.end());
  if (!edges.empty())
    agreed = withEdges(agreed, edges);
  return agreed;
}

Indexed<Index> partsOf(const Positions& points, const Graph& agreed, const Stars& stars,
                       std::size_t min_points) {
  UnionFind components = connectedComponents(agreed);
  joinSmall(points, agreed, components);
  const Partition parts(components);
  Indexed<Index> part = parts.of;
  Indexed<char> is_part(part.size(), 0);  // of the components
  for (const Index k : part)
    is_part[k] = parts.sizes[k] >= min_points ? 1 : 0;
  const auto in_part = [&](Index k) { return is_part[k] != 0; };
  if (std::all_of(part.begin(), part.end(), in_part))
    return part;
  if (std::none_of(part.begin(), part.end(), in_part))
    return Indexed<Index>(part.size(), -1);

  SurfaceDistance distance(points, agreed, stars);
  distance.setSurfaces(part, is_part);
  for (const Index i : indicesOf(part))
    if (!in_part(parts.of[i]))
      part[i] = distance.ofStray(i) > 0.0 ? -1 : parts.of[distance.nearest(i)];
  return part;
}

std::vector<StrayPoint> strayPoints(const Positions& points, const Graph& agreed,
                                    const Stars& stars) {
  UnionFind parts = connectedComponents(agreed);
  const Partition pieces(parts);
  const auto largest = std::max_element(pieces.sizes.begin(), pieces.sizes.end());
  if (*largest == agreed.size() || *largest < kMinSurface)
    return {};

  Indexed<char> is_surface(agreed.size(), 0);  // of the pieces
  is_surface[largest - pieces.sizes.begin()] = 1;
  markSheets(agreed, pieces, is_surface);
  SurfaceDistance distance(points, agreed, stars);
  distance.setSurfaces(pieces.of, is_surface);
  markFinePieces(distance, pieces, is_surface);
  distance.setSurfaces(pieces.of, is_surface);
  std::vector<StrayPoint> stray;
  for (const Index i : agreed.nodes())
    if (const double spacings = distance.ofStray(i); spacings > 0.0)
      stray.push_back({i, spacings});
  return stray;
}

}  // namespace spherical_param::internal
