// Times each stage of the reconstruction on generated scans, so that a change to one is seen.
//
//   benchmark_stages [--benchmark_filter=REGEX] [--benchmark_out=FILE.json] ...    --help for all
//
// A name has the stage, what it does, the number of points and, where it may have several, of
// threads. Other numbers of points than 10,000 and 100,000:
//
//   BENCHMARK_POINTS="1000000" benchmark_stages ...
//
// Debian's libbenchmark warns that it was built as DEBUG: that is itself, not what it times.

#include "bench_data.h"
#include "compiler.h"

#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

namespace {

/// For the whole to take about a minute: each benchmark is repeated for so long [s], unless another
/// --benchmark_min_time is given.
constexpr const char* kMinTime = "--benchmark_min_time=0.3";

}  // namespace

int main(int argc, char** argv) {
  std::string min_time = kMinTime;
  std::vector<char*> words(argv, argv + argc);
  words.insert(words.begin() + 1, min_time.data());
  auto count = static_cast<int>(words.size());
  words.push_back(nullptr);
  benchmark::Initialize(&count, words.data());
  if (benchmark::ReportUnrecognizedArguments(count, words.data()))
    return 2;
  if (spherical_param::stages::sizes().empty()) {
    std::cerr << argv[0] << ": the environment variable BENCHMARK_POINTS is not valid; give it "
              << "numbers of points from 100 to 10000000 such as \"10000 1000000\"\n";
    return 2;
  }
  benchmark::AddCustomContext("data", "generated scan of a hand");
  benchmark::AddCustomContext("compiler", spherical_param::stages::kCompiler);
  benchmark::AddCustomContext("openmp_threads",
                              std::to_string(spherical_param::stages::allThreads()));
  try {
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  benchmark::Shutdown();
  return EXIT_SUCCESS;
}
