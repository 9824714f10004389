#pragma once

#include "graph.h"
#include "median.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Point spacing at a node: the median length of its edges, robust against long edges across an
/// opening; 0 without edges.
///
/// \param lengths working memory.
inline double nodeSpacing(const Graph& graph, std::size_t node, std::vector<double>& lengths) {
  lengths.assign(graph.lengths.begin() + static_cast<std::ptrdiff_t>(graph.offsets[node]),
                 graph.lengths.begin() + static_cast<std::ptrdiff_t>(graph.offsets[node + 1]));
  if (lengths.empty())
    return 0.0;
  return medianOf(lengths);
}

}  // namespace spherical_param::internal
