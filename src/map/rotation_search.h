#pragma once

#include "progress.h"
#include "spherical_param/map/morphing.h"

#include <utility>
#include <vector>

namespace spherical_param::internal {

/// The mean squared distance of two surfaces on one sphere, x_A(u) against x_B(R u), each centred
/// and scaled to area 1.
///
/// It is the average of the mean over A's surface and the mean over B's: both surfaces count alike,
/// and each part of them by its area.
double alignmentError(const SphereSurface& first, const SphereSurface& second,
                      const Eigen::Matrix3d& rotation, int threads);

/// The rotation with the least alignmentError().
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
