#pragma once

#include "progress.h"
#include "spherical_param/map/morphing.h"

#include <utility>
#include <vector>

namespace spherical_param::internal {

/// The mean squared distance of two surfaces on one sphere, x_A(u) against x_B(R u), each centred
/// and scaled to area 1.
///
/// The mean is that of the mean over A's surface and the mean over B's: which of them is the first
/// makes no difference, and what is large on either counts as much as it is large.
double alignmentError(const SphereSurface& first, const SphereSurface& second,
                      const Eigen::Matrix3d& rotation, int threads);

/// The rotation of least alignmentError(), of all there are.
///
/// \param pairs directions on the first and the second sphere that are to be the same place: their
///              mean squared distance [chord, of the unit sphere] counts as well, so that the
///              rotation brings them near each other. May be empty.
/// The same, bit by bit, for any number of threads.
Eigen::Matrix3d
searchRotation(const SphereSurface& first, const SphereSurface& second,
               const std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>& pairs, int threads,
               const FractionReport& report);

}  // namespace spherical_param::internal
