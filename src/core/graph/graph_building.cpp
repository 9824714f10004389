#include "graph_building.h"

#include "component_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace spherical_param::internal {
namespace {

Bridge bridgeOf(const Positions& points, const ComponentTree::Pair& pair) {
  return {pair.from, pair.to, edgeLength(points, pair.from, pair.to)};
}

/// Appends up to `count` bridges, the shortest first, with different ends.
///
/// \param from  nodes that a bridge may begin at.
/// \param to    component of the tree that it leads to.
/// \param taken nodes that are no ends.
template <typename Nodes>
void appendClosest(const Positions& points, const ComponentTree& tree, const Nodes& from, Index to,
                   std::vector<Index> taken, int count, std::vector<Bridge>& bridges) {
  for (int k = 0; k < count; ++k) {
    ComponentTree::Pair closest;
    for (const Index i : from)
      if (std::find(taken.begin(), taken.end(), i) == taken.end())
        tree.findNearest(i, taken, closest, to);
    if (closest.from < 0)
      break;
    bridges.push_back(bridgeOf(points, closest));
    taken.insert(taken.end(), {closest.from, closest.to});
  }
}

/// A depth-first search of a connected graph from node 0, and the leaves of its block-cut tree
/// (Hopcroft and Tarjan 1973).
struct SearchTree {
  explicit SearchTree(const Graph& graph);

  Indexed<Index> rank;
  Indexed<Index> parent;
  Indexed<Index> size;   ///< number of nodes below each, with itself: their ranks follow its own
  Indexed<Index> order;  ///< the node of each rank
  /// The top node of each part: only its parent joins the nodes below it to the others, and they
  /// contain no other such part.
  std::vector<Index> parts;
};

SearchTree::SearchTree(const Graph& graph)
    : rank(graph.size(), -1), parent(graph.size(), -1), size(graph.size(), 1) {
  order.reserve(graph.size());
  Indexed<Index> reach(graph.size());  // lowest rank that an edge from the nodes below reaches
  Indexed<char> holds_part(graph.size(), 0);  // whether the nodes below contain a part
  std::vector<Index> parts_of_root;
  Index children_of_root = 0;
  Indexed<std::size_t> next(graph.offsets.begin(), graph.offsets.end() - 1);
  const auto enter = [&](Index node, Index from) {
    rank[node] = reach[node] = static_cast<Index>(order.size());
    parent[node] = from;
    order.push_back(node);
    return node;
  };
  Index current = graph.size() > 0 ? enter(0, -1) : -1;
  while (current >= 0) {
    if (next[current] < graph.end(current)) {
      const Index neighbor = graph.neighbors[next[current]++];
      if (rank[neighbor] < 0)
        current = enter(neighbor, current);
      else
        reach[current] = std::min(reach[current], rank[neighbor]);
      continue;
    }
    const Index above = parent[current];
    if (above >= 0) {
      const bool is_part = reach[current] >= rank[above];
      if (is_part && holds_part[current] == 0)
        (above == 0 ? parts_of_root : parts).push_back(current);
      if (is_part || holds_part[current] != 0)
        holds_part[above] = 1;
      children_of_root += above == 0 ? 1 : 0;
      size[above] += size[current];
      reach[above] = std::min(reach[above], reach[current]);
    }
    current = above;
  }
  // With one child, the root is no articulation point.
  if (children_of_root > 1)
    parts.insert(parts.end(), parts_of_root.begin(), parts_of_root.end());
}

}  // namespace

double edgeLength(const Positions& points, Index i, Index j) {
  const Eigen::Vector3d edge = points.col(i) - points.col(j);
  const double squared = edge.squaredNorm();
  constexpr double safe = 1e-280;
  const double length = squared > safe ? std::sqrt(squared) : edge.stableNorm();
  return std::max(length, std::numeric_limits<double>::min());
}

double nodeSpacing(const Graph& graph, Index node) {
  const Row<double> row = graph.lengthsOf(node);
  std::vector<double> lengths(row.begin(), row.end());
  return lengths.empty() ? 0.0 : medianOf(lengths);
}

UnionFind connectedComponents(const NeighborRows& graph) {
  UnionFind parts(graph.size());
  for (const Index i : graph.nodes())
    for (const Index j : graph.row(i))
      if (j > i)  // each edge is stored at both ends
        parts.unite(i, j);
  return parts;
}

std::vector<Bridge> shortestBridges(const Positions& points, UnionFind& parts,
                                    int bridges_per_joint) {
  std::vector<Bridge> bridges;
  for (;;) {
    const Partition partition(parts);
    const Indexed<Index>& part = partition.of;
    const Indexed<std::size_t>& sizes = partition.sizes;
    const auto most = std::max_element(sizes.begin(), sizes.end());
    if (*most == sizes.size())
      return bridges;
    const auto largest = static_cast<Index>(most - sizes.begin());
    ComponentTree tree(points);
    tree.setComponents(part);
    const NeighborRows nodes = nodesOfParts(part, part.size());

    Indexed<ComponentTree::Pair> shortest(part.size());
    for (const Index i : indicesOf(part))
      if (part[i] != largest)
        tree.findNearest(i, {}, shortest[part[i]]);
    std::sort(shortest.begin(), shortest.end());
    std::vector<Bridge> joints;
    for (const ComponentTree::Pair& pair : shortest) {
      if (pair.from < 0)
        break;  // the parts without a pair sort last
      if (parts.unite(pair.from, pair.to))
        joints.push_back(bridgeOf(points, pair));
    }
    bridges.insert(bridges.end(), joints.begin(), joints.end());
    for (const Bridge& joint : joints) {
      // From the smaller end, so that no point is asked too often: the joints are a tree.
      const auto [smaller, other] =
          std::minmax({part[joint.from], part[joint.to]},
                      [&](Index a, Index b) { return sizes[a] < sizes[b]; });
      appendClosest(points, tree, nodes.row(smaller), other, {joint.from, joint.to},
                    bridges_per_joint - 1, bridges);
    }
  }
}

std::vector<Bridge> articulationBridges(const Positions& points, const Graph& graph, int count) {
  std::vector<Bridge> bridges;
  const SearchTree search(graph);
  if (search.parts.empty())
    return bridges;
  const auto n = static_cast<Index>(graph.size());
  Indexed<Index> part(graph.size(), n);  // no part has this number
  for (const Index top : search.parts)
    for (Index rank = search.rank[top]; rank < search.rank[top] + search.size[top]; ++rank)
      part[search.order[rank]] = top;
  ComponentTree tree(points);
  tree.setComponents(part);
  for (const Index top : search.parts) {
    const auto begin = search.order.begin() + search.rank[top];
    const auto end = begin + search.size[top];
    // From the smaller side.
    const bool from_inside = search.size[top] <= n / 2;
    std::vector<Index> from(from_inside ? begin : search.order.begin(), from_inside ? end : begin);
    if (!from_inside)
      from.insert(from.end(), end, search.order.end());
    appendClosest(points, tree, from, from_inside ? ComponentTree::kAnyOther : top,
                  {search.parent[top]}, count, bridges);
  }
  return bridges;
}

Graph withEdges(const Graph& graph, const std::vector<Bridge>& edges, std::size_t nodes) {
  std::vector<Bridge> added;  // both ways
  added.reserve(2 * edges.size());
  for (const Bridge& edge : edges) {
    added.push_back(edge);
    added.push_back({edge.to, edge.from, edge.length});
  }
  std::sort(added.begin(), added.end(), [](const Bridge& a, const Bridge& b) {
    return std::tuple(a.from, a.to, a.length) < std::tuple(b.from, b.to, b.length);
  });
  nodes = std::max(nodes, graph.size());
  Graph result;
  result.offsets.reserve(nodes + 1);
  result.neighbors.reserve(graph.neighbors.size() + added.size());
  result.lengths.reserve(graph.neighbors.size() + added.size());
  auto next = added.begin();
  for (const Index i : NumberRange(Index{0}, static_cast<Index>(nodes))) {
    const auto add = [&](Index neighbor, double length) {
      if (result.neighbors.size() > result.offsets.back() && result.neighbors.back() == neighbor)
        return;
      result.neighbors.push_back(neighbor);
      result.lengths.push_back(length);
    };
    const auto add_below = [&](Index end) {
      for (; next != added.end() && next->from == i && next->to < end; ++next)
        add(next->to, next->length);
    };
    if (i < static_cast<Index>(graph.size()))
      for (const std::size_t e : graph.entries(i)) {
        add_below(graph.neighbors[e]);
        add(graph.neighbors[e], graph.lengths[e]);
      }
    add_below(std::numeric_limits<Index>::max());
    result.endRow();
  }
  return result;
}

}  // namespace spherical_param::internal
