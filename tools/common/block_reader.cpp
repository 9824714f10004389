#include "common/block_reader.h"

#include "common/input_file.h"
#include "common/text.h"

#include <sys/stat.h>
#include <sys/types.h>

#include <algorithm>
#include <cerrno>

namespace spherical_param::tools {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 20;
constexpr std::size_t smallest_block = std::size_t{1} << 12;

}  // namespace

BlockReader::BlockReader(const std::string& path, std::uint64_t position,
                         const FileProgress& progress)
    : path_(path), file_(std::fopen(path.c_str(), "rb"), std::fclose), progress_(progress),
      position_(position) {
  struct stat status {};
  if (!file_ || fstat(fileno(file_.get()), &status) != 0 ||
      fseeko(file_.get(), static_cast<off_t>(position), SEEK_SET) != 0) {
    failReading(path, systemMessage(errno), "check the rights of the file");
  }
  file_size_ = static_cast<std::uint64_t>(status.st_size);
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
