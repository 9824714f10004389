// The calls of fuzz_stages on the map and what is made of it.

#include "fuzz_stages.h"
#include "spherical_param/map/handle_cutting.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/map/texture_atlas.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace fuzz {

using namespace spherical_param;

namespace {

/// A surface and its map to the sphere.
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

void fuzzResampling(Bytes& bytes, const SphereSurface& surface, bool untangles) {
  const auto grid = bytes.choice<SphereGrid>(2);
  GridSphere directions = makeGridSphere(grid, atMost(4, bytes.integerOr(2), 1 << 15));
  if (bytes.oneIn(8))
    directions.triangles = trianglesFrom(bytes, directions.directions);
  ResampledMesh mesh = resampleSurface(surface, directions);
  if (bytes.oneIn(8))
    mesh.points(bytes.byte() % 3, bytes.byte() % mesh.points.cols()) = bytes.real();
  if (untangles)
    untangle(surface, mesh, bytes.integerOr(0));
  else
    removeIntersections(mesh, bytes.integerOr(0));
  require(isSphere(mesh.triangles, mesh.points) || !isSphere(directions.triangles, mesh.points),
          "the remeshed surface is a sphere");
  geometryImageOfMesh(mesh);
}

void fuzzCuts(Bytes& bytes) {
  const int rings = 3 + bytes.byte() % 8;
  const int around = 3 + bytes.byte() % 8;
  Triangles triangles = spherical_param::test::torusTriangles(rings, around);
  Positions points(3, rings * around);
  for (double& x : points.reshaped())
    x = bytes.byte();
  if (bytes.oneIn(8))
    triangles.data()[bytes.byte() % triangles.size()] = bytes.byte() % points.cols();
  if (bytes.oneIn(2))  // an opening
    triangles = Triangles(triangles.rightCols(triangles.cols() - 1 - bytes.byte() % 2));
  const CutMesh cut = cutHandles(points, triangles);
  require(checkTopology(cut.triangles, cut.vertex_of.size()).isOpenSurface(),
          "a cut torus is an open surface");
  const SphereMap map = computeSphereMap(cut.points, cut.triangles, {});
  TextureAtlas atlas = makeTextureAtlas(cut.triangles, map.sphere, {bytes.choice<SphereChart>(3)});
  CutMesh spoiled = cut;
  const std::uint8_t fault = bytes.byte();
  if (fault == 1)
    atlas.vertices[bytes.byte() % atlas.vertices.size()].vertices[1] = bytes.raw<Index>() % 1000;
  else if (fault == 2)
    atlas.triangles.data()[bytes.byte() % atlas.triangles.size()] = bytes.byte();
  else if (fault == 3)
    spoiled.vertex_of[bytes.byte() % spoiled.vertex_of.size()] = bytes.byte();
  else if (fault == 4)
    atlas.source.resize(bytes.byte());
  atlas = joinCuts(std::move(atlas), spoiled);
  const MeshTopology topology = checkTopology(atlas.triangles, atlas.vertices.size());
  require(fault > 1 || (topology.isSurface() && topology.genus == 1), "joined, it is a torus");
}

}  // namespace

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
    const SurfacePoints samples = sampleEvenly(surface, bytes.byte(), bytes.byte());
    require(samples.locations.size() == static_cast<std::size_t>(samples.points.cols()),
            "each sample has a place");
  } else if (how == 4) {
    const int side = atMost(17, bytes.integer() | 1, 16385);
    meshOfGeometryImage(makeGeometryImage(surface, side));
  } else {
    fuzzResampling(bytes, surface, how == 6);
  }
}

void fuzzTexture(Bytes& bytes, const Positions& points, Watch& watch) {
  if (bytes.oneIn(4)) {
    fuzzCuts(bytes);
    return;
  }
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

}  // namespace fuzz
