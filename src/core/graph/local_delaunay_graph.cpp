#include "local_delaunay_graph.h"

#include "component_tree.h"
#include "graph_building.h"
#include "neighbor_lists.h"
#include "parallel.h"
#include "power_of_two.h"
#include "progress.h"
#include "spherical_param/errors.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

namespace spherical_param {
namespace {

// The experiments are on 13 models and 13 shapes of up to 60,000 points, on 25 awkward clouds (few
// points, lines of a scanner, tubes, parts, volumes) and on 35 open, partial and raw scans.

/// Bridges of each pair of components that are joined: one alone lets a part dangle, and collapse
/// in the embedding. With 1 or 2, two spheres have 962 or 780 self-intersections instead of 0.
constexpr int kBridgesPerJoint = 3;
/// Degree below which a point is repaired. Below 4 would be too generous: it brings back edges that
/// one star alone saw, across gaps; a model then has 1,203 self-intersections instead of 0. With 0,
/// a pair of elephants has 2,093,249 instead of 77,968.
constexpr std::size_t kMinDegree = 3;

/// Voronoi edges shorter than this part of the cell's radius count as none: of four points on a
/// circle, those across from each other are no neighbours, whatever the round-off. With 0 the graph
/// of the fandisk, which has such points, depends on it; a view of it has 701 self-intersections
/// instead of 596 then.
constexpr double kTie = 1e-9;

/// Largest ratio of the smallest to the middle variance of a neighbourhood with a tangent plane:
/// above, all directions are alike. Stars are better than what takes their place for as long as
/// there is any plane at all. With 0.5 a model has 6 self-intersections, without a bound 2.
constexpr double kMaxRoundness = 0.9;
/// Least ratio of the middle to the largest variance: below, the neighbourhood is a line. Without,
/// a sphere scanned in lines has 27 self-intersections instead of 3.
constexpr double kMinWidthRatio = 0.01;

/// Nearest neighbours that span the tangent plane; more where these are on a line. With 6 the
/// awkward clouds have 111,926 self-intersections instead of 61,815, with 12 a model has 799
/// instead of 0.
constexpr int kTangentNeighbors = 10;
/// Candidates steeper than this to the tangent plane are on another sheet [sine of the angle]. With
/// 1 a model has 2 self-intersections, with 0.7 two have 2 and 412.
constexpr double kMaxSlope = 0.85;
/// Nearest neighbours used of a list, and searched for, at most. With 12 or 24 a sphere scanned in
/// lines has some 20,000 self-intersections instead of 3; with 64, 0, but the search takes longer.
constexpr int kMaxCandidates = 32;

struct Candidate {
  double squared_distance;
  Index node;
  Eigen::Vector3d offset;  ///< from the point

  bool operator<(const Candidate& other) const {
    return squared_distance < other.squared_distance ||
           (squared_distance == other.squared_distance && node < other.node);
  }
};

/// Voronoi cell of the origin in the plane: a convex polygon that is cut by bisectors.
class VoronoiCell {
public:
  static constexpr Index kBox = -1;

  void reserve(std::size_t sites) {
    // Each cut adds one corner at most.
    corners_.reserve(sites + 4);
    cut_.reserve(sites + 4);
    sides_.reserve(sites + 4);
  }

  /// A square, in place of the unbounded cell.
  void reset(double half_size) {
    corners_ = {{half_size, half_size, kBox},
                {-half_size, half_size, kBox},
                {-half_size, -half_size, kBox},
                {half_size, -half_size, kBox}};
    squared_radius_ = 2.0 * half_size * half_size;
  }

  /// Cuts off what is nearer to `site` than to the origin.
  void cut(double x, double y, Index site) {
    const double half_square = 0.5 * (x * x + y * y);
    const double tolerance = kTie * half_square;
    const std::size_t count = corners_.size();
    sides_.resize(count);
    bool cuts = false;
    for (std::size_t k = 0; k < count; ++k) {
      sides_[k] = corners_[k].x * x + corners_[k].y * y - half_square;
      cuts = cuts || sides_[k] > tolerance;
    }
    if (!cuts)
      return;
    cut_.clear();
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t next = k + 1 < count ? k + 1 : 0;
      const bool inside = sides_[k] <= tolerance;
      if (inside)
        cut_.push_back(corners_[k]);
      if (inside == (sides_[next] <= tolerance))
        continue;
      // The side of the new edge begins where the polygon leaves; the old one goes on where it
      // comes back.
      const double inner = inside ? sides_[k] : sides_[next];
      const double outer = inside ? sides_[next] : sides_[k];
      const Corner& from = inside ? corners_[k] : corners_[next];
      const Corner& to = inside ? corners_[next] : corners_[k];
      const double fraction = inner < 0.0 ? inner / (inner - outer) : 0.0;
      cut_.push_back({from.x + fraction * (to.x - from.x), from.y + fraction * (to.y - from.y),
                      inside ? site : corners_[k].site});
    }
    corners_.swap(cut_);
    squared_radius_ = 0.0;
    for (const Corner& corner : corners_)
      squared_radius_ = std::max(squared_radius_, corner.x * corner.x + corner.y * corner.y);
  }

  double squaredRadius() const { return squared_radius_; }

  bool isBounded() const {
    return std::none_of(corners_.begin(), corners_.end(),
                        [](const Corner& corner) { return corner.site == kBox; });
  }

  /// Calls found(site) for each edge that is longer than round-off.
  template <typename Found>
  void forEachSite(const Found& found) const {
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Corner& begin = corners_[k];
      const Corner& end = corners_[k + 1 < corners_.size() ? k + 1 : 0];
      const double x = end.x - begin.x;
      const double y = end.y - begin.y;
      if (begin.site != kBox && x * x + y * y > kTie * kTie * squared_radius_)
        found(begin.site);
    }
  }

private:
  struct Corner {
    double x;
    double y;
    Index site;  ///< whose bisector the edge to the next corner is on
  };

  std::vector<Corner> corners_;  ///< counter-clockwise
  std::vector<Corner> cut_;
  std::vector<double> sides_;  ///< of a bisector that the corners are on; positive: beyond
  double squared_radius_ = 0.0;
};

/// What one thread works with.
struct Scratch {
  std::vector<Candidate> candidates;
  VoronoiCell cell;
};

struct StarKind {
  Index candidates = -1;       ///< nearest points that are known; -1: not looked at yet
  bool tangent_plane = false;  ///< there is one that can be trusted
  bool certified = false;      ///< no further point can change the star
  bool wants_more = false;     ///< more candidates may help
};

/// The neighbours that each point would have. Those of point i are nodes[begin[i]] ...
/// nodes[begin[i] + count[i] - 1], ascending.
struct Stars {
  explicit Stars(std::size_t n) : begin(n), count(n), kind(n), nearest(n) {}

  std::vector<std::size_t> begin;
  std::vector<Index> count;
  std::vector<Index> nodes;
  std::vector<StarKind> kind;
  std::vector<std::array<Index, 3>> nearest;  ///< the three nearest; -1: unknown

  std::size_t size() const { return begin.size(); }
  std::size_t endOf(std::size_t i) const { return begin[i] + static_cast<std::size_t>(count[i]); }
  bool holds(Index i, Index j) const {
    const auto first =
        nodes.begin() + static_cast<std::ptrdiff_t>(begin[static_cast<std::size_t>(i)]);
    const auto last = first + count[static_cast<std::size_t>(i)];
    return std::find(first, last, j) != last;
  }
};

/// The nearest candidates of a list, sorted; in units of their own if squares would underflow.
void collectCandidates(const Positions& points, Index i, const Index* begin, const Index* end,
                       int most, std::vector<Candidate>& candidates) {
  candidates.clear();
  const Eigen::Vector3d point = points.col(i);
  double extent = 0.0;
  for (const Index* j = begin; j != end; ++j) {
    if (*j == i)
      continue;
    Candidate candidate;
    candidate.node = *j;
    candidate.offset = points.col(*j) - point;
    candidate.squared_distance = candidate.offset.squaredNorm();
    extent = std::max(extent, candidate.offset.cwiseAbs().maxCoeff());
    candidates.push_back(candidate);
  }
  constexpr double safe = 1e-100;
  if (extent > 0.0 && (extent < safe || extent > 1.0 / safe)) {
    // By a power of two, which is exact.
    const internal::PowerOfTwo scaled(-std::ilogb(extent));
    for (Candidate& candidate : candidates) {
      candidate.offset = scaled(candidate.offset);
      candidate.squared_distance = candidate.offset.squaredNorm();
    }
  }
  if (!std::is_sorted(candidates.begin(), candidates.end()))
    std::sort(candidates.begin(), candidates.end());
  candidates.erase(
      std::unique(candidates.begin(), candidates.end(),
                  [](const Candidate& a, const Candidate& b) { return a.node == b.node; }),
      candidates.end());
  if (candidates.size() > static_cast<std::size_t>(most))
    candidates.erase(candidates.begin() + most, candidates.end());
}

/// Axes of the `count` nearest candidates about their centroid, by ascending variance. False if
/// they span no plane that can be trusted.
bool findTangentPlane(const std::vector<Candidate>& candidates, std::size_t count,
                      Eigen::Matrix3d& axes, bool& is_line) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (std::size_t c = 0; c < count; ++c)
    centroid += candidates[c].offset;
  centroid /= static_cast<double>(count);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < count; ++c) {
    const Eigen::Vector3d offset = candidates[c].offset - centroid;
    covariance += offset * offset.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  axes = solver.eigenvectors();
  const Eigen::Vector3d& variances = solver.eigenvalues();
  is_line = !(variances[1] > kMinWidthRatio * variances[2]);
  return !is_line && variances[0] <= kMaxRoundness * variances[1];
}

/// Writes the neighbours in the graph of Gabriel and Sokal (1969): no point is in the ball whose
/// diameter the two are. It needs no plane, is the same from both ends, and is decided by the
/// nearest points alone.
void findGabrielNeighbors(const std::vector<Candidate>& candidates, Index* star, Index& count) {
  for (const Candidate& candidate : candidates) {
    const bool blocked =
        std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
          return other.node != candidate.node &&
                 other.squared_distance <= (1.0 + kTie) * other.offset.dot(candidate.offset);
        });
    if (!blocked)
      star[count++] = candidate.node;
  }
}

/// Writes the Voronoi neighbours in the tangent plane. Returns whether they are certified.
bool findVoronoiNeighbors(const std::vector<Candidate>& candidates, const Eigen::Matrix3d& axes,
                          double max_slope, VoronoiCell& cell, Index* star, Index& count) {
  const double squared_reach = candidates.back().squared_distance;
  // A cell that is larger ends there: sites beyond would be neighbours across a gap.
  cell.reset(std::sqrt(squared_reach));
  // In terms of the cosine; of what is as steep as round-off the direction means nothing.
  const double least_fraction = std::max(1.0 - max_slope * max_slope, 1e-20);
  for (const Candidate& candidate : candidates) {
    if (candidate.squared_distance > 4.0 * cell.squaredRadius())
      break;
    const double x = axes.col(1).dot(candidate.offset);
    const double y = axes.col(2).dot(candidate.offset);
    const double fraction = (x * x + y * y) / candidate.squared_distance;
    if (!(fraction >= least_fraction))
      continue;
    const double stretch = 1.0 / std::sqrt(fraction);
    cell.cut(stretch * x, stretch * y, candidate.node);
  }
  cell.forEachSite([&](Index site) {
    // Round-off at corners may leave two edges of one site.
    if (std::find(star, star + count, site) == star + count)
      star[count++] = site;
  });
  return cell.isBounded() && 4.0 * cell.squaredRadius() <= squared_reach;
}

/// Writes the star of the point whose sorted candidates are given, ascending.
///
/// \param others number of other points there are
StarKind findStar(const std::vector<Candidate>& candidates, std::size_t others, VoronoiCell& cell,
                  Index* star, Index& count) {
  StarKind kind;
  kind.candidates = static_cast<Index>(candidates.size());
  count = 0;
  const bool complete = candidates.size() >= others;
  const auto tangent_neighbors = std::size_t{kTangentNeighbors};
  if (candidates.size() < tangent_neighbors) {
    kind.wants_more = !complete;
    findGabrielNeighbors(candidates, star, count);
  } else {
    Eigen::Matrix3d axes;
    bool is_line = true;
    // Where the nearest are on a scan line, those of the next ones may be among some more.
    for (std::size_t span = tangent_neighbors; is_line; span *= 2) {
      span = std::min(span, candidates.size());
      kind.tangent_plane = findTangentPlane(candidates, span, axes, is_line);
      if (span == candidates.size())
        break;
    }
    if (kind.tangent_plane) {
      const bool certified = findVoronoiNeighbors(candidates, axes, kMaxSlope, cell, star, count);
      kind.certified = certified || complete;
      kind.wants_more = !kind.certified;
    } else {
      kind.wants_more = is_line && !complete;
      findGabrielNeighbors(candidates, star, count);
    }
  }
  std::sort(star, star + count);
  return kind;
}

/// Finds the stars of the points in `subset` (empty: of all) from lists in its order. Lists that
/// are no longer than the one before change nothing.
void findStars(const Positions& points, const std::vector<Index>& subset,
               const NeighborLists& lists, int threads, std::vector<Scratch>& scratch,
               const internal::FractionReport& report, Stars& stars) {
  const std::size_t base = stars.nodes.size();
  stars.nodes.resize(base + lists.indices.size());
  std::size_t longest = 0;
  for (std::size_t q = 0; q < lists.size(); ++q)
    longest = std::max(longest, lists.offsets[q + 1] - lists.offsets[q]);
  for (Scratch& memory : scratch) {
    memory.candidates.reserve(longest);
    memory.cell.reserve(longest);
  }
  const std::size_t others = stars.size() - 1;
  internal::reportFraction(report, 0.0);
  internal::forEachItem(lists.size(), threads, report, [&](std::size_t thread, std::size_t q) {
    const Index node = subset.empty() ? static_cast<Index>(q) : subset[q];
    const auto i = static_cast<std::size_t>(node);
    std::vector<Candidate>& candidates = scratch[thread].candidates;
    collectCandidates(points, node, lists.indices.data() + lists.offsets[q],
                      lists.indices.data() + lists.offsets[q + 1], kMaxCandidates, candidates);
    if (static_cast<Index>(candidates.size()) <= stars.kind[i].candidates)
      return;
    stars.begin[i] = base + lists.offsets[q];
    stars.kind[i] = findStar(candidates, others, scratch[thread].cell,
                             stars.nodes.data() + stars.begin[i], stars.count[i]);
    for (std::size_t c = 0; c < stars.nearest[i].size(); ++c)
      stars.nearest[i][c] = c < candidates.size() ? candidates[c].node : -1;
  });
}

/// Asks for more neighbours of the points that want them. Returns how many points these were.
Index searchForMore(const Positions& points, const NeighborSearch& search, int threads,
                    std::vector<Scratch>& scratch, const internal::FractionReport& report,
                    Stars& stars) {
  const int most =
      static_cast<int>(std::min(static_cast<std::size_t>(kMaxCandidates), stars.size() - 1));
  int count = 0;
  for (const StarKind& kind : stars.kind)
    count = std::max(count, static_cast<int>(kind.candidates));
  count = std::max(count, kTangentNeighbors / 2);
  std::vector<Index> open;
  Index searched = 0;
  while (count < most) {
    count = std::min(2 * count, most);
    open.clear();
    for (std::size_t i = 0; i < stars.size(); ++i)
      if (stars.kind[i].wants_more)
        open.push_back(static_cast<Index>(i));
    if (open.empty())
      break;
    searched = std::max(searched, static_cast<Index>(open.size()));
    const NeighborLists lists = search(open, count);
    internal::checkIndices("buildNeighborGraph: the answer of the search", lists, open.size(),
                           stars.size());
    findStars(points, open, lists, threads, scratch, {}, stars);
    internal::reportFraction(report, static_cast<double>(count) / most);
  }
  return searched;
}

/// The graph of the pairs whose stars agree.
Graph agreedEdges(const Positions& points, const Stars& stars, int threads,
                  const internal::FractionReport& report) {
  const std::size_t n = stars.size();
  Graph graph;
  graph.offsets.assign(n + 1, 0);
  std::vector<char> agreed(stars.nodes.size());  // not bool: written by several threads
  internal::forEachItem(n, threads, report, [&](std::size_t, std::size_t i) {
    for (std::size_t e = stars.begin[i]; e < stars.endOf(i); ++e)
      if (stars.holds(stars.nodes[e], static_cast<Index>(i))) {
        agreed[e] = 1;
        ++graph.offsets[i + 1];
      }
  });
  for (std::size_t i = 0; i < n; ++i)
    graph.offsets[i + 1] += graph.offsets[i];
  graph.neighbors.resize(graph.offsets[n]);
  graph.lengths.resize(graph.offsets[n]);
  internal::forEachItem(n, threads, report, [&](std::size_t, std::size_t i) {
    std::size_t entry = graph.offsets[i];
    for (std::size_t e = stars.begin[i]; e < stars.endOf(i); ++e) {
      if (agreed[e] == 0)
        continue;
      graph.neighbors[entry] = stars.nodes[e];
      graph.lengths[entry] = internal::edgeLength(points, static_cast<Index>(i), stars.nodes[e]);
      ++entry;
    }
  });
  return graph;
}

/// For each point whether it is in the star of one of the given ones.
std::vector<char> inStarsOf(const std::vector<char>& given, const Stars& stars) {
  std::vector<char> result(stars.size(), 0);
  for (std::size_t i = 0; i < stars.size(); ++i)
    if (given[i] != 0)
      for (std::size_t e = stars.begin[i]; e < stars.endOf(i); ++e)
        result[static_cast<std::size_t>(stars.nodes[e])] = 1;
  return result;
}

Bridge edgeBetween(const Positions& points, Index i, Index j) {
  return {std::min(i, j), std::max(i, j), internal::edgeLength(points, i, j)};
}

/// Joins points without a tangent plane that only one of them finds near: their neighbourhood is
/// the same from both ends, but for the ends of the lists.
void joinWithoutPlane(const Positions& points, const Stars& stars,
                      const std::vector<Index>& without_plane, Graph& graph) {
  std::vector<Bridge> edges;
  for (const Index i : without_plane)
    for (std::size_t e = stars.begin[static_cast<std::size_t>(i)];
         e < stars.endOf(static_cast<std::size_t>(i)); ++e) {
      const Index j = stars.nodes[e];
      if (!stars.kind[static_cast<std::size_t>(j)].tangent_plane && !stars.holds(j, i))
        edges.push_back(edgeBetween(points, i, j));
    }
  if (!edges.empty())
    graph = internal::withEdges(graph, edges);
}

std::vector<Index> pointsOfLowDegree(const Graph& graph) {
  std::vector<Index> result;
  for (std::size_t i = 0; i < graph.size(); ++i)
    if (graph.offsets[i + 1] - graph.offsets[i] < kMinDegree)
      result.push_back(static_cast<Index>(i));
  return result;
}

/// Gives points of low degree their whole star and their nearest neighbours. Returns their number.
Index repairWeak(const Positions& points, const Stars& stars, Graph& graph) {
  const std::vector<Index> weak = pointsOfLowDegree(graph);
  if (weak.empty())
    return 0;
  std::vector<Bridge> edges;
  for (const Index i : weak) {
    const auto row = static_cast<std::size_t>(i);
    for (std::size_t e = stars.begin[row]; e < stars.endOf(row); ++e)
      edges.push_back(edgeBetween(points, i, stars.nodes[e]));
    for (const Index j : stars.nearest[row])
      if (j >= 0)
        edges.push_back(edgeBetween(points, i, j));
  }
  graph = internal::withEdges(graph, edges);

  // Lists of fewer than three points leave some behind.
  const std::vector<Index> poor = pointsOfLowDegree(graph);
  if (poor.empty())
    return static_cast<Index>(weak.size());
  edges.clear();
  const internal::ComponentTree tree(points);
  std::vector<Index> found;
  for (const Index i : poor) {
    found.clear();
    while (found.size() < kMinDegree) {
      internal::ComponentTree::Pair pair;
      tree.nearestExcept(i, found, pair);
      if (pair.from < 0)
        break;  // all points are found
      found.push_back(pair.from == i ? pair.to : pair.from);
      edges.push_back(edgeBetween(points, i, found.back()));
    }
  }
  graph = internal::withEdges(graph, edges);
  return static_cast<Index>(weak.size());
}

/// Joins the components by edges of stars that found no agreement, the shortest first, and what is
/// left by the closest pairs.
std::vector<Bridge> joinParts(const Positions& points, const Stars& stars,
                              const std::vector<Index>& part, internal::UnionFind& parts) {
  std::vector<Bridge> edges;
  for (std::size_t i = 0; i < stars.size(); ++i)
    for (std::size_t e = stars.begin[i]; e < stars.endOf(i); ++e)
      if (part[i] != part[static_cast<std::size_t>(stars.nodes[e])])
        edges.push_back(edgeBetween(points, static_cast<Index>(i), stars.nodes[e]));
  std::sort(edges.begin(), edges.end(), [](const Bridge& a, const Bridge& b) {
    return std::tuple(a.length, a.from, a.to) < std::tuple(b.length, b.from, b.to);
  });
  std::vector<Bridge> bridges;
  for (const Bridge& edge : edges)
    if (parts.unite(edge.from, edge.to))
      bridges.push_back(edge);
  const auto append = [&](const std::vector<Bridge>& more) {
    bridges.insert(bridges.end(), more.begin(), more.end());
  };
  append(internal::furtherBridges(points, part, bridges, kBridgesPerJoint - 1));
  append(internal::shortestBridges(points, parts, kBridgesPerJoint));
  return bridges;
}

/// Joins components, and ties each part that only one node joins to the others: it would collapse.
/// Of parts in a chain only the ends: needles have such chains, and gained nothing from more
/// rounds.
void connect(const Positions& points, const Stars& stars, const internal::FractionReport& report,
             NeighborGraph& result) {
  internal::UnionFind parts = internal::connectedComponents(result.graph);
  const std::vector<Index> part = internal::representatives(parts, stars.size());
  result.report.components = internal::countSets(part);
  internal::reportFraction(report, 0.0);
  if (result.report.components > 1) {
    result.report.bridges = joinParts(points, stars, part, parts);
    result.graph = internal::withEdges(result.graph, result.report.bridges);
  }
  const std::vector<Bridge> bridges =
      internal::danglingBridges(points, result.graph, kBridgesPerJoint - 1);
  if (bridges.empty())
    return;
  result.graph = internal::withEdges(result.graph, bridges);
  result.report.bridges.insert(result.report.bridges.end(), bridges.begin(), bridges.end());
}

/// The stars of all points; what is wrong with them is added to the report.
Stars starsOf(const Positions& points, const NeighborLists& lists, const NeighborSearch& search,
              int threads, const internal::FractionReport& progress, GraphReport& report) {
  std::vector<Scratch> scratch(static_cast<std::size_t>(threads));
  Stars stars(static_cast<std::size_t>(points.cols()));
  findStars(points, {}, lists, threads, scratch, progress, stars);
  if (search)
    report.searched_again = searchForMore(points, search, threads, scratch, progress, stars);
  for (std::size_t i = 0; i < stars.size(); ++i) {
    if (!stars.kind[i].tangent_plane)
      report.without_tangent_plane.push_back(static_cast<Index>(i));
    else if (!stars.kind[i].certified)
      ++report.uncertified;
  }
  return stars;
}

}  // namespace

namespace internal {

NeighborGraph buildLocalDelaunayGraph(const Positions& points, const NeighborLists& lists,
                                      const NeighborSearch& search, const Execution& execution) {
  const auto n = static_cast<std::size_t>(points.cols());
  const int threads = threadCount(execution.threads, n, kParallelThreshold);
  NeighborGraph result;
  if (n == 0)
    return result;

  const FractionReport report = reportOf(execution, "graph");
  const Stars stars = starsOf(points, lists, search, threads, report, result.report);
  result.graph = agreedEdges(points, stars, threads, report);
  result.report.stray_points =
      strayPoints(points, result.graph,
                  [&](const std::vector<char>& given) { return inStarsOf(given, stars); });
  joinWithoutPlane(points, stars, result.report.without_tangent_plane, result.graph);
  result.report.weak = repairWeak(points, stars, result.graph);
  connect(points, stars, report, result);
  return result;
}

AgreedGraph agreedGraph(const Positions& points, const NeighborLists& lists,
                        const NeighborSearch& search, const Execution& execution) {
  const int threads =
      threadCount(execution.threads, static_cast<std::size_t>(points.cols()), kParallelThreshold);
  const FractionReport report = reportOf(execution, "graph");
  GraphReport unused;
  const auto stars =
      std::make_shared<const Stars>(starsOf(points, lists, search, threads, report, unused));
  return {agreedEdges(points, *stars, threads, report),
          [stars](const std::vector<char>& given) { return inStarsOf(given, *stars); }};
}

}  // namespace internal
}  // namespace spherical_param
