#pragma once

#include "spherical_param/reconstruct.h"

#include <string>

namespace spherical_param::internal {

/// The options of a run, and what is different from the first.
struct Plan {
  std::string description;
  Options options;
};

/// The plan of run 0, which is what was asked for, or of a retry, which differs in one thing.
Plan planOf(int run, const Options& options);

}  // namespace spherical_param::internal
