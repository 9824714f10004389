#include "neighborhoods.h"

#include "local_delaunay_graph.h"
#include "neighbor_search.h"
#include "progress.h"
#include "spherical_param/errors.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

namespace spherical_param::internal {
namespace {

OrderedPoints orderInputs(const Positions& cloud, const std::vector<Index>& inputs, int threads) {
  return static_cast<Eigen::Index>(inputs.size()) == cloud.cols()
             ? orderCheckedPoints(cloud, threads)
             : orderCheckedPoints(cloud(Eigen::all, inputs), threads);
}

/// Points that a caller's search is asked for at once: between two questions progress is reported.
constexpr std::size_t kQuestion = 4096;

/// The caller's search, in the numbers of nodes.
NeighborSearch searchOfCaller(const OrderedPoints& nodes, const std::vector<Index>& inputs,
                              const NeighborSearchFactory& search_of, const Execution& execution) {
  std::vector<Index> points;  // the first at each position, ascending
  points.reserve(nodes.input_of_node.size());
  for (const Index input : nodes.distinct.input_of_vertex)
    points.push_back(inputs[slotOf(input)]);
  std::vector<Index> input_of_node(nodes.input_of_node.size());
  std::transform(nodes.input_of_node.begin(), nodes.input_of_node.end(), input_of_node.begin(),
                 [&](Index input) { return inputs[slotOf(input)]; });
  const std::size_t last = points.empty() ? 0 : slotOf(points.back()) + 1;
  std::vector<Index> node_of_input(last, -1);
  for (std::size_t node = 0; node < input_of_node.size(); ++node)
    node_of_input[slotOf(input_of_node[node])] = static_cast<Index>(node);
  return [search = search_of(points), input_of_node = std::move(input_of_node),
          node_of_input = std::move(node_of_input),
          report = reportOf(execution, "neighbors")](const std::vector<Index>& queries, int count) {
    NeighborLists lists;
    for (std::size_t begin = 0; begin < queries.size(); begin += kQuestion) {
      reportFraction(report, static_cast<double>(begin) / static_cast<double>(queries.size()));
      std::vector<Index> asked;
      for (std::size_t q = begin; q < std::min(begin + kQuestion, queries.size()); ++q)
        asked.push_back(input_of_node[slotOf(queries[q])]);
      const NeighborLists found = search(asked, count);
      checkLists(found, asked.size(), node_of_input.size());
      for (std::size_t i = 0; i < asked.size(); ++i) {
        for (std::size_t e = found.offsets[i]; e < found.offsets[i + 1]; ++e) {
          const Index node = node_of_input[slotOf(found.indices[e])];
          if (node < 0)
            throw InvalidInput("reconstruct: the search returned point " +
                               std::to_string(found.indices[e]) +
                               ", which it was not given; return indices of its points");
          lists.indices.push_back(node);
        }
        lists.offsets.push_back(lists.indices.size());
      }
    }
    return lists;
  };
}

/// Which nodes of a cloud those of some of its points are.
NodeSubset subsetOf(const OrderedPoints& all, const std::vector<Index>& all_inputs,
                    const OrderedPoints& some, const std::vector<Index>& inputs) {
  const std::vector<Index> node_of_all = nodesOfInput(all);
  NodeSubset subset;
  subset.new_of_old.assign(all.input_of_node.size(), -1);
  subset.old_of_new.reserve(some.input_of_node.size());
  for (const Index first : some.input_of_node) {
    const auto place =
        std::lower_bound(all_inputs.begin(), all_inputs.end(), inputs[slotOf(first)]);
    const Index old = node_of_all[static_cast<std::size_t>(place - all_inputs.begin())];
    subset.new_of_old[slotOf(old)] = static_cast<Index>(subset.old_of_new.size());
    subset.old_of_new.push_back(old);
  }
  return subset;
}

/// Number of nearest neighbours of each point to search for. The tangent Delaunay graph searches
/// for up to 32 where these do not certify its cells.
int neighborsToSearch(const Options& options) {
  constexpr int of_delaunay_graph = 12;
  return options.method == Method::Paper ? options.paper.k : of_delaunay_graph;
}

}  // namespace

Neighborhoods::Neighborhoods(const Positions& cloud, std::vector<Index> inputs,
                             const Options& options, const NeighborSearchFactory& search_of,
                             const Execution& execution)
    : inputs_(std::move(inputs)), nodes_(orderInputs(cloud, inputs_, execution.threads)) {
  neighbors_ = findNeighbors(search_of ? searchOfCaller(nodes_, inputs_, search_of, execution)
                                       : makeNeighborSearch(nodes_.points, execution),
                             nodes_.input_of_node.size(), neighborsToSearch(options));
}

Neighborhoods::Neighborhoods(const Positions& cloud, std::vector<Index> inputs,
                             const Options& options, const Neighborhoods& all,
                             const Execution& execution)
    : inputs_(std::move(inputs)), nodes_(orderInputs(cloud, inputs_, execution.threads)),
      all_(&all), subset_(subsetOf(all.nodes_, all.inputs_, nodes_, inputs_)) {
  neighbors_ = neighborsOf(nodes_.points, all.neighbors_, neighborsToSearch(options), subset_);
}

void Neighborhoods::findStars(const Execution& execution) {
  if (stars_.size() > 0)
    return;
  stars_ = all_ != nullptr && all_->stars_.size() > 0
               ? internal::findStars(nodes_.points, neighbors_, all_->stars_, subset_, execution)
               : internal::findStars(nodes_.points, neighbors_, execution);
  agreed_ = agreedGraph(nodes_.points, stars_, execution);
}

void Neighborhoods::release() {
  neighbors_ = {};
  stars_ = Stars();
  agreed_ = {};
  subset_ = {};
}

std::vector<Index> Neighborhoods::inputsOf(const std::vector<char>& marked) const {
  std::vector<Index> result;
  const std::vector<Index> node_of_input = nodesOfInput(nodes_);
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (marked[slotOf(node_of_input[i])] != 0)
      result.push_back(inputs_[i]);
  return result;
}

std::vector<std::vector<Index>> Neighborhoods::groupInputs(const std::vector<Index>& group) const {
  std::vector<std::vector<Index>> groups(group.size());
  const std::vector<Index> node_of_input = nodesOfInput(nodes_);
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const Index of = group[slotOf(node_of_input[i])];
    if (of >= 0)
      groups[slotOf(of)].push_back(inputs_[i]);
  }
  groups.erase(std::remove_if(groups.begin(), groups.end(),
                              [](const std::vector<Index>& inputs) { return inputs.empty(); }),
               groups.end());
  std::sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
    return a.size() != b.size() ? a.size() > b.size() : a.front() < b.front();
  });
  return groups;
}

}  // namespace spherical_param::internal
