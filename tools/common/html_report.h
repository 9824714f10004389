#pragma once

#include "common/cloud_reconstruction.h"
#include "common/command_line.h"
#include "common/json_report.h"
#include "common/output_file.h"
#include "common/reconstruction_options.h"

#include <string>
#include <string_view>
#include <vector>

namespace spherical_param::tools {

/// The option -report.
std::vector<OptionInfo> htmlReportOptions();

/// The file that -report names; empty without the option. \throw UsageError for a name without
/// .html, or a program built without the page
std::string parseHtmlReport(const CommandLine& command_line);

/// Makes a reconstruction keep the data of a page.
void keepForHtmlReport(ReconstructionSettings& settings);

/// The command line that repeats the run, for a POSIX shell.
std::string repeatedCommand(const std::string& tool, const std::vector<std::string>& words);

/// The data of a page.
struct HtmlReportInput {
  std::string tool;                            ///< its name
  std::string command;                         ///< \see repeatedCommand
  Json report;                                 ///< of -json
  const CloudReconstruction* cloud = nullptr;  ///< made after keepForHtmlReport()
  const Surface* surface = nullptr;            ///< one of `cloud`, to be shown; null: all
};

/// The page without its data: HTML with one line `<!--DATA-->`, in place of which the program and
/// the data come. Empty in a build without three.js: there is no -report then.
std::string_view reportPage();

/// The JavaScript that shows the data, with three.js.
std::string_view reportProgram();

/// Writes a page that opens in a browser without other files or a network.
/// \throw Failure if it cannot be stored.
void writeHtmlReport(OutputFile& file, const HtmlReportInput& input);

}  // namespace spherical_param::tools
