#pragma once

#include "spherical_param/reconstruct.h"

#include <string>
#include <vector>

namespace spherical_param::internal {

/// What a user should know of a result, one sentence each.
std::vector<std::string> warningsOf(const Options& options, const Result& result);

}  // namespace spherical_param::internal
