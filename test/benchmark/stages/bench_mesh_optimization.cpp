#include "bench_data.h"

#include "spherical_param/mesh_optimization.h"

namespace spherical_param::stages {
namespace {

/// Half the width of the noise that is optimised on smoothed positions, and leaves triangles that
/// intersect for a while [mean distance to neighbours].
constexpr double kNoise = 0.6;

void optimize(benchmark::State& state, OptimizationMethod method, double noise = 0.0) {
  Data& data = dataOf(state, noise);
  const Positions& points = data.points();
  const Triangles& triangles = data.sphereTriangles();
  OptimizationOptions options;
  options.method = method;
  options.threads = threadsOf(state);
  options.smoother = smootherOf(points, options.threads);
  MeshOptimization outcome;
  for (auto _ : state)
    outcome = optimizeMesh(points, triangles, data.graph().graph, options);
  countPoints(state);
  std::size_t moves = 0;
  for (const OptimizationPhase& phase : outcome.phases)
    moves += phase.moves;
  setCounter(state, "moves", moves);
  setCounter(state, "energy", outcome.energy);
  setCounter(state, "self_intersections", outcome.self_intersections.size());
}

void flips(benchmark::State& state) {
  optimize(state, OptimizationMethod::Flips);
}
BENCHMARK(flips)->Name("mesh_optimization/flips")->Apply(overSizesAndThreads);

void full(benchmark::State& state) {
  optimize(state, OptimizationMethod::Full);
}
BENCHMARK(full)->Name("mesh_optimization/full")->Apply(overSizesAndThreads);

void fullOnNoise(benchmark::State& state) {
  optimize(state, OptimizationMethod::Full, kNoise);
}
BENCHMARK(fullOnNoise)->Name("mesh_optimization/full_on_noise")->Apply(overSizesAndThreads);

}  // namespace
}  // namespace spherical_param::stages
