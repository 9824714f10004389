#include "bench_data.h"

#include "spherical_param/surface_diagnosis.h"

namespace spherical_param::stages {
namespace {

void diagnose(benchmark::State& state) {
  Data& data = dataOf(state);
  const Triangles& triangles = data.triangles();
  const NeighborGraph& graph = data.graph();
  SurfaceDiagnosis diagnosis;
  for (auto _ : state)
    diagnosis = diagnoseSurface(data.points(), triangles, graph.graph, graph.bridges);
  countPoints(state);
  setCounter(state, "edges", graph.graph.edgeCount());
  setCounter(state, "closed_genus_0", diagnosis.looksClosedGenus0() ? 1 : 0);
}
BENCHMARK(diagnose)->Name("surface_diagnosis/diagnose")->Apply(overSizes);

}  // namespace
}  // namespace spherical_param::stages
