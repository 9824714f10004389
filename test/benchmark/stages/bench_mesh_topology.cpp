#include "bench_data.h"

#include "spherical_param/mesh_topology.h"

namespace spherical_param::stages {
namespace {

void check(benchmark::State& state) {
  Data& data = dataOf(state);
  const Triangles& triangles = data.triangles();
  MeshTopology topology;
  for (auto _ : state)
    topology = checkTopology(triangles, static_cast<std::size_t>(data.size()));
  countPoints(state);
  setCounter(state, "edges", topology.edges);
  setCounter(state, "triangles", topology.triangles);
}
BENCHMARK(check)->Name("mesh_topology/check")->Apply(overSizes);

}  // namespace
}  // namespace spherical_param::stages
