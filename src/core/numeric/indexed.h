#pragma once

#include "spherical_param/types.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace spherical_param::internal {

/// A fraction of a number of items, rounded down.
inline std::size_t fractionOf(double fraction, std::size_t count) {
  return static_cast<std::size_t>(fraction * static_cast<double>(count));
}

/// A vector with an entry for each vertex or triangle, which Index numbers.
template <typename T>
class Indexed : public std::vector<T> {
public:
  using std::vector<T>::vector;

  /// \param i an Index, or any other integer.
  template <typename Integer>
  T& operator[](Integer i) {
    return std::vector<T>::operator[](static_cast<std::size_t>(i));
  }
  template <typename Integer>
  const T& operator[](Integer i) const {
    return std::vector<T>::operator[](static_cast<std::size_t>(i));
  }
  /// Number of entries.
  Index count() const { return static_cast<Index>(this->size()); }
};

/// Number of columns of a matrix, as the size of a list with an entry for each.
template <typename Matrix>
std::size_t columnCount(const Matrix& matrix) {
  return static_cast<std::size_t>(matrix.cols());
}

/// The numbers 0 ... n - 1.
inline Indexed<Index> firstIndices(std::size_t n) {
  Indexed<Index> indices(n);
  std::iota(indices.begin(), indices.end(), Index{0});
  return indices;
}

/// Sorts values and removes repetitions.
template <typename T>
void sortUnique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Removes the longest list; of several the first.
///
/// \param lists not empty.
template <typename T>
std::vector<std::vector<T>> withoutLargest(std::vector<std::vector<T>> lists) {
  lists.erase(std::max_element(lists.begin(), lists.end(),
                               [](const auto& a, const auto& b) { return a.size() < b.size(); }));
  return lists;
}

/// The median; the upper one of two. Changes the order of the values.
///
/// \param values not empty.
inline double medianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A set of vertices or triangles that is cleared in constant time.
class IndexSet {
public:
  explicit IndexSet(std::size_t size) : stamps_(size, 0) {}

  void clear() { ++stamp_; }
  bool contains(Index i) const { return stamps_[i] == stamp_; }
  /// Returns whether it was not in the set.
  bool insert(Index i) {
    const bool is_new = !contains(i);
    stamps_[i] = stamp_;
    return is_new;
  }

private:
  Indexed<std::uint32_t> stamps_;  ///< equal to stamp_: in the set
  std::uint32_t stamp_ = 1;
};

}  // namespace spherical_param::internal
