#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Sorts items by their unsigned `key`, stably: a pass of counting sort for each 11 bits of it,
/// without those in which all keys are the same.
template <typename Item>
void radixSort(std::vector<Item>& items) {
  constexpr unsigned digit_bits = 11;
  constexpr std::uint32_t mask = (1U << digit_bits) - 1U;
  constexpr unsigned key_bits = 8 * sizeof(Item::key);
  std::vector<Item> sorted(items.size());
  for (unsigned shift = 0; shift < key_bits; shift += digit_bits) {
    std::array<std::size_t, mask + 1> begin{};
    for (const Item& item : items)
      ++begin[item.key >> shift & mask];
    if (!items.empty() && begin[items.front().key >> shift & mask] == items.size())
      continue;
    std::size_t sum = 0;
    for (std::size_t& count : begin)
      count = std::exchange(sum, sum + count);
    for (const Item& item : items)
      sorted[begin[item.key >> shift & mask]++] = item;
    items.swap(sorted);
  }
}

}  // namespace spherical_param::internal
