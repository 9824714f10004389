#include "common/lzf.h"

#include <utility>

namespace spherical_param::tools {

std::optional<std::string> unpackLzf(BlockReader& reader, std::uint64_t packed_size,
                                     std::size_t size) {
  std::string bytes;
  bytes.reserve(size);
  const auto take = [&](std::size_t count) {
    const char* const taken = count <= packed_size ? reader.take(count) : nullptr;
    packed_size -= taken != nullptr ? count : 0;
    return taken;
  };
  while (packed_size > 0) {
    const char* next = take(1);
    if (next == nullptr) {
      return std::nullopt;
    }
    const auto control = static_cast<std::uint8_t>(*next);
    constexpr std::uint8_t first_reference = 32;
    if (control < first_reference) {
      const std::size_t count = std::size_t{control} + 1;
      next = take(count);
      if (next == nullptr || count > size - bytes.size()) {
        return std::nullopt;
      }
      bytes.append(next, count);
      continue;
    }
    // Three bits of length, five and eight of distance; the longest length has another byte.
    std::size_t length = (std::size_t{control} >> 5U) + 2;
    constexpr std::size_t longest = 9;
    const std::size_t more = length == longest ? 2 : 1;
    next = take(more);
    if (next == nullptr) {
      return std::nullopt;
    }
    length += more == 2 ? static_cast<std::uint8_t>(next[0]) : 0U;
    const std::size_t distance =
        ((std::size_t{control} & 0x1fU) << 8U) + static_cast<std::uint8_t>(next[more - 1]) + 1;
    if (distance > bytes.size() || length > size - bytes.size()) {
      return std::nullopt;
    }
    // It may reach into what it makes.
    for (std::size_t i = 0; i < length; ++i) {
      bytes += bytes[bytes.size() - distance];
    }
  }
  return bytes.size() == size ? std::optional(std::move(bytes)) : std::nullopt;
}

}  // namespace spherical_param::tools
