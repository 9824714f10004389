#pragma once

#include "neighbor_graph.h"
#include "neighbors.h"
#include "spherical_param/options.h"

#include <vector>

namespace spherical_param::internal {

/// Marks the outliers of a cloud.
///
/// OutlierMode::Auto: stray points, \see strayPoints, and single points near a surface but off it,
/// \see nearOutliers. A point as near to a surface as its own are to each other may be noise, and
/// one that far from the rim of an opening continues the surface: both are kept.
///
/// OutlierMode::Deviation: points that are too far from the average of their neighbours (Zwicker
/// and Gotsman 2004, section 4.2), \see deviatingPoints, and the stray points that are farther off
/// than the threshold of the others.
///
/// \param points    3 x n, the nodes.
/// \param neighbors of all nodes; more are searched for.
/// \param stray     the stray points.
/// \return n entries, not 0 for an outlier; the same for any number of threads.
/// Cost: that of a search and a fit for each point.
std::vector<char> markOutliers(OutlierMode mode, double sigma, const Positions& points,
                               const Neighbors& neighbors, const std::vector<StrayPoint>& stray,
                               const Execution& execution);

/// Points that are off the surface of their neighbours.
struct DeviatingPoints {
  std::vector<Index> indices;  ///< ascending
  /// n entries: how far each point is off the surface of its neighbours, relative to the mean
  /// distances there; that of an outlier as of the round in which it was found.
  std::vector<double> scores;
  double threshold = 0.0;  ///< no point but the outliers is above it
};

/// Finds points that are too far from the average of their neighbours. What is compared is
///
///   score_i = |n_i . (p_i - c_i)| / M_i,
///
/// with the median M_i of the mean distances that the k = 16 nearest neighbours have to their own,
/// the centroid c_i of the neighbours, and the normal n_i of their plane of least squares.
/// Neighbours with mean distances above 2 M_i have no say in centroid and plane: they may be
/// outliers too. Outliers are points with
///
///   score_i > max(mean + sigma * standard deviation, 1),
///
/// mean and deviation over all points, with scores above 1 counted as 1, so that a few far outliers
/// do not hide the nearer ones. Points of a surface, even those at sharp corners, hardly reach 1.
/// Outliers are taken out of the neighbour lists, and it is done again until no more are found: a
/// group of outliers dissolves from its rim.
///
/// Why not plainly |p_i - c_i|: on a surface that is sampled unevenly, a point at the rim of a
/// dense part is far from the centroid, but along the surface; and far or near depends on the
/// sampling around. The neighbours' distances show that, not those of the point itself,
/// which are long at an outlier.
///
/// \param points 3 x n, finite, distinct.
/// \param lists  n neighbour lists, the nearest of each point; unsorted, longer or shorter than k,
///               with or without the point itself. What is beyond the k nearest steps in for
///               outliers. A list of fewer than three others gives score 0.
/// \return the same, bit by bit, for any number of threads.
/// Cost: O(n k log k) per round, a few rounds.
///
/// No guarantees: a group as dense as the surface, or larger than k, is a surface of its own;
/// beyond the tip of a thin limb, an outlier may be in the plane of its neighbours; where the
/// spacing jumps by ten and more, points at the rim may be taken for outliers.
DeviatingPoints deviatingPoints(const Positions& points, const NeighborLists& lists, double sigma,
                                const Execution& execution);

}  // namespace spherical_param::internal
