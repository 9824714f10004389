// Times each stage of the reconstruction on a generated scan of a hand.
//
//   benchmark_stages [--benchmark_filter=REGEX] [--benchmark_out=FILE.json] ...    --help for all
//
// A name has the stage, the number of points and the number of threads.

#include "scan_shapes.h"
#include "spherical_param/graph_hierarchy.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_optimization.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/neighbor_graph.h"
#include "spherical_param/outliers.h"
#include "spherical_param/point_set.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/smoothing.h"
#include "spherical_param/sphere_embedding.h"
#include "spherical_param/sphere_triangulation.h"
#include "spherical_param/surface_diagnosis.h"

#include <pcl/surface/impl/spherical_param_reconstruction.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <numeric>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace spherical_param::benchmark {
namespace {

using State = ::benchmark::State;

/// Of each point: for the tangent Delaunay graph, the default, and for the paper's graph.
constexpr int kDelaunayNeighbors = 12;
constexpr int kPaperNeighbors = 25;

Positions scanOf(Index count) {
  tools::ScanOptions options;
  options.shape = tools::Shape::Hand;
  options.points = static_cast<std::size_t>(count);
  // Rounded as by a file or a cloud of PCL.
  return tools::generateScan(options).points.cast<float>().cast<double>();
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
      : scan(scanOf(count)), points(scan(Eigen::all, spatialOrder(scan))), tree(points),
        all(static_cast<std::size_t>(count)) {
    std::iota(all.begin(), all.end(), Index{0});
    lists = search(0)(all, kDelaunayNeighbors);
    long_lists = search(0)(all, kPaperNeighbors);
    LocalDelaunayOptions options;
    options.search = search(0);
    graph = buildLocalDelaunayGraph(points, lists, options);
    hierarchy = buildGraphHierarchy(graph.graph);
    sphere = embedMultilevel(graph.graph, hierarchy).directions;
    sphere_triangles = triangulateSphere(sphere).triangles;
    if (signedVolume(points, sphere_triangles) < 0.0)
      flipOrientation(sphere_triangles);
    triangles = optimizeMesh(points, sphere_triangles, graph.graph, {}).triangles;
  }

  NeighborSearch search(int threads) const {
    return [this, threads](const std::vector<Index>& some, int neighbors) {
      return tree.findNeighbors(some, neighbors, threads, [](double) {});
    };
  }

  Positions scan;    ///< 3 x n, in the order of the scan
  Positions points;  ///< 3 x n, along a space-filling curve: reconstruct() calls the stages with it
  pcl::detail::KdTreeSearch tree;
  std::vector<Index> all;  ///< 0 ... n - 1
  NeighborLists lists;
  NeighborLists long_lists;
  NeighborGraph graph;
  GraphHierarchy hierarchy;
  Positions sphere;            ///< 3 x n
  Triangles sphere_triangles;  ///< 3 x (2n - 4), of `sphere`, outward on `points`
  Triangles triangles;         ///< 3 x (2n - 4), the same, optimised
};

/// What a benchmark calls, with data and a number of threads.
using Stage = void (*)(const Data& data, int threads);

template <typename Options>
Options withThreads(int threads) {
  Options options;
  options.threads = threads;
  return options;
}

template <typename Value>
void keep(const Value& value) {
  ::benchmark::DoNotOptimize(&value);
}

void buildTree(const Data& data, int) {
  keep(pcl::detail::KdTreeSearch(data.points));
}

void searchNeighbors(const Data& data, int threads) {
  keep(data.search(threads)(data.all, kDelaunayNeighbors));
}

void buildDelaunayGraph(const Data& data, int threads) {
  auto options = withThreads<LocalDelaunayOptions>(threads);
  options.search = data.search(threads);
  keep(buildLocalDelaunayGraph(data.points, data.lists, options));
}

void embedIteratively(const Data& data, int threads) {
  // As many iterations, however they converge.
  auto options = withThreads<EmbeddingOptions>(threads);
  options.max_iterations = 50;
  options.tolerance = 0.0;
  options.stagnation_window = 0;
  keep(embedOnSphere(data.graph.graph, data.points, options));
}

void embed(const Data& data, int threads) {
  keep(embedMultilevel(data.graph.graph, data.hierarchy, withThreads<MultilevelOptions>(threads)));
}

void embedConverged(const Data& data, int threads) {
  auto options = withThreads<MultilevelOptions>(threads);
  options.tolerance = 1e-8;
  keep(embedMultilevel(data.graph.graph, data.hierarchy, options));
}

void optimize(const Data& data, int threads) {
  keep(optimizeMesh(data.points, data.sphere_triangles, data.graph.graph,
                    withThreads<OptimizationOptions>(threads)));
}

void reconstructAll(const Data& data, int threads) {
  keep(reconstruct(data.points, data.lists, withThreads<Options>(threads), data.search(threads)));
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
    {"k-d tree", false, buildTree},
    {"neighbours", true, searchNeighbors},
    {"outliers", true,
     [](const Data& d, int n) {
       keep(findOutliers(d.points, d.long_lists, withThreads<OutlierOptions>(n)));
     }},
    {"tangent Delaunay graph", true, buildDelaunayGraph},
    {"nearest-neighbour graph", false,
     [](const Data& d, int) { keep(buildNeighborGraph(d.points, d.long_lists, {})); }},
    {"graph hierarchy", false,
     [](const Data& d, int) { keep(buildGraphHierarchy(d.graph.graph)); }},
    {"embedding, multilevel", true, embed},
    {"embedding, converged", true, embedConverged},
    {"embedding, 50 iterations", true, embedIteratively},
    {"triangulation, incremental", false,
     [](const Data& d, int) { keep(triangulateSphere(d.sphere)); }},
    {"triangulation, qhull", false,
     [](const Data& d, int) { keep(triangulateSphere(d.sphere, TriangulationMethod::Qhull)); }},
    {"optimisation", true, optimize},
    {"self-intersections", true,
     [](const Data& d, int n) {
       keep(findSelfIntersections(d.points, d.triangles, withThreads<SelfIntersectionOptions>(n)));
     }},
    {"smoothing", true,
     [](const Data& d, int n) {
       keep(smoothSurface(d.points, d.triangles, withThreads<SmoothingOptions>(n)));
     }},
    {"diagnosis", false,
     [](const Data& d, int) {
       keep(diagnoseSurface(d.points, d.triangles, d.graph.graph, d.graph.bridges));
     }},
    {"measures", false, [](const Data& d, int) { keep(measureMesh(d.points, d.triangles)); }},
    {"topology", false, [](const Data& d, int) { keep(checkTopology(d.triangles, d.all.size())); }},
    {"whole core", true, reconstructAll},
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
