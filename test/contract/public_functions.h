#pragma once

#include "core/reconstructions.h"
#include "handle_shapes.h"
#include "map/map_shapes.h"
#include "numbers.h"
#include "paper_method.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"

#include <stdexcept>

/// The public functions of the core and the map in one table: for the tests of what holds of all of
/// them, and for the fuzzer.
namespace spherical_param::test {

/// What the functions are given: by default valid, a cloud of about n points for each kind of work,
/// meshes of as many, and options.
struct Inputs {
  explicit Inputs(Index n) : size(n) {
    std::mt19937 random(7);
    for (Index change = 0; change < n / 20; ++change)
      damaged.data()[random() % static_cast<unsigned>(damaged.size())] =
          static_cast<Index>(random() % static_cast<unsigned>(n));
    for (Index i = 2; i < few.points.cols(); i += 48)
      morph.pairs.push_back({i, nearestTo(few.sphere.col(i), many)});
  }

  Index size;
  int rings = static_cast<int>(std::sqrt(2.5 * size));
  Positions cloud = withNoise(ellipsoid(size), 0.1 / std::sqrt(size), 1);
  Positions directions = cloud.colwise().normalized();
  Positions rough = withNoise(randomSphere(size / 3, 8), 0.02, 9);
  Positions holed = sphereWithHoles(size, 3, 0.4);
  Positions torus = torusCloud(rings, 2 * rings / 5);
  Positions scattered =
      horizontally(cloud, Positions(cloud.leftCols(size / 2).array() + 3.0), 2.0 * spiralSphere(9));
  Triangles triangles = triangulateSphere(spiralSphere(size));
  Triangles damaged = triangles;
  Mesh knot = bentTube(20.0, 2.2 * kPi, rings / 5 + 4);  // into itself
  Mapped bumps = bumpy(spiralSphere(size / 4));
  Mapped few = firstBlob().over(spiralSphere(size / 30 + 30));
  Mapped many = firstBlob().over(spiralSphere(size / 4));

  Options options = given("outliers", "auto");
  std::vector<Index> chosen = {0, 5};  ///< triangles
  SphereMapOptions map = {{}, 0.85, 2};
  SurfaceFit fit = SurfaceFit::Smooth;
  MorphOptions morph = {};
  SphereGrid grid = SphereGrid::Octahedral;
  int frequency = 4;
  int degree = 12;  ///< of the harmonics
  double chart_margin = 0.1;
  BakeOptions bake = {100, 5, 0};
  int cells = 8;  ///< of the checkerboard
  Vector3d direction = {0.1, 0.2, 0.3};
  SphereLocation location = {0, {1.0, 0.0, 0.0}};
  double time = 0.5;  ///< of the in-between
};

/// Calls functions of the library and returns all numbers of their answers. A broken promise is a
/// std::logic_error.
using Run = std::function<Numbers(const Inputs&, const Execution&)>;

struct Function {
  std::string name;
  Run run;
  std::optional<double> last = {};  ///< fraction that its progress ends with; none: it has none
};

using Add = std::function<void(const std::string&, std::optional<double> last, const Run&)>;

template <typename Options>
Options with(Options options, const Execution& execution) {
  static_cast<Execution&>(options) = execution;
  return options;
}

inline void promise(bool holds, const char* what) {
  if (!holds)
    throw std::logic_error(std::string("not so: ") + what);
}

inline bool isSphere(const Triangles& triangles, const Positions& points) {
  return isSphereOverAll(triangles, static_cast<Index>(points.cols()));
}

inline void addReconstructions(const Add& add) {
  const auto add_of = [&](const std::string& what, Positions Inputs::*cloud,
                          const Options& options) {
    add("reconstruct(), " + what, 1.0, [=](const Inputs& in, const Execution& e) {
      return numbersOf(reconstruct(in.*cloud, with(options, e)));
    });
  };
  add_of("smoothed", &Inputs::rough, given(withDetails(), "smoothing", 2));
  add_of("converged", &Inputs::cloud, given("tolerance", 1e-7));
  const Options published = given(withDetails(paper()), "max_iterations", 5);
  for (const char* const weights : {"uniform", "inverse", "adaptive"})
    add_of("as published", &Inputs::rough, given(published, "weights", weights));
  add_of("open", &Inputs::holed, given("surface", "open"));
  add_of("filled", &Inputs::holed, given("surface", "closed", "fill", "smooth"));
  add_of("with a handle", &Inputs::torus, {});
  add_of("in parts", &Inputs::scattered,
         given("parts", "each", "outliers", 4.0, "consolidation", "auto"));
}

inline void addFunctionsOfTheCore(const Add& add) {
  add("findOutliers() and findParts()", 1.0, [](const Inputs& in, const Execution& e) {
    Numbers numbers;
    for (const Options& options : {in.options, given(in.options, "outliers", 4.0)}) {
      const std::vector<Index> outliers = findOutliers(in.scattered, with(options, e));
      const std::vector<std::vector<Index>> parts = findParts(in.scattered, with(options, e));
      std::set<Index> seen;
      const auto check = [&](const std::vector<Index>& points) {
        promise(std::is_sorted(points.begin(), points.end()), "points are in order");
        for (const Index i : points)
          promise(i >= 0 && i < in.scattered.cols() && seen.insert(i).second,
                  "a point is an outlier, or in one part");
      };
      check(outliers);
      std::for_each(parts.begin(), parts.end(), check);
      numbers.add(outliers);
      numbers.add(parts);
    }
    return numbers;
  });
  add("triangulateSphere()", 0.0, [](const Inputs& in, const Execution& e) {
    const Triangles triangles = triangulateSphere(in.directions, e);
    const Triangles hull = paper::convexHull(in.directions, e);  // of what is valid
    promise(isSphere(hull, in.directions) && isSphere(triangles, in.directions),
            "triangulations are spheres over all points");
    return Numbers(hull, triangles);
  });
  add("findSelfIntersections()", 1.0, [](const Inputs& in, const Execution& e) {
    const auto& [points, triangles] = in.knot;
    const auto pairs = findSelfIntersections(points, triangles, e);
    const auto some = findSelfIntersectionsOf(points, triangles, in.chosen, e);
    promise(std::is_sorted(pairs.begin(), pairs.end()), "pairs are in order");
    return Numbers(pairs, some);
  });
  add("checkTopology()", {}, [](const Inputs& in, const Execution& e) {
    const MeshTopology of = checkTopology(in.damaged, static_cast<std::size_t>(in.size), e.threads);
    promise(of.isSphere() == isSphereOverAll(in.damaged, in.size), "the mesh is a sphere or not");
    return Numbers(of.vertices, of.edges, of.components, of.oriented, of.euler_characteristic,
                   of.nonmanifold_vertices, of.unused_vertices);
  });
  add("measureMesh()", {}, [](const Inputs& in, const Execution& e) {
    const MeshMeasures of = measureMesh(in.cloud, in.triangles, e.threads);
    return Numbers(of.volume, of.area, of.mean_edge_length, of.centroid, of.inertia,
                   signedVolume(in.cloud, in.triangles), surfaceArea(in.cloud, in.triangles),
                   areaWeightedNormals(in.cloud, in.triangles));
  });
}

inline void addMaps(const Add& add) {
  add("computeSphereMap()", 1.0, [](const Inputs& in, const Execution& e) {
    const Mapped& mesh = in.bumps;
    const SphereMap map =
        computeSphereMap(mesh.points, mesh.triangles, mesh.sphere, with(in.map, e));
    promise(map.sphere.cols() == mesh.points.cols() &&
                (map.sphere.colwise().norm().array() - 1.0).abs().maxCoeff() < 1e-9,
            "the map is of unit vectors");
    promise(map.distortion.flipped_triangles == 0, "the map is one to one");
    return Numbers(map.sphere);
  });
  add("morphSurfaces()", 1.0, [](const Inputs& in, const Execution& e) {
    const MorphResult of = morphSurfaces(in.few.surface(), in.many.surface(), with(in.morph, e));
    promise(isSphere(of.triangles, of.first) && of.second.cols() == of.first.cols(),
            "the morph is a sphere");
    return Numbers(of.rotation, of.alignment_error, of.first, of.second, of.sphere, of.triangles,
                   of.worst_pair, inBetween(of, in.time));
  });
  add("measureMapDistortion()", {}, [](const Inputs& in, const Execution& e) {
    const MapDistortion of = measureMapDistortion(randomPositions(in.bumps.points.cols(), 4),
                                                  in.bumps.triangles, in.bumps.sphere, e.threads);
    return Numbers(of.mean_angle_difference, of.stretch_efficiency, of.angle.mean, of.angle.p95,
                   of.area.mean, of.area.max);
  });
  add("SphereSurface", {}, [](const Inputs& in, const Execution& e) {
    const SphereSurface surface = in.bumps.surface(in.fit, e.threads);
    const SurfaceSamples of = surface.evaluate(randomSphere(in.size / 4, 2));
    Numbers numbers(surface.area(), of.positions, of.normals);
    for (const SphereLocation& location : of.locations)
      numbers.add(location.weights);
    numbers.add(surface.evaluate(in.location).position);
    const SphereLocation location = surface.locate(in.direction);
    promise(location.triangle >= 0 && location.triangle < surface.triangles().cols() &&
                location.weights.minCoeff() >= 0.0 && std::abs(location.weights.sum() - 1.0) < 1e-9,
            "a direction is in a triangle");
    return numbers;
  });
  add("spherical harmonics", {}, [](const Inputs& in, const Execution& e) {
    const SphericalHarmonics of = computeSphericalHarmonics(in.few.surface(), in.degree, e.threads);
    return Numbers(of.coefficients, of.rms_residual, sphericalHarmonicsAt(in.direction, in.degree),
                   evaluateSphericalHarmonics(of, in.directions, e.threads));
  });
  add("remeshing", {}, [](const Inputs& in, const Execution& e) {
    const SphereSurface surface = in.few.surface(in.fit, e.threads);
    ResampledMesh mesh = resampleSurface(surface, makeGridSphere(in.grid, in.frequency));
    untangle(surface, mesh, e.threads);
    promise(isSphere(mesh.triangles, mesh.points), "the remeshed surface is a sphere");
    Numbers numbers(mesh.points, mesh.triangles);
    if (in.grid == SphereGrid::Octahedral)
      numbers.add(geometryImageOfMesh(mesh).positions);
    return numbers;
  });
  for (const SphereChart chart :
       {SphereChart::Equirectangular, SphereChart::Octahedral, SphereChart::CubeMap})
    add("textures", {}, [chart](const Inputs& in, const Execution& e) {
      const TextureAtlasOptions layout{chart, in.chart_margin};
      const TextureAtlas atlas = makeTextureAtlas(in.few.triangles, in.few.sphere, layout);
      promise(atlas.coordinates.minCoeff() >= 0.0 && atlas.coordinates.maxCoeff() <= 1.0,
              "texture coordinates are in [0, 1]");
      const BakeOptions bake{in.bake.height, in.bake.gutter, e.threads};
      const TextureImage baked = bakeColors(atlas, 100.0 * in.few.sphere.cwiseAbs(), bake);
      const Eigen::Vector2d place = chartCoordinates(layout, in.direction);
      promise(place.minCoeff() >= 0.0 && place.maxCoeff() <= 1.0, "a direction is in the chart");
      return Numbers(baked.pixels, baked.covered, place,
                     bakeCheckerboard(atlas, in.few.sphere, in.cells, bake).pixels);
    });
}

/// The functions of some of the parts above.
inline std::vector<Function> functionsOf(const std::vector<void (*)(const Add&)>& parts) {
  std::vector<Function> functions;
  const Add add = [&](const std::string& name, std::optional<double> last, const Run& run) {
    functions.push_back({name, run, last});
  };
  for (const auto& add_part : parts)
    add_part(add);
  return functions;
}

}  // namespace spherical_param::test
