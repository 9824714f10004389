#include "bench_data.h"

#include "spherical_param/neighbor_graph.h"

namespace spherical_param::stages {
namespace {

void localDelaunay(benchmark::State& state) {
  Data& data = dataOf(state);
  const NeighborLists& lists = data.lists();
  LocalDelaunayOptions options;
  options.threads = threadsOf(state);
  options.search = data.finder().search(options.threads);
  NeighborGraph graph;
  for (auto _ : state)
    graph = buildLocalDelaunayGraph(data.points(), lists, options);
  countPoints(state);
  setCounter(state, "edges", graph.graph.edgeCount());
  setCounter(state, "searched_again", graph.searched_again);
}
BENCHMARK(localDelaunay)->Name("neighbor_graph/local_delaunay")->Apply(overSizesAndThreads);

void nearestNeighbors(benchmark::State& state) {
  Data& data = dataOf(state);
  const NeighborLists& lists = data.longLists();
  NeighborGraph graph;
  for (auto _ : state)
    graph = buildNeighborGraph(data.points(), lists, {kNearestNeighbors});
  countPoints(state);
  setCounter(state, "edges", graph.graph.edgeCount());
}
BENCHMARK(nearestNeighbors)->Name("neighbor_graph/nearest_neighbors")->Apply(overSizes);

}  // namespace
}  // namespace spherical_param::stages
