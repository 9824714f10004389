#include "bench_data.h"

#include "spherical_param/sphere_embedding.h"

namespace spherical_param::stages {
namespace {

/// Iterations of the paper's solver, whose number does not depend on how it converges here.
constexpr int kIterations = 50;

/// Mean tangential Laplacian of an embedding that has converged [radius].
constexpr double kTolerance = 1e-8;

void iterative(benchmark::State& state) {
  Data& data = dataOf(state);
  const Graph& graph = data.graph().graph;
  EmbeddingOptions options;
  options.max_iterations = kIterations;
  options.tolerance = 0.0;
  options.stagnation_window = 0;
  options.threads = threadsOf(state);
  Embedding embedding;
  for (auto _ : state)
    embedding = embedOnSphere(graph, data.points(), options);
  countPoints(state);
  setCounter(state, "edges", graph.edgeCount());
  setCounter(state, "iterations", embedding.iterations);
}
BENCHMARK(iterative)->Name("sphere_embedding/iterative")->Apply(overSizesAndThreads);

void embedByLevels(benchmark::State& state, const MultilevelOptions& options) {
  Data& data = dataOf(state);
  const Graph& graph = data.graph().graph;
  const GraphHierarchy& hierarchy = data.hierarchy();
  MultilevelEmbedding embedding;
  for (auto _ : state)
    embedding = embedMultilevel(graph, hierarchy, options);
  countPoints(state);
  int newton = 0;
  int linear = 0;
  for (const LevelReport& level : embedding.levels) {
    newton += level.newton_iterations;
    linear += level.linear_iterations;
  }
  setCounter(state, "levels", embedding.levels.size());
  setCounter(state, "newton", newton);
  setCounter(state, "linear", linear);
  setCounter(state, "residual", embedding.residual);
}

void multilevel(benchmark::State& state) {
  MultilevelOptions options;
  options.threads = threadsOf(state);
  embedByLevels(state, options);
}
BENCHMARK(multilevel)->Name("sphere_embedding/multilevel")->Apply(overSizesAndThreads);

void converged(benchmark::State& state) {
  MultilevelOptions options;
  options.tolerance = kTolerance;
  options.threads = threadsOf(state);
  embedByLevels(state, options);
}
BENCHMARK(converged)->Name("sphere_embedding/converged")->Apply(overSizesAndThreads);

}  // namespace
}  // namespace spherical_param::stages
