// Times the two methods of triangulateSphere() on uniform random points, in turn, and compares what
// they make and the memory that they take.
//
//   benchmark_triangulation_methods [-json] [n ...]      default: 10000 100000 1000000
//
// -json: one JSON object instead of the table.

#include "compiler.h"
#include "helpers.h"
#include "spherical_param/sphere_triangulation.h"

#include <nlohmann/json.hpp>

#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

namespace spherical_param::stages {
namespace {

using Json = nlohmann::ordered_json;

/// n points spread at random over the sphere, the same on every platform but for rounding.
Positions uniformSphere(Index n) {
  std::uint64_t state = 1;
  const auto uniform = [&] {  // in [0, 1): splitmix64
    std::uint64_t z = state += 0x9e3779b97f4a7c15ULL;
    z = (z ^ z >> 30U) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ z >> 27U) * 0x94d049bb133111ebULL;
    return static_cast<double>((z ^ z >> 31U) >> 11U) * 0x1p-53;
  };
  Positions points(3, n);
  for (Index i = 0; i < n; ++i) {
    const double z = 2.0 * uniform() - 1.0;
    const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
    const double angle = 2.0 * test::kPi * uniform();
    points.col(i) =
        Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z).normalized();
  }
  return points;
}

/// Peak of the resident memory [MiB] of a process that makes n points and triangulates them; not a
/// number if that failed.
double peakMemory(Index n, TriangulationMethod method) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      triangulateSphere(uniformSphere(n), method);
    } catch (const std::exception&) {
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0)
    return std::nan("");
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // it comes in KiB
}

/// One method on one number of points.
struct Run {
  explicit Run(TriangulationMethod how) : method(how) {}

  TriangulationMethod method;
  double peak_mib = 0.0;
  std::vector<double> times;  ///< of each repetition [s]
  SphereTriangulation result;

  void repeat(const Positions& points) {
    const auto start = std::chrono::steady_clock::now();
    result = triangulateSphere(points, method);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    times.push_back(elapsed.count());
  }
  double seconds() const {  ///< the median
    std::vector<double> sorted = times;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// Both methods on one number of points.
struct Comparison {
  Index points;
  Run incremental{TriangulationMethod::Incremental};
  Run qhull{TriangulationMethod::Qhull};
  bool same_triangles = false;

  std::size_t repetitions() const { return incremental.times.size(); }
  double ratio() const { return qhull.seconds() / incremental.seconds(); }
};

void measureMemory(Comparison& comparison) {
  for (Run* run : {&comparison.incremental, &comparison.qhull})
    run->peak_mib = peakMemory(comparison.points, run->method);
}

void measureTime(Comparison& comparison) {
  const Positions points = uniformSphere(comparison.points);
  const int repetitions = comparison.points <= 20000 ? 15 : comparison.points <= 200000 ? 7 : 3;
  // In turn, so that both see the same of what else the machine does.
  for (int i = 0; i < repetitions; ++i) {
    comparison.incremental.repeat(points);
    comparison.qhull.repeat(points);
  }
  comparison.same_triangles = test::canonical(comparison.incremental.result.triangles) ==
                              test::canonical(comparison.qhull.result.triangles);
}

Json toJson(const Run& run, Index points) {
  return {{"seconds", run.seconds()},
          {"microseconds_per_point", 1e6 * run.seconds() / points},
          {"peak_mib", run.peak_mib},
          {"left_out", run.result.reinserted}};
}

Json toJson(const std::vector<Comparison>& comparisons) {
  Json sizes = Json::array();
  for (const Comparison& comparison : comparisons)
    sizes.push_back({{"points", comparison.points},
                     {"repetitions", comparison.repetitions()},
                     {"incremental", toJson(comparison.incremental, comparison.points)},
                     {"qhull", toJson(comparison.qhull, comparison.points)},
                     {"qhull_over_incremental", comparison.ratio()},
                     {"same_triangles", comparison.same_triangles}});
  return {{"data", "uniform random points on the sphere"},
          {"threads", 1},
          {"compiler", kCompiler},
          {"sizes", std::move(sizes)}};
}

void printHead() {
  std::cout << "uniform random points on the sphere, 1 thread, compiler " << kCompiler << '\n'
            << "        n  method         seconds  us/point  peak MiB  left out\n";
}

void printRow(const char* method, const Run& run, Index points) {
  std::cout << std::setw(9) << points << "  " << std::left << std::setw(11) << method << std::right
            << std::fixed << std::setw(10) << std::setprecision(4) << run.seconds() << std::setw(10)
            << std::setprecision(3) << 1e6 * run.seconds() / points << std::setw(10)
            << std::setprecision(0) << run.peak_mib << std::setw(10) << run.result.reinserted
            << '\n';
}

void print(const Comparison& comparison) {
  printRow("incremental", comparison.incremental, comparison.points);
  printRow("qhull", comparison.qhull, comparison.points);
  std::cout << "           qhull / incremental: " << std::setprecision(1) << comparison.ratio()
            << " (median of " << comparison.repetitions()
            << "); triangles: " << (comparison.same_triangles ? "the same" : "DIFFERENT")
            << std::endl;
}

struct Arguments {
  std::vector<Comparison> comparisons;
  bool json = false;
  bool valid = true;
};

Arguments parseArguments(const std::vector<std::string>& words) {
  constexpr long fewest = 4;
  constexpr long most = 100000000;
  Arguments arguments;
  for (const std::string& word : words) {
    if (word == "-json" || word == "--json") {
      arguments.json = true;
      continue;
    }
    char* end = nullptr;
    const long n = std::strtol(word.c_str(), &end, 10);
    arguments.valid = arguments.valid && *end == '\0' && n >= fewest && n <= most;
    arguments.comparisons.push_back({static_cast<Index>(n)});
  }
  if (arguments.comparisons.empty())
    arguments.comparisons = {{10000}, {100000}, {1000000}};
  return arguments;
}

void compare(Arguments& arguments) {
  // First of all, as long as the processes begin small.
  for (Comparison& comparison : arguments.comparisons)
    measureMemory(comparison);
  if (!arguments.json)
    printHead();
  for (Comparison& comparison : arguments.comparisons) {
    measureTime(comparison);
    if (!arguments.json)
      print(comparison);
  }
  if (arguments.json)
    std::cout << toJson(arguments.comparisons).dump(2) << '\n';
}

}  // namespace
}  // namespace spherical_param::stages

int main(int argc, char** argv) {
  using namespace spherical_param::stages;
  Arguments arguments = parseArguments(std::vector<std::string>(argv + 1, argv + argc));
  if (!arguments.valid) {
    std::cerr << "usage: " << argv[0] << " [-json] [n ...], with numbers of points from 4 on\n";
    return 2;
  }
  try {
    compare(arguments);
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
