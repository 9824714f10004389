#include "bench_data.h"

#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::stages {
namespace {

void triangulate(benchmark::State& state, TriangulationMethod method) {
  const Positions& sphere = dataOf(state).sphere();
  SphereTriangulation triangulation;
  for (auto _ : state)
    triangulation = triangulateSphere(sphere, method);
  countPoints(state);
  setCounter(state, "triangles", triangulation.triangles.cols());
  setCounter(state, "reinserted", triangulation.reinserted);
}

void incremental(benchmark::State& state) {
  triangulate(state, TriangulationMethod::Incremental);
}
BENCHMARK(incremental)->Name("sphere_triangulation/incremental")->Apply(overSizes);

void qhull(benchmark::State& state) {
  triangulate(state, TriangulationMethod::Qhull);
}
BENCHMARK(qhull)->Name("sphere_triangulation/qhull")->Apply(overSizes);

}  // namespace
}  // namespace spherical_param::stages
