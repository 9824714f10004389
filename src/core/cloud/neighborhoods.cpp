#include "neighborhoods.h"

#include "cloud_surfaces.h"
#include "local_delaunay_graph.h"
#include "progress.h"
#include "spherical_param/errors.h"

#include <algorithm>
#include <string>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Checks the answer of a caller's search: `count` lists of indices in [0, n).
void checkLists(const NeighborLists& lists, std::size_t count, std::size_t n) {
  if (lists.offsets.size() != count + 1 || lists.offsets.front() != 0 ||
      lists.offsets.back() != lists.indices.size() ||
      !std::is_sorted(lists.offsets.begin(), lists.offsets.end()))
    throw InvalidInput("reconstruct: the neighbour lists of the search do not fit " +
                       std::to_string(count) +
                       " points; give one more offset than points, ascending from 0 to the number "
                       "of indices");
  for (const Index j : lists.indices)
    if (j < 0 || static_cast<std::size_t>(j) >= n)
      throw InvalidInput("reconstruct: the search answers with neighbour " + std::to_string(j) +
                         " of " + std::to_string(n) + " points; indices must be in [0, n)");
}

/// The caller's search, in terms of nodes.
NeighborSearch searchOfCaller(const OrderedPoints& nodes, const Indexed<Index>& inputs,
                              const NeighborSearchFactory& search_of, const Execution& execution) {
  const auto in_cloud = [&](const std::vector<Index>& positions) {
    Indexed<Index> result(positions.size());
    std::transform(positions.begin(), positions.end(), result.begin(),
                   [&](Index position) { return inputs[position]; });
    return result;
  };
  const Indexed<Index> points = in_cloud(nodes.input_of_vertex);  // ascending
  const Indexed<Index> input_of_node = in_cloud(nodes.input_of_node);
  Indexed<Index> node_of_input(static_cast<std::size_t>(points.back()) + 1, -1);
  for (const Index node : indicesOf(input_of_node))
    node_of_input[input_of_node[node]] = node;
  return [search = search_of(points), input_of_node, node_of_input,
          report = reportOf(execution, "neighbors")](const std::vector<Index>& queries, int count) {
    // Number of points in one call of the search, between two reports of progress.
    constexpr std::size_t question = 4096;
    NeighborLists lists;
    for (std::size_t begin = 0; begin < queries.size(); begin += question) {
      reportFraction(report, static_cast<double>(begin) / static_cast<double>(queries.size()));
      std::vector<Index> asked;
      for (std::size_t q = begin; q < std::min(begin + question, queries.size()); ++q)
        asked.push_back(input_of_node[queries[q]]);
      const NeighborLists found = search(asked, count);
      checkLists(found, asked.size(), node_of_input.size());
      for (const Index i : indicesOf(asked)) {
        for (const Index input : listOf(found, i)) {
          if (node_of_input[input] < 0)
            throw InvalidInput("reconstruct: the search returned point " + std::to_string(input) +
                               ", which it was not given; return indices of its points");
          lists.indices.push_back(node_of_input[input]);
        }
        lists.offsets.push_back(lists.indices.size());
      }
    }
    return lists;
  };
}

}  // namespace

Neighborhoods::Neighborhoods(const Positions& cloud, const std::vector<Index>& inputs,
                             const Options& options, const NeighborSearchFactory& search_of,
                             const Execution& execution, std::optional<SearchedNodes> known)
    : inputs_(inputs.begin(), inputs.end()) {
  if (known)
    nodes_ = std::move(known->nodes);
  else if (inputs.size() == columnCount(cloud))
    nodes_ = orderCheckedPoints(cloud, execution.threads);
  else
    nodes_ = orderCheckedPoints(cloud(Eigen::all, inputs), execution.threads);
  if (search_of)
    neighbors_.search = searchOfCaller(nodes_, inputs_, search_of, execution);
  else if (known && known->search)
    neighbors_.search = std::move(known->search);
  else
    neighbors_.search = makeNeighborSearch(nodes_.points, execution);
  // The tangent Delaunay graph searches for up to 32 if 12 do not certify its cells.
  neighbors_.lists = neighbors_.search(firstIndices(nodes_.input_of_node.size()),
                                       options.method == Method::Paper ? options.paper.k : 12);
}

void Neighborhoods::findStars(const Execution& execution) {
  if (stars_.size() > 0)
    return;
  stars_ = internal::findStars(nodes_.points, neighbors_, execution);
  agreed_ =
      joinedAlongBoundaries(nodes_.points, agreedGraph(nodes_.points, stars_, execution), stars_);
}

void Neighborhoods::release() {
  neighbors_ = {};
  stars_ = {};
  agreed_ = {};
}

std::vector<Index> Neighborhoods::inputsOf(const Indexed<char>& marked) const {
  std::vector<Index> result;
  const Indexed<Index> nodes = nodesOfInput(nodes_);
  for (const Index i : indicesOf(nodes))
    if (marked[nodes[i]] != 0)
      result.push_back(inputs_[i]);
  return result;
}

std::vector<std::vector<Index>> Neighborhoods::groupInputs(const Indexed<Index>& group) const {
  Indexed<std::vector<Index>> groups(group.size());
  const Indexed<Index> nodes = nodesOfInput(nodes_);
  for (const Index i : indicesOf(nodes))
    if (const Index to = group[nodes[i]]; to >= 0)
      groups[to].push_back(inputs_[i]);
  groups.erase(std::remove_if(groups.begin(), groups.end(),
                              [](const std::vector<Index>& inputs) { return inputs.empty(); }),
               groups.end());
  std::sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
    return a.size() != b.size() ? a.size() > b.size() : a.front() < b.front();
  });
  return groups;
}

}  // namespace spherical_param::internal
