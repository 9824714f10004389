#pragma once

#include "spherical_param/options.h"
#include "spherical_param/result.h"

#include <string>
#include <vector>

namespace spherical_param::internal {

/// What a user should know of a result, the causes of other findings first.
std::vector<Finding> findingsOf(const Options& options, const Surface& result);

/// A headline: whether the mesh is sound, and what is left open, filled, cut or joined.
std::string verdictOf(const Options& options, const Surface& result);

}  // namespace spherical_param::internal
