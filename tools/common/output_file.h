#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace spherical_param::tools {

/// Checks that a file could be written: its directory exists and takes new files, and the path is
/// no directory. \throw Failure.
void checkOutputPath(const std::string& path);

/// Whether two paths name one file, existing or not.
bool isSameFile(const std::string& first, const std::string& second);

/// A file that appears under its name only when it is complete.
///
/// The bytes go to a temporary file in the same directory, which commit() renames. Without commit()
/// (an exception, or a signal answered by removeTemporaryFiles()) it disappears, and a file that
/// had the name before stays as it was. A path that is no regular file (a pipe, a device) has
/// nothing to be kept and is written directly.
class OutputFile {
public:
  /// Opens the temporary file. \throw Failure.
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Adds bytes, better many at a time. \throw Failure if they cannot be stored, e.g. for a full
  /// disk.
  void write(std::string_view bytes);
  /// Flushes and closes the file and checks its size. \throw Failure.
  void finish();
  /// finish() if that was not done, then gives the file its name. \throw Failure.
  void commit();

private:
  void createTemporary();
  [[noreturn]] void fail(const std::string& action, const std::error_code& error) const;

  std::string path_;                              ///< as the user gave it
  std::string target_;                            ///< behind symbolic links
  std::string temporary_;                         ///< empty: written directly
  std::optional<std::filesystem::perms> rights_;  ///< of the file that it replaces
  std::uintmax_t written_ = 0;
  std::FILE* file_ = nullptr;
};

/// Removes the temporary files of all OutputFiles and calls a function, while no other thread can
/// make, rename or remove one.
void removeTemporaryFiles(const std::function<void()>& afterwards);

}  // namespace spherical_param::tools
