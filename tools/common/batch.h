#pragma once

#include "common/command_line.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// How a tool that makes a file of an input works on many of them.
struct BatchTool {
  std::string name;
  /// An upper bound of the memory [bytes] that one input takes.
  std::function<std::uint64_t(const std::string& input)> memory_need;
  /// Looks at the names of the files of an input. \throw UsageError
  std::function<void(const std::string& option, const std::string& file)> check_output;
};

/// The lines of the options of batches, from -output to -shard.
std::vector<OptionInfo> batchOptions();

/// Tells whether a command line asks for a batch. \throw UsageError for one that does not and has
/// options of batches all the same.
bool isBatch(const CommandLine& command_line);

/// Runs the tool itself on every input, as a program of its own, so that none takes others down:
/// several at a time, within a budget of memory. Goes on after failures. Ends with a table, and
/// keeps a record of each input as a line of JSON.
///
/// \param command_line whose options for single inputs are known to be good; `sphere`, `json` and
/// `report` are patterns as well. \throw UsageError before any work, Failure if an input failed.
void runBatch(const BatchTool& tool, const CommandLine& command_line);

}  // namespace spherical_param::tools
