#pragma once

#include "graph.h"
#include "neighbor_search.h"
#include "spherical_param/execution.h"
#include "spherical_param/options.h"
#include "tangent_stars.h"

#include <vector>

namespace spherical_param::internal {

/// Marks the outliers of a cloud.
///
/// OutlierMode::Auto: stray points, \see strayPoints, and isolated points near a surface. Points
/// within one spacing of a surface (perhaps noise) or of the boundary loop of an opening (perhaps
/// more of the surface) stay.
///
/// OutlierMode::Deviation: points too far from the average of their neighbours (Zwicker and Gotsman
/// 2004, section 4.2), \see deviatingPoints, and stray points beyond the same threshold.
///
/// \param points    3 x n, the nodes.
/// \param neighbors of the nodes, with their search.
/// \param stars     of the nodes.
/// \param stray     the stray points.
/// \return n entries, not 0 for an outlier; the same for any number of threads.
/// Cost: O(n), and that of a search and a fit for each point that is not in the plane of its star.
Indexed<char> markOutliers(OutlierMode mode, double sigma, const Positions& points,
                           const Neighbors& neighbors, const Stars& stars,
                           const std::vector<StrayPoint>& stray, const Execution& execution);

/// Points that are off the surface of their neighbours.
struct DeviatingPoints {
  std::vector<Index> indices;  ///< ascending
  /// n entries: score of each point; of an outlier, in the round in which it was found.
  std::vector<double> scores;
  double threshold = 0.0;  ///< only outliers are above it
};

/// Finds points that are too far from the average of their neighbours, by
///
///   score_i = |n_i . (p_i - c_i)| / M_i,
///
/// with the median M_i of the mean distances that the k = 16 nearest neighbours have to their own,
/// the centroid c_i of the neighbours, and the normal n_i of their plane of least squares.
/// Neighbours with mean distances above 2 M_i do not count for centroid and plane: they may be
/// outliers too. Outliers are points with
///
///   score_i > max(mean + sigma * standard deviation, 1),
///
/// mean and deviation over all points, with scores above 1 counted as 1, so that far outliers do
/// not hide nearer ones. Points of a surface hardly reach 1, even at sharp corners. Outliers are
/// removed from the neighbour lists, and the search is repeated until it finds hardly any more: a
/// group of outliers dissolves from its boundary.
///
/// Why not |p_i - c_i|: on an unevenly sampled surface, a point at the edge of a dense region is
/// far from the centroid, but along the surface. The scale comes from the distances of the
/// neighbours because those of an outlier itself are long.
///
/// \param points 3 x n, finite, distinct.
/// \param lists  n neighbour lists, the nearest of each point; unsorted, longer or shorter than k,
///               with or without the point itself. Entries beyond the k nearest replace outliers.
///               A list of fewer than three others gives score 0.
/// \return the same, bit by bit, for any number of threads.
/// Cost: O(n k log k) per round, a few rounds.
///
/// No guarantees: a group as dense as the surface, or larger than k, is a surface of its own; an
/// outlier beyond the tip of a thin limb may be in the plane of its neighbours; where the spacing
/// jumps tenfold, points at the jump may be taken for outliers.
DeviatingPoints deviatingPoints(const Positions& points, const NeighborLists& lists, double sigma,
                                const Execution& execution);

}  // namespace spherical_param::internal
