#pragma once

#include "common/console.h"
#include "common/json_report.h"
#include "spherical_param/result.h"

#include <optional>
#include <vector>

namespace spherical_param::tools {

/// The figures of a surface by the names of its fields, with the fields of its topology among them.
/// Vertices are rows of the cloud. Lists of triangles become their number, except for the first
/// 1,000 intersecting pairs. Arrays by vertex or triangle are omitted.
Json toJson(const Surface& surface);

/// null without a view.
Json toJson(const std::optional<View>& view);
Json toJson(const LeftOut& left_out);
Json toJson(const std::vector<Finding>& findings);

/// Prints the figures of a report, by their names: all but files, options, stages and findings.
void printFigures(const Json& report, Console& console);

/// Prints the levels of the embedding, the size of the mesh and its solid.
void printTables(const Surface& surface, Console& console);

}  // namespace spherical_param::tools
