#include "caller_neighbors.h"

#include "neighbor_lists.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Neighbour lists between nodes; a node has the entries of all its input points.
NeighborLists listsOfNodes(const NeighborLists& lists, const std::vector<Index>& node_of_input,
                           std::size_t node_count) {
  const std::size_t n = node_of_input.size();
  NeighborLists result;
  result.offsets.assign(node_count + 1, 0);
  result.indices.resize(lists.indices.size());
  const auto count = [&](std::size_t i) { return lists.offsets[i + 1] - lists.offsets[i]; };
  for (std::size_t i = 0; i < n; ++i)
    result.offsets[static_cast<std::size_t>(node_of_input[i]) + 1] += count(i);
  for (std::size_t i = 0; i < node_count; ++i)
    result.offsets[i + 1] += result.offsets[i];
  std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e)
      result.indices[next[static_cast<std::size_t>(node_of_input[i])]++] =
          node_of_input[static_cast<std::size_t>(lists.indices[e])];
  return result;
}

}  // namespace

Neighbors nearestNeighbors(const OrderedPoints& nodes, int count, const Execution& execution) {
  std::vector<Index> all(nodes.input_of_node.size());
  std::iota(all.begin(), all.end(), Index{0});
  Neighbors result;
  result.search = makeNeighborSearch(nodes.points, execution);
  result.lists = result.search(all, count);
  return result;
}

Neighbors callerNeighbors(const OrderedPoints& nodes, const NeighborLists& lists,
                          const NeighborSearch& search) {
  std::vector<Index> node_of_input = nodesOfInput(nodes);
  checkNeighborLists("reconstruct", lists, node_of_input.size());
  Neighbors result;
  result.lists = listsOfNodes(lists, node_of_input, nodes.input_of_node.size());
  if (search)
    result.search = [&search, &nodes, node_of_input = std::move(node_of_input)](
                        const std::vector<Index>& queries, int count) {
      std::vector<Index> inputs(queries.size());
      std::transform(queries.begin(), queries.end(), inputs.begin(), [&](Index query) {
        return nodes.input_of_node[static_cast<std::size_t>(query)];
      });
      NeighborLists found = search(inputs, count);
      checkIndices("reconstruct: the answer of the search", found, queries.size(),
                   node_of_input.size());
      for (Index& neighbor : found.indices)
        neighbor = node_of_input[static_cast<std::size_t>(neighbor)];
      return found;
    };
  return result;
}

}  // namespace spherical_param::internal
