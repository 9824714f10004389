#pragma once

#include "common/command_line.h"

#include <functional>
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

/// Runs a tool: temporary files are removed on signals, and every exception becomes one line of
/// cause and one of remedy on the standard error. \return the exit code of main().
///
/// \param body is given the words of the command line without the program's name.
int runTool(const std::string& tool, int argc, char** argv,
            const std::function<void(const std::vector<std::string>&)>& body);

/// Prints the help or the version if that is what the user wants. \return whether it was.
bool answerHelpOrVersion(const CommandLine& command_line, const ToolText& text,
                         const OptionTable& options);

/// The words that are no options: a file for each name in the text. \throw UsageError
std::vector<std::string> filesOf(const CommandLine& command_line, const ToolText& text);

}  // namespace spherical_param::tools
