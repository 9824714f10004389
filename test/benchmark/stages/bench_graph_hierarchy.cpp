#include "bench_data.h"

#include "spherical_param/graph_hierarchy.h"

namespace spherical_param::stages {
namespace {

void build(benchmark::State& state) {
  const Graph& graph = dataOf(state).graph().graph;
  GraphHierarchy hierarchy;
  for (auto _ : state)
    hierarchy = buildGraphHierarchy(graph);
  countPoints(state);
  setCounter(state, "edges", graph.edgeCount());
  setCounter(state, "levels", hierarchy.levels.size());
}
BENCHMARK(build)->Name("graph_hierarchy/build")->Apply(overSizes);

}  // namespace
}  // namespace spherical_param::stages
