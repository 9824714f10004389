#pragma once

#include "spherical_param/errors.h"

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

namespace spherical_param::tools {

/// What a tool returns to its caller. NotUsable: all was written, but more than 1 % of the
/// triangles intersect.
enum class ExitCode { Done = 0, Failed = 1, Usage = 2, NotUsable = 3 };

/// An error as the user sees it: one line of cause, one of remedy.
class ToolError : public std::runtime_error {
public:
  ToolError(ExitCode exit_code, const std::string& cause, std::string remedy)
      : std::runtime_error(cause), exit_code_(exit_code), remedy_(std::move(remedy)) {}

  ExitCode exitCode() const { return exit_code_; }
  const std::string& remedy() const { return remedy_; }

private:
  ExitCode exit_code_;
  std::string remedy_;
};

template <ExitCode Code>
struct ErrorOf : ToolError {
  ErrorOf(const std::string& cause, std::string remedy)
      : ToolError(Code, cause, std::move(remedy)) {}
};
/// The work could not be done.
using Failure = ErrorOf<ExitCode::Failed>;
/// The command line is wrong, even without a look at the files.
using UsageError = ErrorOf<ExitCode::Usage>;

/// A message of the library, "function: cause; remedy" or "cause; remedy", for the user of a tool,
/// who does not know the functions.
///
/// \param task   what could not be done, e.g. "cannot mesh 'file'".
/// \param remedy used where the message has none.
inline Failure libraryFailure(const std::string& task, const std::string& message,
                              const std::string& remedy) {
  const std::size_t name = message.find(": ");
  // The name of a function is one word.
  const std::string text = name < message.find(' ') ? message.substr(name + 2) : message;
  const std::size_t end = text.find("; ");
  return {task + ": " + text.substr(0, end),
          end == std::string::npos ? remedy : text.substr(end + 2)};
}

/// Does some work with the library. \throw Failure if the library refuses its input or fails.
template <typename Work>
void runLibrary(const std::string& task, const std::string& remedy, const Work& work) {
  try {
    work();
  } catch (const InvalidInput& error) {
    throw libraryFailure(task, error.what(), remedy);
  } catch (const ComputeError& error) {
    throw libraryFailure(task, error.what(), remedy);
  }
}

/// The remedy of failures that should not occur.
inline constexpr const char* kReportIt = "this should not happen: please report it";

}  // namespace spherical_param::tools
