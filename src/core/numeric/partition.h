#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// The nodes of each part of a partition, ascending, one part after the other.
class Partition {
public:
  /// \param part  n entries, the part of each node, in [0, count).
  Partition(const std::vector<Index>& part, std::size_t count) : begin_(count + 1, 0) {
    for (const Index p : part)
      ++begin_[static_cast<std::size_t>(p) + 1];
    for (std::size_t p = 0; p < count; ++p)
      begin_[p + 1] += begin_[p];
    nodes_.resize(part.size());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < part.size(); ++i)
      nodes_[next[static_cast<std::size_t>(part[i])]++] = static_cast<Index>(i);
  }

  std::size_t count(Index part) const {
    const auto p = static_cast<std::size_t>(part);
    return begin_[p + 1] - begin_[p];
  }

  template <typename Visit>
  void forEach(Index part, const Visit& visit) const {
    const auto p = static_cast<std::size_t>(part);
    for (std::size_t k = begin_[p]; k < begin_[p + 1]; ++k)
      visit(nodes_[k]);
  }

private:
  std::vector<std::size_t> begin_;
  std::vector<Index> nodes_;
};

}  // namespace spherical_param::internal
