#include "bench_data.h"

#include "spherical_param/smoothing.h"

namespace spherical_param::stages {
namespace {

void smooth(benchmark::State& state, SmoothingMethod method) {
  Data& data = dataOf(state);
  const Triangles& triangles = data.triangles();
  SmoothingOptions options;
  options.method = method;
  options.threads = threadsOf(state);
  Smoothing smoothing;
  for (auto _ : state)
    smoothing = smoothSurface(data.points(), triangles, options);
  countPoints(state);
  setCounter(state, "steps", options.steps);
  setCounter(state, "rms_displacement", smoothing.rms_displacement);
}

void umbrella(benchmark::State& state) {
  smooth(state, SmoothingMethod::Umbrella);
}
BENCHMARK(umbrella)->Name("smoothing/umbrella")->Apply(overSizesAndThreads);

void taubin(benchmark::State& state) {
  smooth(state, SmoothingMethod::Taubin);
}
BENCHMARK(taubin)->Name("smoothing/taubin")->Apply(overSizesAndThreads);

void biharmonic(benchmark::State& state) {
  smooth(state, SmoothingMethod::Biharmonic);
}
BENCHMARK(biharmonic)->Name("smoothing/biharmonic")->Apply(overSizesAndThreads);

}  // namespace
}  // namespace spherical_param::stages
