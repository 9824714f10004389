#pragma once

#include "common/cloud_reconstruction.h"
#include "common/command_line.h"
#include "common/json_report.h"
#include "common/output_file.h"
#include "common/reconstruction_options.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace spherical_param::tools {

/// Triangles of a mesh with a map to the sphere up to which a page shows all of it: it has about
/// 12 bytes for each.
inline constexpr std::size_t kMaxReportTriangles = 1000000;

/// The line of -report.
std::vector<OptionInfo> htmlReportOptions();

/// The file of -report; empty: none. \throw UsageError for a name without .html, or a program built
/// without the page
std::string parseHtmlReport(const CommandLine& command_line);

/// Makes a reconstruction keep the data of a page.
void keepForHtmlReport(ReconstructionSettings& settings);

/// A command line that repeats the run, for a POSIX shell: the program, its options, and the seed
/// if it matters.
///
/// \param files    of the run, in any order.
/// \param settings parsed from the command line.
std::string repeatedCommand(const std::string& tool, const CommandLine& command_line,
                            const std::vector<OptionInfo>& options,
                            const std::vector<std::string>& files,
                            const ReconstructionSettings& settings);

/// The data of a page.
struct HtmlReportInput {
  std::string tool;                            ///< its name
  std::string command;                         ///< \see repeatedCommand
  Json report;                                 ///< of -json
  const CloudReconstruction* cloud = nullptr;  ///< made after keepForHtmlReport()
  const Surface* surface = nullptr;            ///< to be shown
  int threads = 0;
};

/// Writes a page that opens in a browser without other files or a network.
///
/// \param page           the page without its data. \see reportPage()
/// \param max_triangles of the shown mesh, if it has a sphere.
/// \throw Failure if it cannot be stored.
void writeHtmlReport(OutputFile& file, std::string_view page, const HtmlReportInput& input,
                     std::size_t max_triangles = kMaxReportTriangles);

}  // namespace spherical_param::tools
