// Times each stage of the reconstruction on a generated scan of a hand.
//
//   benchmark_stages [--benchmark_filter=REGEX] [--benchmark_out=FILE.json] ...    --help for all
//
// A name has the stage, the number of points and the number of threads.

#include "embedding.h"
#include "local_delaunay_graph.h"
#include "mesh_optimization.h"
#include "nearest_neighbor_graph.h"
#include "neighbor_search.h"
#include "point_set.h"
#include "scan_shapes.h"
#include "smoothing.h"
#include "sphere_triangulation.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/self_intersection.h"
#include "surface_diagnosis.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <numeric>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace spherical_param::benchmark {
namespace {

using State = ::benchmark::State;

/// Neighbours of each point in the default graph, and in the graph of the paper.
constexpr int kNeighbors = 12;
constexpr int kPaperNeighbors = 25;

Execution withThreads(int threads) {
  Execution execution;
  execution.threads = threads;
  return execution;
}

Positions scanOf(Index count) {
  tools::ScanOptions options;
  options.shape = "hand";
  options.points = static_cast<std::size_t>(count);
  // Rounded as by a file or a cloud of PCL.
  return tools::generateScan(options).points.cast<float>().cast<double>();
}

NeighborGraph delaunayGraphOf(const Positions& points, const internal::Neighbors& neighbors,
                              const Execution& execution) {
  return internal::buildLocalDelaunayGraph(points,
                                           internal::findStars(points, neighbors, execution),
                                           internal::StraySearch::Yes, execution);
}

/// A scan and what each stage makes of the results of the stages before it, with all threads.
class Data {
public:
  /// The only one of that many points.
  static const Data& of(const State& state) {
    static std::unique_ptr<Data> data;
    const auto count = static_cast<Index>(state.range(0));
    if (!data || data->points.cols() != count)
      data = std::make_unique<Data>(count);
    return *data;
  }

  explicit Data(Index count)
      : scan(scanOf(count)), points(scan(Eigen::all, spatialOrder(scan))),
        search(makeNeighborSearch(points)),
        search_alone(makeNeighborSearch(points, withThreads(1))),
        all(static_cast<std::size_t>(count)) {
    std::iota(all.begin(), all.end(), Index{0});
    lists = search(all, kNeighbors);
    long_lists = search(all, kPaperNeighbors);
    graph = delaunayGraphOf(points, {lists, search}, {});
    sphere = embed(graph.graph, points).directions;
    sphere_triangles = triangulateSphere(sphere);
    if (signedVolume(points, sphere_triangles) < 0.0)
      flipOrientation(sphere_triangles);
    triangles = optimizeMesh(points, sphere_triangles, graph.graph).triangles;
  }

  Positions scan;    ///< 3 x n, in the order of the scan
  Positions points;  ///< 3 x n, along a space-filling curve: reconstruct() calls the stages with it
  NeighborSearch search;        ///< with all threads
  NeighborSearch search_alone;  ///< with one thread
  std::vector<Index> all;       ///< 0 ... n - 1
  NeighborLists lists;          ///< for the default graph
  NeighborLists long_lists;     ///< for the graph of the paper
  NeighborGraph graph;
  Positions sphere;            ///< 3 x n
  Triangles sphere_triangles;  ///< 3 x (2n - 4), of `sphere`, outward on `points`
  Triangles triangles;         ///< 3 x (2n - 4), the same, optimised
};

/// What a benchmark calls, with data and a number of threads.
using Stage = void (*)(const Data& data, int threads);

template <typename Value>
void keep(const Value& value) {
  ::benchmark::DoNotOptimize(&value);
}

void embedBy(const EmbeddingOptions& options, const Data& data, int threads) {
  keep(embed(data.graph.graph, data.points, options, 1, withThreads(threads)));
}

EmbeddingOptions toTolerance(double tolerance) {
  EmbeddingOptions options;
  options.tolerance = tolerance;
  return options;
}

/// As many iterations, however they converge.
EmbeddingOptions ofIterations(int count) {
  EmbeddingOptions options = toTolerance(0.0);
  options.method = EmbeddingMethod::Iterative;
  options.max_iterations = count;
  options.stagnation_window = 0;
  return options;
}

struct Entry {
  const char* name;
  bool parallel;
  Stage stage;
};

/// In the order of the work.
const std::vector<Entry> kEntries = {
    {"distinct points", false, [](const Data& d, int) { keep(findDistinctPoints(d.scan)); }},
    {"spatial order", false, [](const Data& d, int) { keep(spatialOrder(d.scan)); }},
    {"k-d tree", false, [](const Data& d, int) { keep(makeNeighborSearch(d.points)); }},
    {"tree and neighbours", true,
     [](const Data& d, int n) {
       keep(findNearestNeighbors(d.points, kNeighbors, withThreads(n)));
     }},
    {"outliers", true,
     [](const Data& d, int n) {
       Options options;
       options.outliers = OutlierMode::Auto;
       options.threads = n;
       keep(findOutliers(d.scan, options));
     }},
    {"tangent Delaunay graph", true,
     [](const Data& d, int n) {
       keep(delaunayGraphOf(d.points, {d.lists, n == 1 ? d.search_alone : d.search},
                            withThreads(n)));
     }},
    {"nearest-neighbour graph", false,
     [](const Data& d, int) {
       keep(internal::buildNearestNeighborGraph(d.points, d.long_lists, kPaperNeighbors));
     }},
    {"embedding, multilevel", true, [](const Data& d, int n) { embedBy({}, d, n); }},
    {"embedding, converged", true, [](const Data& d, int n) { embedBy(toTolerance(1e-8), d, n); }},
    {"embedding, 50 iterations", true,
     [](const Data& d, int n) { embedBy(ofIterations(50), d, n); }},
    {"triangulation, incremental", false,
     [](const Data& d, int) { keep(triangulateSphere(d.sphere)); }},
    {"triangulation, qhull", false,
     [](const Data& d, int) { keep(triangulateSphere(d.sphere, TriangulationMethod::Qhull)); }},
    {"optimisation", true,
     [](const Data& d, int n) {
       keep(optimizeMesh(d.points, d.sphere_triangles, d.graph.graph, {}, 1, withThreads(n)));
     }},
    {"self-intersections", true,
     [](const Data& d, int n) {
       keep(findSelfIntersections(d.points, d.triangles, withThreads(n)));
     }},
    {"smoothing", true,
     [](const Data& d, int n) {
       SmoothingOptions options;
       options.steps = 5;
       keep(smoothSurface(d.points, d.triangles, options, n));
     }},
    {"diagnosis", false,
     [](const Data& d, int) {
       keep(diagnoseSurface(d.points, d.triangles, d.graph.graph, d.graph.report.bridges, {}));
     }},
    {"measures", false, [](const Data& d, int) { keep(measureMesh(d.points, d.triangles)); }},
    {"topology", false, [](const Data& d, int) { keep(checkTopology(d.triangles, d.all.size())); }},
    {"whole core", true,
     [](const Data& d, int n) {
       Options options;
       options.threads = n;
       keep(reconstruct(d.scan, options));
     }},
};

void addBenchmarks() {
  const std::set<int> counts = {
      1, static_cast<int>(std::max(1U, std::thread::hardware_concurrency()))};
  for (const int size : {10000, 100000})
    for (const Entry& entry : kEntries)
      for (const int threads : entry.parallel ? counts : std::set<int>{1})
        ::benchmark::RegisterBenchmark(entry.name,
                                       [stage = entry.stage](State& state) {
                                         const Data& data = Data::of(state);
                                         for (auto _ : state)
                                           stage(data, static_cast<int>(state.range(1)));
                                         state.SetItemsProcessed(state.iterations() *
                                                                 state.range(0));
                                       })
            ->Args({size, threads})
            ->Unit(::benchmark::kMillisecond)
            ->UseRealTime();
}

}  // namespace
}  // namespace spherical_param::benchmark

int main(int argc, char** argv) {
  // For the whole to take about a minute. Arguments that follow win.
  std::string min_time = "--benchmark_min_time=0.3";
  std::vector<char*> words(argv, argv + argc);
  words.insert(words.begin() + 1, min_time.data());
  auto count = static_cast<int>(words.size());
  words.push_back(nullptr);
  benchmark::Initialize(&count, words.data());
  if (benchmark::ReportUnrecognizedArguments(count, words.data()))
    return 2;
  spherical_param::benchmark::addBenchmarks();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
