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

/// Triangles of a mesh up to which a page shows all of it: it has about 12 bytes for each.
inline constexpr std::size_t kMaxReportTriangles = 1000000;

/// The line of -report.
std::vector<OptionInfo> htmlReportOptions();

/// The file of -report, empty: not wanted. \throw UsageError for a name that is none of a page, or
/// a program that was built without one.
std::string parseHtmlReport(const CommandLine& command_line);

/// Has a reconstruction keep what a page shows.
void keepForHtmlReport(ReconstructionSettings& settings);

/// A command line that does the same again, for a POSIX shell: the program, the options that were
/// given, and the seed where it has a say.
///
/// \param files    of that run, which the command line may have in another order.
/// \param settings what was made of the command line.
std::string repeatedCommand(const std::string& tool, const CommandLine& command_line,
                            const std::vector<OptionInfo>& options,
                            const std::vector<std::string>& files,
                            const ReconstructionSettings& settings);

/// What a page is made of.
struct HtmlReportInput {
  std::string tool;                            ///< its name
  std::string command;                         ///< \see repeatedCommand
  Json report;                                 ///< that of -json
  const CloudReconstruction* cloud = nullptr;  ///< made after keepForHtmlReport()
  const Surface* surface = nullptr;            ///< of the cloud, that is shown
  int threads = 0;
};

/// Writes a page with all it needs: it opens in a browser, without any other file or the network.
///
/// \param page           the page without its data. \see reportPage()
/// \param max_triangles of the mesh that is shown.
/// \throw Failure if it cannot be stored.
void writeHtmlReport(OutputFile& file, std::string_view page, const HtmlReportInput& input,
                     std::size_t max_triangles = kMaxReportTriangles);

}  // namespace spherical_param::tools
