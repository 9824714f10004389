#pragma once

#include "common/console.h"
#include "common/json_report.h"
#include "spherical_param/result.h"

#include <vector>

namespace spherical_param::tools {

/// The figures of a surface by the names of its fields; those of its topology stand among them.
/// Vertices are rows of the cloud, lists of triangles their number, and arrays with an entry for
/// each vertex or triangle are left out. Of the triangles that intersect, the first 1,000 pairs.
Json toJson(const Surface& surface);

Json toJson(const LeftOut& left_out);
Json toJson(const std::vector<Finding>& findings);

/// Prints the levels of the embedding, and the size of the mesh; what it encloses, if anything.
void printTables(const Surface& surface, Console& console);

}  // namespace spherical_param::tools
