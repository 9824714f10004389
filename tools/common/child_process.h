#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// The exit code of a program that could not be run at all.
constexpr int exit_code_not_run = 127;

/// How a program ended.
struct ChildResult {
  pid_t process = 0;
  int exit_code = -1;             ///< -1: ended by a signal
  int signal = 0;                 ///< 0: ended by itself
  std::uint64_t peak_memory = 0;  ///< [bytes]; not below that of the program that started it
  std::string output;             ///< what it printed on the standard output
  std::string errors;             ///< the end of what it printed on the standard error
};

/// Programs that run beside this one, with an empty standard input. Those that still run at the
/// end are killed; if this program ends by whatever cause, they are told to end (Linux).
///
/// All functions must be called from one thread.
class ChildProcesses {
public:
  ChildProcesses() = default;
  ~ChildProcesses();
  ChildProcesses(const ChildProcesses&) = delete;
  ChildProcesses& operator=(const ChildProcesses&) = delete;

  /// Starts a program. \param words its path and its arguments. \return its process id.
  /// \throw Failure
  pid_t start(const std::vector<std::string>& words);

  /// Waits until a program ends, there is something to read from a descriptor, or the time is up.
  /// \param wake a descriptor, or -1. \param seconds the longest time, or negative.
  /// \return the program that ended.
  std::optional<ChildResult> wait(int wake, double seconds);

  /// Sends a signal to all.
  void signalAll(int signal) const;

  std::size_t count() const { return children_.size(); }

private:
  struct Child {
    int output = -1;  ///< pipe, -1: closed
    int errors = -1;
    ChildResult result;
  };

  std::map<pid_t, Child> children_;
};

/// A signal's name and what it means, e.g. "SIGSEGV (Segmentation fault)".
std::string signalName(int signal);

/// The path of this program's file. \throw Failure
std::string pathOfThisProgram();

}  // namespace spherical_param::tools
