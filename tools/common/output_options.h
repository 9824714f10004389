#pragma once

#include "common/command_line.h"
#include "common/json_report.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"

#include <memory>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// What tools that make files are told about them, besides their names.
struct OutputSettings {
  std::string json;  ///< file of the report, empty: not wanted
  Encoding encoding = Encoding::Binary;
  bool quiet = false;

  bool jsonToStandardOutput() const { return json == "-"; }
  /// Tells whether the console may be used.
  bool printsText() const { return !quiet && !jsonToStandardOutput(); }
};

/// The lines of -json, -ascii and -quiet.
std::vector<OptionInfo> outputOptions();

/// \throw UsageError
OutputSettings parseOutputOptions(const CommandLine& command_line);

/// Adds the members `json`, `ascii` and `quiet`.
void addToJson(const OutputSettings& settings, Json& json);

/// Adds the file of the report, if there is one, to the names of those that will be written.
void addReport(const OutputSettings& settings, std::vector<std::string>& outputs);

/// Looks for what would fail or do harm only after the work: an output that is an input or another
/// output, or that cannot be written. \throw UsageError, Failure.
void checkOutputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

/// Prints the report, or stores it as one more of the files, which is not committed yet.
/// \throw Failure
void storeReport(const OutputSettings& settings, const Json& report,
                 std::vector<std::unique_ptr<OutputFile>>& files);

}  // namespace spherical_param::tools
