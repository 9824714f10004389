// Every public function but reconstruct(), and every stage: the first byte picks one. Stages are
// given what their callers give them, as they do not check it; what is public is given anything.

#include "fuzz_stages.h"
#include "embedding.h"
#include "embedding_starts.h"
#include "graphs.h"
#include "mesh_optimization.h"
#include "neighbor_search.h"
#include "openings.h"
#include "outliers.h"
#include "point_set.h"
#include "smoothing.h"
#include "sphere_triangulation.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/self_intersection.h"
#include "surface_diagnosis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace fuzz {
namespace {

using namespace spherical_param;

NeighborGraph graphOf(const Positions& points) {
  return internal::buildNearestNeighborGraph(points, nearest(points, 6), 6);
}

/// Whether a stage may be given the points: finite, distinct, and scaled to an extent of about 1.
bool areNodes(const Positions& points) {
  return points.allFinite() && points.cols() >= 4 &&
         stress::firstAtPlaces(points).size() == static_cast<std::size_t>(points.cols());
}

/// Moved and scaled as reconstruct() does it before all stages.
Positions scaledToOne(const Positions& points) {
  const Eigen::Vector3d low = points.rowwise().minCoeff();
  const Positions moved = points.colwise() - low;
  return moved / std::max(moved.maxCoeff(), std::numeric_limits<double>::min());
}

/// A connected graph of distinct points: of their neighbours, or of any.
Graph graphFrom(Bytes& bytes, const Positions& points) {
  const auto n = static_cast<std::size_t>(points.cols());
  if (bytes.oneIn(4))
    return internal::buildNearestNeighborGraph(points, arbitraryLists(bytes, n, n, true), 6).graph;
  return graphOf(points).graph;
}

/// A number that an option may have.
double within(double low, double high, double value) {
  return value >= low && value <= high ? value : low;
}

void requireConnected(const Graph& graph, std::size_t n) {
  require(graph.size() == n && graph.neighbors.size() == graph.offsets.back() &&
              graph.lengths.size() == graph.neighbors.size(),
          "the graph's arrays fit");
  std::vector<bool> is_reached(n, false);
  std::vector<std::size_t> stack;
  const auto reach = [&](std::size_t i) {
    if (!is_reached[i])
      stack.push_back(i);
    is_reached[i] = true;
  };
  if (n > 0)
    reach(0);
  while (!stack.empty()) {
    const std::size_t i = stack.back();
    stack.pop_back();
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(graph.neighbors[e]);
      require(j < n && j != i, "an edge leads to another point");
      reach(j);
    }
  }
  require(std::count(is_reached.begin(), is_reached.end(), false) == 0, "the graph is connected");
}

void fuzzNeighbors(Bytes& bytes, const Positions& points, Watch& watch) {
  if (!points.allFinite() || points.cols() == 0)
    return;
  // An extent of about 1: squared distances neither overflow nor underflow.
  const Positions scaled = points / std::max(points.cwiseAbs().maxCoeff(), 1e-300);
  const auto n = static_cast<std::size_t>(points.cols());
  const int count = bytes.integerOr(12);
  const NeighborLists lists = findNearestNeighbors(scaled, count, executionFrom(bytes, watch));
  require(stress::areLists(lists, n, n), "neighbours are points");
  const NeighborLists expected = nearest(scaled, std::clamp(count, 0, static_cast<int>(n)));
  for (std::size_t i = 0; i < n; ++i) {
    const auto far = [&](const NeighborLists& of) {
      double square = 0.0;
      for (std::size_t e = of.offsets[i]; e < of.offsets[i + 1]; ++e)
        square = std::max(
            square,
            (scaled.col(of.indices[e]) - scaled.col(static_cast<Eigen::Index>(i))).squaredNorm());
      return square;
    };
    require(std::abs(far(lists) - far(expected)) <= 1e-14, "neighbours are the nearest");
  }
}

void fuzzPointSet(Bytes& bytes, const Positions& points, Watch& watch) {
  const std::size_t distinct = findDistinctPoints(points).input_of_vertex.size();
  require(distinct == stress::firstAtPlaces(points).size(), "distinct points are counted");
  require(areCoplanar(points) == stress::liesInPlane(points), "points are coplanar or not");
  std::vector<Index> order = spatialOrder(points);
  std::sort(order.begin(), order.end());
  std::vector<Index> all(static_cast<std::size_t>(points.cols()));
  std::iota(all.begin(), all.end(), Index{0});
  require(order == all, "the order is a permutation");
  require(stress::areUnitVectors(internal::projectFromCentroid(points)) &&
              stress::areUnitVectors(internal::projectByRank(points)),
          "a start is of unit vectors");
  fuzzNeighbors(bytes, points, watch);
}

void fuzzTriangulation(Bytes& bytes, const Positions& points, Watch& watch) {
  const bool is_by_qhull = bytes.oneIn(2);
  const bool is_raw = bytes.oneIn(8);
  const Positions sphere = is_raw ? points : normalized(points);
  const Execution execution = executionFrom(bytes, watch);
  const Triangles triangles =
      is_by_qhull ? triangulateSphere(sphere, TriangulationMethod::Qhull, execution).triangles
                  : triangulateSphere(sphere, execution);
  require(isSphere(triangles, sphere), "the triangulation is a sphere over all points");
}

void fuzzGraph(Bytes& bytes, const Positions& points, Watch& watch) {
  const auto n = static_cast<std::size_t>(points.cols());
  const NeighborLists lists =
      bytes.oneIn(2) ? nearest(points, 12) : arbitraryLists(bytes, n, n, true);
  if (!areNodes(points))
    return;
  const GraphMethod method =
      bytes.oneIn(2) ? GraphMethod::NearestNeighbors : GraphMethod::LocalDelaunay;
  const int k = std::max(3, bytes.integerOr(25));
  const std::uint8_t how = bytes.byte();
  NeighborSearch search;
  if (how % 2 == 1)
    search = [&](const std::vector<Index>& queries, int) {
      return arbitraryLists(bytes, queries.size(), n, how % 8 != 7);
    };
  const Execution execution = executionFrom(bytes, watch);
  requireConnected(test::graphOf(points, lists, {method, k}, search, execution).graph, n);
}

void fuzzEmbedding(Bytes& bytes, const Positions& given, Watch& watch) {
  if (!areNodes(given))
    return;
  const Positions points = scaledToOne(given);
  if (!areNodes(points))
    return;
  const Graph graph = graphFrom(bytes, points);
  EmbeddingOptions options;
  options.method = bytes.oneIn(2) ? EmbeddingMethod::Iterative : EmbeddingMethod::Multilevel;
  options.weights = static_cast<EdgeWeights>(bytes.below(3));
  if (options.method == EmbeddingMethod::Multilevel)
    options.exponent = within(2.1, 16.0, bytes.realOr(3.0));
  options.damping = within(0.01, 1.0, bytes.realOr(0.5));
  options.max_iterations = std::clamp(bytes.integerOr(100), 0, 300);
  if (bytes.oneIn(2))
    options.tolerance = within(0.0, 1.0, bytes.real());
  options.stagnation_window = std::max(0, bytes.integerOr(100));
  options.starts = std::clamp(bytes.integerOr(2), 1, 10);
  options.history_vertices = std::clamp(bytes.integerOr(0), 0, 1 << 24);
  options.history_frames = std::clamp(bytes.integerOr(20), 2, 10000);
  const NodeMass mass = bytes.oneIn(2) ? NodeMass::ByArea : NodeMass::Equal;
  const std::uint32_t seed = bytes.byte();
  const Embedding result = embed(graph, points, options, seed, executionFrom(bytes, watch), mass);
  require(result.directions.cols() == points.cols() && stress::areUnitVectors(result.directions),
          "the embedding is of unit vectors");
  for (const HistoryFrame& frame : result.history.frames)
    require(frame.sphere.cols() == static_cast<Eigen::Index>(result.history.vertices.size()) &&
                stress::areUnitVectors(frame.sphere),
            "a frame of the history is of unit vectors");
  meanTangentialLaplacian(graph, result.directions, options.weights, options.exponent);
}

void fuzzOutliers(Bytes& bytes, const Positions& points, Watch& watch) {
  const auto n = static_cast<std::size_t>(points.cols());
  const auto are_points = [&](const std::vector<Index>& some) {
    return std::is_sorted(some.begin(), some.end()) &&
           stress::areLists({{0, some.size()}, some}, 1, n);
  };
  if (areNodes(points)) {
    const double sigma = within(0.0, 1000.0, bytes.realOr(4.0));
    const NeighborLists lists =
        bytes.oneIn(2) ? nearest(points, 32) : arbitraryLists(bytes, n, n, true);
    const internal::DeviatingPoints found = internal::deviatingPoints(points, lists, sigma, {});
    require(found.scores.size() == n && are_points(found.indices),
            "each point has a score, and outliers are points, in order");
  }
  Options options;
  static_cast<Execution&>(options) = executionFrom(bytes, watch);
  options.outliers = bytes.choice<OutlierMode>(3);
  options.outlier_sigma = bytes.realOr(4.0);
  options.min_points = bytes.integerOr(8);
  const std::vector<Index> outliers = findOutliers(points, options);
  require(are_points(outliers), "outliers are points, in order");
  for (const std::vector<Index>& part : findParts(points, options)) {
    require(are_points(part), "parts are points, in order");
    for (const Index i : part)
      require(!std::binary_search(outliers.begin(), outliers.end(), i), "no outlier is in a part");
  }
}

/// Whether no coordinate has digits below 1e-100 of the largest one: intersections are then exact.
bool haveExactProducts(const Positions& points) {
  const double largest = points.size() > 0 ? points.cwiseAbs().maxCoeff() : 0.0;
  return (points.array() == 0.0 ||
          points.array().abs() * std::numeric_limits<double>::epsilon() / 2.0 >= 1e-100 * largest)
      .all();
}

void fuzzChecks(Bytes& bytes, const Positions& points, Watch& watch) {
  const Triangles triangles = trianglesFrom(bytes, normalized(points));
  const auto n = static_cast<std::size_t>(points.cols());
  const MeshTopology topology = checkTopology(triangles, n, bytes.integerOr(0));
  require(topology.isSphere() == isSphere(triangles, points), "the mesh is a sphere or not");
  measureMesh(points, triangles, bytes.integerOr(0));
  signedVolume(points, triangles);
  surfaceArea(points, triangles);
  areaWeightedNormals(points, triangles);
  Execution execution = executionFrom(bytes, watch);
  const auto pairs = findSelfIntersections(points, triangles, execution);
  require(std::is_sorted(pairs.begin(), pairs.end()), "pairs are in order");
  std::vector<Index> of;
  for (std::size_t i = bytes.below(8); i > 0; --i)
    of.push_back(bytes.index(static_cast<std::size_t>(triangles.cols())));
  execution.progress = {};
  const auto some = findSelfIntersectionsOf(points, triangles, of, execution);
  auto expected = pairs;
  const auto is_of = [&](Index t) { return std::find(of.begin(), of.end(), t) != of.end(); };
  expected.erase(
      std::remove_if(expected.begin(), expected.end(),
                     [&](const auto& pair) { return !is_of(pair[0]) && !is_of(pair[1]); }),
      expected.end());
  require(some == expected || !haveExactProducts(points),
          "the pairs of some triangles are those among all");
}

void fuzzOptimization(Bytes& bytes, const Positions& given, Watch& watch) {
  if (!areNodes(given))
    return;
  const Positions points = scaledToOne(given);
  if (!areNodes(points))
    return;
  const Triangles triangles = triangulateSphere(normalized(points));
  const Graph graph = graphFrom(bytes, points);
  OptimizationOptions options;
  options.method = static_cast<OptimizationMethod>(bytes.below(3));
  const std::uint32_t seed = bytes.byte();
  const Execution execution = executionFrom(bytes, watch);
  options.finish_on_points = bytes.byte() % 2 == 0;
  require(
      isSphere(optimizeMesh(points, triangles, graph, options, seed, execution).triangles, points),
      "the optimised mesh is a sphere over all points");
}

void fuzzSmoothing(Bytes& bytes, const Positions& given, Watch&) {
  if (!areNodes(given))
    return;
  const Positions points = scaledToOne(given);
  const Triangles triangles = triangulateSphere(normalized(points));
  SmoothingOptions options;
  options.method = bytes.oneIn(2) ? SmoothingMethod::Umbrella : SmoothingMethod::Biharmonic;
  options.steps = std::clamp(bytes.integerOr(5), 0, 200);
  options.restore_volume = bytes.oneIn(2);
  const Smoothing result = smoothSurface(points, triangles, options, bytes.integerOr(0));
  require(result.points.cols() == points.cols() && result.points.allFinite(),
          "there are as many smoothed points");
}

void fuzzDiagnosis(Bytes& bytes, const Positions& given, Watch&) {
  if (!areNodes(given))
    return;
  const Positions points = scaledToOne(given);
  if (!areNodes(points))
    return;
  const Triangles triangles = triangulateSphere(normalized(points));
  const NeighborGraph graph = graphOf(points);
  DiagnosisOptions options;
  options.max_vertices = bytes.byte();
  options.mark_triangles = bytes.oneIn(2);
  options.count_cycles = bytes.oneIn(2);
  const SurfaceDiagnosis result =
      diagnoseSurface(points, triangles, graph.graph, graph.report.bridges,
                      findOpenings(points, graph.graph).openings, options, bytes.integerOr(0));
  require(!options.mark_triangles ||
              result.triangle_marks.size() == static_cast<std::size_t>(triangles.cols()),
          "each triangle has a mark");
}

}  // namespace
}  // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fuzz;
  constexpr std::array<Call, 13> calls{
      fuzzPointSet, fuzzTriangulation, fuzzGraph,        fuzzEmbedding, fuzzOutliers,
      fuzzChecks,   fuzzSurface,       fuzzOptimization, fuzzSmoothing, fuzzDiagnosis,
      fuzzTexture,  fuzzMorph,         fuzzHarmonics};
  Bytes bytes(data, size);
  const std::uint8_t which = bytes.byte();
  Watch watch(bytes);
  const std::size_t before = bytes.byte();
  // The points come last: a change of them moves no other byte.
  const std::size_t head = std::min<std::size_t>(size, 3 + 8 + before % 64);
  Bytes of_points(data + head, size - head);
  const Positions points = pointsFrom(of_points);
  std::string message;
  endingOf(
      watch, [&] { calls[which % calls.size()](bytes, points, watch); }, message);
  return 0;
}
