#pragma once

#include "neighborhoods.h"
#include "spherical_param/options.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/result.h"
#include "spherical_param/types.h"
#include "stage_clock.h"

#include <optional>

namespace spherical_param::internal {

/// Meshes a cloud that a place sees as one layer, by the directions from there: Result::view, the
/// surfaces, without verdicts, and the points that are left out.
///
/// \param points  3 x n, finite or not.
/// \param given   options.
/// \param known   receives the nodes of usableInputs() for the general method.
/// \return false if there is no such place, or other options need the general method. Nothing has
///         changed then.
/// \throw InvalidInput if the caller gave a place from which there is no mesh, or such options.
bool reconstructView(const Positions& points, const Options& given, const CloudInfo& info,
                     StageClock& clock, Result& result, std::optional<SearchedNodes>& known);

}  // namespace spherical_param::internal
