#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace spherical_param::tools {

/// What a tool returns to its caller.
enum class ExitCode { Done = 0, Failed = 1, Usage = 2 };

/// An end of the work that the user is told about: one line of cause, one of remedy.
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

/// The work could not be done.
class Failure : public ToolError {
public:
  Failure(const std::string& cause, std::string remedy)
      : ToolError(ExitCode::Failed, cause, std::move(remedy)) {}
};

/// The command line makes no sense, whatever the files hold.
class UsageError : public ToolError {
public:
  UsageError(const std::string& cause, std::string remedy)
      : ToolError(ExitCode::Usage, cause, std::move(remedy)) {}
};

}  // namespace spherical_param::tools
