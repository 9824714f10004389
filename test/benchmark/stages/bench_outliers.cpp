#include "bench_data.h"

#include "spherical_param/outliers.h"

namespace spherical_param::stages {
namespace {

void find(benchmark::State& state) {
  Data& data = dataOf(state);
  const NeighborLists& lists = data.longLists();
  OutlierOptions options;
  options.threads = threadsOf(state);
  Outliers outliers;
  for (auto _ : state)
    outliers = findOutliers(data.points(), lists, options);
  countPoints(state);
  setCounter(state, "rounds", outliers.rounds);
  setCounter(state, "outliers", outliers.indices.size());
}
BENCHMARK(find)->Name("outliers/find")->Apply(overSizesAndThreads);

}  // namespace
}  // namespace spherical_param::stages
