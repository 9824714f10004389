#pragma once

#include "indexed.h"
#include "parallel.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace spherical_param::internal {

/// The numbers of [first, last), for a loop.
template <typename Number>
class NumberRange {
public:
  struct Iterator {
    Number number;
    Number operator*() const { return number; }
    void operator++() { ++number; }
    bool operator!=(const Iterator& other) const { return number != other.number; }
  };

  NumberRange(Number first, Number last) : begin_{first}, end_{last} {}
  Iterator begin() const { return begin_; }
  Iterator end() const { return end_; }

private:
  Iterator begin_, end_;
};

/// Consecutive entries of an array.
template <typename T>
class Row {
public:
  Row(const T* begin, const T* end) : begin_(begin), end_(end) {}

  const T* begin() const { return begin_; }
  const T* end() const { return end_; }
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  /// The first `count` entries, or all if there are fewer.
  Row first(std::size_t count) const { return {begin_, begin_ + std::min(count, size())}; }
  bool contains(const T& value) const { return std::find(begin_, end_, value) != end_; }

private:
  const T* begin_;
  const T* end_;
};

/// The neighbours of the nodes 0 ... n - 1, in compressed rows.
struct NeighborRows {
  std::vector<std::size_t> offsets{0};  ///< n + 1 positions in `neighbors`
  std::vector<Index> neighbors;

  /// Number of nodes. \return n
  std::size_t size() const { return offsets.size() - 1; }
  NumberRange<Index> nodes() const { return {0, static_cast<Index>(size())}; }
  /// Positions of the row of a node in `neighbors`.
  NumberRange<std::size_t> entries(Index node) const { return {begin(node), end(node)}; }
  std::size_t begin(Index node) const { return offsets[static_cast<std::size_t>(node)]; }
  std::size_t end(Index node) const { return offsets[static_cast<std::size_t>(node) + 1]; }
  Row<Index> row(Index node) const {
    return {neighbors.data() + begin(node), neighbors.data() + end(node)};
  }
  /// Ends a row: the next node has the neighbours appended since the last call.
  void endRow() { offsets.push_back(neighbors.size()); }
};

/// The nodes of each part of a partition, ascending: row p has those of part p.
///
/// \param part the part of each node, in [0, count).
inline NeighborRows nodesOfParts(const std::vector<Index>& part, std::size_t count) {
  NeighborRows rows;
  Indexed<std::size_t> next(count + 1, 0);
  for (const Index p : part)
    ++next[p + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  rows.offsets.assign(next.begin(), next.end());
  rows.neighbors.resize(part.size());
  Index node = 0;
  for (const Index p : part)
    rows.neighbors[next[p]++] = node++;
  return rows;
}

/// List i of some neighbour lists.
inline Row<Index> listOf(const NeighborLists& lists, Index i) {
  const auto place = static_cast<std::size_t>(i);
  return {lists.indices.data() + lists.offsets[place],
          lists.indices.data() + lists.offsets[place + 1]};
}

/// The indices of an array.
template <typename Array>
NumberRange<Index> indicesOf(const Array& array) {
  return {0, static_cast<Index>(array.size())};
}

}  // namespace spherical_param::internal
