#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace spherical_param::tools {

/// Checks that a file is there, regular, readable and not empty. \return its size [bytes].
/// \throw Failure.
std::uint64_t checkInputFile(const std::string& path);

/// The first bytes of a file, all of them if it has fewer. \throw Failure.
std::string readBeginning(const std::string& path, std::size_t size);

/// \throw Failure for a file that cannot be read, with the reason.
[[noreturn]] void failReading(const std::string& path, const std::string& reason,
                              const std::string& remedy);

/// \throw Failure for a file whose content is not what its extension promises.
[[noreturn]] void failContent(const std::string& path, const std::string& reason);

/// Called now and then with the fraction of a file that has been read or written, in [0, 1].
using FileProgress = std::function<void(double)>;

/// Reads a file from its beginning to its end, a block at a time.
class BlockReader {
public:
  /// \param position bytes to leave out. \throw Failure.
  BlockReader(const std::string& path, std::uint64_t position, const FileProgress& progress);

  /// The next bytes, until the next call of anything; null if the file has fewer.
  /// \throw Failure, as everything below.
  const char* take(std::size_t count);
  /// Leaves out bytes. \return false if the file has fewer.
  bool skip(std::uint64_t count);
  /// The next line without its end, until the next call of anything. \return false if there is
  /// none.
  bool nextLine(std::string_view& line);

private:
  /// Reads another block. \return false at the end of the file
  bool refill();

  std::string path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  FileProgress progress_;
  std::uint64_t file_size_ = 0;
  std::uint64_t position_ = 0;  // of the end of the buffer in the file
  std::string buffer_;
  std::size_t begin_ = 0;  // of the rest of the block
};

}  // namespace spherical_param::tools
