#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Sorts items by their `key`, a std::uint32_t, stably: three passes of counting sort.
template <typename Item>
void radixSort(std::vector<Item>& items) {
  constexpr unsigned digit_bits = 11;
  constexpr std::uint32_t mask = (1U << digit_bits) - 1U;
  std::vector<Item> sorted(items.size());
  for (unsigned shift = 0; shift < 32; shift += digit_bits) {
    std::array<std::size_t, mask + 1> begin{};
    for (const Item& item : items)
      ++begin[item.key >> shift & mask];
    std::size_t sum = 0;
    for (std::size_t& count : begin)
      count = std::exchange(sum, sum + count);
    for (const Item& item : items)
      sorted[begin[item.key >> shift & mask]++] = item;
    items.swap(sorted);
  }
}

}  // namespace spherical_param::internal
