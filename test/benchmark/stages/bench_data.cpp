#include "bench_data.h"

#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

namespace spherical_param::stages {
namespace {

/// Range of the numbers of points: of fewer, some stages have nothing to do.
constexpr long kFewestPoints = 100;
constexpr long kMostPoints = 10000000;

}  // namespace

Data& dataOf(const benchmark::State& state, double noise) {
  return Data::of(static_cast<Index>(state.range(0)), noise);
}

int threadsOf(const benchmark::State& state) {
  return static_cast<int>(state.range(1));
}

void countPoints(benchmark::State& state) {
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * state.range(0));
}

std::vector<Index> sizes() {
  const char* text = std::getenv("BENCHMARK_POINTS");
  std::istringstream numbers(text == nullptr ? "10000 100000" : text);
  std::vector<Index> result;
  for (std::string word; numbers >> word;) {
    char* end = nullptr;
    const long n = std::strtol(word.c_str(), &end, 10);
    if (*end != '\0' || n < kFewestPoints || n > kMostPoints)
      return {};
    result.push_back(static_cast<Index>(n));
  }
  return result;
}

void overSizes(benchmark::internal::Benchmark* stage) {
  for (const Index n : sizes())
    stage->Args({n});
  stage->Unit(benchmark::kMillisecond)->UseRealTime();
}

void overSizesAndThreads(benchmark::internal::Benchmark* stage) {
  for (const Index n : sizes()) {
    stage->Args({n, 1});
    if (allThreads() > 1)
      stage->Args({n, allThreads()});
  }
  stage->Unit(benchmark::kMillisecond)->UseRealTime();
}

}  // namespace spherical_param::stages
