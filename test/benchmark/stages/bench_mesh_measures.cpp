#include "bench_data.h"

#include "spherical_param/mesh_measures.h"

namespace spherical_param::stages {
namespace {

void measure(benchmark::State& state) {
  Data& data = dataOf(state);
  const Triangles& triangles = data.triangles();
  for (auto _ : state)
    benchmark::DoNotOptimize(measureMesh(data.points(), triangles));
  countPoints(state);
  setCounter(state, "triangles", triangles.cols());
}
BENCHMARK(measure)->Name("mesh_measures/measure")->Apply(overSizes);

}  // namespace
}  // namespace spherical_param::stages
