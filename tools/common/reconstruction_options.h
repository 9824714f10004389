#pragma once

#include "common/command_line.h"
#include "common/console.h"
#include "common/json_report.h"
#include "spherical_param/options.h"

#include <string>
#include <vector>

namespace spherical_param::tools {

/// How a cloud is to be meshed.
struct ReconstructionSettings {
  Options options;                   ///< the number of threads is never 0
  bool strict = false;               ///< faults are a failure, see Findings
  std::vector<std::string> columns;  ///< of text files; empty: those that they say themselves
};

/// The lines of the options of the reconstruction: those of the library's table, and a few more.
std::vector<OptionInfo> reconstructionOptions(const Options& defaults = {});

/// Refuses options that would have no effect as well. \throw UsageError
ReconstructionSettings parseReconstructionOptions(const CommandLine& command_line,
                                                  const Options& defaults = {});

/// Prints the values in force.
void printReconstructionOptions(const ReconstructionSettings& settings, Console& console);

/// The values of the options; null if unset or without effect.
Json reconstructionOptionsToJson(const ReconstructionSettings& settings);

/// The value in force of an option of the library's table, as text.
std::string optionText(const Options& options, const std::string& name);

}  // namespace spherical_param::tools
