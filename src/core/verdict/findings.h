#pragma once

#include "spherical_param/options.h"
#include "spherical_param/result.h"

#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param::internal {

/// The findings of a result, causes before their consequences.
std::vector<Finding> findingsOf(const Options& given, const Surface& result);

/// Message for parts that cannot be meshed.
///
/// \param points of these parts.
/// \param error  why, e.g. the message of the exception.
std::string failureOf(std::size_t parts, std::size_t points, std::string error);

/// Fills verdict and findings of a result from its surfaces and failures; equal findings of several
/// surfaces become one.
///
/// \param parts_in_all number of parts, also those without a mesh.
void summarize(std::size_t parts_in_all, Result& result);

/// A headline: whether the mesh is sound, and what it leaves open, fills, cuts or joins.
std::string verdictOf(const Options& options, const Surface& result);

}  // namespace spherical_param::internal
