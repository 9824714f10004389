#pragma once

#include "rows.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Sorts items by their `key`, an unsigned integer, stably: a pass of counting sort for each digit
/// of 11 bits in which the keys differ.
template <typename Item>
void radixSort(std::vector<Item>& items) {
  using Key = decltype(Item::key);
  static_assert(std::is_unsigned_v<Key>);
  constexpr unsigned digit_bits = 11;
  constexpr Key mask = (Key{1} << digit_bits) - Key{1};
  if (items.empty())
    return;
  std::vector<Item> sorted(items.size());
  for (unsigned shift = 0; shift < std::numeric_limits<Key>::digits; shift += digit_bits) {
    std::array<std::size_t, mask + 1> begin{};
    for (const Item& item : items)
      ++begin[item.key >> shift & mask];
    if (begin[items.front().key >> shift & mask] == items.size())
      continue;
    std::size_t sum = 0;
    for (std::size_t& count : begin)
      count = std::exchange(sum, sum + count);
    for (const Item& item : items)
      sorted[begin[item.key >> shift & mask]++] = item;
    items.swap(sorted);
  }
}

/// An item and the key that it is sorted by.
struct Place {
  std::uint64_t key;
  Index index;
};

/// The items 0 ... count - 1 in the order of their keys, key_of(i); ties by index.
template <typename KeyOf>
Indexed<Place> sortedPlaces(std::size_t count, int threads, const KeyOf& key_of) {
  Indexed<Place> places(count);
  forEachIndex(count, threads, {}, [&](Index i) { places[i] = {key_of(i), i}; });
  radixSort(places);
  return places;
}

}  // namespace spherical_param::internal
