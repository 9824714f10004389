#pragma once

#include "rows.h"

#include <cstddef>

namespace spherical_param::internal {

/// The size of a list, which is the index of its next entry.
template <typename List>
Index indexCount(const List& list) {
  return static_cast<Index>(list.size());
}

/// Entry i of a list with std::size_t indices, as the public headers have them.
template <typename List>
auto& entry(List& list, Eigen::Index i) {
  return list[static_cast<std::size_t>(i)];
}

/// Calls work(i) for each i in [0, count), on several threads where that pays.
///
/// \param cost of an item, in passes over a neighbourhood.
template <typename Work>
void forEachIndex(std::size_t count, int threads, const Work& work, std::size_t cost = 1) {
  forEachIndex(count, threadCount(threads, count * cost), {}, work);
}

/// The sum of term(i) over i in [0, count); the same bits for any number of threads.
template <typename Value, typename Term>
Value sumOfIndices(std::size_t count, int threads, const Value& zero, const Term& term) {
  return accumulate(count, threadCount(threads, count), zero,
                    [&](Index i, Value& sum) { sum += term(i); });
}

}  // namespace spherical_param::internal
