#include "common/input_file.h"

#include "common/errors.h"
#include "common/text.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace spherical_param::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t block_size = std::size_t{1} << 20;

}  // namespace

void failReading(const std::string& path, const std::string& reason, const std::string& remedy) {
  throw Failure("cannot read " + inQuotes(path) + ": " + reason, remedy);
}

void failContent(const std::string& path, const std::string& reason) {
  failReading(path, reason, "check that the file is complete and what its extension says");
}

InputFile::InputFile(const std::string& path, FileProgress progress)
    : path_(path), progress_(std::move(progress)) {
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
  size_ = fs::file_size(path, error);
  if (size_ == 0) {
    failContent(path, "it is empty");
  }
  file_.open(path, std::ios::binary);
  if (!file_) {
    failReading(path, systemMessage(errno), "check the rights of the file");
  }
}

bool InputFile::refill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t kept = buffer_.size();
  // One byte more than there is, to see the end.
  const auto wanted = static_cast<std::size_t>(
      std::min<std::uint64_t>(block_size, size_ - std::min(size_, position_) + 1));
  buffer_.resize(kept + wanted);
  file_.read(&buffer_[kept], static_cast<std::streamsize>(wanted));
  const auto count = static_cast<std::size_t>(file_.gcount());
  buffer_.resize(kept + count);
  if (file_.bad()) {
    failReading(path_, systemMessage(errno), "check the disk that holds the file");
  }
  position_ += count;
  if (progress_) {
    progress_(std::min(1.0, static_cast<double>(position_) / static_cast<double>(size_)));
  }
  return count > 0;
}

std::uint64_t InputFile::bytesLeft() const {
  const std::uint64_t taken = position_ - (buffer_.size() - begin_);
  return size_ - std::min(size_, taken);
}

std::string_view InputFile::peek(std::size_t count) {
  while (buffer_.size() - begin_ < count && refill()) {
  }
  return std::string_view(buffer_).substr(begin_, count);
}

const char* InputFile::take(std::size_t count) {
  const std::string_view bytes = peek(count);
  if (bytes.size() < count) {
    return nullptr;
  }
  begin_ += count;
  return bytes.data();
}

bool InputFile::skip(std::uint64_t count) {
  while (count > 0) {
    const std::uint64_t step = std::min<std::uint64_t>(count, block_size);
    if (take(static_cast<std::size_t>(step)) == nullptr) {
      return false;
    }
    count -= step;
  }
  return true;
}

bool InputFile::nextLine(std::string_view& line) {
  std::size_t searched = 0;
  std::size_t end = std::string::npos;
  do {
    const std::string_view rest = std::string_view(buffer_).substr(begin_);
    end = rest.find('\n', searched);
    searched = rest.size();
  } while (end == std::string::npos && refill());
  line = std::string_view(buffer_).substr(begin_, end);
  begin_ = std::min(begin_ + line.size() + 1, buffer_.size());
  // The last line may end without "\n"; behind it, there is none.
  if (line.empty() && end == std::string::npos) {
    return false;
  }
  ++line_number_;
  line = line_number_ == 1 ? withoutByteOrderMark(line) : line;
  return true;
}

}  // namespace spherical_param::tools
