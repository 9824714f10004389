#include "graph_building.h"

#include "component_tree.h"
#include "partition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace spherical_param::internal {
namespace {

Bridge bridgeOf(const Positions& points, const ComponentTree::Pair& pair) {
  return {pair.from, pair.to, edgeLength(points, pair.from, pair.to)};
}

/// Appends up to `count` bridges for each joint; tree and partition know the components.
void appendFurther(const Positions& points, const ComponentTree& tree,
                   const std::vector<Index>& part, const Partition& partition,
                   const std::vector<Bridge>& joints, int count, std::vector<Bridge>& bridges) {
  std::vector<Index> taken;
  for (const Bridge& joint : joints) {
    // The joints are a tree of the components: from the smaller ends no point asks too often.
    Index smaller = part[static_cast<std::size_t>(joint.from)];
    Index other = part[static_cast<std::size_t>(joint.to)];
    if (partition.count(other) < partition.count(smaller))
      std::swap(smaller, other);
    taken = {joint.from, joint.to};
    for (int k = 0; k < count; ++k) {
      ComponentTree::Pair closest;
      partition.forEach(smaller, [&](Index i) {
        if (std::find(taken.begin(), taken.end(), i) == taken.end())
          tree.nearestIn(other, i, taken, closest);
      });
      if (closest.from < 0)
        break;
      bridges.push_back(bridgeOf(points, closest));
      taken.insert(taken.end(), {closest.from, closest.to});
    }
  }
}

/// A depth-first search of a connected graph from node 0, and the parts below which it finds no
/// edge past their parent (Hopcroft and Tarjan 1973).
class SearchTree {
public:
  explicit SearchTree(const Graph& graph)
      : rank_(graph.size(), -1), parent_(graph.size(), -1), size_(graph.size(), 1) {
    const std::size_t n = graph.size();
    order_.reserve(n);
    std::vector<Index> reach(n);         // lowest rank that the nodes below have an edge to
    std::vector<char> holds_part(n, 0);  // whether there is a part among the nodes below
    std::vector<Index> parts_of_root;
    Index children_of_root = 0;
    std::vector<std::size_t> next(graph.offsets.begin(), graph.offsets.end() - 1);
    const auto enter = [&](Index node, Index parent) {
      const auto i = static_cast<std::size_t>(node);
      rank_[i] = reach[i] = static_cast<Index>(order_.size());
      parent_[i] = parent;
      order_.push_back(node);
      return node;
    };
    Index current = n > 0 ? enter(0, -1) : -1;
    while (current >= 0) {
      const auto i = static_cast<std::size_t>(current);
      if (next[i] < graph.offsets[i + 1]) {
        const Index neighbor = graph.neighbors[next[i]++];
        const Index seen = rank_[static_cast<std::size_t>(neighbor)];
        if (seen < 0)
          current = enter(neighbor, current);
        else
          reach[i] = std::min(reach[i], seen);
        continue;
      }
      const Index parent = parent_[i];
      if (parent >= 0) {
        const auto above = static_cast<std::size_t>(parent);
        const bool is_part = reach[i] >= rank_[above];
        if (is_part && holds_part[i] == 0)
          (above == 0 ? parts_of_root : parts_).push_back(current);
        if (is_part || holds_part[i] != 0)
          holds_part[above] = 1;
        children_of_root += above == 0 ? 1 : 0;
        size_[above] += size_[i];
        reach[above] = std::min(reach[above], reach[i]);
      }
      current = parent;
    }
    // All that the root has is below its only child.
    if (children_of_root > 1)
      parts_.insert(parts_.end(), parts_of_root.begin(), parts_of_root.end());
  }

  /// Nodes below which is all of a part, without a part among them: only their parent joins them to
  /// the others. There are some if a node alone joins two parts of the graph.
  const std::vector<Index>& parts() const { return parts_; }

  Index parent(Index node) const { return parent_[static_cast<std::size_t>(node)]; }
  /// The node and all below are those with the ranks rank(node) ... rank(node) + size(node) - 1.
  Index rank(Index node) const { return rank_[static_cast<std::size_t>(node)]; }
  Index size(Index node) const { return size_[static_cast<std::size_t>(node)]; }
  Index atRank(Index rank) const { return order_[static_cast<std::size_t>(rank)]; }

private:
  std::vector<Index> rank_;
  std::vector<Index> parent_;
  std::vector<Index> size_;
  std::vector<Index> order_;
  std::vector<Index> parts_;
};

}  // namespace

double edgeLength(const Positions& points, Index i, Index j) {
  const Eigen::Vector3d edge = points.col(i) - points.col(j);
  const double squared = edge.squaredNorm();
  constexpr double safe = 1e-280;
  const double length = squared > safe ? std::sqrt(squared) : edge.stableNorm();
  return std::max(length, std::numeric_limits<double>::min());
}

UnionFind connectedComponents(const Graph& graph) {
  UnionFind parts(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      if (graph.neighbors[e] > static_cast<Index>(i))  // each edge is stored at both ends
        parts.unite(static_cast<Index>(i), graph.neighbors[e]);
  return parts;
}

std::vector<Index> representatives(UnionFind& sets, std::size_t n) {
  std::vector<Index> result(n);
  for (std::size_t i = 0; i < n; ++i)
    result[i] = sets.find(static_cast<Index>(i));
  return result;
}

Index countSets(const std::vector<Index>& representative) {
  Index count = 0;
  for (std::size_t i = 0; i < representative.size(); ++i)
    count += representative[i] == static_cast<Index>(i) ? 1 : 0;
  return count;
}

std::vector<std::size_t> setSizes(const std::vector<Index>& representative) {
  std::vector<std::size_t> sizes(representative.size(), 0);
  for (const Index set : representative)
    ++sizes[static_cast<std::size_t>(set)];
  return sizes;
}

std::vector<Bridge> shortestBridges(const Positions& points, UnionFind& parts,
                                    int bridges_per_joint) {
  const auto n = static_cast<std::size_t>(points.cols());
  std::vector<Bridge> bridges;
  std::vector<Index> part = representatives(parts, n);
  Index component_count = countSets(part);
  ComponentTree tree(points);
  while (component_count > 1) {
    const Partition partition(part, n);
    Index largest = 0;
    for (Index component = 1; component < static_cast<Index>(n); ++component)
      if (partition.count(component) > partition.count(largest))
        largest = component;
    tree.setComponents(part);

    std::vector<ComponentTree::Pair> shortest(n);
    for (std::size_t i = 0; i < n; ++i)
      if (part[i] != largest)
        tree.nearestOther(static_cast<Index>(i), {}, shortest[static_cast<std::size_t>(part[i])]);
    std::sort(shortest.begin(), shortest.end());
    std::vector<Bridge> joints;
    for (const ComponentTree::Pair& pair : shortest) {
      if (pair.from < 0)
        break;  // the parts without a pair sort last
      if (parts.unite(pair.from, pair.to))
        joints.push_back(bridgeOf(points, pair));
    }
    bridges.insert(bridges.end(), joints.begin(), joints.end());
    appendFurther(points, tree, part, partition, joints, bridges_per_joint - 1, bridges);
    component_count -= static_cast<Index>(joints.size());
    part = representatives(parts, n);
  }
  return bridges;
}

std::vector<Bridge> furtherBridges(const Positions& points, const std::vector<Index>& part,
                                   const std::vector<Bridge>& joints, int count) {
  std::vector<Bridge> bridges;
  if (joints.empty())
    return bridges;
  ComponentTree tree(points);
  tree.setComponents(part);
  appendFurther(points, tree, part, Partition(part, part.size()), joints, count, bridges);
  return bridges;
}

std::vector<Bridge> articulationBridges(const Positions& points, const Graph& graph, int count) {
  std::vector<Bridge> bridges;
  const SearchTree search(graph);
  if (search.parts().empty())
    return bridges;
  const auto n = static_cast<Index>(graph.size());
  std::vector<Index> part(graph.size(), n);  // no part has this number
  for (const Index top : search.parts())
    for (Index rank = search.rank(top); rank < search.rank(top) + search.size(top); ++rank)
      part[static_cast<std::size_t>(search.atRank(rank))] = top;
  ComponentTree tree(points);
  tree.setComponents(part);

  std::vector<Index> taken;
  for (const Index top : search.parts()) {
    const Index begin = search.rank(top);
    const Index end = begin + search.size(top);
    taken = {search.parent(top)};
    for (int k = 0; k < count; ++k) {
      ComponentTree::Pair closest;
      const auto query = [&](Index from_rank, Index to_rank, bool inside) {
        for (Index rank = from_rank; rank < to_rank; ++rank) {
          const Index i = search.atRank(rank);
          if (std::find(taken.begin(), taken.end(), i) != taken.end())
            continue;
          if (inside)
            tree.nearestOther(i, taken, closest);
          else
            tree.nearestIn(top, i, taken, closest);
        }
      };
      // From the smaller side: the search may have begun in the part that dangles.
      if (end - begin <= n / 2) {
        query(begin, end, true);
      } else {
        query(0, begin, false);
        query(end, n, false);
      }
      if (closest.from < 0)
        break;
      bridges.push_back(bridgeOf(points, closest));
      taken.insert(taken.end(), {closest.from, closest.to});
    }
  }
  return bridges;
}

Graph withEdges(const Graph& graph, const std::vector<Bridge>& edges) {
  std::vector<std::tuple<Index, Index, double>> entries;
  entries.reserve(2 * edges.size());
  for (const Bridge& edge : edges) {
    entries.emplace_back(edge.from, edge.to, edge.length);
    entries.emplace_back(edge.to, edge.from, edge.length);
  }
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  Graph result;
  result.offsets.reserve(graph.offsets.size());
  result.neighbors.reserve(graph.neighbors.size() + entries.size());
  result.lengths.reserve(graph.neighbors.size() + entries.size());
  auto entry = entries.begin();
  const auto add_entry = [&] {
    result.neighbors.push_back(std::get<1>(*entry));
    result.lengths.push_back(std::get<2>(*entry));
    ++entry;
  };
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const auto in_row = [&] {
      return entry != entries.end() && static_cast<std::size_t>(std::get<0>(*entry)) == i;
    };
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      while (in_row() && std::get<1>(*entry) < graph.neighbors[e])
        add_entry();
      if (in_row() && std::get<1>(*entry) == graph.neighbors[e])
        ++entry;
      result.neighbors.push_back(graph.neighbors[e]);
      result.lengths.push_back(graph.lengths[e]);
    }
    while (in_row())
      add_entry();
    result.offsets.push_back(result.neighbors.size());
  }
  return result;
}

}  // namespace spherical_param::internal
