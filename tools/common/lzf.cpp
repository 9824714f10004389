#include "common/lzf.h"

#include <utility>

namespace spherical_param::tools {
namespace {

class LzfReader {
public:
  LzfReader(BlockReader& reader, std::uint64_t packed_size, std::size_t size)
      : reader_(reader), packed_left_(packed_size), size_(size) {
    bytes_.reserve(size);
  }

  std::optional<std::string> unpack() {
    while (packed_left_ > 0) {
      if (!addNext()) {
        return std::nullopt;
      }
    }
    return bytes_.size() == size_ ? std::optional(std::move(bytes_)) : std::nullopt;
  }

private:
  const char* take(std::size_t count) {
    if (count > packed_left_) {
      return nullptr;
    }
    packed_left_ -= count;
    return reader_.take(count);
  }

  /// Adds what the next control byte stands for. \return false if that makes no sense.
  bool addNext() {
    const char* next = take(1);
    if (next == nullptr) {
      return false;
    }
    const auto control = static_cast<std::uint8_t>(*next);
    constexpr std::uint8_t first_reference = 32;
    if (control < first_reference) {
      const std::size_t count = std::size_t{control} + 1;
      next = take(count);
      if (next == nullptr || count > size_ - bytes_.size()) {
        return false;
      }
      bytes_.append(next, count);
      return true;
    }
    // Three bits of length, five and eight of distance; the longest length has another byte.
    std::size_t length = (std::size_t{control} >> 5U) + 2;
    constexpr std::size_t longest = 9;
    const std::size_t more = length == longest ? 2 : 1;
    next = take(more);
    if (next == nullptr) {
      return false;
    }
    length += more == 2 ? static_cast<std::uint8_t>(next[0]) : 0U;
    const std::size_t distance =
        ((std::size_t{control} & 0x1fU) << 8U) + static_cast<std::uint8_t>(next[more - 1]) + 1;
    if (distance > bytes_.size() || length > size_ - bytes_.size()) {
      return false;
    }
    // It may reach into what it makes.
    for (std::size_t i = 0; i < length; ++i) {
      bytes_ += bytes_[bytes_.size() - distance];
    }
    return true;
  }

  BlockReader& reader_;
  std::uint64_t packed_left_;
  std::size_t size_;
  std::string bytes_;
};

}  // namespace

std::optional<std::string> unpackLzf(BlockReader& reader, std::uint64_t packed_size,
                                     std::size_t size) {
  return LzfReader(reader, packed_size, size).unpack();
}

}  // namespace spherical_param::tools
