#pragma once

#include "sampling_analysis.h"
#include "workbench.h"

namespace spherical_param::internal {

/// Flips with the energy that suits a sampling.
///
/// \param mu of a sampling that is not even.
void flipFor(Workbench& bench, const Sampling& sampling, double mu);

/// Last flips and relocations, with the energy that suits the sampling.
void polish(Workbench& bench, const Sampling& sampling);

}  // namespace spherical_param::internal
