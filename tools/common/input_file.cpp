#include "common/input_file.h"

#include "common/errors.h"
#include "common/system.h"
#include "common/text.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace spherical_param::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t block_size = std::size_t{1} << 20;
constexpr std::size_t smallest_block = std::size_t{1} << 12;

}  // namespace

void failReading(const std::string& path, const std::string& reason, const std::string& remedy) {
  throw Failure("cannot read " + inQuotes(path) + ": " + reason, remedy);
}

void failContent(const std::string& path, const std::string& reason) {
  failReading(path, reason, "check that the file is complete and what its extension says");
}

std::uint64_t checkInputFile(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    failReading(path, error.message(), "check the name of the file");
  }
  if (fs::is_directory(status)) {
    failReading(path, "it is a directory", "give a file");
  }
  if (!fs::is_regular_file(status)) {
    failReading(path, "it is not a regular file", "save the data to a file first");
  }
  const std::uintmax_t size = fs::file_size(path, error);
  if (size == 0) {
    failContent(path, "it is empty");
  }
  readBeginning(path, 1);
  return size;
}

std::string readBeginning(const std::string& path, std::size_t size) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file) {
    failReading(path, systemMessage(errno), "check the rights of the file");
  }
  // No more than there is; what is not a regular file has the largest size.
  std::error_code error;
  std::string content(
      static_cast<std::size_t>(std::min<std::uintmax_t>(size, fs::file_size(path, error))), '\0');
  content.resize(std::fread(content.data(), 1, content.size(), file.get()));
  if (std::ferror(file.get()) != 0) {
    failReading(path, systemMessage(errno), "check the disk that holds the file");
  }
  return content;
}

BlockReader::BlockReader(const std::string& path, std::uint64_t position,
                         const FileProgress& progress)
    : path_(path), file_(std::fopen(path.c_str(), "rb"), std::fclose), progress_(progress),
      position_(position) {
  if (!file_ || !seek(*file_, position)) {
    failReading(path, systemMessage(errno), "check the rights of the file");
  }
  std::error_code error;
  file_size_ = fs::file_size(path, error);
  // The blocks are ours; another copy of each would only take time.
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
}

bool BlockReader::refill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t kept = buffer_.size();
  // No more than there is, or a little, should the file grow.
  const auto wanted = static_cast<std::size_t>(std::clamp<std::uint64_t>(
      file_size_ - std::min(file_size_, position_), smallest_block, block_size));
  buffer_.resize(kept + wanted);
  const std::size_t count = std::fread(buffer_.data() + kept, 1, wanted, file_.get());
  buffer_.resize(kept + count);
  if (std::ferror(file_.get()) != 0) {
    failReading(path_, systemMessage(errno), "check the disk that holds the file");
  }
  position_ += count;
  if (progress_ && file_size_ > 0) {
    progress_(std::min(1.0, static_cast<double>(position_) / static_cast<double>(file_size_)));
  }
  return count > 0;
}

const char* BlockReader::take(std::size_t count) {
  while (buffer_.size() - begin_ < count) {
    if (!refill()) {
      return nullptr;
    }
  }
  const char* const bytes = buffer_.data() + begin_;
  begin_ += count;
  return bytes;
}

bool BlockReader::skip(std::uint64_t count) {
  while (count > 0) {
    const std::uint64_t step = std::min<std::uint64_t>(count, block_size);
    if (take(static_cast<std::size_t>(step)) == nullptr) {
      return false;
    }
    count -= step;
  }
  return true;
}

bool BlockReader::nextLine(std::string_view& line) {
  std::size_t searched = 0;
  for (;;) {
    const std::string_view rest = std::string_view(buffer_).substr(begin_);
    const std::size_t end = rest.find('\n', searched);
    if (end != std::string_view::npos) {
      line = rest.substr(0, end);
      begin_ += end + 1;
      return true;
    }
    searched = rest.size();
    if (!refill()) {
      // The last line need not be ended.
      line = std::string_view(buffer_).substr(begin_);
      begin_ = buffer_.size();
      return !line.empty();
    }
  }
}

}  // namespace spherical_param::tools
