#pragma once

#include "common/command_line.h"

#include <functional>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// Runs a tool: temporary files are removed on signals, and every exception becomes one line of
/// cause and one of remedy on the standard error. \return the exit code of main().
///
/// \param body is given the words of the command line without the program's name.
int runTool(const std::string& tool, int argc, char** argv,
            const std::function<void(const std::vector<std::string>&)>& body);

/// Prints the help or the version if that is what the user wants. \return whether it was.
///
/// \param help makes the text, with the options of experts or without.
bool answerHelpOrVersion(const CommandLine& command_line, const std::string& tool,
                         const std::function<std::string(bool with_experts)>& help);

}  // namespace spherical_param::tools
