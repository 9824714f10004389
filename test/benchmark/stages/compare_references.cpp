// Times every stage beside a plain reference - the same as one would write it first - and compares
// what the two make, on generated scans of a hand. Of stages whose reference is a chapter of its
// own the reference is one thread.
//
//   benchmark_reference_paths [-json] [n ...]      default: 10000 100000
//
// -json: one JSON object instead of the table. Each is run three times, all in turn, and the median
// counts. Ends with 1 if a stage does not make the same as its reference, or not the same with all
// threads as with one.

#include "compiler.h"
#include "core/mesh_optimizer.h"
#include "core/ordered_points.h"
#include "helpers.h"
#include "reference/distinct_points.h"
#include "reference/edge_flips.h"
#include "reference/graph_coarsening.h"
#include "reference/mesh_topology.h"
#include "reference/self_intersection.h"
#include "scan_data.h"
#include "spherical_param/mesh_optimization.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/sphere_embedding.h"
#include "spherical_param/sphere_triangulation.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/impl/spherical_param_reconstruction.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <functional>
#include <iomanip>
#include <iostream>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::stages {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kRepetitions = 3;
/// Half the width of the noise of a scan whose first mesh intersects itself in many places [mean
/// distance to neighbours].
constexpr double kNoise = 0.6;
/// What the reference is where it is none of its own.
constexpr const char* kOneThread = "one thread";

/// One stage on one number of points.
struct Row {
  std::string stage;
  std::string reference;  ///< what the product is compared with
  Index points = 0;
  double reference_seconds = 0.0;
  double one_thread_seconds = 0.0;
  double all_threads_seconds = 0.0;
  bool same = false;  ///< all that the three made

  double ratio() const { return reference_seconds / all_threads_seconds; }
};

/// Times of repetitions, and what the last one made.
template <typename Output>
struct Run {
  std::vector<double> times;  ///< [s]
  std::optional<Output> output;

  template <typename Work>
  void repeat(const Work& work) {
    output.reset();
    const auto start = std::chrono::steady_clock::now();
    output.emplace(work());
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    times.push_back(elapsed.count());
  }
  double seconds() const {  ///< the median
    std::vector<double> sorted = times;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// Compares a stage with a reference.
///
/// \param reference makes something; \param product the same with a number of threads, 0: all.
/// \param as_reference (what the reference made, what the product made): whether they agree.
/// \param same whether two that the product made are the same, to the last bit.
template <typename Reference, typename Product, typename AsReference, typename Same>
Row compare(Row row, const Reference& reference, const Product& product,
            const AsReference& as_reference, const Same& same) {
  Run<decltype(reference())> plain;
  Run<decltype(product(0))> one;
  Run<decltype(product(0))> all;
  // In turn, so that all see the same of what else the machine does.
  for (int i = 0; i < kRepetitions; ++i) {
    plain.repeat(reference);
    one.repeat([&] { return product(1); });
    all.repeat([&] { return product(0); });
  }
  row.reference_seconds = plain.seconds();
  row.one_thread_seconds = one.seconds();
  row.all_threads_seconds = all.seconds();
  row.same = as_reference(*plain.output, *all.output) && same(*one.output, *all.output);
  return row;
}

/// The same for a stage of which the threads alone are compared.
template <typename Product, typename Same>
Row compareThreads(Row row, const Product& product, const Same& same) {
  row.reference = kOneThread;
  Run<decltype(product(0))> one;
  Run<decltype(product(0))> all;
  for (int i = 0; i < kRepetitions; ++i) {
    one.repeat([&] { return product(1); });
    all.repeat([&] { return product(0); });
  }
  row.reference_seconds = row.one_thread_seconds = one.seconds();
  row.all_threads_seconds = all.seconds();
  row.same = same(*one.output, *all.output);
  return row;
}

// --- The stages, in the order of the work --------------------------------------------------------

Row comparePointOrder(Data& data) {
  // Every tenth point twice: there is something to find.
  const Positions& scan = data.scan();
  const Positions points = test::horizontally(scan, scan.leftCols(scan.cols() / 10));
  const auto product = [&](int threads) { return internal::orderPoints(points, threads); };
  const int exponent = product(1).exponent;
  const auto as_reference = [](const reference::OrderedPoints& expected,
                               const internal::OrderedPoints& ordered) {
    return ordered.distinct.vertex_of_input == expected.distinct.vertex_of_input &&
           ordered.distinct.input_of_vertex == expected.distinct.input_of_vertex &&
           ordered.vertex_of_node == expected.vertex_of_node && ordered.points == expected.points;
  };
  const auto same = [](const internal::OrderedPoints& a, const internal::OrderedPoints& b) {
    return a.input_of_node == b.input_of_node && a.vertex_of_node == b.vertex_of_node &&
           a.distinct.vertex_of_input == b.distinct.vertex_of_input && a.points == b.points;
  };
  return compare(
      {"distinct points in order", "hash table, then a sort by comparison"},
      [&] { return reference::orderPoints(points, exponent); }, product, as_reference, same);
}

/// The nearest neighbours of each point and the point itself, one query of PCL's tree after the
/// other.
NeighborLists neighborsOneByOne(const Positions& points, int count) {
  const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3f p = points.col(i).cast<float>();
    cloud->push_back({p.x(), p.y(), p.z()});
  }
  pcl::search::KdTree<pcl::PointXYZ> tree;
  tree.setInputCloud(cloud);
  NeighborLists lists;
  pcl::Indices indices;
  std::vector<float> distances;
  for (const pcl::PointXYZ& point : *cloud) {
    tree.nearestKSearch(point, count + 1, indices, distances);
    lists.indices.insert(lists.indices.end(), indices.begin(), indices.end());
    lists.offsets.push_back(lists.indices.size());
  }
  return lists;
}

/// Ascending, of the entries of list i from point `of`.
std::vector<double> distancesOf(const Positions& points, const NeighborLists& lists, std::size_t i,
                                Index of) {
  std::vector<double> result;
  for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e)
    result.push_back((points.col(lists.indices[e]) - points.col(of)).norm());
  std::sort(result.begin(), result.end());
  return result;
}

Row compareNeighbors(Data& data) {
  const Positions& scan = data.scan();
  const internal::OrderedPoints ordered = internal::orderPoints(scan, 0);
  std::vector<Index> all(ordered.input_of_node.size());
  std::iota(all.begin(), all.end(), Index{0});
  const auto product = [&](int threads) {
    return pcl::detail::KdTreeSearch(ordered.points)
        .findNeighbors(all, kLocalDelaunayNeighbors, threads, [](double) {});
  };
  const auto as_reference = [&](const NeighborLists& expected, const NeighborLists& lists) {
    const double scale = std::ldexp(1.0, ordered.exponent);
    for (std::size_t node = 0; node < all.size(); ++node) {
      const Index input = ordered.input_of_node[node];
      const std::vector<double> a =
          distancesOf(scan, expected, static_cast<std::size_t>(input), input);
      const std::vector<double> b =
          distancesOf(ordered.points, lists, node, static_cast<Index>(node));
      // Of two points as far but for the rounding of float either may be found.
      constexpr double tolerance = 4.0 * std::numeric_limits<float>::epsilon();
      if (!std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [&](double x, double y) { return std::abs(x - scale * y) <= tolerance * x; }))
        return false;
    }
    return true;
  };
  const auto same = [](const NeighborLists& a, const NeighborLists& b) {
    return a.offsets == b.offsets && a.indices == b.indices;
  };
  return compare(
      {"nearest neighbours", "PCL's tree, a query at a time"},
      [&] { return neighborsOneByOne(scan, kLocalDelaunayNeighbors); }, product, as_reference,
      same);
}

bool areSame(const Graph& a, const Graph& b) {
  return a.offsets == b.offsets && a.neighbors == b.neighbors && a.lengths == b.lengths;
}

Row compareGraphs(Data& data) {
  return compareThreads(
      {"neighbour graph", ""},
      [&](int threads) {
        LocalDelaunayOptions options;
        options.threads = threads;
        options.search = data.finder().search(threads);
        return buildLocalDelaunayGraph(data.points(), data.lists(), options).graph;
      },
      areSame);
}

bool areSame(const HierarchyLevel& a, const HierarchyLevel& b) {
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor, Index>;
  const Matrix& p = a.prolongation;
  const Matrix& q = b.prolongation;
  return a.seeds == b.seeds && a.aggregate_of == b.aggregate_of && areSame(a.graph, b.graph) &&
         p.rows() == q.rows() && p.cols() == q.cols() && p.nonZeros() == q.nonZeros() &&
         std::equal(p.outerIndexPtr(), p.outerIndexPtr() + p.rows() + 1, q.outerIndexPtr()) &&
         std::equal(p.innerIndexPtr(), p.innerIndexPtr() + p.nonZeros(), q.innerIndexPtr()) &&
         std::equal(p.valuePtr(), p.valuePtr() + p.nonZeros(), q.valuePtr());
}

Row compareHierarchies(Data& data) {
  const Graph& graph = data.graph().graph;
  HierarchyOptions options;
  options.coarsest_size = static_cast<Index>(graph.size()) - 1;  // one level
  const auto same = [](const HierarchyLevel& a, const HierarchyLevel& b) { return areSame(a, b); };
  return compare(
      {"one level of the hierarchy", "sort, Dijkstra's algorithm, maps"},
      [&] { return reference::coarsen(graph, options.seed); },
      [&](int threads) {
        options.threads = threads;
        return buildGraphHierarchy(graph, options).levels.at(0);
      },
      same, same);
}

Row compareEmbeddings(Data& data) {
  const Graph& graph = data.graph().graph;
  const GraphHierarchy& hierarchy = data.hierarchy();
  return compareThreads(
      {"embedding", ""},
      [&](int threads) {
        MultilevelOptions options;
        options.threads = threads;
        return embedMultilevel(graph, hierarchy, options).directions;
      },
      std::equal_to<Positions>());
}

Row compareTriangulations(Data& data) {
  // Random points, of which floating point gets the hull right.
  const Positions directions = test::randomSphere(data.size(), 1);
  const auto same = [](const Triangles& a, const Triangles& b) {
    return test::canonical(a) == test::canonical(b);
  };
  // It has but one thread.
  return compare(
      {"triangulation of random points", "qhull"},
      [&] { return triangulateSphere(directions, TriangulationMethod::Qhull).triangles; },
      [&](int) { return triangulateSphere(directions).triangles; }, same, same);
}

Row compareFlips(Data& data) {
  const Positions& points = data.points();
  const Graph& graph = data.graph().graph;
  const Triangles& triangles = data.sphereTriangles();
  return compare(
      {"edge flips", "sorted set of gains"},
      [&] { return reference::flipAll(points, triangles, graph); },
      [&](int threads) {
        internal::MeshOptimizer optimizer(points, triangles, graph, threads);
        optimizer.setEnergy({});
        optimizer.flipAll();
        return optimizer.mesh().triangles();
      },
      std::equal_to<Triangles>(), std::equal_to<Triangles>());
}

Row compareOptimizations(Data& data) {
  const Positions& points = data.points();
  const Graph& graph = data.graph().graph;
  const Triangles& triangles = data.sphereTriangles();
  return compareThreads(
      {"whole optimisation", ""},
      [&](int threads) {
        OptimizationOptions options;
        options.threads = threads;
        options.smoother = smootherOf(points, threads);
        return optimizeMesh(points, triangles, graph, options).triangles;
      },
      std::equal_to<Triangles>());
}

Row compareSelfIntersections(Data& data) {
  Data& noisy = Data::of(data.size(), kNoise);
  const Positions& points = noisy.points();
  const Triangles& triangles = noisy.sphereTriangles();
  using Pairs = std::vector<std::array<Index, 2>>;
  return compare(
      {"self-intersections of a noisy mesh", "sweep along x"},
      [&] { return reference::findSelfIntersections(points, triangles); },
      [&](int threads) {
        SelfIntersectionOptions options;
        options.threads = threads;
        return findSelfIntersections(points, triangles, options);
      },
      // A mesh without any would show little.
      [](const Pairs& expected, const Pairs& pairs) {
        return !expected.empty() && pairs == expected;
      },
      std::equal_to<Pairs>());
}

Row compareTopologies(Data& data) {
  const Triangles& triangles = data.triangles();
  const Index n = data.size();
  const auto product = [&](const Triangles& of, int threads) {
    TopologyOptions options;
    options.threads = threads;
    return checkTopology(of, static_cast<std::size_t>(n), options);
  };
  Row row = compare(
      {"topology", "map of edges"}, [&] { return reference::topologyOf(triangles, n); },
      [&](int threads) { return product(triangles, threads); }, reference::areSame,
      reference::areSame);
  // Nothing is wrong with this mesh. With a hole, a fin and a triangle turned over in it, there is.
  Triangles spoiled = triangles.rightCols(triangles.cols() - 1);
  spoiled.col(0).reverseInPlace();
  spoiled(0, spoiled.cols() / 2) = spoiled(0, spoiled.cols() / 3);
  const MeshTopology faulty = product(spoiled, 0);
  row.same = row.same && !faulty.faults.boundary_edges.empty() &&
             reference::areSame(reference::topologyOf(spoiled, n), faulty);
  return row;
}

Row compareWhole(Data& data) {
  const Positions& scan = data.scan();
  return compareThreads(
      {"whole reconstruction", ""},
      [&](int threads) {
        Options options;
        options.threads = threads;
        // As in the PCL class.
        return reconstruct(
            scan,
            [threads](const Positions& points, const std::vector<Index>&) -> NeighborSearch {
              return [threads, tree = pcl::detail::KdTreeSearch(points)](
                         const std::vector<Index>& some_points, int neighbors) {
                return tree.findNeighbors(some_points, neighbors, threads, [](double) {});
              };
            },
            options);
      },
      [](const Result& a, const Result& b) {
        return a.triangles == b.triangles && a.sphere == b.sphere;
      });
}

// --- Output --------------------------------------------------------------------------------------

Json toJson(const std::vector<Row>& rows) {
  Json stages = Json::array();
  for (const Row& row : rows)
    stages.push_back({{"stage", row.stage},
                      {"points", row.points},
                      {"reference", row.reference},
                      {"reference_seconds", row.reference_seconds},
                      {"one_thread_seconds", row.one_thread_seconds},
                      {"all_threads_seconds", row.all_threads_seconds},
                      {"reference_over_all_threads", row.ratio()},
                      {"same_output", row.same}});
  return {{"data", "generated scans of a hand"},
          {"threads", allThreads()},
          {"repetitions", kRepetitions},
          {"compiler", kCompiler},
          {"stages", std::move(stages)}};
}

void printHead() {
  std::cout << "generated scans of a hand, compiler " << kCompiler << ", medians of "
            << kRepetitions << " [ms]\n"
            << "                             stage        n  reference  1 thread  " << std::setw(2)
            << allThreads() << " threads   ratio  output     reference is\n";
}

void print(const Row& row) {
  std::cout << std::setw(34) << row.stage << std::setw(9) << row.points << std::fixed
            << std::setprecision(2) << std::setw(11) << 1e3 * row.reference_seconds << std::setw(10)
            << 1e3 * row.one_thread_seconds << std::setw(12) << 1e3 * row.all_threads_seconds
            << std::setprecision(1) << std::setw(8) << row.ratio() << "  " << std::left
            << std::setw(11) << (row.same ? "the same" : "DIFFERENT") << row.reference << std::right
            << std::endl;
}

struct Arguments {
  std::vector<Index> sizes;
  bool json = false;
  bool valid = true;
};

Arguments parseArguments(const std::vector<std::string>& words) {
  constexpr long fewest = 1000;  // for each stage to have something to do
  constexpr long most = 10000000;
  Arguments arguments;
  for (const std::string& word : words) {
    if (word == "-json" || word == "--json") {
      arguments.json = true;
      continue;
    }
    char* end = nullptr;
    const long n = std::strtol(word.c_str(), &end, 10);
    arguments.valid = arguments.valid && *end == '\0' && n >= fewest && n <= most;
    arguments.sizes.push_back(static_cast<Index>(n));
  }
  if (arguments.sizes.empty())
    arguments.sizes = {10000, 100000};
  return arguments;
}

std::vector<Row> compareAll(const Arguments& arguments) {
  if (!arguments.json)
    printHead();
  std::vector<Row> rows;
  for (const auto compareStage :
       {comparePointOrder, compareNeighbors, compareGraphs, compareHierarchies, compareEmbeddings,
        compareTriangulations, compareFlips, compareOptimizations, compareSelfIntersections,
        compareTopologies, compareWhole})
    for (const Index n : arguments.sizes) {
      rows.push_back(compareStage(Data::of(n, 0.0)));
      rows.back().points = n;
      if (!arguments.json)
        print(rows.back());
    }
  if (arguments.json)
    std::cout << toJson(rows).dump(2) << '\n';
  return rows;
}

}  // namespace
}  // namespace spherical_param::stages

int main(int argc, char** argv) {
  using namespace spherical_param::stages;
  const Arguments arguments = parseArguments(std::vector<std::string>(argv + 1, argv + argc));
  if (!arguments.valid) {
    std::cerr << "usage: " << argv[0] << " [-json] [n ...], with numbers of points from 1000 to "
              << "10000000\n";
    return 2;
  }
  try {
    const std::vector<Row> rows = compareAll(arguments);
    for (const Row& row : rows)
      if (!row.same) {
        std::cerr << argv[0] << ": " << row.stage << " of " << row.points
                  << " points does not make the same as its reference (" << row.reference << ")\n"
                  << "run it without -json to see all stages\n";
        return EXIT_FAILURE;
      }
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
