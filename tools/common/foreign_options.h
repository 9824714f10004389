#pragma once

#include "common/command_line.h"

#include <string>
#include <vector>

namespace spherical_param::tools {

// Command lines of PCL's own tools that make meshes are taken with the program's name changed. What
// their options ask for has no counterpart here: either it changes nothing, and the user is told
// so, or it would, and is refused.

/// The options of pcl_gp3_surface, pcl_poisson_reconstruction and pcl_marching_cubes_reconstruction
/// that no tool of ours has, for CommandLine alone: no help shows them.
std::vector<OptionInfo> foreignOptions();

/// What to say about those that were given and have no effect, a line each.
/// \throw UsageError for a value that is no number, and for an option whose effect cannot be had.
std::vector<std::string> notesOnForeignOptions(const CommandLine& command_line);

/// Tells whether an option is one of them.
bool isForeignOption(const std::string& name);

}  // namespace spherical_param::tools
