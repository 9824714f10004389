#include "bench_data.h"

#include "spherical_param/reconstruct.h"

namespace spherical_param::stages {
namespace {

/// The whole core, without the first search for neighbours.
void whole(benchmark::State& state) {
  Data& data = dataOf(state);
  const NeighborLists& lists = data.scanLists();
  Options options;
  options.threads = threadsOf(state);
  const NeighborSearch search = data.scanFinder().search(options.threads);
  Result result;
  for (auto _ : state)
    result = reconstruct(data.scan(), lists, options, search);
  countPoints(state);
  setCounter(state, "edges", result.graph.edges);
  setCounter(state, "levels", result.embedding.levels.size());
  setCounter(state, "self_intersections", result.self_intersections.size());
}
BENCHMARK(whole)->Name("reconstruct/core")->Apply(overSizesAndThreads);

}  // namespace
}  // namespace spherical_param::stages
