#pragma once

#include "neighbor_graph.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param {

/// \addtogroup outliers
/// @{

/// Points that do not belong to the surface of the others.
struct Outliers {
  std::vector<Index> indices;  ///< the outliers, ascending
  /// n entries: how far each point is off the surface of its neighbours, relative to the mean
  /// distances there; that of an outlier as of the round in which it was found.
  std::vector<double> scores;
  int rounds = 0;  ///< passes over the points; the last one finds none
  /// Mean of the scores, each counted as 1 at most, of the points that are not outliers.
  double mean = 0.0;
  double standard_deviation = 0.0;  ///< of the same scores
  double threshold = 0.0;  ///< what they are compared to: no point but the outliers is above it
};

/// Finds stray points: single ones, small clusters, nets of them, points between sheets, and single
/// points near a surface but off it.
///
/// The graph is that of local Delaunay neighbourhoods before anything is repaired or joined: points
/// are neighbours if each is in the star of the other. A stray point has no neighbours, or others
/// like it. The pieces of this graph are surfaces, but for
///
///   - clusters: pieces of fewer than 32 points,
///   - nets: pieces of which no 32 points form a sheet (are joined by edges with triangles on both
///     sides) and whose median distance of neighbours is above 5 times that of the surface beside.
///
/// A point of a cluster or a net is stray if it is farther from the nearest surface than the mean
/// distance of neighbours there and 6 times the roughness, and in no star of a point of a surface.
/// The roughness is the root mean square distance of some 12 points there from their plane.
///
/// The 20 nearest neighbours of each other point have a quadric of least squares over their plane.
/// A point is stray, too, if its distance from that is above 10 times their standard deviation, and
/// above a quarter of the spacing there, the median distance of the fourth neighbours, and if, seen
/// along the normal, a neighbour is no farther than that spacing. The distance is divided by
/// sqrt(1 + leverage): a quadric is less certain where no neighbours hold it.
///
/// \param points 3 x n, finite. Of points at one position all are stray or none.
/// \param execution threads, progress
/// \return the stray points, the same, bit by bit, for any number of threads; the score of one is
///         StrayPoint::distance, or its distance from the quadric in spacings, that of others 0.
/// \throw InvalidInput for coordinates that are not finite, or options out of range; Cancelled.
/// Cost: that of a neighbour graph and of a search and a fit for each point. Surface::outliers of
/// reconstruct() are those without the last kind, and cost no more than a search for each point
/// that is on no surface.
///
/// No guarantees: a point as near to a surface as its own are to each other may be noise, and one
/// that far from the rim of an opening continues the surface.
Outliers findStrayPoints(const Positions& points, const Execution& execution = {});

/// Parameters of findOutliers().
struct OutlierOptions {
  /// Outliers are farther off than the mean by this number of standard deviations; [0, 1000].
  double sigma = 4.0;
  /// Nearest neighbours used of each list; lists that hold fewer are used whole. Range: 3 and up.
  int k = 16;
  /// Nothing nearer to the surface of its neighbours than this is an outlier [fraction of their
  /// mean distances]; >= 0. Points of a surface, even those at sharp corners, hardly reach 1.
  double least_score = 1.0;
};

/// Finds points that are too far from the average of their neighbours (Zwicker and Gotsman 2004,
/// section 4.2).
///
/// What is compared is
///
///   score_i = |n_i . (p_i - c_i)| / M_i,
///
/// with the median M_i of the mean distances that the k nearest neighbours have to their own, the
/// centroid c_i of the neighbours, and the normal n_i of their plane of least squares. Neighbours
/// with mean distances above 2 M_i have no say in centroid and plane: they may be outliers too.
/// Outliers are points with
///
///   score_i > max(mean + sigma * standard deviation, least_score),
///
/// mean and deviation over all points, with scores above 1 counted as 1, so that a few far outliers
/// do not hide the nearer ones. They are taken out of the neighbour lists, and it is done again
/// until no more are found: a group of outliers dissolves from its rim.
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
/// \param options how far off an outlier is, k
/// \param execution threads, progress
/// \return the outliers, the same, bit by bit, for any number of threads.
/// \throw InvalidInput for coordinates that are not finite, sizes that disagree, an index out of
///        range, or options out of range; Cancelled.
/// Cost: O(n k log k) per round, a few rounds.
///
/// No guarantees: a group as dense as the surface, or larger than k, is a surface of its own;
/// beyond the tip of a thin limb, an outlier may be in the plane of its neighbours; where the
/// spacing jumps by ten and more, points at the rim may be taken for outliers.
Outliers findOutliers(const Positions& points, const NeighborLists& lists,
                      const OutlierOptions& options = {}, const Execution& execution = {});

/// The same with neighbours that are found here, twice as many of each point as OutlierOptions::k,
/// among the points that are not stray: those of a net have each other for neighbours, and those
/// between two sheets are in the plane of both. The score of a stray point is StrayPoint::distance.
///
/// \param points 3 x n, finite. Of points at one position all are outliers or none.
/// \param options, execution as above.
/// \return the outliers, as above, in the numbers of the input; none of fewer than 4 positions,
///         which cannot be meshed anyway.
/// \throw InvalidInput as above; Cancelled.
Outliers findOutliers(const Positions& points, const OutlierOptions& options = {},
                      const Execution& execution = {});

/// @}

}  // namespace spherical_param
