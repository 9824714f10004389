#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

/// Helpers of the tests that run the tools as a user does.
namespace tool_test {

/// An empty directory that disappears with the object.
class TemporaryDirectory {
public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + "/" + name; }
  /// All that is below the directory: names with contents (of directories: nothing).
  std::map<std::string, std::string> listing() const;

private:
  std::string path_;
};

/// How a tool is run.
struct RunOptions {
  std::string directory;            ///< where it works
  bool unprivileged = false;        ///< give up the rights of root, if there are any
  std::size_t file_size_limit = 0;  ///< bytes that a file may have, like a full disk; 0: no limit
  std::size_t address_space_limit = 0;  ///< bytes of address space; 0: no limit
  std::string standard_output;          ///< file or device for the standard output; empty: captured
  bool terminal = false;                ///< the standard output is a terminal
  int signal_when_temporary = 0;        ///< signal to send as soon as a temporary file is there
  unsigned time_limit = 60;             ///< [s]
};

/// What came of it.
struct RunResult {
  int exit_code = -1;  ///< -1: ended by a signal
  int signal = 0;
  std::string output;
  std::string errors;

  /// The lines of `errors` that are not empty.
  std::vector<std::string> errorLines() const;
};

/// Runs a program and waits for its end.
RunResult run(const std::string& program, const std::vector<std::string>& arguments,
              const RunOptions& options);

std::string readFile(const std::string& path);
void writeFile(const std::string& path, const std::string& content);

}  // namespace tool_test
