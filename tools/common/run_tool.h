#pragma once

#include "common/command_line.h"
#include "common/console.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"
#include "spherical_param/result.h"

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::tools {

/// The texts of a tool.
struct ToolText {
  std::string name;
  std::string files;  ///< the words of the command line that are no options
  std::string about;  ///< lines
  std::vector<std::pair<std::string, std::string>> examples;  ///< what each does, and its words
  std::string exit_codes =
      "0 done (also with warnings), 1 failed (with -strict also if the mesh is unfit),\n"
      "2 wrong usage, 3 written but not usable: more than 1 % of the triangles intersect.";
};

/// Runs a tool, or prints its help or version: temporary files are removed on signals, and every
/// exception becomes one line of cause and one of remedy on the standard error.
///
/// \param body is given the command line, whose options are set, if no help was wanted.
/// \return the exit code of main().
int runTool(const ToolText& text, int argc, char** argv, const OptionTable& options,
            const std::function<void(const CommandLine&)>& body);

/// The words that are no options: a file for each name in the text. \throw UsageError
std::vector<std::string> filesOf(const CommandLine& command_line, const ToolText& text);

/// Options on the files that a tool makes, besides their names.
struct OutputSettings {
  std::string json;             ///< file of the report; empty: not wanted; "-": the standard output
  std::optional<Point> offset;  ///< of the coordinates that are written; unset: as the format needs
  bool ascii = false;
  bool quiet = false;
  bool verbose = false;

  Encoding encoding() const { return ascii ? Encoding::Ascii : Encoding::Binary; }
  /// What is subtracted from the coordinates of a file.
  Point offsetOf(const std::string& path, const PointData& data) const {
    return offset ? *offset : offsetFor(data, formatOf(path), encoding());
  }
};

OptionTable outputOptions(OutputSettings& settings);

/// The names of the files that a tool makes, without empty ones, and that of the report.
std::vector<std::string> outputsOf(const OutputSettings& settings,
                                   const std::vector<std::string>& names);

/// Looks for what would fail or do harm only after the work: an output that is an input or another
/// output, or that cannot be written. \throw UsageError, Failure.
void checkOutputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

/// What all tools do around their work.
class ToolRun {
public:
  /// Prints the files and the options in force. \throw UsageError
  ///
  /// \param settings must outlive it. \param strict faults are a failure.
  ToolRun(const OutputSettings& settings, bool strict, const std::string& tool,
          const std::vector<std::pair<std::string, std::string>>& files,
          const OptionTable& options);

  Console console;

  /// A file that gets its name together with the others.
  OutputFile& open(const std::string& path) { return files_.emplace_back(path); }
  /// Stores a mesh in such a file, in the format of its name.
  void write(const std::string& path, const MeshView& mesh, const FileProgress& progress = {});
  /// Prints the summary and gives all files their names, once everything is stored.
  ///
  /// \param make_report called if a report is wanted. \throw Failure
  void publish(const std::function<Json()>& make_report, const Summary& summary);

  /// Adds findings of an input; `of` names it where there are several.
  void add(const std::string& of, const std::vector<Finding>& findings);
  /// Adds a failure that is no finding of the library, and counts as a fault.
  void addFailure(const std::string& failure);
  /// Prints the findings. Ends the tool with exit code 3 if a mesh is not usable, and with -strict
  /// with 1 if there is a fault.
  ///
  /// \param page_option an option that shows where faults are, if it was not given. \throw
  /// ToolError
  void conclude(bool is_usable, const std::string& page_option = "");

private:
  struct Entry {
    std::string of;  ///< the inputs that it is true of; empty: the only one
    Finding finding;
    bool is_failure = false;
  };

  const OutputSettings& settings_;
  bool strict_;
  std::deque<OutputFile> files_;
  std::vector<Entry> entries_;
};

}  // namespace spherical_param::tools
