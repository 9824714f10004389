#include "bench_data.h"

#include "spherical_param/point_set.h"

namespace spherical_param::stages {
namespace {

void distinct(benchmark::State& state) {
  const Positions& points = dataOf(state).scan();
  for (auto _ : state)
    benchmark::DoNotOptimize(findDistinctPoints(points));
  countPoints(state);
}
BENCHMARK(distinct)->Name("point_set/distinct")->Apply(overSizes);

void order(benchmark::State& state) {
  const Positions& points = dataOf(state).scan();
  for (auto _ : state)
    benchmark::DoNotOptimize(spatialOrder(points));
  countPoints(state);
}
BENCHMARK(order)->Name("point_set/spatial_order")->Apply(overSizes);

}  // namespace
}  // namespace spherical_param::stages
