#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>

namespace spherical_param::tools {

/// \throw Failure for a file that cannot be read, with the reason.
[[noreturn]] void failReading(const std::string& path, const std::string& reason,
                              const std::string& remedy);

/// \throw Failure for a file whose content is not what its extension promises.
[[noreturn]] void failContent(const std::string& path, const std::string& reason);

/// Called now and then with the fraction of a file that has been read or written, in [0, 1].
using FileProgress = std::function<void(double)>;

/// Reads a file from its beginning to its end, a block at a time. Its functions throw Failure where
/// the file cannot be read. What they return is valid until the next call.
class InputFile {
public:
  /// Checks that the file is there, regular, readable and not empty.
  explicit InputFile(const std::string& path, FileProgress progress = {});

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// Bytes that were not taken yet.
  std::uint64_t bytesLeft() const;
  /// Number of the last line that was taken, from 1.
  std::size_t lineNumber() const { return line_number_; }

  /// The next bytes, without taking them; fewer if the file ends before.
  std::string_view peek(std::size_t count);
  /// Takes the next bytes. \return null if the file has fewer.
  const char* take(std::size_t count);
  /// Leaves out bytes. \return false if the file has fewer.
  bool skip(std::uint64_t count);
  /// Takes the next line, without its end and a byte order mark. \return false if there is none.
  bool nextLine(std::string_view& line);

private:
  /// Reads another block. \return false at the end of the file
  bool refill();

  std::string path_;
  FileProgress progress_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;  // of the end of the buffer in the file
  std::string buffer_;
  std::size_t begin_ = 0;  // of the rest of the block
  std::size_t line_number_ = 0;
};

}  // namespace spherical_param::tools
