// Every public function but reconstruct(): the first byte picks one. It is given any arguments. The
// watch is the callback and has to outlive the call.

#include "embedding.h"
#include "fuzz_input.h"
#include "paper_method.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/sphere_triangulation.h"

namespace fuzz {
namespace {

using namespace spherical_param;

/// Points on the sphere, unless they are not finite.
Positions normalized(const Positions& points) {
  return points.allFinite() ? internal::projectFromCentroid(points) : points;
}

/// A mesh on points on the sphere, sometimes spoiled.
Triangles trianglesFrom(Bytes& bytes, const Positions& sphere) {
  Triangles triangles(3, 0);
  if (sphere.cols() >= 4 && stress::areUnitVectors(sphere))
    triangles = triangulateSphere(sphere);
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
    for (Index& corner : triangles.reshaped())
      corner = bytes.index(n, how % 2 == 0);
  }
  return triangles;
}

/// Threads from bytes, and the watch as the callback.
Execution executionFrom(Bytes& bytes, Watch& watch) {
  Execution execution;
  execution.threads = bytes.integerOr(0);
  if (watch.listens())
    execution.progress = std::ref(watch);
  return execution;
}

/// Limits the time of the work; a value that is out of range is kept.
int atMost(int most, int value, int range) {
  return value > most && value <= range ? most : value;
}

bool isSphere(const Triangles& triangles, const Positions& points) {
  return test::isSphereOverAll(triangles, static_cast<Index>(points.cols()));
}

void fuzzTriangulation(Bytes& bytes, const Positions& points, Watch& watch) {
  const bool is_by_qhull = bytes.oneIn(2);
  const bool is_raw = bytes.oneIn(8);
  const Positions sphere = is_raw ? points : normalized(points);
  const Execution execution = executionFrom(bytes, watch);
  const Triangles triangles = is_by_qhull ? internal::paper::convexHull(sphere, execution)
                                          : triangulateSphere(sphere, execution);
  require(isSphere(triangles, sphere), "the triangulation is a sphere over all points");
}

void fuzzOutliers(Bytes& bytes, const Positions& points, Watch& watch) {
  const auto n = static_cast<std::size_t>(points.cols());
  const auto are_points = [&](const std::vector<Index>& some) {
    return std::is_sorted(some.begin(), some.end()) &&
           stress::areLists({{0, some.size()}, some}, 1, n);
  };
  Options options;
  static_cast<Execution&>(options) = executionFrom(bytes, watch);
  options.outliers = bytes.choice<OutlierMode>(4);
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
  std::vector<std::array<Index, 2>> expected;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(expected), [&](const auto& pair) {
    return std::find_first_of(of.begin(), of.end(), pair.begin(), pair.end()) != of.end();
  });
  require(some == expected || !haveExactProducts(points),
          "the pairs of some triangles are those among all");
}

struct Mapped {
  Triangles triangles;
  Positions sphere;
};

Mapped mapFrom(Bytes& bytes, const Positions& points, Watch& watch) {
  const Positions start = normalized(points);
  Mapped mapped{trianglesFrom(bytes, start), start};
  SphereMapOptions options;
  options.area_weight = bytes.realOr(0.85);
  options.sweeps = atMost(20, bytes.integerOr(3), 1000);
  static_cast<Execution&>(options) = executionFrom(bytes, watch);
  if (bytes.oneIn(16) && start.cols() > 0)
    mapped.sphere(bytes.byte() % 3, bytes.byte() % start.cols()) = bytes.real();
  const SphereMap map = computeSphereMap(points, mapped.triangles, mapped.sphere, options);
  require(map.sphere.cols() == points.cols() && stress::areUnitVectors(map.sphere),
          "the map is of unit vectors");
  require(map.distortion.flipped_triangles == 0, "the map is one to one");
  if (!bytes.oneIn(8))  // else the start, which may be folded
    mapped.sphere = map.sphere;
  return mapped;
}

SphereSurface surfaceFrom(Bytes& bytes, const Positions& points, Watch& watch) {
  const Mapped mapped = mapFrom(bytes, points, watch);
  SphereSurfaceOptions options;
  options.fit = bytes.choice<SurfaceFit>(2);
  options.threads = bytes.integerOr(0);
  return {points, mapped.triangles, mapped.sphere, options};
}

void fuzzResampling(Bytes& bytes, const SphereSurface& surface) {
  const auto grid = bytes.choice<SphereGrid>(2);
  GridSphere directions = makeGridSphere(grid, atMost(4, bytes.integerOr(2), 1 << 15));
  if (bytes.oneIn(8))
    directions.triangles = trianglesFrom(bytes, directions.directions);
  ResampledMesh mesh = resampleSurface(surface, directions);
  if (bytes.oneIn(8))
    mesh.points(bytes.byte() % 3, bytes.byte() % mesh.points.cols()) = bytes.real();
  untangle(surface, mesh, bytes.integerOr(0));
  require(isSphere(mesh.triangles, mesh.points) || !isSphere(directions.triangles, mesh.points),
          "the remeshed surface is a sphere");
}

void fuzzSurface(Bytes& bytes, const Positions& points, Watch& watch) {
  const SphereSurface surface = surfaceFrom(bytes, points, watch);
  const Eigen::Vector3d direction(bytes.real(), bytes.real(), bytes.real());
  const int how = bytes.byte() % 8;
  if (how == 0) {
    const SphereLocation location = surface.locate(direction);
    require(location.triangle >= 0 && location.triangle < surface.triangles().cols() &&
                location.weights.minCoeff() >= 0.0 && std::abs(location.weights.sum() - 1.0) < 1e-9,
            "a direction is in a triangle");
    surface.evaluate(location);
  } else if (how == 1) {
    SphereLocation location;
    location.triangle = bytes.index(static_cast<std::size_t>(surface.triangles().cols()));
    location.weights = direction;
    surface.evaluate(location);
  } else if (how == 2) {
    computeSphericalHarmonics(surface, atMost(8, bytes.integer(), 512), bytes.integerOr(0));
  } else if (how == 3) {
    fuzzResampling(bytes, surface);
  }
}

void fuzzTexture(Bytes& bytes, const Positions& points, Watch& watch) {
  const Mapped mapped = mapFrom(bytes, points, watch);
  TextureAtlasOptions options;
  options.chart = bytes.choice<SphereChart>(3);
  options.margin = bytes.realOr(1.0 / 64);
  const Eigen::Vector3d direction(bytes.real(), bytes.real(), bytes.real());
  TextureAtlas atlas = makeTextureAtlas(mapped.triangles, mapped.sphere, options);
  require(atlas.coordinates.minCoeff() >= 0.0 && atlas.coordinates.maxCoeff() <= 1.0,
          "texture coordinates are in [0, 1]");
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
  bake.height = atMost(40, bytes.integerOr(16), 16384);
  bake.gutter = bytes.integerOr(2);
  bake.threads = bytes.integerOr(0);
  if (bytes.oneIn(2)) {
    Positions colors = (points.array() - points.minCoeff()).matrix();
    colors *= 255.0 / std::max(colors.maxCoeff(), 1e-300);
    bakeColors(atlas, bytes.oneIn(2) ? points : colors, bake);
  } else {
    bakeCheckerboard(atlas, bytes.oneIn(8) ? points : mapped.sphere, bytes.integerOr(8), bake);
  }
  const Eigen::Vector2d place = chartCoordinates(options, direction);
  require(place.minCoeff() >= 0.0 && place.maxCoeff() <= 1.0, "a direction is in the chart");
}

void fuzzMorph(Bytes& bytes, const Positions& points, Watch& watch) {
  const Eigen::Index few = bytes.byte() % 16 + 4;
  Bytes of_second = bytes;
  Positions second = pointsFrom(of_second);
  second.conservativeResize(Eigen::NoChange, std::min(second.cols(), few));
  Bytes silence(nullptr, 0);
  Watch nobody(silence);
  const SphereSurface from = surfaceFrom(bytes, points, nobody);
  const SphereSurface to = surfaceFrom(bytes, second, nobody);
  MorphOptions options;
  options.align = bytes.oneIn(32);  // as long as all the rest together
  for (std::size_t i = bytes.below(4); i > 0; --i)
    options.pairs.push_back({bytes.index(static_cast<std::size_t>(points.cols())),
                             bytes.index(static_cast<std::size_t>(second.cols()))});
  options.connectivity = bytes.choice<MorphConnectivity>(2);
  options.samples = bytes.oneIn(8) ? bytes.raw<std::size_t>() : 12U + bytes.byte();
  if (options.samples > 1000 && options.samples <= std::size_t{1} << 24)
    options.samples = 1000;
  static_cast<Execution&>(options) = executionFrom(bytes, watch);
  const MorphResult result = morphSurfaces(from, to, options);
  require(isSphere(result.triangles, result.first) && result.second.cols() == result.first.cols(),
          "the morph is a sphere");
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
  require(evaluateSphericalHarmonics(harmonics, points, bytes.integerOr(0)).cols() == points.cols(),
          "each direction has a point");
  if (points.cols() > 0)
    sphericalHarmonicsAt(points.col(0), atMost(30, bytes.integer(), 512));
}

}  // namespace
}  // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fuzz;
  using Call = void (*)(Bytes&, const Positions&, Watch&);
  constexpr std::array<Call, 7> calls{fuzzTriangulation, fuzzOutliers, fuzzChecks,   fuzzSurface,
                                      fuzzTexture,       fuzzMorph,    fuzzHarmonics};
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
