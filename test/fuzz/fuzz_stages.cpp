// Every public function but reconstruct(), with everything made of bytes: the first byte picks it.

#include "embedding_starts.h"
#include "fuzz_input.h"
#include "spherical_param/embedding.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_optimization.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/neighbor_graph.h"
#include "spherical_param/neighbor_search.h"
#include "spherical_param/outliers.h"
#include "spherical_param/point_set.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/smoothing.h"
#include "spherical_param/sphere_triangulation.h"
#include "spherical_param/surface_diagnosis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace spherical_param;
using fuzz::Bytes;
using fuzz::Ending;
using fuzz::finding;
using fuzz::Watch;

Index sizeOf(const Positions& points) {
  return static_cast<Index>(points.cols());
}

/// One of `count` values of an enumeration, seldom another.
template <typename Enum>
Enum enumFrom(Bytes& bytes, int count) {
  const std::uint8_t choice = bytes.byte();
  return static_cast<Enum>(choice < 250 ? choice % count : bytes.integer());
}

/// A default, mostly, or any number.
int integerOr(Bytes& bytes, int usual) {
  return bytes.oneIn(4) ? bytes.integer() : usual;
}
double realOr(Bytes& bytes, double usual) {
  return bytes.oneIn(4) ? bytes.real() : usual;
}
/// Limits the time of the work; a value that is out of range is kept.
int atMost(int most, int value, int range) {
  return value > most && value <= range ? most : value;
}

Positions normalized(const Positions& points) {
  return points.allFinite() ? internal::projectFromCentroid(points) : points;
}

/// A mesh on points on the sphere, sometimes spoiled.
Triangles trianglesFrom(Bytes& bytes, const Positions& sphere) {
  Triangles triangles(3, 0);
  if (sphere.cols() >= 4 && fuzz::areUnitVectors(sphere))
    triangles = triangulateSphere(sphere).triangles;
  const auto n = static_cast<std::size_t>(sphere.cols());
  const std::uint8_t how = bytes.byte();
  if (how < 160)
    return triangles;
  if (how < 200) {  // some other corners
    for (std::size_t i = bytes.below(8); i > 0 && triangles.cols() > 0; --i)
      triangles.data()[bytes.raw<std::uint16_t>() % triangles.size()] =
          bytes.index(n, how % 2 == 0);
  } else if (how < 220 && triangles.cols() > 0) {  // an open one
    const Eigen::Index left = triangles.cols() - 1 - bytes.byte() % triangles.cols();
    triangles.conservativeResize(Eigen::NoChange, left);
  } else if (how < 235) {
    flipOrientation(triangles);
  } else {
    triangles.resize(3, bytes.byte() % 64);
    for (Eigen::Index i = 0; i < triangles.size(); ++i)
      triangles.data()[i] = bytes.index(n, how % 2 == 0);
  }
  return triangles;
}

GraphOptions ofSixNeighbors() {
  GraphOptions options;
  options.method = GraphMethod::NearestNeighbors;
  options.k = 6;
  return options;
}

/// A graph of points, sometimes spoiled.
Graph graphFrom(Bytes& bytes, const Positions& points) {
  Graph graph;
  if (points.allFinite() && points.cols() > 0) {
    graph = buildNeighborGraph(points, fuzz::nearest(points, 6), ofSixNeighbors()).graph;
  }
  const std::uint8_t how = bytes.byte();
  if (how < 200)
    return graph;
  const auto n = static_cast<std::size_t>(points.cols());
  if (how < 230) {
    NeighborLists lists = fuzz::arbitraryLists(bytes, n, n, how % 2 == 0);
    graph.offsets = lists.offsets;
    graph.neighbors = lists.indices;
    graph.lengths.assign(graph.neighbors.size(), 1.0);
  }
  for (std::size_t i = bytes.below(6); i > 0 && !graph.lengths.empty(); --i)
    graph.lengths[bytes.byte() % graph.lengths.size()] = bytes.real();
  if (how % 4 == 1 && !graph.lengths.empty())
    graph.lengths.pop_back();
  return graph;
}

/// Threads from bytes, and the watch as the callback. The watch must outlive it.
Execution executionFrom(Bytes& bytes, Watch& watch) {
  Execution execution;
  execution.threads = integerOr(bytes, 0);
  if (watch.listens())
    execution.progress = std::ref(watch);
  return execution;
}

void checkGraph(const NeighborGraph& graph, std::size_t n) {
  const Graph& g = graph.graph;
  if (g.size() != n || g.neighbors.size() != g.offsets.back() ||
      g.lengths.size() != g.neighbors.size())
    finding("the graph's arrays do not fit");
  std::vector<bool> is_seen(n, false);
  std::vector<std::size_t> stack;
  if (n > 0) {
    stack.push_back(0);
    is_seen[0] = true;
  }
  std::size_t seen = stack.size();
  while (!stack.empty()) {
    const std::size_t i = stack.back();
    stack.pop_back();
    for (std::size_t e = g.offsets[i]; e < g.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(g.neighbors[e]);
      if (j >= n || j == i)
        finding("the graph has an edge to nowhere");
      if (!is_seen[j]) {
        is_seen[j] = true;
        ++seen;
        stack.push_back(j);
      }
    }
  }
  if (seen != n)
    finding("the graph is not connected");
}

using Call = std::function<void(Bytes&, const Positions&, Watch&)>;

void checkNeighbors(Bytes& bytes, const Positions& points, Watch& watch) {
  // Points of an extent of about 1: squared distances neither overflow nor underflow.
  if (!points.allFinite() || points.cols() == 0)
    return;
  const double largest = std::max(points.cwiseAbs().maxCoeff(), 1e-300);
  const Positions scaled = points / largest;
  const auto n = static_cast<std::size_t>(points.cols());
  const int count = integerOr(bytes, 12);
  const NeighborLists lists = findNearestNeighbors(scaled, count, executionFrom(bytes, watch));
  if (!fuzz::areLists(lists, n, n))
    finding("neighbours that are not points");
  const NeighborLists nearest = fuzz::nearest(scaled, std::max(0, std::min(count, sizeOf(points))));
  for (std::size_t i = 0; i < n; ++i) {
    const auto far = [&](const NeighborLists& of) {
      double square = 0.0;
      for (std::size_t e = of.offsets[i]; e < of.offsets[i + 1]; ++e)
        square = std::max(
            square,
            (scaled.col(of.indices[e]) - scaled.col(static_cast<Eigen::Index>(i))).squaredNorm());
      return square;
    };
    if (std::abs(far(lists) - far(nearest)) > 1e-14)
      finding("neighbours that are not the nearest");
  }
}

void fuzzPointSet(Bytes& bytes, const Positions& points, Watch& watch) {
  const DistinctPoints distinct = findDistinctPoints(points);
  if (distinct.input_of_vertex.size() != fuzz::countDistinct(points))
    finding("another number of distinct points");
  if (areCoplanar(points) != fuzz::liesInPlane(points))
    finding("coplanar or not");
  std::vector<Index> order = spatialOrder(points);
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != static_cast<Index>(i))
      finding("the order is not a permutation");
  if (order.size() != static_cast<std::size_t>(points.cols()))
    finding("the order is too short");
  if (!fuzz::areUnitVectors(internal::projectFromCentroid(points)) ||
      !fuzz::areUnitVectors(internal::projectByRank(points)))
    finding("a start that is not of unit vectors");
  checkNeighbors(bytes, points, watch);
}

void fuzzTriangulation(Bytes& bytes, const Positions& points, Watch& watch) {
  TriangulationOptions options;
  options.method = enumFrom<TriangulationMethod>(bytes, 2);
  const bool is_raw = bytes.oneIn(8);
  const Positions sphere = is_raw ? points : normalized(points);
  const SphereTriangulation result =
      triangulateSphere(sphere, options, executionFrom(bytes, watch));
  if (!test::isSphereOverAll(result.triangles, sizeOf(sphere)))
    finding("the triangulation is not a sphere over all points");
}

void fuzzGraph(Bytes& bytes, const Positions& points, Watch& watch) {
  const auto n = static_cast<std::size_t>(points.cols());
  const bool is_wrong = bytes.oneIn(4);
  const NeighborLists lists =
      bytes.oneIn(2) ? fuzz::nearest(points, 12) : fuzz::arbitraryLists(bytes, n, n, !is_wrong);
  // Distinct and finite is a precondition that is not checked.
  if (!points.allFinite() || fuzz::countDistinct(points) != n)
    return;
  GraphOptions options;
  options.method = enumFrom<GraphMethod>(bytes, 2);
  if (bytes.oneIn(2))
    options.k = integerOr(bytes, 25);
  options.agreement = enumFrom<StarAgreement>(bytes, 2);
  const std::uint8_t how = bytes.byte();
  NeighborSearch search;
  if (how % 2 == 1)
    search = [&](const std::vector<Index>& queries, int) {
      return fuzz::arbitraryLists(bytes, queries.size(), n, how % 8 != 7);
    };
  checkGraph(buildNeighborGraph(points, lists, options, search, executionFrom(bytes, watch)), n);
}

void fuzzEmbedding(Bytes& bytes, const Positions& points, Watch& watch) {
  const Graph graph = graphFrom(bytes, points);
  EmbeddingOptions options;
  options.method = enumFrom<EmbeddingMethod>(bytes, 2);
  options.weights = enumFrom<EdgeWeights>(bytes, 3);
  if (options.method == EmbeddingMethod::Multilevel)
    options.exponent = realOr(bytes, 3.0);
  options.damping = realOr(bytes, 0.5);
  options.max_iterations = atMost(300, integerOr(bytes, 100), std::numeric_limits<int>::max());
  if (bytes.oneIn(2))
    options.tolerance = bytes.real();
  options.stagnation_window = integerOr(bytes, 100);
  options.starts = atMost(10, integerOr(bytes, 2), 100);
  options.history.vertices = integerOr(bytes, 0);
  options.history.frames = integerOr(bytes, 20);
  const std::uint32_t seed = bytes.byte();
  const Embedding result = embed(graph, points, options, seed, executionFrom(bytes, watch));
  if (result.directions.cols() != points.cols() ||
      (points.cols() > 0 && !fuzz::areUnitVectors(result.directions)))
    finding("the embedding is not of unit vectors");
  for (const HistoryFrame& frame : result.history.frames)
    if (frame.sphere.cols() != static_cast<Eigen::Index>(result.history.vertices.size()) ||
        !fuzz::areUnitVectors(frame.sphere))
      finding("a frame of the history is not of unit vectors");
  meanTangentialLaplacian(graph, result.directions, options.weights, options.exponent);
}

void fuzzOutliers(Bytes& bytes, const Positions& points, Watch& watch) {
  const auto n = static_cast<std::size_t>(points.cols());
  OutlierOptions options;
  options.sigma = realOr(bytes, 4.0);
  options.k = integerOr(bytes, 16);
  options.least_score = realOr(bytes, 1.0);
  const Execution execution = executionFrom(bytes, watch);
  const auto by_lists = [&] {
    const NeighborLists lists = bytes.oneIn(2) ? fuzz::nearest(points, 12)
                                               : fuzz::arbitraryLists(bytes, n, n, bytes.oneIn(2));
    return findOutliers(points, lists, options, execution);
  };
  const Outliers result = bytes.oneIn(2) ? findOutliers(points, options, execution) : by_lists();
  if (result.scores.size() != n || !std::is_sorted(result.indices.begin(), result.indices.end()) ||
      std::any_of(result.indices.begin(), result.indices.end(),
                  [&](Index i) { return i < 0 || static_cast<std::size_t>(i) >= n; }))
    finding("outliers that are not points");
}

void fuzzChecks(Bytes& bytes, const Positions& points, Watch& watch) {
  const Triangles triangles = trianglesFrom(bytes, normalized(points));
  const auto n = static_cast<std::size_t>(points.cols());
  const MeshTopology topology = checkTopology(triangles, n, integerOr(bytes, 0));
  if (topology.isSphere() != test::isSphereOverAll(triangles, sizeOf(points)))
    finding("sphere or not");
  measureMesh(points, triangles, integerOr(bytes, 0));
  signedVolume(points, triangles);
  surfaceArea(points, triangles);
  areaWeightedNormals(points, triangles);
  Execution execution = executionFrom(bytes, watch);
  const auto pairs = findSelfIntersections(points, triangles, execution);
  if (!std::is_sorted(pairs.begin(), pairs.end()))
    finding("pairs out of order");
  std::vector<Index> of;
  for (std::size_t i = bytes.below(8); i > 0; --i)
    of.push_back(bytes.index(static_cast<std::size_t>(triangles.cols()), false));
  execution.progress = {};
  auto some = findSelfIntersectionsOf(points, triangles, of, execution);
  decltype(some) expected;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(expected), [&](const auto& pair) {
    return std::find(of.begin(), of.end(), pair[0]) != of.end() ||
           std::find(of.begin(), of.end(), pair[1]) != of.end();
  });
  if (some != expected && fuzz::haveExactProducts(points))
    finding("the pairs of some triangles are not those among all");
}

void fuzzOptimization(Bytes& bytes, const Positions& points, Watch& watch) {
  const Triangles triangles = trianglesFrom(bytes, normalized(points));
  const Graph graph = graphFrom(bytes, points);
  OptimizationOptions options;
  options.method = enumFrom<OptimizationMethod>(bytes, 3);
  const std::uint32_t seed = bytes.byte();
  const Execution execution = executionFrom(bytes, watch);
  options.finish_on_points = bytes.byte() % 2 == 0;
  const MeshOptimization result = optimizeMesh(points, triangles, graph, options, seed, execution);
  if (!test::isSphereOverAll(result.triangles, sizeOf(points)))
    finding("the optimised mesh is not a sphere over all points");
}

void fuzzSmoothing(Bytes& bytes, const Positions& points, Watch&) {
  const Triangles triangles = trianglesFrom(bytes, normalized(points));
  SmoothingOptions options;
  options.method = enumFrom<SmoothingMethod>(bytes, 2);
  options.steps = atMost(200, integerOr(bytes, 5), 10000);
  options.restore_volume = bytes.oneIn(2);
  const Smoothing result = smoothSurface(points, triangles, options, integerOr(bytes, 0));
  if (result.points.cols() != points.cols())
    finding("not as many smoothed points");
}

void fuzzDiagnosis(Bytes& bytes, const Positions& points, Watch&) {
  if (!points.allFinite() || points.cols() == 0)
    return;
  const Triangles triangles = trianglesFrom(bytes, normalized(points));
  const NeighborGraph graph =
      buildNeighborGraph(points, fuzz::nearest(points, 6), ofSixNeighbors());
  std::vector<Bridge> bridges = graph.report.bridges;
  if (bytes.oneIn(4))
    bridges.push_back({bytes.index(static_cast<std::size_t>(points.cols()), false),
                       bytes.index(static_cast<std::size_t>(points.cols()), false), bytes.real()});
  DiagnosisOptions options;
  options.max_vertices = bytes.byte();
  options.mark_triangles = bytes.oneIn(2);
  const SurfaceDiagnosis result =
      diagnoseSurface(points, triangles, graph.graph, bridges, options, integerOr(bytes, 0));
  if (options.mark_triangles &&
      result.triangle_marks.size() != static_cast<std::size_t>(triangles.cols()))
    finding("not a mark for each triangle");
}

/// A surface and its map to the sphere.
struct Mapped {
  Triangles triangles;
  Positions sphere;
};

Mapped mapFrom(Bytes& bytes, const Positions& points, Watch& watch) {
  const Positions start = normalized(points);
  Mapped mapped{trianglesFrom(bytes, start), start};
  SphereMapOptions options;
  options.area_weight = realOr(bytes, 0.85);
  options.sweeps = atMost(20, integerOr(bytes, 3), 1000);
  static_cast<Execution&>(options) = executionFrom(bytes, watch);
  if (bytes.oneIn(16) && start.cols() > 0)
    mapped.sphere(bytes.byte() % 3, bytes.byte() % start.cols()) = bytes.real();
  const SphereMap map = computeSphereMap(points, mapped.triangles, mapped.sphere, options);
  if (map.sphere.cols() != points.cols() || !fuzz::areUnitVectors(map.sphere))
    finding("the map is not of unit vectors");
  if (map.distortion.flipped_triangles != 0)
    finding("the map is not one to one");
  if (bytes.oneIn(8))
    return mapped;  // the start, which may be folded
  mapped.sphere = map.sphere;
  return mapped;
}

SphereSurface surfaceFrom(Bytes& bytes, const Positions& points, Watch& watch) {
  const Mapped mapped = mapFrom(bytes, points, watch);
  SphereSurfaceOptions options;
  options.fit = enumFrom<SurfaceFit>(bytes, 2);
  options.threads = integerOr(bytes, 0);
  return {points, mapped.triangles, mapped.sphere, options};
}

void fuzzSurface(Bytes& bytes, const Positions& points, Watch& watch) {
  const SphereSurface surface = surfaceFrom(bytes, points, watch);
  const Eigen::Vector3d direction(bytes.real(), bytes.real(), bytes.real());
  const std::uint8_t how = bytes.byte();
  if (how % 8 == 0) {
    const SphereLocation location = surface.locate(direction);
    if (location.triangle < 0 || location.triangle >= surface.triangles().cols() ||
        !(location.weights.minCoeff() >= 0.0) || !(std::abs(location.weights.sum() - 1.0) < 1e-9))
      finding("a direction that is nowhere");
    surface.evaluate(location);
  } else if (how % 8 == 1) {
    SphereLocation location;
    location.triangle = bytes.index(static_cast<std::size_t>(surface.triangles().cols()), false);
    location.weights = direction;
    surface.evaluate(location);
  } else if (how % 8 == 2) {
    computeSphericalHarmonics(surface, atMost(8, bytes.integer(), 512), integerOr(bytes, 0));
  } else if (how % 8 == 3) {
    const SurfacePoints samples = sampleEvenly(surface, bytes.byte(), bytes.byte());
    if (samples.locations.size() != static_cast<std::size_t>(samples.points.cols()))
      finding("samples without places");
  } else if (how % 8 == 4) {
    const int side = atMost(17, bytes.integer() | 1, 16385);
    meshOfGeometryImage(makeGeometryImage(surface, side));
  } else {
    const auto grid = enumFrom<SphereGrid>(bytes, 2);
    GridSphere directions = makeGridSphere(grid, atMost(4, integerOr(bytes, 2), 1 << 15));
    if (bytes.oneIn(8))
      directions.triangles = trianglesFrom(bytes, directions.directions);
    ResampledMesh mesh = resampleSurface(surface, directions);
    if (bytes.oneIn(8))
      mesh.points(bytes.byte() % 3, bytes.byte() % mesh.points.cols()) = bytes.real();
    if (how % 2 == 0)
      untangle(surface, mesh, integerOr(bytes, 0));
    else
      removeIntersections(mesh, integerOr(bytes, 0));
    if (!test::isSphereOverAll(mesh.triangles, sizeOf(mesh.points)) &&
        test::isSphereOverAll(directions.triangles, sizeOf(mesh.points)))
      finding("the remeshed surface is not a sphere");
    geometryImageOfMesh(mesh);
  }
}

void fuzzTexture(Bytes& bytes, const Positions& points, Watch& watch) {
  const Mapped mapped = mapFrom(bytes, points, watch);
  TextureAtlasOptions options;
  options.chart = enumFrom<SphereChart>(bytes, 3);
  options.margin = realOr(bytes, 1.0 / 64);
  const Eigen::Vector3d direction(bytes.real(), bytes.real(), bytes.real());
  TextureAtlas atlas = makeTextureAtlas(mapped.triangles, mapped.sphere, options);
  if (!(atlas.coordinates.minCoeff() >= 0.0 && atlas.coordinates.maxCoeff() <= 1.0))
    finding("texture coordinates outside of [0, 1]");
  const std::uint8_t fault = bytes.byte();
  if (fault == 1)
    atlas.triangles.data()[bytes.byte() % atlas.triangles.size()] = bytes.raw<Index>();
  else if (fault == 2)
    atlas.coordinate_triangles.data()[bytes.byte() % atlas.coordinate_triangles.size()] =
        bytes.raw<Index>();
  else if (fault == 3)
    atlas.vertices[bytes.byte() % atlas.vertices.size()].vertices[1] = bytes.raw<Index>() % 1000;
  else if (fault == 4)
    atlas.coordinates(0, bytes.byte() % atlas.coordinates.cols()) = bytes.real();
  else if (fault == 5)
    atlas.chart = static_cast<SphereChart>(bytes.integer());
  BakeOptions bake;
  bake.height = atMost(40, integerOr(bytes, 16), 16384);
  bake.gutter = integerOr(bytes, 2);
  bake.threads = integerOr(bytes, 0);
  if (bytes.oneIn(2)) {
    Positions colors = (points.array() - points.minCoeff()).matrix();
    colors *= 255.0 / std::max(colors.maxCoeff(), 1e-300);
    bakeColors(atlas, bytes.oneIn(2) ? points : colors, bake);
  } else {
    bakeCheckerboard(atlas, bytes.oneIn(8) ? points : mapped.sphere, integerOr(bytes, 8), bake);
  }
  const Eigen::Vector2d place = chartCoordinates(options, direction);
  if (!(place.minCoeff() >= 0.0 && place.maxCoeff() <= 1.0))
    finding("a direction outside of the chart");
}

void fuzzMorph(Bytes& bytes, const Positions& points, Watch& watch) {
  const std::size_t few = bytes.byte() % 16 + 4U;
  Bytes of_second = bytes;
  Positions second = fuzz::pointsFrom(of_second);
  if (static_cast<std::size_t>(second.cols()) > few)
    second.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(few));
  Bytes silence(nullptr, 0);
  Watch nobody(silence);
  const SphereSurface from = surfaceFrom(bytes, points, nobody);
  const SphereSurface to = surfaceFrom(bytes, second, nobody);
  MorphOptions options;
  options.align = bytes.oneIn(32);  // as long as all the rest together
  for (std::size_t i = bytes.below(4); i > 0; --i)
    options.pairs.push_back({bytes.index(static_cast<std::size_t>(points.cols()), false),
                             bytes.index(static_cast<std::size_t>(second.cols()), false)});
  options.connectivity = enumFrom<MorphConnectivity>(bytes, 2);
  options.samples = bytes.oneIn(8) ? bytes.raw<std::size_t>() : 12U + bytes.byte();
  if (options.samples > 1000 && options.samples <= std::size_t{1} << 24)
    options.samples = 1000;
  static_cast<Execution&>(options) = executionFrom(bytes, watch);
  const MorphResult result = morphSurfaces(from, to, options);
  if (!test::isSphereOverAll(result.triangles, sizeOf(result.first)) ||
      result.second.cols() != result.first.cols())
    finding("the morph is not a sphere");
  inBetween(result, bytes.real());
}

void fuzzHarmonics(Bytes& bytes, const Positions& points, Watch&) {
  SphericalHarmonics harmonics;
  harmonics.degree = atMost(8, bytes.integer(), 512);
  const int terms = harmonics.degree >= 0 && harmonics.degree < 512
                        ? (harmonics.degree + 1) * (harmonics.degree + 1)
                        : 1;
  harmonics.coefficients =
      Positions::Constant(3, bytes.oneIn(4) ? bytes.byte() : terms, bytes.real());
  if (evaluateSphericalHarmonics(harmonics, points, integerOr(bytes, 0)).cols() != points.cols())
    finding("not as many points as directions");
  if (points.cols() > 0)
    sphericalHarmonicsAt(points.col(0), atMost(30, bytes.integer(), 512));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array calls{fuzzPointSet,  fuzzTriangulation, fuzzGraph,   fuzzEmbedding,
                             fuzzOutliers,  fuzzChecks,        fuzzSurface, fuzzOptimization,
                             fuzzSmoothing, fuzzDiagnosis,     fuzzTexture, fuzzMorph,
                             fuzzHarmonics};
  Bytes bytes(data, size);
  const std::uint8_t which = bytes.byte();
  Watch watch(bytes);
  const std::size_t before = bytes.byte();
  // The points come last: a change of them moves no other byte.
  const std::size_t head = std::min<std::size_t>(size, 3 + 8 + before % 64);
  Bytes of_points(data + head, size - head);
  const Positions points = fuzz::pointsFrom(of_points);
  const Ending ending = fuzz::endingOf([&] { calls[which % calls.size()](bytes, points, watch); });
  if (!fuzz::wasEndedBy(watch, ending) && ending.kind == Ending::Kind::CallersFault)
    finding("an exception that no callback threw");
  return 0;
}
