// Times the two methods of triangulateSphere() on uniform random points, in turn, and compares what
// they make.
//
//   bench_sphere_triangulation [n ...]      default: 10000 100000 1000000

#include "helpers.h"
#include "spherical_param/sphere_triangulation.h"

#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

namespace spherical_param {
namespace {

#ifdef __clang__
constexpr const char* kCompiler = __VERSION__;
#else
constexpr const char* kCompiler = "gcc " __VERSION__;
#endif

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

/// Peak of the resident memory [MiB] of a process that makes n points and triangulates them.
double peakMemory(Index n, TriangulationMethod method) {
  const pid_t child = fork();
  if (child == 0) {
    triangulateSphere(uniformSphere(n), method);
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0)
    return std::nan("");
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // it comes in KiB
}

struct Timing {
  std::vector<double> seconds;
  SphereTriangulation result;

  void run(const Positions& points, TriangulationMethod method) {
    const auto start = std::chrono::steady_clock::now();
    result = triangulateSphere(points, method);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    seconds.push_back(elapsed.count());
  }
  double median() {
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::nth_element(seconds.begin(), middle, seconds.end());
    return *middle;
  }
};

void printRow(Index n, const std::string& method, Timing& timing, double peak) {
  const double median = timing.median();
  std::cout << std::setw(9) << n << "  " << std::left << std::setw(11) << method << std::right
            << std::fixed << std::setw(10) << std::setprecision(4) << median << std::setw(10)
            << std::setprecision(3) << 1e6 * median / n << std::setw(10) << std::setprecision(0)
            << peak << std::setw(11) << timing.result.reinserted << '\n';
}

void compare(Index n, const std::array<double, 2>& peaks) {
  const Positions points = uniformSphere(n);
  Timing incremental;
  Timing qhull;
  const int repeats = n <= 20000 ? 15 : n <= 200000 ? 7 : 3;
  for (int i = 0; i < repeats; ++i) {
    incremental.run(points, TriangulationMethod::Incremental);
    qhull.run(points, TriangulationMethod::Qhull);
  }
  printRow(n, "incremental", incremental, peaks[0]);
  printRow(n, "qhull", qhull, peaks[1]);
  const bool same =
      test::canonical(incremental.result.triangles) == test::canonical(qhull.result.triangles);
  std::cout << "           qhull / incremental: " << std::setprecision(1)
            << qhull.median() / incremental.median() << " (median of " << repeats
            << "); triangles: " << (same ? "the same" : "DIFFERENT") << std::endl;
}

}  // namespace
}  // namespace spherical_param

int main(int argc, char** argv) {
  using spherical_param::Index;
  std::vector<Index> sizes;
  try {
    for (int i = 1; i < argc; ++i)
      sizes.push_back(static_cast<Index>(std::stoi(argv[i])));
  } catch (const std::exception&) {
    std::cout << "usage: " << argv[0] << " [n ...]\n";
    return EXIT_FAILURE;
  }
  if (sizes.empty())
    sizes = {10000, 100000, 1000000};
  try {
    // First of all, as long as the processes begin small.
    std::vector<std::array<double, 2>> peaks;
    for (const Index n : sizes) {
      using spherical_param::TriangulationMethod;
      peaks.push_back({spherical_param::peakMemory(n, TriangulationMethod::Incremental),
                       spherical_param::peakMemory(n, TriangulationMethod::Qhull)});
    }
    std::cout << "uniform random points on the sphere, 1 thread, compiler "
              << spherical_param::kCompiler << '\n'
              << "        n  method         seconds  us/point  peak MiB  left out\n";
    for (std::size_t i = 0; i < sizes.size(); ++i)
      spherical_param::compare(sizes[i], peaks[i]);
  } catch (const std::exception& error) {
    std::cout << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
