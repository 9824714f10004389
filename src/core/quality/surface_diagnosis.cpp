#include "surface_diagnosis.h"

#include "spherical_param/errors.h"

#include "corner_table.h"
#include "graph_cycles.h"
#include "node_spacing.h"
#include "parallel.h"
#include "pi.h"
#include "union_find.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::kPi;

// The thresholds rest on measurements: raw, optimised and true meshes of 14 closed scans of very
// different sampling and of generated closed shapes, on none of which anything may be reported; on
// scans with places of 8, 16 and 40 spacings cut out, with a cap cut off or seen from one side
// only, and a real open scan; on a bowl, a torus and a pair of bodies of 1,000 to 50,000 points.
// Random points on the closed scans, with and without openings, confirmed them.

/// The thresholds hold for graphs of up to this mean degree: local Delaunay neighbourhoods have 5
/// to 6, the 8 nearest neighbours 8 to 9, and both classify models, cuts, holes, views and pairs
/// alike. With the 25 nearest, the closed elephant had a handle, and holes were missed:
/// of graphs of a larger degree, the kThinnedDegree shortest edges of each point are looked at.
constexpr std::size_t kMaxMeanDegree = 12;
constexpr std::size_t kThinnedDegree = 8;

/// A region grows across edges longer than this [distance of the points at both ends]. So it takes
/// in the triangles at the rim of an opening, whose corners are near each other in the graph:
/// without them openings of 8 spacings measure 1.3 to 2.7 edges of their rim, with them 3.0 and up.
constexpr double kMinLongEdge = 1.6;

/// The least diameter of a filled hole [distance of the points at its rim].
constexpr double kMinHoleDiameter = 5.0;
/// Neighbours in the graph that are more steps apart on the mesh were torn apart.
constexpr int kMinHandleSteps = 8;
/// The least gap between parts [distance of the points at the gap].
constexpr double kMinPartGap = 4.0;

/// The least diameter of a filled hole [length that a tenth of the triangles around it exceed].
/// Openings of 8 spacings have 3.0 and up, clouds that are dense along lines and coarse in between
/// up to 1.9 where the diameter is 5 spacings.
constexpr double kMinRimDiameters = 2.5;

/// The least mean area of a filled hole's triangles [squared distance of the points at its rim].
/// Those of an even cloud have 0.43, openings of 8 spacings 1.9 and up, folds of dense points 0.5.
constexpr double kMinTriangleArea = 1.2;

/// Length of the mean direction from a point to its near neighbours, median over the rim: 0.64 for
/// all of a half disc. Of all near neighbours, openings have 0.33 to 0.53, cuts through handles,
/// where those beyond the cut count, up to 0.16, folds mostly up to 0.29. Without the neighbours
/// along the rim, which blur it where the rim is ragged, openings have 0.54 to 0.91, folds up to
/// 0.47.
constexpr double kMinOneSidedness = 0.25;
constexpr double kMinInwardness = 0.5;

/// Torn neighbours that count have normals less than 73 degrees apart, and are less than 37 degrees
/// off both tangent planes: others are false neighbours, on sheets that nearly touch.
constexpr double kMinNormalCosine = 0.3;
constexpr double kMaxSlope = 0.6;

/// The least number of torn neighbours of a handle. A cut with 9 points around it tears 18. The
/// closed scans have 0, and up to 28 before the test of normals; random quarters of their points
/// up to 9. The torus has 59, 212 and 2,416 in one place at 1,000, 5,000 and 50,000 points.
constexpr std::size_t kMinTornEdges = 12;

/// Above this fraction of edges outside the graph the mesh shows nothing but parts and openings.
/// Closed scans have up to 0.05, optimised meshes of scans from one side 0.04, of the torus 0.06
/// and of closed shapes with noise of half the distance of neighbours less still; noise twice as
/// strong has 0.11 and more, and the torus 0.28 and more as long as its mesh is folded.
constexpr double kMaxOutsideGraph = 0.1;

/// Where the mesh is folded, openings are sought by their rims: at least kMinRimPoints connected
/// points at which the mean direction to the neighbours is at least this long. An opening of 8
/// spacings has 25 points around.
constexpr double kMinOneSidednessInGraph = 0.4;
constexpr std::size_t kMinRimPoints = 20;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

using Edge = std::array<Index, 2>;

/// One side of a triangle, from its corner `corner` to the next.
struct Side {
  Index triangle;
  Index corner;
};

/// The edges that the mesh has and the graph has not, and the other way round.
struct Differences {
  /// Edges of the mesh whose ends are more than two steps apart in the graph, each from one side,
  /// by triangle and corner.
  std::vector<Side> sides;
  /// Edges {lower, higher} of the graph whose ends are more than two steps apart on the mesh,
  /// ascending.
  std::vector<Edge> edges;
};

/// The mesh and the graph of the points, with queries on both.
class MeshAndGraph {
public:
  MeshAndGraph(const Positions& points, const Triangles& triangles, const Graph& graph, int threads)
      : points_(points), triangles_(triangles), graph_(graph), threads_(threads),
        corners_(triangles, graph.size(), threads) {}

  Index vertex(Index t, Index k) const { return triangles_(k % 3, t); }
  Eigen::Vector3d point(Index v) const { return points_.col(v); }
  double distance(Index a, Index b) const { return (points_.col(a) - points_.col(b)).norm(); }

  /// Calls visit(neighbour, length) for the graph's neighbours of v.
  template <typename Visit>
  void forEachNeighbor(Index v, const Visit& visit) const {
    for (std::size_t e = graph_.offsets[at(v)]; e < graph_.offsets[at(v) + 1]; ++e)
      visit(graph_.neighbors[e], graph_.lengths[e]);
  }

  /// Calls visit(triangle, corner) for the triangles around v.
  template <typename Visit>
  void forEachCorner(Index v, const Visit& visit) const {
    corners_.forEachCorner(v, visit);
  }

  /// The triangle beyond side k, from corner k to the next, of triangle t; -1: none.
  Index beyond(Index t, Index k) const {
    const Index a = vertex(t, k);
    const Index b = vertex(t, k + 1);
    Index found = -1;
    forEachCorner(b, [&](Index other, Index corner) {
      if (vertex(other, corner + 1) == a)
        found = other;
    });
    return found;
  }

  /// Normal of a triangle, twice as long as its area.
  Eigen::Vector3d normal(Index t) const {
    const Eigen::Vector3d a = point(vertex(t, 0));
    return (point(vertex(t, 1)) - a).cross(point(vertex(t, 2)) - a);
  }

  double longestSide(Index t) const {
    return std::max({distance(vertex(t, 0), vertex(t, 1)), distance(vertex(t, 1), vertex(t, 2)),
                     distance(vertex(t, 2), vertex(t, 0))});
  }

  /// The edges that only one of mesh and graph has.
  Differences differences() const {
    const std::size_t n = graph_.size();
    std::vector<Differences> of_blocks((n + internal::kBlockSize - 1) / internal::kBlockSize);
    internal::forEachBlock(n, threads_, [&](std::size_t block, std::size_t begin, std::size_t end) {
      Differences found;
      Ring ring;
      for (std::size_t v = begin; v < end; ++v)
        collectAt(static_cast<Index>(v), ring, found);
      of_blocks[block] = std::move(found);
    });
    Differences all;
    for (const Differences& found : of_blocks) {
      all.sides.insert(all.sides.end(), found.sides.begin(), found.sides.end());
      all.edges.insert(all.edges.end(), found.edges.begin(), found.edges.end());
    }
    std::sort(all.sides.begin(), all.sides.end(), [](const Side& a, const Side& b) {
      return std::pair(a.triangle, a.corner) < std::pair(b.triangle, b.corner);
    });
    return all;
  }

  /// Distance of the points around v in the graph.
  double spacing(Index v) const {
    std::vector<double> lengths;
    return internal::nodeSpacing(graph_, at(v), lengths);
  }

private:
  /// A set of vertices around one, for quick questions.
  class Ring {
  public:
    void clear() { size_ = 0; }
    void add(Index v) {
      // Whole packs are searched: unused entries are -1, which is no vertex.
      if (size_ % kPack == 0)
        vertices_.resize(std::max(vertices_.size(), size_ + kPack));
      if (size_ % kPack == 0)
        std::fill_n(vertices_.begin() + static_cast<std::ptrdiff_t>(size_), kPack, Index{-1});
      vertices_[size_++] = v;
    }
    bool has(Index v) const {
      for (std::size_t begin = 0; begin < size_; begin += kPack) {
        Index hits = 0;
        for (std::size_t i = begin; i < begin + kPack; ++i)
          hits += vertices_[i] == v ? 1 : 0;
        if (hits > 0)
          return true;
      }
      return false;
    }

  private:
    static constexpr std::size_t kPack = 8;
    std::vector<Index> vertices_;
    std::size_t size_ = 0;
  };

  /// Compares the edges from `a` to higher vertices.
  void collectAt(Index a, Ring& ring, Differences& found) const {
    ring.clear();
    std::size_t edges_of_mesh = 0;
    forEachCorner(a, [&](Index t, Index k) {
      const Index b = triangles_(internal::nextCorner(k), t);
      ring.add(b);
      edges_of_mesh += a < b ? 1 : 0;
    });
    for (std::size_t e = graph_.offsets[at(a)]; e < graph_.offsets[at(a) + 1]; ++e) {
      const Index b = graph_.neighbors[e];
      if (b < a)
        continue;
      bool near = ring.has(b);
      edges_of_mesh -= near ? 1 : 0;
      // Nearly all others are the other diagonal of two triangles.
      if (!near)
        forEachCorner(b, [&](Index t, Index k) {
          const Index c = triangles_(internal::nextCorner(k), t);
          near = near || c == a || ring.has(c);
        });
      if (!near)
        found.edges.push_back({a, b});
    }
    if (edges_of_mesh == 0)
      return;  // the graph has them all
    forEachCorner(a, [&](Index t, Index k) {
      if (a < vertex(t, k + 1) && !nearInGraph(a, vertex(t, k + 1)))
        found.sides.push_back({t, k});
    });
  }

  /// Whether a and b are neighbours in the graph or have a common one.
  bool nearInGraph(Index a, Index b) const {
    auto i = graph_.offsets[at(a)];
    auto j = graph_.offsets[at(b)];
    const auto i_end = graph_.offsets[at(a) + 1];
    const auto j_end = graph_.offsets[at(b) + 1];
    for (std::size_t e = i; e < i_end; ++e)
      if (graph_.neighbors[e] == b)
        return true;
    while (i != i_end && j != j_end) {
      if (graph_.neighbors[i] == graph_.neighbors[j])
        return true;
      graph_.neighbors[i] < graph_.neighbors[j] ? ++i : ++j;
    }
    return false;
  }

  const Positions& points_;
  const Triangles& triangles_;
  const Graph& graph_;
  int threads_;
  internal::CornerTable corners_;
};

double quantile(std::vector<double> values, double fraction) {
  const auto k = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

/// Connected triangles around edges that leave the graph, grown across long edges.
struct Region {
  Index number = 0;  ///< of RegionSearch
  std::vector<Index> triangles;
  std::vector<Index> rim;  ///< vertices of its boundary, ascending
  double area = 0.0;
  double boundary_length = 0.0;
  /// That of the disc of its area and boundary length. Of two ways to compute it, which agree for a
  /// disc, the lesser: strips have little area, and folds that stand out little boundary.
  double diameter = 0.0;
  double rim_triangle = 0.0;   ///< nine tenths of the triangles around it have no longer side
  double spacing = 0.0;        ///< distance of the points at its rim, median
  double one_sidedness = 0.0;  ///< see kMinOneSidedness
  double inwardness = 0.0;     ///< see kMinInwardness
  Eigen::Vector3d center = Eigen::Vector3d::Zero();

  bool isWide() const {
    return diameter >= kMinHoleDiameter * spacing && diameter >= kMinRimDiameters * rim_triangle &&
           area >= kMinTriangleArea * spacing * spacing * static_cast<double>(triangles.size());
  }

  bool isOpening() const {
    return one_sidedness >= kMinOneSidedness && inwardness >= kMinInwardness;
  }
};

/// Finds the regions of a mesh.
class RegionSearch {
public:
  RegionSearch(const MeshAndGraph& surface, std::size_t triangle_count)
      : surface_(surface), triangle_count_(triangle_count) {}

  /// \param outside the edges of the mesh that leave the graph, from one of their sides.
  std::vector<Region> run(const std::vector<Side>& outside) {
    if (outside.empty())
      return {};
    region_.assign(triangle_count_, -1);
    is_outside_.assign(3 * triangle_count_, 0);
    for (const auto& [t, k] : outside) {
      is_outside_[at(3 * t + k)] = 1;
      const Index other = surface_.beyond(t, k);
      for (Index q = 0; other >= 0 && q < 3; ++q)
        if (surface_.vertex(other, q) == surface_.vertex(t, k + 1))
          is_outside_[at(3 * other + q)] = 1;
    }
    std::vector<Region> regions;
    for (const Side& side : outside)
      if (region_[at(side.triangle)] < 0) {
        regions.push_back(grownFrom(side.triangle, static_cast<Index>(regions.size())));
        measure(regions.back());
      }
    return regions;
  }

  /// The boundary of a region that was found, with the region on its left seen from outside: each
  /// loop from its lowest vertex, the longest first.
  std::vector<std::vector<Index>> loopsOf(const Region& region) const {
    std::set<std::pair<Index, Index>> left;  // sides, by triangle and corner
    for (const Index t : region.triangles)
      for (Index k = 0; k < 3; ++k)
        if (isBoundary(t, k, region.number))
          left.emplace(t, k);
    std::vector<std::pair<double, std::vector<Index>>> measured;
    while (!left.empty()) {
      auto& [length, loop] = measured.emplace_back();
      for (auto side = left.begin(); side != left.end();) {
        const auto [t, k] = *side;
        left.erase(side);
        loop.push_back(surface_.vertex(t, k));
        length += surface_.distance(surface_.vertex(t, k), surface_.vertex(t, k + 1));
        side = left.find(nextBoundary(t, k, region.number));
      }
      std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    }
    std::sort(measured.begin(), measured.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<std::vector<Index>> loops;
    loops.reserve(measured.size());
    for (auto& each : measured)
      loops.push_back(std::move(each.second));
    return loops;
  }

private:
  bool isBoundary(Index t, Index k, Index number) const {
    const Index other = surface_.beyond(t, k);
    return other < 0 || region_[at(other)] != number;
  }

  /// The side of the boundary that follows side k of triangle t there: the first around the vertex
  /// between them, within the region, so that loops through a vertex that several fans of the
  /// region share do not cross.
  std::pair<Index, Index> nextBoundary(Index t, Index k, Index number) const {
    const Index around = surface_.vertex(t, k + 1);
    k = (k + 1) % 3;
    // A vertex has fewer triangles than the mesh: the loop ends on any input.
    for (std::size_t step = 0; step < triangle_count_ && !isBoundary(t, k, number); ++step) {
      t = surface_.beyond(t, k);
      k = 0;
      while (surface_.vertex(t, k) != around)
        ++k;
    }
    return {t, k};
  }

  Region grownFrom(Index seed, Index number) {
    Region region;
    region.number = number;
    region.triangles.push_back(seed);
    region_[at(seed)] = number;
    for (std::size_t i = 0; i < region.triangles.size(); ++i)
      for (Index k = 0; k < 3; ++k) {
        const Index t = region.triangles[i];
        if (is_outside_[at(3 * t + k)] == 0 &&
            !isLong(surface_.vertex(t, k), surface_.vertex(t, k + 1)))
          continue;
        const Index other = surface_.beyond(t, k);
        if (other >= 0 && region_[at(other)] < 0) {
          region_[at(other)] = number;
          region.triangles.push_back(other);
        }
      }
    return region;
  }

  void measure(Region& region) {
    std::vector<double> around;
    for (const Index t : region.triangles) {
      const double area = surface_.normal(t).norm() / 2.0;
      region.area += area;
      region.center +=
          area / 3.0 *
          (surface_.point(surface_.vertex(t, 0)) + surface_.point(surface_.vertex(t, 1)) +
           surface_.point(surface_.vertex(t, 2)));
      for (Index k = 0; k < 3; ++k) {
        const Index other = surface_.beyond(t, k);
        if (other < 0 || region_[at(other)] == region.number)
          continue;
        region.boundary_length +=
            surface_.distance(surface_.vertex(t, k), surface_.vertex(t, k + 1));
        region.rim.push_back(surface_.vertex(t, k));
        around.push_back(surface_.longestSide(other));
      }
    }
    if (around.empty() || region.area <= 0.0)
      return;
    region.center /= region.area;
    std::sort(region.rim.begin(), region.rim.end());
    region.rim.erase(std::unique(region.rim.begin(), region.rim.end()), region.rim.end());
    region.diameter =
        std::min(4.0 * region.area / region.boundary_length, region.boundary_length / kPi);
    region.rim_triangle = quantile(around, 0.9);
    std::vector<double> spacings;
    std::vector<double> one_sidedness;
    std::vector<double> inwardness;
    for (const Index v : region.rim) {
      spacings.push_back(spacing(v));
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      Eigen::Vector3d off_rim = Eigen::Vector3d::Zero();
      int count = 0;
      int count_off_rim = 0;
      surface_.forEachNeighbor(v, [&](Index w, double length) {
        if (length > kMinLongEdge * spacing(v))
          return;  // it may lead across the opening
        const Eigen::Vector3d direction = (surface_.point(w) - surface_.point(v)) / length;
        sum += direction;
        ++count;
        if (!std::binary_search(region.rim.begin(), region.rim.end(), w)) {
          off_rim += direction;
          ++count_off_rim;
        }
      });
      one_sidedness.push_back(sum.norm() / std::max(count, 1));
      if (count_off_rim > 0)
        inwardness.push_back(off_rim.norm() / count_off_rim);
    }
    region.spacing = quantile(spacings, 0.5);
    region.one_sidedness = quantile(one_sidedness, 0.5);
    if (!inwardness.empty())
      region.inwardness = quantile(inwardness, 0.5);
  }

  bool isLong(Index a, Index b) {
    return surface_.distance(a, b) > kMinLongEdge * std::max(spacing(a), spacing(b));
  }

  double spacing(Index v) {
    const auto [entry, is_new] = spacing_.try_emplace(v, 0.0);
    if (is_new)
      entry->second = surface_.spacing(v);
    return entry->second;
  }

  const MeshAndGraph& surface_;
  std::size_t triangle_count_;
  std::vector<Index> region_;     // of each triangle; -1: none
  std::vector<char> is_outside_;  // of each side
  std::map<Index, double> spacing_;
};

/// Measures how far apart vertices are on the mesh.
class MeshDistance {
public:
  MeshDistance(const MeshAndGraph& surface, std::size_t n) : surface_(surface), mark_(n, 0) {}

  /// Whether a and b are more than `steps` edges apart: the discs of half as many do not meet.
  bool exceeds(Index a, Index b, int steps) {
    if (last_mark_ > std::numeric_limits<Mark>::max() - 2) {
      std::fill(mark_.begin(), mark_.end(), Mark{0});
      last_mark_ = 0;
    }
    const Mark of_a = ++last_mark_;
    const Mark of_b = ++last_mark_;
    markDisc(a, steps - steps / 2, of_a, of_b);
    return !markDisc(b, steps / 2, of_b, of_a);
  }

private:
  using Mark = std::uint32_t;

  /// Whether it met the mark `other`, where it ends.
  bool markDisc(Index center, int steps, Mark own, Mark other) {
    if (mark_[at(center)] == other)
      return true;
    mark_[at(center)] = own;
    disc_.assign(1, center);
    bool met = false;
    std::size_t begin = 0;
    for (int step = 0; step < steps; ++step)
      for (const std::size_t end = disc_.size(); begin < end; ++begin) {
        surface_.forEachCorner(disc_[begin], [&](Index t, Index k) {
          Mark& mark = mark_[at(surface_.vertex(t, k + 1))];
          met = met || mark == other;
          if (mark != own)
            disc_.push_back(surface_.vertex(t, k + 1));
          mark = own;
        });
        if (met)
          return true;
      }
    return false;
  }

  const MeshAndGraph& surface_;
  std::vector<Mark> mark_;
  std::vector<Index> disc_;
  Mark last_mark_ = 0;
};

/// The edges of the graph along the surface whose ends are far apart on the mesh: those between
/// sheets that nearly touch are left out, unless the mesh fills a hole there.
///
/// \param apart     those whose ends are more than two steps apart.
/// \param regions   all that leaves the graph.
/// \param wide_count number of wide regions, at the front.
std::vector<Edge> tornEdges(const MeshAndGraph& surface, const std::vector<Edge>& apart,
                            const std::vector<Region>& regions, std::size_t wide_count,
                            std::size_t triangle_count, const std::vector<Edge>& bridges,
                            std::size_t n) {
  if (apart.empty())
    return {};
  std::vector<char> in_region(triangle_count, 0);
  std::vector<char> at_cut(n, 0);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    for (const Index t : regions[r].triangles)
      in_region[at(t)] = 1;
    if (r < wide_count && !regions[r].isOpening())
      for (const Index v : regions[r].rim)
        at_cut[at(v)] = 1;
  }
  const auto normal = [&](Index v) {
    Eigen::Vector3d of_surface = Eigen::Vector3d::Zero();
    Eigen::Vector3d of_all = Eigen::Vector3d::Zero();
    surface.forEachCorner(v, [&](Index t, Index) {
      of_all += surface.normal(t);
      if (in_region[at(t)] == 0)
        of_surface += surface.normal(t);
    });
    return Eigen::Vector3d((of_surface.norm() > 0.0 ? of_surface : of_all).normalized());
  };
  MeshDistance distance(surface, n);
  std::vector<Edge> torn;
  for (const auto& [a, b] : apart) {
    if (!distance.exceeds(a, b, kMinHandleSteps) ||
        std::binary_search(bridges.begin(), bridges.end(), Edge{a, b}))
      continue;
    if (at_cut[at(a)] != 0 || at_cut[at(b)] != 0) {
      torn.push_back({a, b});
      continue;
    }
    const Eigen::Vector3d at_a = normal(a);
    const Eigen::Vector3d at_b = normal(b);
    const Eigen::Vector3d along = (surface.point(b) - surface.point(a)).normalized();
    if (at_a.dot(at_b) >= kMinNormalCosine && std::abs(along.dot(at_a)) <= kMaxSlope &&
        std::abs(along.dot(at_b)) <= kMaxSlope)
      torn.push_back({a, b});
  }
  return torn;
}

/// At most `count` of the vertices, spread over their order.
std::vector<Index> someOf(const std::vector<Index>& vertices, std::size_t count) {
  if (vertices.size() <= count)
    return vertices;
  std::vector<Index> result;
  for (std::size_t i = 0; i < count; ++i)
    result.push_back(vertices[i * vertices.size() / count]);
  return result;
}

void sortUnique(std::vector<Index>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

Eigen::Vector3d meanOf(const MeshAndGraph& surface, const std::vector<Index>& vertices) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Index v : vertices)
    sum += surface.point(v);
  return sum / static_cast<double>(vertices.size());
}

/// Groups of torn edges that share an end, or whose ends are neighbours on the mesh; all ends are
/// listed.
std::vector<CollapsedHandle> handlesOf(const MeshAndGraph& surface, const std::vector<Edge>& torn) {
  std::map<Index, Index> edge_at;
  internal::UnionFind groups(torn.size());
  for (std::size_t e = 0; e < torn.size(); ++e)
    for (const Index v : torn[e])
      groups.unite(edge_at.try_emplace(v, static_cast<Index>(e)).first->second,
                   static_cast<Index>(e));
  for (const auto& entry : edge_at)
    surface.forEachCorner(entry.first, [&](Index t, Index k) {
      const auto next = edge_at.find(surface.vertex(t, k + 1));
      if (next != edge_at.end())
        groups.unite(entry.second, next->second);
    });
  std::map<Index, CollapsedHandle> handles;
  for (std::size_t e = 0; e < torn.size(); ++e) {
    CollapsedHandle& handle = handles[groups.find(static_cast<Index>(e))];
    ++handle.edges;
    handle.vertices.insert(handle.vertices.end(), torn[e].begin(), torn[e].end());
  }
  std::vector<CollapsedHandle> result;
  for (auto& [group, handle] : handles) {
    if (handle.edges < kMinTornEdges)
      continue;
    sortUnique(handle.vertices);
    handle.center = meanOf(surface, handle.vertices);
    Eigen::AlignedBox3d box;
    for (const Index v : handle.vertices)
      box.extend(surface.point(v));
    handle.size = box.diagonal().norm();
    result.push_back(std::move(handle));
  }
  std::stable_sort(
      result.begin(), result.end(),
      [](const CollapsedHandle& a, const CollapsedHandle& b) { return a.edges > b.edges; });
  return result;
}

/// Whether the graph has the rim of an opening.
bool hasRim(const MeshAndGraph& surface, std::size_t n) {
  std::vector<char> one_sided(n, 0);
  for (std::size_t v = 0; v < n; ++v) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    surface.forEachNeighbor(static_cast<Index>(v), [&](Index w, double length) {
      sum += (surface.point(w) - surface.point(static_cast<Index>(v))) / length;
      ++count;
    });
    one_sided[v] = sum.norm() >= kMinOneSidednessInGraph * count ? 1 : 0;
  }
  internal::UnionFind rims(n);
  for (std::size_t v = 0; v < n; ++v)
    surface.forEachNeighbor(static_cast<Index>(v), [&](Index w, double) {
      if (one_sided[v] != 0 && one_sided[at(w)] != 0)
        rims.unite(static_cast<Index>(v), w);
    });
  std::vector<std::size_t> sizes(n, 0);
  for (std::size_t v = 0; v < n; ++v)
    if (one_sided[v] != 0)
      ++sizes[at(rims.find(static_cast<Index>(v)))];
  return *std::max_element(sizes.begin(), sizes.end()) >= kMinRimPoints;
}

/// Number of handles of a surface with the given number of openings, by the cycles of its graph.
/// Empty if the number depends on how wide a gap in the graph has to be.
std::optional<int> genusOf(const Graph& graph, std::size_t openings) {
  const std::optional<int> narrow = internal::countCycles(graph, 2);
  const std::optional<int> wide = narrow ? internal::countCycles(graph, 3) : std::nullopt;
  if (!wide || *narrow != *wide)
    return std::nullopt;
  const int of_handles = *wide - (openings > 1 ? static_cast<int>(openings) - 1 : 0);
  return of_handles >= 0 && of_handles % 2 == 0 ? std::optional(of_handles / 2) : std::nullopt;
}

/// The parts of a graph without the bridges between them.
class Parts {
public:
  Parts(const Graph& graph, const std::vector<Edge>& bridges) : sets_(graph.size()) {
    for (std::size_t a = 0; a < graph.size(); ++a)
      for (std::size_t e = graph.offsets[a]; e < graph.offsets[a + 1]; ++e)
        if (static_cast<Index>(a) < graph.neighbors[e] &&
            !std::binary_search(bridges.begin(), bridges.end(),
                                Edge{static_cast<Index>(a), graph.neighbors[e]}))
          sets_.unite(static_cast<Index>(a), graph.neighbors[e]);
    sizes_.assign(graph.size(), 0);
    for (std::size_t v = 0; v < graph.size(); ++v)
      ++sizes_[at(of(static_cast<Index>(v)))];
  }

  Index of(Index v) { return sets_.find(v); }
  std::size_t sizeOf(Index part) const { return sizes_[at(part)]; }

private:
  internal::UnionFind sets_;
  std::vector<std::size_t> sizes_;
};

/// Pairs of parts with a gap that is wide against the distance of the points; all ends are listed.
std::vector<PartBridge> partsOf(const MeshAndGraph& surface, const std::vector<Edge>& bridges,
                                Parts& parts) {
  std::map<Edge, std::vector<Edge>> joints;
  for (const auto& [a, b] : bridges) {
    const Index of_a = parts.of(a);
    const Index of_b = parts.of(b);
    if (of_a != of_b)
      joints[{std::min(of_a, of_b), std::max(of_a, of_b)}].push_back({a, b});
  }
  std::vector<PartBridge> result;
  for (const auto& [pair, edges] : joints) {
    PartBridge joint;
    std::vector<double> spacings;
    std::vector<double> gaps;
    for (const auto& [a, b] : edges) {
      gaps.push_back(surface.distance(a, b));
      for (const Index v : {a, b}) {
        joint.vertices.push_back(v);
        spacings.push_back(surface.spacing(v));
      }
    }
    sortUnique(joint.vertices);
    joint.gap = quantile(gaps, 0.0);
    joint.spacing = quantile(spacings, 0.5);
    if (joint.gap < kMinPartGap * joint.spacing)
      continue;
    joint.center = meanOf(surface, joint.vertices);
    joint.points = std::min(parts.sizeOf(pair[0]), parts.sizeOf(pair[1]));
    joint.other_points = std::max(parts.sizeOf(pair[0]), parts.sizeOf(pair[1]));
    result.push_back(std::move(joint));
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const PartBridge& a, const PartBridge& b) { return a.points > b.points; });
  return result;
}

/// What a wide region is a trace of; empty for a fold.
std::optional<SurfaceKind> causeOf(const Region& region, Parts* parts,
                                   const std::vector<PartBridge>& bridges,
                                   const std::vector<CollapsedHandle>& handles) {
  if (region.isOpening())
    return SurfaceKind::Open;
  if (!bridges.empty())
    for (const Index v : region.rim)
      if (parts->of(v) != parts->of(region.rim.front()))
        return SurfaceKind::SeveralParts;
  for (const CollapsedHandle& handle : handles)
    for (const Index v : region.rim)
      if (std::binary_search(handle.vertices.begin(), handle.vertices.end(), v))
        return SurfaceKind::Handles;
  return std::nullopt;
}

/// Puts marks on triangles.
class TriangleMarker {
public:
  TriangleMarker(const MeshAndGraph& surface, std::size_t triangle_count)
      : surface_(surface), marks_(triangle_count, 0) {}

  void mark(const std::vector<Index>& triangles, std::uint8_t bit) {
    for (const Index t : triangles)
      add(t, bit);
  }
  /// The triangles with a corner at one of the vertices.
  void markAround(const std::vector<Index>& vertices, std::uint8_t bit) {
    for (const Index v : vertices)
      surface_.forEachCorner(v, [&](Index t, Index) { add(t, bit); });
  }
  /// The triangles on both sides of edges.
  void markBesides(const std::vector<Side>& sides, std::uint8_t bit) {
    for (const Side& side : sides) {
      add(side.triangle, bit);
      const Index other = surface_.beyond(side.triangle, side.corner);
      if (other >= 0)
        add(other, bit);
    }
  }
  std::vector<std::uint8_t> take() { return std::move(marks_); }

private:
  void add(Index t, std::uint8_t bit) {
    marks_[at(t)] = static_cast<std::uint8_t>(marks_[at(t)] | bit);
  }

  const MeshAndGraph& surface_;
  std::vector<std::uint8_t> marks_;
};

}  // namespace

std::size_t SurfaceDiagnosis::openings() const {
  return static_cast<std::size_t>(
      std::count_if(filled_holes.begin(), filled_holes.end(),
                    [](const FilledHole& hole) { return hole.cause == SurfaceKind::Open; }));
}

bool SurfaceDiagnosis::isFolded() const {
  return edges_outside_graph > kMaxOutsideGraph;
}

namespace {

/// The edges of the graph that join its parts, {lower, higher}, ascending.
std::vector<Edge> edgesOf(const std::vector<Bridge>& bridges) {
  std::vector<Edge> edges;
  edges.reserve(bridges.size());
  for (const Bridge& bridge : bridges)
    edges.push_back({std::min(bridge.from, bridge.to), std::max(bridge.from, bridge.to)});
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// The edges of a graph that are among the kThinnedDegree shortest of one of their ends, and the
/// bridges; the graph itself if its mean degree is small.
Graph thinned(const Graph& graph, const std::vector<Edge>& bridges) {
  if (graph.neighbors.size() <= kMaxMeanDegree * graph.size())
    return graph;
  std::vector<double> reach(graph.size(), std::numeric_limits<double>::infinity());
  for (std::size_t v = 0; v < graph.size(); ++v) {
    std::vector<double> lengths(
        graph.lengths.begin() + static_cast<std::ptrdiff_t>(graph.offsets[v]),
        graph.lengths.begin() + static_cast<std::ptrdiff_t>(graph.offsets[v + 1]));
    if (lengths.size() <= kThinnedDegree)
      continue;
    const auto last = lengths.begin() + static_cast<std::ptrdiff_t>(kThinnedDegree - 1);
    std::nth_element(lengths.begin(), last, lengths.end());
    reach[v] = *last;
  }
  Graph thin;
  for (std::size_t v = 0; v < graph.size(); ++v) {
    for (std::size_t e = graph.offsets[v]; e < graph.offsets[v + 1]; ++e) {
      const Index w = graph.neighbors[e];
      const Edge edge{std::min(static_cast<Index>(v), w), std::max(static_cast<Index>(v), w)};
      if (graph.lengths[e] > std::max(reach[v], reach[at(w)]) &&
          !std::binary_search(bridges.begin(), bridges.end(), edge))
        continue;
      thin.neighbors.push_back(w);
      thin.lengths.push_back(graph.lengths[e]);
    }
    thin.offsets.push_back(thin.neighbors.size());
  }
  return thin;
}

/// Finds filled holes, handles and parts, and decides what the cloud shows.
class Diagnosis {
public:
  Diagnosis(const Positions& points, const Triangles& triangles, const Graph& graph,
            const std::vector<Bridge>& bridges, const DiagnosisOptions& options, int threads)
      : given_graph_(graph), options_(options), bridges_(edgesOf(bridges)),
        graph_(thinned(graph, bridges_)),
        triangle_count_(static_cast<std::size_t>(triangles.cols())),
        surface_(points, triangles, graph_,
                 internal::threadCount(threads, graph.size(), internal::kShortPassThreshold)),
        differences_(surface_.differences()), search_(surface_, triangle_count_) {}

  SurfaceDiagnosis run() {
    result_.edges_outside_graph = static_cast<double>(differences_.sides.size()) /
                                  (1.5 * static_cast<double>(triangle_count_));
    findRegions();
    findParts();
    findHandles();
    findFilledHoles();
    if (options_.mark_triangles)
      markTriangles();
    result_.kind = kind();
    shortenLists();
    return std::move(result_);
  }

private:
  /// Finds the regions that leave the graph, the wide ones first.
  void findRegions() {
    regions_ = search_.run(differences_.sides);
    const auto wide_end = std::stable_partition(
        regions_.begin(), regions_.end(), [](const Region& region) { return region.isWide(); });
    // A folded mesh leaves the graph everywhere, whether the surface has holes or not.
    wide_count_ = result_.isFolded() ? 0 : static_cast<std::size_t>(wide_end - regions_.begin());
  }

  /// Only graphs with bridges may be in parts.
  void findParts() {
    if (bridges_.empty())
      return;
    parts_.emplace(given_graph_, bridges_);
    result_.bridges = partsOf(surface_, bridges_, *parts_);
  }

  /// A mesh that is folded, or was squeezed through a bridge, tears neighbours apart without
  /// handles as well.
  void findHandles() {
    if (!result_.bridges.empty())
      return;
    if (result_.isFolded()) {
      if (options_.count_cycles && !hasRim(surface_, graph_.size()))
        result_.genus = genusOf(graph_, 0);
      return;
    }
    result_.handles =
        handlesOf(surface_, tornEdges(surface_, differences_.edges, regions_, wide_count_,
                                      triangle_count_, bridges_, graph_.size()));
    if (result_.handles.empty() || !options_.count_cycles)
      return;
    const auto wide_end = regions_.begin() + static_cast<std::ptrdiff_t>(wide_count_);
    const auto openings = std::count_if(regions_.begin(), wide_end,
                                        [](const Region& region) { return region.isOpening(); });
    result_.genus = genusOf(graph_, static_cast<std::size_t>(openings));
    // Without handles, neighbours are torn apart where the mesh is folded.
    if (result_.genus == 0)
      result_.handles.clear();
  }

  void findFilledHoles() {
    for (std::size_t r = 0; r < wide_count_; ++r) {
      const Region& region = regions_[r];
      const std::optional<SurfaceKind> cause =
          causeOf(region, parts_ ? &*parts_ : nullptr, result_.bridges, result_.handles);
      if (!cause)
        continue;
      result_.filled_holes.push_back({*cause, region.triangles.size(), region.area,
                                      region.boundary_length, region.diameter, region.spacing,
                                      region.center, someOf(region.rim, options_.max_vertices),
                                      search_.loopsOf(region)});
      filled_.insert(filled_.end(), region.triangles.begin(), region.triangles.end());
    }
    std::stable_sort(result_.filled_holes.begin(), result_.filled_holes.end(),
                     [](const FilledHole& a, const FilledHole& b) { return a.area > b.area; });
  }

  void markTriangles() {
    TriangleMarker marker(surface_, triangle_count_);
    marker.mark(filled_, TriangleMarks::filled_hole);
    for (const CollapsedHandle& handle : result_.handles)
      marker.markAround(handle.vertices, TriangleMarks::handle);
    for (const PartBridge& bridge : result_.bridges)
      marker.markAround(bridge.vertices, TriangleMarks::part_bridge);
    marker.markBesides(differences_.sides, TriangleMarks::outside_graph);
    result_.triangle_marks = marker.take();
  }

  SurfaceKind kind() const {
    if (!result_.bridges.empty())
      return SurfaceKind::SeveralParts;
    const bool is_torn = !result_.handles.empty();
    if (result_.isFolded() ? result_.genus.value_or(0) > 0 : is_torn && options_.count_cycles)
      return SurfaceKind::Handles;
    if (result_.isFolded() || is_torn)
      return SurfaceKind::Unclear;
    return result_.openings() > 0 ? SurfaceKind::Open : SurfaceKind::ClosedGenus0;
  }

  void shortenLists() {
    for (CollapsedHandle& handle : result_.handles)
      handle.vertices = someOf(handle.vertices, options_.max_vertices);
    for (PartBridge& bridge : result_.bridges)
      bridge.vertices = someOf(bridge.vertices, options_.max_vertices);
  }

  const Graph& given_graph_;
  const DiagnosisOptions& options_;
  std::vector<Edge> bridges_;
  Graph graph_;  ///< thinned
  std::size_t triangle_count_;
  MeshAndGraph surface_;
  Differences differences_;
  RegionSearch search_;
  std::vector<Region> regions_;
  std::size_t wide_count_ = 0;  ///< of regions_, at the front
  std::optional<Parts> parts_;  ///< with bridges only
  std::vector<Index> filled_;   ///< triangles of all filled holes
  SurfaceDiagnosis result_;
};

}  // namespace

SurfaceDiagnosis diagnoseSurface(const Positions& points, const Triangles& triangles,
                                 const Graph& graph, const std::vector<Bridge>& bridges,
                                 const DiagnosisOptions& options, int threads) {
  return Diagnosis(points, triangles, graph, bridges, options, threads).run();
}

}  // namespace spherical_param
