#pragma once

#include "common/command_line.h"

#include <functional>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// Runs a tool: quiet libraries, temporary files removed on signals, and every exception told as
/// one line of cause and one of remedy on the standard error. \return the exit code of main().
///
/// \param body is given the words of the command line without the program's name.
int runTool(const std::string& tool, int argc, char** argv,
            const std::function<void(const std::vector<std::string>&)>& body);

/// While it lives, a signal that would end the tool is told to a function instead, which runs in a
/// thread of its own. There is one at most.
class SignalWatch {
public:
  explicit SignalWatch(std::function<void(int)> told);
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;
};

/// Ends the tool as the signal would have, so that the caller sees what happened.
[[noreturn]] void endBySignal(int signal_number);

/// Prints the help or the version if that is what the user wants. \return whether it was.
bool answerHelpOrVersion(const CommandLine& command_line, const std::string& tool,
                         const std::string& help);

}  // namespace spherical_param::tools
