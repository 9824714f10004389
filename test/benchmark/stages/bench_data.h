#pragma once

#include "scan_data.h"
#include "spherical_param/types.h"

#include <benchmark/benchmark.h>

#include <vector>

/// What the benchmarks of the stages have in common.
namespace spherical_param::stages {

/// The data for a benchmark's first argument, the number of points.
Data& dataOf(const benchmark::State& state, double noise = 0.0);

/// The second argument of a benchmark overSizesAndThreads().
int threadsOf(const benchmark::State& state);

/// Tells how many points were worked on.
void countPoints(benchmark::State& state);

/// A number that describes the work or its result, the same in all iterations.
template <typename Number>
void setCounter(benchmark::State& state, const char* name, Number value) {
  state.counters[name] = static_cast<double>(value);
}

/// The numbers of points: 10,000 and 100,000, or those of the environment variable
/// BENCHMARK_POINTS, separated by blanks; none if these are not valid.
std::vector<Index> sizes();

/// Sets arguments and unit of a benchmark: each number of points; the second one, each with 1 and
/// with all threads.
void overSizes(benchmark::internal::Benchmark* stage);
void overSizesAndThreads(benchmark::internal::Benchmark* stage);

}  // namespace spherical_param::stages
