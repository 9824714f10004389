#pragma once

#include "workbench.h"

namespace spherical_param::internal {

/// Ruins and recreates parts around folded edges. Returns whether some are left.
bool unfold(Workbench& bench);

}  // namespace spherical_param::internal
