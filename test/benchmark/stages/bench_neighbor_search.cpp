#include "bench_data.h"

namespace spherical_param::stages {
namespace {

void build(benchmark::State& state) {
  const Positions& points = dataOf(state).points();
  for (auto _ : state)
    benchmark::DoNotOptimize(NeighborFinder(points));
  countPoints(state);
}
BENCHMARK(build)->Name("neighbor_search/build_tree")->Apply(overSizes);

void search(benchmark::State& state) {
  const NeighborFinder& finder = dataOf(state).finder();
  for (auto _ : state)
    benchmark::DoNotOptimize(finder.allLists(kLocalDelaunayNeighbors, threadsOf(state)));
  countPoints(state);
  setCounter(state, "neighbors", kLocalDelaunayNeighbors);
}
BENCHMARK(search)->Name("neighbor_search/search")->Apply(overSizesAndThreads);

}  // namespace
}  // namespace spherical_param::stages
