#pragma once

#include "sampling_analysis.h"
#include "workbench.h"

namespace spherical_param::internal {

/// Flips with the energy that suits a sampling.
///
/// \param mu of a sampling that is not even.
void flipFor(Workbench& bench, const Sampling& sampling, const char* phase, double mu);

/// Last flips and relocations, with the energy that suits the sampling. \see optimizeMesh()
void polish(Workbench& bench, const Sampling& sampling);

}  // namespace spherical_param::internal
