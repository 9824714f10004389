#include "neighbors.h"

#include "spherical_param/errors.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

namespace spherical_param::internal {
namespace {

/// The entries of a list that are in the subset, in its numbers: the nearest `count` and the node
/// itself, nearest first. Returns whether there are that many.
bool keptOf(const Positions& points, const Index* begin, const Index* end, Index node, int count,
            const NodeSubset& subset, std::vector<std::pair<double, Index>>& kept) {
  kept.clear();
  for (const Index* entry = begin; entry != end; ++entry) {
    const Index other = subset.new_of_old[slotOf(*entry)];
    if (other >= 0)
      kept.emplace_back((points.col(other) - points.col(node)).squaredNorm(), other);
  }
  std::sort(kept.begin(), kept.end());
  const auto most =
      static_cast<std::size_t>(count) + (!kept.empty() && kept.front().second == node ? 1U : 0U);
  if (kept.size() < most)
    return false;
  kept.resize(most);
  return true;
}

}  // namespace

Neighbors findNeighbors(NeighborSearch search, std::size_t n, int count) {
  std::vector<Index> all(n);
  std::iota(all.begin(), all.end(), Index{0});
  Neighbors result;
  result.lists = search(all, count);
  result.search = std::move(search);
  return result;
}

Neighbors neighborsOf(const Positions& points, const Neighbors& all, int count,
                      NodeSubset& subset) {
  const std::size_t m = subset.old_of_new.size();
  subset.has_lost.assign(m, 0);
  std::vector<Index> changed;
  for (std::size_t i = 0; i < m; ++i) {
    const std::size_t old = slotOf(subset.old_of_new[i]);
    for (std::size_t e = all.lists.offsets[old]; e < all.lists.offsets[old + 1]; ++e)
      if (subset.new_of_old[slotOf(all.lists.indices[e])] < 0)
        subset.has_lost[i] = 1;
    if (subset.has_lost[i] != 0)
      changed.push_back(static_cast<Index>(i));
  }
  Neighbors result;
  result.search = searchWithin(points, all.search, subset);
  const NeighborLists anew = changed.empty() ? NeighborLists() : result.search(changed, count);
  std::size_t next = 0;
  for (std::size_t i = 0; i < m; ++i) {
    std::vector<Index>& indices = result.lists.indices;
    if (subset.has_lost[i] != 0) {
      indices.insert(indices.end(),
                     anew.indices.begin() + static_cast<std::ptrdiff_t>(anew.offsets[next]),
                     anew.indices.begin() + static_cast<std::ptrdiff_t>(anew.offsets[next + 1]));
      ++next;
    } else {
      const std::size_t old = slotOf(subset.old_of_new[i]);
      for (std::size_t e = all.lists.offsets[old]; e < all.lists.offsets[old + 1]; ++e)
        indices.push_back(subset.new_of_old[slotOf(all.lists.indices[e])]);
    }
    result.lists.offsets.push_back(indices.size());
  }
  return result;
}

NeighborSearch searchWithin(const Positions& points, const NeighborSearch& search,
                            const NodeSubset& subset) {
  return [&points, &search, &subset](const std::vector<Index>& queries, int count) {
    std::vector<std::vector<Index>> lists(queries.size());
    std::vector<std::size_t> open(queries.size());  // places in `queries`
    std::iota(open.begin(), open.end(), std::size_t{0});
    const auto all = static_cast<int>(subset.new_of_old.size());
    std::vector<std::pair<double, Index>> kept;
    for (int asked = count; !open.empty(); asked = std::min(2 * asked, all)) {
      std::vector<Index> nodes;
      nodes.reserve(open.size());
      for (const std::size_t q : open)
        nodes.push_back(subset.old_of_new[slotOf(queries[q])]);
      const NeighborLists found = search(nodes, asked);
      std::vector<std::size_t> still_open;
      for (std::size_t i = 0; i < open.size(); ++i) {
        const Index* begin = found.indices.data() + found.offsets[i];
        const Index* end = found.indices.data() + found.offsets[i + 1];
        const Index node = queries[open[i]];
        const bool has_enough = keptOf(points, begin, end, node, count, subset, kept);
        if (!has_enough && asked < all && end - begin >= asked) {
          still_open.push_back(open[i]);
          continue;
        }
        for (const auto& entry : kept)
          lists[open[i]].push_back(entry.second);
      }
      open = std::move(still_open);
    }
    NeighborLists result;
    for (const std::vector<Index>& list : lists) {
      result.indices.insert(result.indices.end(), list.begin(), list.end());
      result.offsets.push_back(result.indices.size());
    }
    return result;
  };
}

void checkLists(const NeighborLists& lists, std::size_t count, std::size_t n) {
  if (lists.offsets.size() != count + 1 || lists.offsets.front() != 0 ||
      lists.offsets.back() != lists.indices.size() ||
      !std::is_sorted(lists.offsets.begin(), lists.offsets.end()))
    throw InvalidInput("reconstruct: the neighbour lists of the search do not fit " +
                       std::to_string(count) +
                       " points; give one more offset than points, ascending from 0 to the number "
                       "of indices");
  for (const Index j : lists.indices)
    if (j < 0 || slotOf(j) >= n)
      throw InvalidInput("reconstruct: the search answers with neighbour " + std::to_string(j) +
                         " of " + std::to_string(n) + " points; indices must be in [0, n)");
}

}  // namespace spherical_param::internal
