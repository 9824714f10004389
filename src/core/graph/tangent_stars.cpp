#include "tangent_stars.h"

#include "progress.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace spherical_param::internal {
namespace {

// The experiments are on 13 models and 13 shapes of up to 60,000 points, on 25 awkward clouds (few
// points, lines of a scanner, tubes, parts, volumes) and on 35 open, partial and raw scans.

/// Voronoi edges shorter than this part of the cell's radius count as none: of four points on a
/// circle, those across from each other are no neighbours, whatever the round-off. With 0 the graph
/// of the fandisk, which has such points, depends on it; a view of it has 701 self-intersections
/// instead of 596 then.
constexpr double kTie = 1e-9;

/// Nearest neighbours that span the tangent plane; more where these are on a line. With 6 the
/// awkward clouds have 111,926 self-intersections instead of 61,815, with 12 a model has 799
/// instead of 0.
constexpr Index kTangentNeighbors = 10;
/// Nearest neighbours used of a list, and searched for, at most. With 12 or 24 a sphere scanned in
/// lines has some 20,000 self-intersections instead of 3; with 64, 0, but the search takes longer.
constexpr Index kMaxCandidates = 32;

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

/// The nearest candidates of a list, sorted.
void collectCandidates(const Positions& points, Index i, const Row<Index>& list,
                       std::vector<Candidate>& candidates) {
  candidates.clear();
  for (const Index j : list) {
    if (j == i)
      continue;
    const Eigen::Vector3d offset = points.col(j) - points.col(i);
    candidates.push_back({offset.squaredNorm(), j, offset});
  }
  if (!std::is_sorted(candidates.begin(), candidates.end()))
    std::sort(candidates.begin(), candidates.end());
  candidates.erase(
      std::unique(candidates.begin(), candidates.end(),
                  [](const Candidate& a, const Candidate& b) { return a.node == b.node; }),
      candidates.end());
  if (candidates.size() > kMaxCandidates)
    candidates.erase(candidates.begin() + kMaxCandidates, candidates.end());
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
  // Largest ratio of the smallest to the middle variance of a neighbourhood with a tangent plane:
  // above, all directions are alike. Stars are better than what takes their place for as long as
  // there is any plane at all. With 0.5 a model has 6 self-intersections, without a bound 2.
  constexpr double max_plane_roundness = 0.9;
  // Least ratio of the middle to the largest variance: below, the neighbourhood is a line. Without,
  // a sphere scanned in lines has 27 self-intersections instead of 3.
  constexpr double min_width_ratio = 0.01;
  is_line = !(variances[1] > min_width_ratio * variances[2]);
  return !is_line && variances[0] <= max_plane_roundness * variances[1];
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
                          VoronoiCell& cell, Index* star, Index& count) {
  const double squared_reach = candidates.back().squared_distance;
  // A cell that is larger ends there: sites beyond would be neighbours across a gap.
  cell.reset(std::sqrt(squared_reach));
  // Candidates steeper than this to the tangent plane are on another sheet [sine of the angle].
  // With 1 a model has 2 self-intersections, with 0.7 two have 2 and 412.
  constexpr double max_candidate_slope = 0.85;
  // In terms of the cosine.
  const double least_fraction = 1.0 - max_candidate_slope * max_candidate_slope;
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
  Eigen::Matrix3d axes;
  bool is_line = true;  // or too few points, of which more are wanted as well
  // Where the nearest are on a scan line, those of the next ones may be among some more.
  const std::size_t all = candidates.size() < kTangentNeighbors ? 0 : candidates.size();
  for (std::size_t span = 0; is_line && span < all;) {
    span = std::min(std::max(2 * span, std::size_t{kTangentNeighbors}), all);
    kind.tangent_plane = findTangentPlane(candidates, span, axes, is_line);
  }
  if (kind.tangent_plane) {
    const bool certified = findVoronoiNeighbors(candidates, axes, cell, star, count);
    kind.wants_more = !certified && !complete;
  } else {
    kind.wants_more = is_line && !complete;
    findGabrielNeighbors(candidates, star, count);
  }
  std::sort(star, star + count);
  return kind;
}

/// Working memory.
struct Scratch {
  std::vector<Candidate> candidates;
  VoronoiCell cell;
};

/// Finds the stars of some nodes from lists in their order. Lists that are no longer than the one
/// before change nothing.
void findStarsOf(const Indexed<Index>& nodes, const Positions& points, const NeighborLists& lists,
                 int threads, const FractionReport& report, Stars& stars) {
  const std::size_t base = stars.nodes.size();
  stars.nodes.resize(base + lists.indices.size());
  reportFraction(report, 0.0);
  forEachIndex<Scratch>(lists.size(), threads, report, [&](Scratch& scratch, Index list) {
    const Index i = nodes[list];
    std::vector<Candidate>& candidates = scratch.candidates;
    collectCandidates(points, i, listOf(lists, list), candidates);
    if (static_cast<Index>(candidates.size()) <= stars.kind[i].candidates)
      return;
    stars.begin[i] = base + lists.offsets[static_cast<std::size_t>(list)];
    stars.kind[i] = findStar(candidates, stars.size() - 1, scratch.cell,
                             stars.nodes.data() + stars.begin[i], stars.count[i]);
  });
}

/// Asks for more neighbours of the points that want them.
void searchForMore(const Positions& points, const NeighborSearch& search, int threads,
                   const FractionReport& report, Stars& stars) {
  const Index most = std::min(kMaxCandidates, static_cast<Index>(stars.size()) - 1);
  Index count = kTangentNeighbors / 2;
  for (const StarKind& kind : stars.kind)
    count = std::max(count, kind.candidates);
  while (count < most) {
    count = std::min(2 * count, most);
    Indexed<Index> open;
    for (const Index i : indicesOf(stars.kind))
      if (stars.kind[i].wants_more)
        open.push_back(i);
    if (open.empty())
      break;
    findStarsOf(open, points, search(open, count), threads, {}, stars);
    reportFraction(report, static_cast<double>(count) / most);
  }
}

}  // namespace

Stars findStars(const Positions& points, const Neighbors& neighbors, const Execution& execution) {
  Stars stars(static_cast<std::size_t>(points.cols()));
  if (stars.size() == 0)
    return stars;
  const int threads = threadCount(execution.threads, stars.size());
  const FractionReport report = reportOf(execution, "graph");
  Indexed<Index> all(stars.size());
  std::iota(all.begin(), all.end(), Index{0});
  findStarsOf(all, points, neighbors.lists, threads, report, stars);
  if (neighbors.search)
    searchForMore(points, neighbors.search, threads, report, stars);
  return stars;
}

}  // namespace spherical_param::internal
