#pragma once

#include "common/cloud_reconstruction.h"
#include "common/console.h"
#include "common/json_report.h"
#include "common/reconstruction_options.h"

namespace spherical_param::tools {

/// What was read, and what of it was left out, as members of a report.
Json cloudToJson(const CloudReconstruction& cloud);

/// Adds a surface of a cloud.
void addSurface(const ReconstructionSettings& settings, const Surface& surface, Json& json);

Json toJson(const std::vector<Finding>& findings);

/// Prints the table of the embedding's levels.
void printTables(const Surface& surface, Console& console);

/// Prints the size of the mesh; volume and centroid where it encloses something.
void printMeasures(const Surface& result, Console& console);

}  // namespace spherical_param::tools
