#pragma once

#include "common/command_line.h"
#include "common/console.h"
#include "common/json_report.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// Options on the files that a tool makes, besides their names.
struct OutputSettings {
  std::string json;  ///< file of the report, empty: not wanted
  Encoding encoding = Encoding::Binary;
  std::optional<Point> offset;  ///< of the coordinates that are written; unset: as the format needs
  bool quiet = false;
  bool verbose = false;

  bool jsonToStandardOutput() const { return json == "-"; }
  /// What the console prints.
  Detail detail() const {
    return quiet || jsonToStandardOutput() ? Detail::Nothing
           : verbose                       ? Detail::All
                                           : Detail::Summary;
  }
};

/// The lines of -json, -verbose, -quiet and -ascii.
std::vector<OptionInfo> outputOptions();

/// \throw UsageError
OutputSettings parseOutputOptions(const CommandLine& command_line);

/// What is subtracted from the coordinates of a file.
Point offsetOf(const OutputSettings& settings, FileFormat format, const PointData& data);

/// Adds the members `json`, `ascii`, `quiet` and `verbose`.
void addToJson(const OutputSettings& settings, Json& json);

/// Adds the file of the report, if any, to the names of output files.
void addReport(const OutputSettings& settings, std::vector<std::string>& outputs);

/// Looks for what would fail or do harm only after the work: an output that is an input or another
/// output, or that cannot be written. \throw UsageError, Failure.
void checkOutputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

/// Gives all files their names, once everything is stored and printed, the report included.
///
/// \param files        finished, but not committed.
/// \param make_report   called if a report is wanted.
/// \param print_verdict prints the last lines on the console. \throw Failure
void publish(const OutputSettings& settings, std::vector<std::unique_ptr<OutputFile>>& files,
             Console& console, const std::function<Json()>& make_report,
             const std::function<void()>& print_verdict);

}  // namespace spherical_param::tools
