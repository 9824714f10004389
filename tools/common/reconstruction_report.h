#pragma once

#include "common/cloud_reconstruction.h"
#include "common/console.h"
#include "common/json_report.h"
#include "common/reconstruction_options.h"

namespace spherical_param::tools {

/// What was read, and what of it was left out, as members of a report.
Json cloudToJson(const ReconstructionSettings& settings, const CloudReconstruction& cloud);

/// Adds what was made of a cloud, or of a part of one.
void addMesh(const ReconstructionSettings& settings, const CloudReconstruction& cloud, Json& json);

/// The size of a part and where it is.
Json toJson(const Part& part);

Json toJson(const std::vector<Finding>& findings);

/// Prints the tables of the embedding's levels and of the optimisation's phases.
void printTables(const CloudReconstruction& cloud, Console& console);

/// Prints the size of the mesh; volume and centroid where it encloses something.
void printMeasures(const Surface& result, Console& console);

}  // namespace spherical_param::tools
