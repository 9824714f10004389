#include "tangent_stars.h"

#include "parallel.h"
#include "power_of_two.h"
#include "progress.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <utility>

namespace spherical_param::internal {
namespace {

// The experiments are on 13 models and 13 shapes of up to 60,000 points, on 25 awkward clouds (few
// points, lines of a scanner, tubes, parts, volumes) and on 35 open, partial and raw scans.

/// Voronoi edges shorter than this part of the cell's radius count as none: of four points on a
/// circle, those across from each other are no neighbours, whatever the round-off. With 0 the graph
/// of the fandisk, which has such points, depends on it; a view of it has 701 self-intersections
/// instead of 596 then.
constexpr double kTie = 1e-9;

/// Largest ratio of the smallest to the middle variance of a neighbourhood with a tangent plane:
/// above, all directions are alike. Stars are better than what takes their place for as long as
/// there is any plane at all. With 0.5 a model has 6 self-intersections, without a bound 2.
constexpr double kMaxPlaneRoundness = 0.9;
/// Least ratio of the middle to the largest variance: below, the neighbourhood is a line. Without,
/// a sphere scanned in lines has 27 self-intersections instead of 3.
constexpr double kMinWidthRatio = 0.01;

/// Nearest neighbours that span the tangent plane; more where these are on a line. With 6 the
/// awkward clouds have 111,926 self-intersections instead of 61,815, with 12 a model has 799
/// instead of 0.
constexpr int kTangentNeighbors = 10;
/// Candidates steeper than this to the tangent plane are on another sheet [sine of the angle]. With
/// 1 a model has 2 self-intersections, with 0.7 two have 2 and 412.
constexpr double kMaxCandidateSlope = 0.85;
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
    const PowerOfTwo scaled(-std::ilogb(extent));
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
  return !is_line && variances[0] <= kMaxPlaneRoundness * variances[1];
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
      const bool certified =
          findVoronoiNeighbors(candidates, axes, kMaxCandidateSlope, cell, star, count);
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
               const FractionReport& report, Stars& stars) {
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
  reportFraction(report, 0.0);
  forEachItem(lists.size(), threads, report, [&](std::size_t thread, std::size_t q) {
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

/// Asks for more neighbours of the points that want them.
void searchForMore(const Positions& points, const NeighborSearch& search, int threads,
                   std::vector<Scratch>& scratch, const FractionReport& report, Stars& stars) {
  const int most =
      static_cast<int>(std::min(static_cast<std::size_t>(kMaxCandidates), stars.size() - 1));
  int count = 0;
  for (const StarKind& kind : stars.kind)
    count = std::max(count, static_cast<int>(kind.candidates));
  count = std::max(count, kTangentNeighbors / 2);
  std::vector<Index> open;
  while (count < most) {
    count = std::min(2 * count, most);
    open.clear();
    for (std::size_t i = 0; i < stars.size(); ++i)
      if (stars.kind[i].wants_more)
        open.push_back(static_cast<Index>(i));
    if (open.empty())
      break;
    const NeighborLists lists = search(open, count);
    checkLists(lists, open.size(), stars.size());
    findStars(points, open, lists, threads, scratch, {}, stars);
    for (const Index i : open)
      stars.kind[static_cast<std::size_t>(i)].is_beyond_list = true;
    reportFraction(report, static_cast<double>(count) / most);
  }
}

/// Finds the stars of the nodes in `subset` (empty: of all) from lists in its order, then from more
/// neighbours where they want them.
void findAll(const Positions& points, const std::vector<Index>& subset, const NeighborLists& lists,
             const NeighborSearch& search, const Execution& execution, Stars& stars) {
  const int threads = threadCount(execution.threads, stars.size());
  const FractionReport report = reportOf(execution, "graph");
  std::vector<Scratch> scratch(static_cast<std::size_t>(threads));
  findStars(points, subset, lists, threads, scratch, report, stars);
  if (search)
    searchForMore(points, search, threads, scratch, report, stars);
}

}  // namespace

bool Stars::holds(Index i, Index j) const {
  const auto first =
      nodes.begin() + static_cast<std::ptrdiff_t>(begin[static_cast<std::size_t>(i)]);
  const auto last = first + count[static_cast<std::size_t>(i)];
  return std::find(first, last, j) != last;
}

std::vector<char> Stars::inStarsOf(const std::vector<char>& given) const {
  std::vector<char> result(size(), 0);
  for (std::size_t i = 0; i < size(); ++i)
    if (given[i] != 0)
      for (std::size_t e = begin[i]; e < endOf(i); ++e)
        result[static_cast<std::size_t>(nodes[e])] = 1;
  return result;
}

Stars findStars(const Positions& points, const Neighbors& neighbors, const Execution& execution) {
  Stars stars(static_cast<std::size_t>(points.cols()));
  if (stars.size() > 0)
    findAll(points, {}, neighbors.lists, neighbors.search, execution, stars);
  return stars;
}

Stars findStars(const Positions& points, const Neighbors& neighbors, const Stars& all,
                const NodeSubset& subset, const Execution& execution) {
  Stars stars(static_cast<std::size_t>(points.cols()));
  const auto renumbered = [&](Index node) {
    return node < 0 ? node : subset.new_of_old[static_cast<std::size_t>(node)];
  };
  std::vector<Index> changed;
  NeighborLists lists;
  for (std::size_t i = 0; i < stars.size(); ++i) {
    const auto old = static_cast<std::size_t>(subset.old_of_new[i]);
    const auto list =
        neighbors.lists.indices.begin() + static_cast<std::ptrdiff_t>(neighbors.lists.offsets[i]);
    const auto end = neighbors.lists.indices.begin() +
                     static_cast<std::ptrdiff_t>(neighbors.lists.offsets[i + 1]);
    // A star of more candidates than its list may have lost one that the list does not show.
    if (subset.has_lost[i] != 0 || all.kind[old].is_beyond_list) {
      changed.push_back(static_cast<Index>(i));
      lists.indices.insert(lists.indices.end(), list, end);
      lists.offsets.push_back(lists.indices.size());
      continue;
    }
    stars.begin[i] = stars.nodes.size();
    stars.count[i] = all.count[old];
    stars.kind[i] = all.kind[old];
    for (std::size_t e = all.begin[old]; e < all.endOf(old); ++e)
      stars.nodes.push_back(renumbered(all.nodes[e]));
    std::sort(stars.nodes.begin() + static_cast<std::ptrdiff_t>(stars.begin[i]), stars.nodes.end());
    std::transform(all.nearest[old].begin(), all.nearest[old].end(), stars.nearest[i].begin(),
                   renumbered);
  }
  if (!changed.empty())
    findAll(points, changed, lists, neighbors.search, execution, stars);
  return stars;
}

}  // namespace spherical_param::internal
