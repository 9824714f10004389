#pragma once

#include "spherical_param/options.h"
#include "spherical_param/result.h"

#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param::internal {

/// What a user should know of a result, the causes of other findings first.
std::vector<Finding> findingsOf(const Options& options, const Surface& result);

/// What is to be said of a part that cannot be meshed.
///
/// \param part  number of it among the parts.
/// \param error message of the exception.
std::string failureOf(std::size_t part, const std::vector<std::vector<Index>>& parts,
                      std::string error);

/// Fills verdict and findings of a result: those of its surfaces, what is true of several said
/// once.
void summarize(Result& result);

/// A headline: whether the mesh is sound, and what is left open, filled, cut or joined.
std::string verdictOf(const Options& options, const Surface& result);

}  // namespace spherical_param::internal
