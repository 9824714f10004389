#pragma once

#include "common/command_line.h"
#include "spherical_param/options.h"

#include <string>
#include <vector>

namespace spherical_param::tools {

/// How a cloud is to be meshed.
struct ReconstructionSettings {
  Options options;                   ///< the number of threads is never 0
  bool strict = false;               ///< faults are a failure, see Findings
  std::vector<std::string> columns;  ///< names, of text files; empty: those that the file has
};

/// The options of the library's table, -columns and -strict.
OptionTable reconstructionOptions(ReconstructionSettings& settings);

/// Refuses options that were given but would have no effect, and finds the number of threads.
/// \throw UsageError
void parseReconstructionOptions(const CommandLine& command_line, ReconstructionSettings& settings);

}  // namespace spherical_param::tools
