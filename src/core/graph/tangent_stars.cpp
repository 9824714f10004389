#include "tangent_stars.h"

#include "progress.h"
#include "union_find.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Voronoi edges shorter than this fraction of the cell's radius do not count: opposite points of
/// four on a circle are no neighbours, whatever the rounding.
constexpr double kTie = 1e-9;

/// Nearest neighbours that span the tangent plane; more are taken if these are on a line.
constexpr Index kTangentNeighbors = 10;
/// Maximum number of nearest neighbours that are searched for and used. Fewer are not enough for
/// scan lines; more take longer.
constexpr Index kMaxCandidates = 32;

/// Voronoi cell of the origin in the plane: a convex polygon that is cut by bisectors.
class VoronoiCell {
public:
  static constexpr Index kBox = -1;

  /// Begins with a square in place of the unbounded cell.
  void reset(double half_size) {
    corners_ = {{{half_size, half_size}, kBox},
                {{-half_size, half_size}, kBox},
                {{-half_size, -half_size}, kBox},
                {{half_size, -half_size}, kBox}};
    squared_radius_ = 2.0 * half_size * half_size;
  }

  /// Cuts off what is nearer to `place` than to the origin.
  void cut(const Eigen::Vector2d& place, Index site) {
    const double half_square = 0.5 * place.squaredNorm();
    const double tolerance = kTie * half_square;
    const std::size_t count = corners_.size();
    sides_.resize(count);
    bool cuts = false;
    for (std::size_t k = 0; k < count; ++k) {
      sides_[k] = corners_[k].place.dot(place) - half_square;
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
      // The new edge begins where the polygon leaves the half plane, and ends on an old edge.
      const std::size_t inner = inside ? k : next;
      const std::size_t outer = inside ? next : k;
      const double fraction =
          sides_[inner] < 0.0 ? sides_[inner] / (sides_[inner] - sides_[outer]) : 0.0;
      const Eigen::Vector2d& from = corners_[inner].place;
      cut_.push_back(
          {from + fraction * (corners_[outer].place - from), inside ? site : corners_[k].site});
    }
    corners_.swap(cut_);
    squared_radius_ = 0.0;
    for (const Corner& corner : corners_)
      squared_radius_ = std::max(squared_radius_, corner.place.squaredNorm());
  }

  double squaredRadius() const { return squared_radius_; }

  bool isBounded() const {
    return std::none_of(corners_.begin(), corners_.end(),
                        [](const Corner& corner) { return corner.site == kBox; });
  }

  /// Calls found(site) for each edge that is longer than rounding.
  template <typename Found>
  void forEachSite(const Found& found) const {
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Corner& begin = corners_[k];
      const Corner& end = corners_[k + 1 < corners_.size() ? k + 1 : 0];
      if (begin.site != kBox &&
          (end.place - begin.place).squaredNorm() > kTie * kTie * squared_radius_)
        found(begin.site);
    }
  }

private:
  struct Corner {
    Eigen::Vector2d place;
    Index site;  ///< the edge to the next corner is on its bisector
  };

  std::vector<Corner> corners_;  ///< counter-clockwise
  std::vector<Corner> cut_;
  std::vector<double> sides_;  ///< of each corner: positive beyond the bisector
  double squared_radius_ = 0.0;
};

/// Finds the axes of the `count` nearest candidates about their centroid, by ascending variance,
/// the height of the origin, and whether they span a reliable plane.
void findTangentPlane(const std::vector<NearPoint>& candidates, std::size_t count,
                      Eigen::Matrix3d& axes, bool& is_line, Star& star) {
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
  // Maximum ratio of the smallest to the middle variance: beyond, all directions are alike. It is
  // high because stars in a poor plane are better than Gabriel neighbours.
  constexpr double max_plane_roundness = 0.9;
  // Minimum ratio of the middle to the largest variance: below, the neighbourhood is a line.
  constexpr double min_width_ratio = 0.01;
  is_line = !(variances[1] > min_width_ratio * variances[2]);
  star.tangent_plane = !is_line && variances[0] <= max_plane_roundness * variances[1];
  constexpr double max_height = 1e9;  // far below the greatest float
  star.height = static_cast<float>(std::min(
      std::abs(axes.col(0).dot(centroid)) / std::sqrt(variances[1] / static_cast<double>(count)),
      max_height));
}

/// Writes the neighbours in the graph of Gabriel and Sokal (1969): no other point is in the ball on
/// the edge as diameter. It needs no plane and is symmetric, and the nearest points alone decide.
void findGabrielNeighbors(const std::vector<NearPoint>& candidates, Index* star, Index& count) {
  for (const NearPoint& candidate : candidates) {
    const bool blocked =
        std::any_of(candidates.begin(), candidates.end(), [&](const NearPoint& other) {
          return other.point != candidate.point &&
                 other.squared_distance <= (1.0 + kTie) * other.offset.dot(candidate.offset);
        });
    if (!blocked)
      star[count++] = candidate.point;
  }
}

/// Writes the Voronoi neighbours in the tangent plane. Returns whether they are certified.
bool findVoronoiNeighbors(const std::vector<NearPoint>& candidates, const Eigen::Matrix3d& axes,
                          VoronoiCell& cell, Index* star, Index& count) {
  const double squared_reach = candidates.back().squared_distance;
  // Larger cells end at the reach: sites beyond would be neighbours across a gap.
  cell.reset(std::sqrt(squared_reach));
  // Candidates steeper than this over the tangent plane are on another sheet [sine].
  constexpr double max_candidate_slope = 0.85;
  const double min_fraction = 1.0 - max_candidate_slope * max_candidate_slope;  // squared cosine
  for (const NearPoint& candidate : candidates) {
    if (candidate.squared_distance > 4.0 * cell.squaredRadius())
      break;
    const Eigen::Vector2d place(axes.col(1).dot(candidate.offset),
                                axes.col(2).dot(candidate.offset));
    const double fraction = place.squaredNorm() / candidate.squared_distance;
    if (fraction >= min_fraction)
      cell.cut(1.0 / std::sqrt(fraction) * place, candidate.point);
  }
  cell.forEachSite([&](Index site) {
    // Rounding at corners may leave two edges of one site.
    if (std::find(star, star + count, site) == star + count)
      star[count++] = site;
  });
  return cell.isBounded() && 4.0 * cell.squaredRadius() <= squared_reach;
}

/// Writes the star of the point whose sorted candidates are given, ascending.
///
/// \param others number of other points there are
/// \param nodes  of the star
void findStar(const std::vector<NearPoint>& candidates, std::size_t others, VoronoiCell& cell,
              Index* nodes, Star& star) {
  star.candidates = static_cast<Index>(candidates.size());
  star.count = 0;
  star.tangent_plane = false;
  const bool complete = candidates.size() >= others;
  Eigen::Matrix3d axes;
  bool is_line = true;  // also if there are too few points
  // If the nearest points are on one scan line, more of them may reach the next.
  const std::size_t all = candidates.size() < kTangentNeighbors ? 0 : candidates.size();
  for (std::size_t span = 0; is_line && span < all;) {
    span = std::min(std::max(2 * span, std::size_t{kTangentNeighbors}), all);
    findTangentPlane(candidates, span, axes, is_line, star);
  }
  bool certified = !is_line;
  if (star.tangent_plane)
    certified = findVoronoiNeighbors(candidates, axes, cell, nodes, star.count);
  else
    findGabrielNeighbors(candidates, nodes, star.count);
  star.wants_more = !certified && !complete;
  std::sort(nodes, nodes + star.count);
}

/// Finds the stars of some nodes from their lists. A list that is not longer than the node's last
/// one changes nothing.
void findStarsOf(const Indexed<Index>& nodes, const Positions& points, const NeighborLists& lists,
                 int threads, const FractionReport& report, Stars& stars) {
  const std::size_t base = stars.nodes.size();
  stars.nodes.resize(base + lists.indices.size());
  reportFraction(report, 0.0);
  forEachIndex<VoronoiCell>(lists.size(), threads, report, [&](VoronoiCell& cell, Index list) {
    const Index i = nodes[list];
    const std::vector<NearPoint> candidates =
        nearestOthers(points, i, listOf(lists, list), kMaxCandidates);
    Star& star = stars.of_node[i];
    if (static_cast<Index>(candidates.size()) <= star.candidates)
      return;
    star.begin = base + lists.offsets[static_cast<std::size_t>(list)];
    findStar(candidates, stars.size() - 1, cell, stars.nodes.data() + star.begin, star);
  });
}

/// Searches for more neighbours of uncertified points.
void searchForMore(const Positions& points, const NeighborSearch& search, int threads,
                   const FractionReport& report, Stars& stars) {
  const Index most = std::min(kMaxCandidates, static_cast<Index>(stars.size()) - 1);
  Index count = kTangentNeighbors / 2;
  for (const Star& star : stars.of_node)
    count = std::max(count, star.candidates);
  while (count < most) {
    count = std::min(2 * count, most);
    Indexed<Index> open;
    for (const Index i : indicesOf(stars))
      if (stars[i].wants_more)
        open.push_back(i);
    if (open.empty())
      break;
    findStarsOf(open, points, search(open, count), threads, {}, stars);
    reportFraction(report, static_cast<double>(count) / most);
  }
}

/// Normal of the plane through a point that most of its neighbours are near; 0 if there is none.
/// Beside another sheet, the plane of the nearest points lies across both; this one is that of the
/// point's own sheet.
Eigen::Vector3d sheetNormal(const std::vector<NearPoint>& candidates) {
  // Candidates are planes through two of the nearest points, at a minimum angle [sine].
  constexpr std::size_t max_spanning = 8;
  constexpr double min_angle = 0.4;
  constexpr std::size_t max_voters = 20;
  // From this slope on a neighbour has no vote [sine].
  constexpr double max_slope = 0.25;
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t k = 0; k < std::min(max_voters, candidates.size()); ++k)
    directions.push_back(candidates[k].offset / std::sqrt(candidates[k].squared_distance));
  const auto vote = [&](const Eigen::Vector3d& direction, const Eigen::Vector3d& normal) {
    const double slope = direction.dot(normal) / max_slope;
    return std::max(1.0 - slope * slope, 0.0);
  };
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double max_votes = 0.0;
  for (std::size_t a = 0; a < std::min(max_spanning, directions.size()); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const Eigen::Vector3d normal = directions[a].cross(directions[b]);
      const double sine = normal.norm();
      double votes = 0.0;
      for (std::size_t k = 0; k < directions.size() && sine >= min_angle; ++k)
        votes += vote(directions[k], normal / sine);
      if (votes > max_votes) {
        max_votes = votes;
        best = normal / sine;
      }
    }
  // Fits the plane to the neighbours near it, twice.
  for (int round = 0; round < 2 && max_votes > 0.0; ++round) {
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& direction : directions)
      moments += vote(direction, best) * direction * direction.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(moments);
    best = solver.eigenvectors().col(0);
  }
  return best;
}

/// Whether a candidate of point i is on another sheet: the planes of both are parallel, and apart.
bool isOnOtherSheet(const Positions& normals, Index i, const NearPoint& candidate) {
  constexpr double min_cosine = 0.9;
  constexpr double min_slope = 0.4;  // [sine]
  const Eigen::Vector3d normal = normals.col(i);
  const Eigen::Vector3d other = normals.col(candidate.point);
  const double height =
      std::min(std::abs(normal.dot(candidate.offset)), std::abs(other.dot(candidate.offset)));
  return height > min_slope * std::sqrt(candidate.squared_distance) &&
         std::abs(normal.dot(other)) > min_cosine;
}

/// For each node the number of edges that both stars have, minus those that only its own has.
Indexed<double> agreementOf(const Stars& stars, int threads) {
  Indexed<double> agreement(stars.size());
  forEachIndex(stars.size(), threads, {}, [&](Index i) {
    for (const Index j : stars.of(i))
      agreement[i] += stars.of(j).contains(i) ? 1.0 : -1.0;
  });
  return agreement;
}

/// The mean of values at a node and its neighbours, twice. Fast if most values are 0.
Indexed<double> meanAround(const Stars& stars, Indexed<double> values) {
  for (int ring = 0; ring < 2; ++ring) {
    const Indexed<double> before = values;
    for (const Index i : indicesOf(stars))
      if (before[i] != 0.0)
        for (const Index j : stars.of(i))
          values[j] += before[i];
    for (const Index i : indicesOf(stars))
      values[i] /= 1.0 + stars[i].count;
  }
  return values;
}

/// Minimum number of points of an area.
constexpr std::size_t kMinArea = 20;

/// The nodes with values above a bound, in connected areas of at least `min_nodes` nodes.
std::vector<Index> largeAreas(const Stars& stars, const Indexed<double>& values, double bound,
                              std::size_t min_nodes = kMinArea) {
  UnionFind areas(stars.size());
  for (const Index i : indicesOf(stars))
    if (values[i] > bound)
      for (const Index j : stars.of(i))
        if (values[j] > bound)
          areas.unite(i, j);
  const Partition partition(areas);
  std::vector<Index> nodes;
  for (const Index i : indicesOf(stars))
    if (values[i] > bound && partition.sizes[partition.of[i]] >= min_nodes)
      nodes.push_back(i);
  return nodes;
}

/// Appends the nodes within some rings around the given ones: those in their lists that meet a
/// condition, then those in the lists of these, and so on.
template <typename Condition>
void appendAround(const NeighborLists& lists, int rings, const Condition& meets,
                  std::vector<Index>& nodes) {
  Indexed<char> is_reached(lists.size(), 0);
  for (const Index i : nodes)
    is_reached[i] = 1;
  std::size_t done = 0;
  for (int ring = 0; ring < rings && done < nodes.size(); ++ring)
    for (const std::size_t ring_end = nodes.size(); done < ring_end; ++done)
      for (const Index j : listOf(lists, nodes[done]))
        if (is_reached[j] == 0 && meets(j)) {
          is_reached[j] = 1;
          nodes.push_back(j);
        }
}

/// Stars without the candidates on other sheets.
struct SheetStars {
  Stars stars;
  Indexed<char> is_changed;  ///< a candidate was left out
  /// Of the points around each node, the fraction with a nearest point on another sheet.
  Indexed<double> fraction_beside;
};

/// Finds the stars of an area without the candidates on other sheets.
///
/// \param normals of the sheets; zero ones in the area are found.
SheetStars findSheetStars(const Positions& points, const Stars& stars, const Indexed<Index>& area,
                          const NeighborSearch& search, int threads, Positions& normals) {
  const NeighborLists lists =
      search(area, std::min(kMaxCandidates, static_cast<Index>(stars.size()) - 1));
  const auto candidates_of = [&](Index list) {
    return nearestOthers(points, area[list], listOf(lists, list), kMaxCandidates);
  };
  forEachIndex(lists.size(), threads, {}, [&](Index list) {
    if (normals.col(area[list]).isZero(0.0))
      normals.col(area[list]) = sheetNormal(candidates_of(list));
  });
  SheetStars result{stars, Indexed<char>(stars.size(), 0), Indexed<double>(stars.size(), 0.0)};
  const std::size_t base = stars.nodes.size();
  result.stars.nodes.resize(base + lists.indices.size());
  forEachIndex<VoronoiCell>(lists.size(), threads, {}, [&](VoronoiCell& cell, Index list) {
    const Index i = area[list];
    std::vector<NearPoint> candidates = candidates_of(list);
    const auto is_on_other = [&](const NearPoint& candidate) {
      return isOnOtherSheet(normals, i, candidate);
    };
    const auto first =
        std::find_if(candidates.begin(), candidates.end(), is_on_other) - candidates.begin();
    if (first == static_cast<std::ptrdiff_t>(candidates.size()))
      return;
    candidates.erase(std::remove_if(candidates.begin(), candidates.end(), is_on_other),
                     candidates.end());
    result.is_changed[i] = 1;
    result.fraction_beside[i] = first < kTangentNeighbors ? 1.0 : 0.0;
    Star& star = result.stars.of_node[i];
    star.begin = base + lists.offsets[static_cast<std::size_t>(list)];
    findStar(candidates, stars.size() - 1, cell, result.stars.nodes.data() + star.begin, star);
  });
  result.fraction_beside = meanAround(stars, std::move(result.fraction_beside));
  return result;
}

/// Separates sheets that are nearer to each other than two spacings, where ten neighbours span a
/// plane across both. Where the stars of an area disagree, finds them without the candidates on
/// other sheets. If they agree more then, the area grows, as long as they do.
void separateSheets(const Positions& points, const Neighbors& neighbors, int threads,
                    Stars& stars) {
  // Means over an area: edges of a star that the other star does not have, and the gain in edges
  // that both have. Larger bounds do not separate walls of nearly two spacings.
  constexpr double max_one_sided = 0.3;
  constexpr double min_gain = 0.3;
  // With fewer points beside another sheet, as on creases, a gain is chance.
  constexpr double min_fraction_beside = 0.5;
  const Indexed<double> agreement = agreementOf(stars, threads);
  Indexed<double> one_sided(stars.size());
  for (const Index i : indicesOf(stars))
    one_sided[i] = 0.5 * (stars[i].count - agreement[i]);
  std::vector<Index> area =
      largeAreas(stars, meanAround(stars, std::move(one_sided)), max_one_sided);
  if (area.empty())
    return;
  Positions normals = Positions::Zero(3, points.cols());
  SheetStars sheets;
  std::vector<Index> taken;
  for (int rings = 2;; rings *= 2) {
    appendAround(
        neighbors.lists, rings, [](Index) { return true; }, area);
    sheets = findSheetStars(points, stars, Indexed<Index>(area.begin(), area.end()),
                            neighbors.search, threads, normals);
    Indexed<double> gain = agreementOf(sheets.stars, threads);
    for (const Index i : indicesOf(stars))
      gain[i] -= agreement[i];
    gain = meanAround(stars, std::move(gain));
    Indexed<double> gain_beside = gain;
    for (const Index i : indicesOf(stars))
      if (sheets.fraction_beside[i] <= min_fraction_beside)
        gain_beside[i] = 0.0;
    const std::size_t before = taken.size();
    // Once there is a large area, small ones count, too.
    taken = largeAreas(stars, gain_beside, min_gain, before == 0 ? kMinArea : 1);
    appendAround(
        neighbors.lists, std::numeric_limits<int>::max(),
        [&](Index i) { return sheets.is_changed[i] != 0 && gain[i] >= 0.0; }, taken);
    if (taken.size() <= before)
      break;
    area = taken;
  }
  stars.nodes = std::move(sheets.stars.nodes);
  for (const Index i : taken)
    stars.of_node[i] = sheets.stars.of_node[i];
}

}  // namespace

Stars findStars(const Positions& points, const Neighbors& neighbors, const Execution& execution) {
  Stars stars;
  stars.of_node.resize(columnCount(points));
  if (stars.size() == 0)
    return stars;
  const int threads = threadCount(execution.threads, stars.size());
  const FractionReport report = reportOf(execution, "graph");
  findStarsOf(firstIndices(stars.size()), points, neighbors.lists, threads, report, stars);
  if (neighbors.search) {
    searchForMore(points, neighbors.search, threads, report, stars);
    separateSheets(points, neighbors, threads, stars);
  }
  return stars;
}

double oneSidedFraction(const Stars& stars, int threads, const FractionReport& report) {
  // The numbers of all entries, and of one-sided ones.
  const Eigen::Array2d sums = accumulate(
      stars.size(), threadCount(threads, stars.size()), Eigen::Array2d(Eigen::Array2d::Zero()),
      [&](Index i, Eigen::Array2d& sum) {
        for (const Index j : stars.of(i))
          sum += Eigen::Array2d(1.0, stars.of(j).contains(i) ? 0.0 : 1.0);
      },
      report);
  return sums[0] > 0.0 ? sums[1] / sums[0] : 0.0;
}

}  // namespace spherical_param::internal
