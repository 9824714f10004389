#include "bench_data.h"

#include "spherical_param/self_intersection.h"

namespace spherical_param::stages {
namespace {

void find(benchmark::State& state, const Positions& points, const Triangles& triangles) {
  SelfIntersectionOptions options;
  options.threads = threadsOf(state);
  std::size_t pairs = 0;
  for (auto _ : state)
    pairs = findSelfIntersections(points, triangles, options).size();
  countPoints(state);
  setCounter(state, "triangles", triangles.cols());
  setCounter(state, "pairs", pairs);
}

void ofMesh(benchmark::State& state) {
  Data& data = dataOf(state);
  find(state, data.points(), data.triangles());
}
BENCHMARK(ofMesh)->Name("self_intersection/optimised_mesh")->Apply(overSizesAndThreads);

/// Before the optimisation there are some.
void ofSphereTriangles(benchmark::State& state) {
  Data& data = dataOf(state);
  find(state, data.points(), data.sphereTriangles());
}
BENCHMARK(ofSphereTriangles)->Name("self_intersection/first_mesh")->Apply(overSizesAndThreads);

}  // namespace
}  // namespace spherical_param::stages
