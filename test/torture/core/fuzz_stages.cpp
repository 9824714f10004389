// Everything public besides reconstruct(), each on whatever bytes say: the first byte picks it.

#include "fuzz_input.h"
#include "spherical_param/embedding_history.h"
#include "spherical_param/graph_hierarchy.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_optimization.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/neighbor_graph.h"
#include "spherical_param/outliers.h"
#include "spherical_param/point_set.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/smoothing.h"
#include "spherical_param/sphere_embedding.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/sphere_triangulation.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/surface_diagnosis.h"
#include "spherical_param/map/texture_atlas.h"

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

/// One of `count` values of an enumeration, seldom none of them.
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
/// No more than what may be waited for; what is out of range stays so.
int atMost(int most, int value, int range) {
  return value > most && value <= range ? most : value;
}

Positions normalized(const Positions& points) {
  return points.allFinite() ? projectFromCentroid(points) : points;
}

/// A mesh on points on the sphere, or what is left of it.
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

/// The graph of lists between points, or what is left of it.
Graph graphFrom(Bytes& bytes, const Positions& points) {
  Graph graph;
  if (points.allFinite() && points.cols() > 0) {
    NeighborGraphOptions options;
    options.k = 6;
    graph = buildNeighborGraph(points, fuzz::nearest(points, 6), options).graph;
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

std::function<bool(double)> shares(Watch& watch, double& last) {
  if (!watch.listens())
    return {};
  return [&watch, &last](double share) {
    if (share < last)
      finding("the share of the work falls");
    last = share;
    return watch(share);
  };
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

void fuzzPointSet(Bytes&, const Positions& points, Watch&) {
  const DistinctPoints distinct = findDistinctPoints(points);
  if (distinct.input_of_vertex.size() != fuzz::countDistinct(points))
    finding("another number of distinct points");
  if (areCoplanar(points) != fuzz::liesInPlane(points))
    finding("coplanar or not");
  std::vector<Index> order = spatialOrder(points);
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != static_cast<Index>(i))
      finding("the order is no permutation");
  if (order.size() != static_cast<std::size_t>(points.cols()))
    finding("the order is too short");
  if (!fuzz::areUnitVectors(projectFromCentroid(points)) ||
      !fuzz::areUnitVectors(projectByRank(points)))
    finding("a start that is not of unit vectors");
}

void fuzzTriangulation(Bytes& bytes, const Positions& points, Watch& watch) {
  TriangulationOptions options;
  options.method = enumFrom<TriangulationMethod>(bytes, 2);
  double last = 0.0;
  options.progress = shares(watch, last);
  const bool is_raw = bytes.oneIn(8);
  const Positions sphere = is_raw ? points : normalized(points);
  const SphereTriangulation result = triangulateSphere(sphere, options);
  if (!test::isSphereOverAll(result.triangles, sizeOf(sphere)))
    finding("the triangulation is no sphere over all points");
}

void fuzzGraph(Bytes& bytes, const Positions& points, Watch& watch) {
  const auto n = static_cast<std::size_t>(points.cols());
  const bool is_wrong = bytes.oneIn(4);
  const NeighborLists lists =
      bytes.oneIn(2) ? fuzz::nearest(points, 12) : fuzz::arbitraryLists(bytes, n, n, !is_wrong);
  // Distinct and finite is a precondition that is not checked.
  if (!points.allFinite() || fuzz::countDistinct(points) != n)
    return;
  if (bytes.oneIn(2)) {
    NeighborGraphOptions options;
    options.k = integerOr(bytes, 25);
    checkGraph(buildNeighborGraph(points, lists, options), n);
    return;
  }
  LocalDelaunayOptions options;
  options.agreement = enumFrom<StarAgreement>(bytes, 2);
  options.tangent_neighbors = integerOr(bytes, 10);
  options.max_slope = realOr(bytes, 0.85);
  options.max_candidates = integerOr(bytes, 32);
  options.threads = integerOr(bytes, 0);
  double last = 0.0;
  options.progress = shares(watch, last);
  const std::uint8_t how = bytes.byte();
  if (how % 2 == 1)
    options.search = [&](const std::vector<Index>& queries, int) {
      return fuzz::arbitraryLists(bytes, queries.size(), n, how % 8 != 7);
    };
  checkGraph(buildLocalDelaunayGraph(points, lists, options), n);
}

void fuzzEmbedding(Bytes& bytes, const Positions& points, Watch& watch) {
  const Graph graph = graphFrom(bytes, points);
  if (bytes.oneIn(2)) {
    EmbeddingOptions options;
    options.weights = enumFrom<EdgeWeights>(bytes, 3);
    options.lambda = realOr(bytes, 0.5);
    options.max_iterations = atMost(300, integerOr(bytes, 100), std::numeric_limits<int>::max());
    options.tolerance = realOr(bytes, 1e-8);
    options.stagnation_window = integerOr(bytes, 100);
    options.stagnation_change = realOr(bytes, 1e-5);
    options.threads = integerOr(bytes, 0);
    if (watch.listens())
      options.progress = [&](int, double) { return watch(0.0); };
    const Embedding result = embedOnSphere(graph, points, options);
    if (result.directions.cols() != points.cols() ||
        (points.cols() > 0 && !fuzz::areUnitVectors(result.directions)))
      finding("the embedding is not of unit vectors");
    meanTangentialLaplacian(graph, result.directions, options.weights);
    return;
  }
  HierarchyOptions coarsening;
  coarsening.coarsest_size = bytes.oneIn(2) ? 4 : bytes.integer();
  coarsening.seed = bytes.byte();
  coarsening.threads = integerOr(bytes, 0);
  GraphHierarchy hierarchy = buildGraphHierarchy(graph, coarsening);
  if (bytes.oneIn(8) && !hierarchy.levels.empty())  // that of another graph
    hierarchy.levels.erase(hierarchy.levels.begin());
  EmbeddingRecorder recorder(graph.size(), GraphHierarchy(), {integerOr(bytes, 10), 20});
  MultilevelOptions options;
  options.weights = enumFrom<EdgeWeights>(bytes, 3);
  options.exponent = realOr(bytes, 3.0);
  options.lambda = realOr(bytes, 0.5);
  options.sweeps = atMost(1000, integerOr(bytes, 10), std::numeric_limits<int>::max());
  options.solved_size = integerOr(bytes, 10000);
  if (bytes.oneIn(2))
    options.tolerance = bytes.real();
  options.starts = atMost(10, integerOr(bytes, 2), 100);
  options.threads = integerOr(bytes, 0);
  if (watch.listens())
    options.progress = [&](double share, double) { return watch(share); };
  const MultilevelEmbedding result = embedMultilevel(graph, hierarchy, options);
  if (result.stop_reason != StopReason::Collapsed &&
      result.directions.cols() != static_cast<Eigen::Index>(graph.size()))
    finding("not a direction for each node");
}

void fuzzOutliers(Bytes& bytes, const Positions& points, Watch&) {
  const auto n = static_cast<std::size_t>(points.cols());
  OutlierOptions options;
  options.sigma = realOr(bytes, 4.0);
  options.k = integerOr(bytes, 16);
  options.least_score = realOr(bytes, 1.0);
  options.threads = integerOr(bytes, 0);
  const NeighborLists lists = bytes.oneIn(2) ? fuzz::nearest(points, 12)
                                             : fuzz::arbitraryLists(bytes, n, n, bytes.oneIn(2));
  const Outliers result = findOutliers(points, lists, options);
  if (result.scores.size() != n || !std::is_sorted(result.indices.begin(), result.indices.end()) ||
      std::any_of(result.indices.begin(), result.indices.end(),
                  [&](Index i) { return i < 0 || static_cast<std::size_t>(i) >= n; }))
    finding("outliers that are no points");
}

void fuzzChecks(Bytes& bytes, const Positions& points, Watch& watch) {
  const Triangles triangles = trianglesFrom(bytes, normalized(points));
  const auto n = static_cast<std::size_t>(points.cols());
  const MeshTopology topology = checkTopology(triangles, n, {integerOr(bytes, 0)});
  if (topology.isSphere() != test::isSphereOverAll(triangles, sizeOf(points)))
    finding("sphere or not");
  measureMesh(points, triangles, {integerOr(bytes, 0)});
  signedVolume(points, triangles);
  surfaceArea(points, triangles);
  areaWeightedNormals(points, triangles);
  SelfIntersectionOptions options;
  options.threads = integerOr(bytes, 0);
  double last = 0.0;
  options.progress = shares(watch, last);
  const auto pairs = findSelfIntersections(points, triangles, options);
  if (!std::is_sorted(pairs.begin(), pairs.end()))
    finding("pairs out of order");
  std::vector<Index> of;
  for (std::size_t i = bytes.below(8); i > 0; --i)
    of.push_back(bytes.index(static_cast<std::size_t>(triangles.cols()), false));
  options.progress = {};
  auto some = findSelfIntersectionsOf(points, triangles, of, options);
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
  options.seed = bytes.byte();
  options.threads = integerOr(bytes, 0);
  const std::uint8_t how = bytes.byte();
  if (how % 4 == 1)
    options.smoother = [&, how](const Triangles&, int) -> Positions {
      return how % 8 == 1 ? points : how % 8 == 5 ? Positions(3, 0) : Positions(2.0 * points);
    };
  options.finish_on_points = how % 2 == 0;
  if (watch.listens())
    options.progress = [&](double share) {
      if (!watch(share))
        throw Cancelled("the fuzzer's");
    };
  const MeshOptimization result = optimizeMesh(points, triangles, graph, options);
  if (!test::isSphereOverAll(result.triangles, sizeOf(points)))
    finding("the optimised mesh is no sphere over all points");
}

void fuzzSmoothing(Bytes& bytes, const Positions& points, Watch&) {
  const Triangles triangles = trianglesFrom(bytes, normalized(points));
  SmoothingOptions options;
  options.method = enumFrom<SmoothingMethod>(bytes, 3);
  options.steps = atMost(200, integerOr(bytes, 5), 10000);
  options.umbrella_lambda = realOr(bytes, 1.0);
  options.taubin_lambda = realOr(bytes, 0.8);
  options.taubin_pass_band = realOr(bytes, 0.05);
  options.restore_volume = bytes.oneIn(2);
  options.threads = integerOr(bytes, 0);
  const Smoothing result = smoothSurface(points, triangles, options);
  if (result.points.cols() != points.cols())
    finding("not as many smoothed points");
}

void fuzzDiagnosis(Bytes& bytes, const Positions& points, Watch&) {
  if (!points.allFinite() || points.cols() == 0)
    return;
  const Triangles triangles = trianglesFrom(bytes, normalized(points));
  NeighborGraphOptions by;
  by.k = 6;
  const NeighborGraph graph = buildNeighborGraph(points, fuzz::nearest(points, 6), by);
  std::vector<Bridge> bridges = graph.bridges;
  if (bytes.oneIn(4))
    bridges.push_back({bytes.index(static_cast<std::size_t>(points.cols()), false),
                       bytes.index(static_cast<std::size_t>(points.cols()), false), bytes.real()});
  DiagnosisOptions options;
  options.lid_diameter = realOr(bytes, 5.0);
  options.handle_steps = integerOr(bytes, 8);
  options.part_gap = realOr(bytes, 4.0);
  options.max_vertices = bytes.byte();
  options.threads = integerOr(bytes, 0);
  options.mark_triangles = bytes.oneIn(2);
  const SurfaceDiagnosis result = diagnoseSurface(points, triangles, graph.graph, bridges, options);
  if (options.mark_triangles &&
      result.triangle_marks.size() != static_cast<std::size_t>(triangles.cols()))
    finding("not a mark for each triangle");
}

/// A surface with a map that is one to one, or none at all.
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
  options.threads = integerOr(bytes, 0);
  double last = 0.0;
  options.progress = shares(watch, last);
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
      finding("the remeshed surface is no sphere");
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
  options.threads = integerOr(bytes, 0);
  double last = 0.0;
  options.progress = shares(watch, last);
  const MorphResult result = morphSurfaces(from, to, options);
  if (!test::isSphereOverAll(result.triangles, sizeOf(result.first)) ||
      result.second.cols() != result.first.cols())
    finding("the morph is no sphere");
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
  // The points come last, so that a change of theirs moves nothing else.
  const std::size_t head = std::min<std::size_t>(size, 3 + 8 + before % 64);
  Bytes of_points(data + head, size - head);
  const Positions points = fuzz::pointsFrom(of_points);
  const Ending ending = fuzz::endingOf([&] { calls[which % calls.size()](bytes, points, watch); });
  if (!fuzz::wasEndedBy(watch, ending) && ending.kind == Ending::Kind::CallersFault)
    finding("an exception that nobody threw");
  return 0;
}
