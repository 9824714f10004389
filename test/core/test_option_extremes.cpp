#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/outliers.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/map/texture_atlas.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace spherical_param::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr double kHuge = std::numeric_limits<double>::max();
constexpr int kLeastInt = std::numeric_limits<int>::min();
constexpr int kMostInt = std::numeric_limits<int>::max();
const std::vector<int> kThreads{0, 1, 1024};
const std::vector<int> kNoThreads{-1, 1025, kLeastInt, kMostInt};

/// What came of a call: empty if it went well, else the message of InvalidInput. Nothing else may
/// come out.
template <typename Call>
std::string refusalOf(const Call& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

/// The values of one option that are to be taken, and those to be refused by name.
///
/// \param set puts a value into the options; \param call uses them.
template <typename Options, typename Set, typename Value>
void expectRange(const std::string& name, const Options& options, const Set& set,
                 const std::function<void(const Options&)>& call, const std::vector<Value>& good,
                 const std::vector<Value>& bad) {
  for (const Value& value : good) {
    Options changed = options;
    set(changed, value);
    EXPECT_EQ(refusalOf([&] { call(changed); }), "") << name << " = " << value;
  }
  for (const Value& value : bad) {
    Options changed = options;
    set(changed, value);
    const std::string refusal = refusalOf([&] { call(changed); });
    EXPECT_NE(refusal.find(name), std::string::npos)
        << name << " = " << value << " came to: \"" << refusal << "\"";
  }
}

/// A member's range.
#define EXPECT_RANGE(options, member, call, ...)                                                   \
  expectRange(                                                                                     \
      #member, options, [](auto& o, const auto& value) { o.member = value; }, call, __VA_ARGS__)
/// An enumeration's: all numbers but those of its `count` values are refused.
#define EXPECT_VALUES(options, member, count, call)                                                \
  expectRange(                                                                                     \
      #member, options,                                                                            \
      [](auto& o, int value) { o.member = static_cast<std::decay_t<decltype(o.member)>>(value); }, \
      call, std::vector<int>{0, (count)-1}, std::vector<int>{-1, count, kLeastInt, kMostInt})

using Ints = std::vector<int>;
using Reals = std::vector<double>;

Positions tetrahedron() {
  Positions points(3, 4);
  points << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  return points;
}

/// The least cloud, and one of a size at which all stages have something to do.
std::vector<Positions> clouds() {
  return {tetrahedron(), randomSphere(200, 7)};
}

/// A map that is one to one: the points are on the sphere.
struct Mapped {
  explicit Mapped(const Positions& cloud)
      : points(cloud), sphere(projectFromCentroid(cloud)),
        triangles(triangulateSphere(sphere).triangles) {}
  Positions points;
  Positions sphere;
  Triangles triangles;
};

Graph graphOf(const Positions& points) {
  return buildNeighborGraph(points, bruteForceNeighbors(points, 8)).graph;
}

TEST(OptionExtremes, ReconstructAnswersOrNamesTheOption) {
  for (const Positions& points : clouds()) {
    const NeighborLists lists = bruteForceNeighbors(points, 12);
    const auto n = static_cast<Index>(points.cols());
    const std::function<void(const Options&)> call = [&](const Options& options) {
      const Result result = reconstruct(points, lists, options);
      EXPECT_TRUE(isSphereOverAll(result.triangles, n));
      EXPECT_TRUE(result.sphere.allFinite());
    };
    Options iterative;
    iterative.solver = EmbeddingMethod::Iterative;
    for (Options options : {Options(), iterative}) {
      EXPECT_VALUES(options, graph, 2, call);
      EXPECT_VALUES(options, solver, 2, call);
      EXPECT_VALUES(options, hull, 2, call);
      EXPECT_VALUES(options, weights, 3, call);
      EXPECT_VALUES(options, optimization, 3, call);
      EXPECT_RANGE(options, k, call, Ints{3, kMostInt}, Ints{2, 0, -1, kLeastInt});
      EXPECT_RANGE(options, lambda, call, Reals{kTiny, 1e-300, 1.0},
                   Reals{0.0, -kTiny, 1.0000000000000002, kInfinity, -kInfinity, kNan, kHuge});
      EXPECT_RANGE(options, tolerance, call, Reals{0.0, kTiny, kHuge, kInfinity},
                   Reals{-kTiny, -kInfinity, kNan});
      EXPECT_RANGE(options, max_iterations, call, Ints{0, 1}, Ints{-1, kLeastInt});
      EXPECT_RANGE(options, stagnation_window, call, Ints{0, 2, kMostInt}, Ints{1, -1, kLeastInt});
      EXPECT_RANGE(options, starts, call, Ints{1, 100}, Ints{0, 101, kLeastInt, kMostInt});
      EXPECT_RANGE(options, attempts, call, Ints{1, 100}, Ints{0, 101, kLeastInt, kMostInt});
      EXPECT_RANGE(options, seed, call, std::vector<std::uint32_t>{0, 0xffffffffU},
                   std::vector<std::uint32_t>{});
      expectRange(
          "steps", options, [](Options& o, int steps) { o.smoothing_steps = steps; }, call,
          Ints{0, 1, 10000}, Ints{-1, 10001, kLeastInt, kMostInt});
      expectRange(
          "vertices", options, [](Options& o, int value) { o.history.vertices = value; }, call,
          Ints{0, 1, 1 << 24}, Ints{-1, (1 << 24) + 1, kLeastInt, kMostInt});
      options.history.vertices = 10;
      expectRange(
          "frames", options, [](Options& o, int value) { o.history.frames = value; }, call,
          Ints{2, 10000}, Ints{1, 0, 10001, kLeastInt, kMostInt});
      EXPECT_RANGE(options, threads, call, kThreads, kNoThreads);
    }
    EXPECT_RANGE(Options(), exponent, call, Reals{2.0000000000000004, 16.0},
                 Reals{2.0, 16.000000000000004, 0.0, -3.0, kInfinity, kNan, kTiny});
    EXPECT_RANGE(iterative, exponent, call, Reals{3.0}, Reals{2.5, 4.0, kNan});
    iterative.max_iterations = kMostInt;
    iterative.tolerance = 1e-2;
    call(iterative);
    // Many extremes together.
    Options all;
    all.k = kMostInt;
    all.lambda = kTiny;
    all.tolerance = kInfinity;
    all.exponent = 16.0;
    all.starts = 1;
    all.seed = 0xffffffffU;
    all.threads = 1024;
    all.history = {1 << 24, 10000};
    all.details = true;
    call(all);
  }
}

TEST(OptionExtremes, StagesAnswerOrNameTheOption) {
  for (const Positions& points : clouds()) {
    const NeighborLists lists = bruteForceNeighbors(points, 12);
    const Graph graph = graphOf(points);
    const Mapped mapped(points);

    const std::function<void(const NeighborGraphOptions&)> nearest =
        [&](const NeighborGraphOptions& o) { buildNeighborGraph(points, lists, o); };
    EXPECT_RANGE(NeighborGraphOptions(), k, nearest, Ints{3, kMostInt}, Ints{2, kLeastInt});

    const std::function<void(const LocalDelaunayOptions&)> local =
        [&](const LocalDelaunayOptions& o) { buildLocalDelaunayGraph(points, lists, o); };
    const LocalDelaunayOptions delaunay;
    EXPECT_VALUES(delaunay, agreement, 2, local);
    EXPECT_RANGE(delaunay, tangent_neighbors, local, Ints{3, 32}, Ints{2, kLeastInt});
    EXPECT_RANGE(delaunay, max_candidates, local, Ints{10, kMostInt}, Ints{9, -1, kLeastInt});
    EXPECT_RANGE(delaunay, max_slope, local, Reals{kTiny, 1.0}, Reals{0.0, 1.1, kInfinity, kNan});
    EXPECT_RANGE(delaunay, threads, local, kThreads, kNoThreads);

    const std::function<void(const EmbeddingOptions&)> iterate = [&](const EmbeddingOptions& o) {
      embedOnSphere(graph, points, o);
    };
    EmbeddingOptions embedding;
    embedding.max_iterations = 50;
    EXPECT_VALUES(embedding, weights, 3, iterate);
    EXPECT_RANGE(embedding, stagnation_change, iterate, Reals{0.0, kHuge, kInfinity},
                 Reals{-kTiny, kNan});
    EXPECT_RANGE(embedding, threads, iterate, kThreads, kNoThreads);

    const std::function<void(const HierarchyOptions&)> coarsen = [&](const HierarchyOptions& o) {
      embedMultilevel(graph, buildGraphHierarchy(graph, o));
    };
    EXPECT_RANGE(HierarchyOptions(), coarsest_size, coarsen, Ints{4, kMostInt},
                 Ints{3, 0, kLeastInt});
    EXPECT_RANGE(HierarchyOptions(), threads, coarsen, kThreads, kNoThreads);

    const std::function<void(const MultilevelOptions&)> multilevel =
        [&](const MultilevelOptions& o) { embedMultilevel(graph, GraphHierarchy(), o); };
    EXPECT_VALUES(MultilevelOptions(), weights, 3, multilevel);
    EXPECT_RANGE(MultilevelOptions(), sweeps, multilevel, Ints{0, 1000}, Ints{-1, kLeastInt});
    EXPECT_RANGE(MultilevelOptions(), solved_size, multilevel, Ints{0, kMostInt},
                 Ints{-1, kLeastInt});
    EXPECT_RANGE(MultilevelOptions(), threads, multilevel, kThreads, kNoThreads);

    const std::function<void(const TriangulationOptions&)> triangulate =
        [&](const TriangulationOptions& o) { triangulateSphere(mapped.sphere, o); };
    EXPECT_VALUES(TriangulationOptions(), method, 2, triangulate);

    const std::function<void(const OutlierOptions&)> outliers = [&](const OutlierOptions& o) {
      findOutliers(points, lists, o);
    };
    EXPECT_RANGE(OutlierOptions(), sigma, outliers, Reals{0.0, 1000.0},
                 Reals{-kTiny, 1000.1, kInfinity, kNan});
    EXPECT_RANGE(OutlierOptions(), k, outliers, Ints{3, kMostInt}, Ints{2, kLeastInt});
    EXPECT_RANGE(OutlierOptions(), least_score, outliers, Reals{0.0, kHuge}, Reals{-kTiny, kNan});
    EXPECT_RANGE(OutlierOptions(), threads, outliers, kThreads, kNoThreads);

    const std::function<void(const OptimizationOptions&)> optimize =
        [&](const OptimizationOptions& o) { optimizeMesh(points, mapped.triangles, graph, o); };
    EXPECT_VALUES(OptimizationOptions(), method, 3, optimize);
    EXPECT_RANGE(OptimizationOptions(), threads, optimize, kThreads, kNoThreads);

    const std::function<void(const SmoothingOptions&)> smooth = [&](const SmoothingOptions& o) {
      EXPECT_TRUE(smoothSurface(points, mapped.triangles, o).points.allFinite());
    };
    EXPECT_VALUES(SmoothingOptions(), method, 3, smooth);
    EXPECT_RANGE(SmoothingOptions(), steps, smooth, Ints{0, 10000},
                 Ints{-1, 10001, kLeastInt, kMostInt});
    EXPECT_RANGE(SmoothingOptions(), threads, smooth, kThreads, kNoThreads);
    SmoothingOptions umbrella;
    umbrella.method = SmoothingMethod::Umbrella;
    expectRange(
        "lambda", umbrella, [](SmoothingOptions& o, double x) { o.umbrella_lambda = x; }, smooth,
        Reals{kTiny, 1.0}, Reals{0.0, 1.1, kInfinity, kNan});
    SmoothingOptions taubin;
    taubin.method = SmoothingMethod::Taubin;
    expectRange(
        "lambda", taubin, [](SmoothingOptions& o, double x) { o.taubin_lambda = x; }, smooth,
        Reals{kTiny, 0.9}, Reals{0.0, 1.1, kInfinity, kNan});
    expectRange(
        "pass", taubin, [](SmoothingOptions& o, double x) { o.taubin_pass_band = x; }, smooth,
        Reals{0.0, 0.1}, Reals{-kTiny, 1.0, kInfinity, kNan});

    const std::function<void(const SelfIntersectionOptions&)> intersect =
        [&](const SelfIntersectionOptions& o) {
          findSelfIntersections(points, mapped.triangles, o);
        };
    EXPECT_RANGE(SelfIntersectionOptions(), threads, intersect, kThreads, kNoThreads);
    const std::function<void(const TopologyOptions&)> check = [&](const TopologyOptions& o) {
      checkTopology(mapped.triangles, static_cast<std::size_t>(points.cols()), o);
    };
    EXPECT_RANGE(TopologyOptions(), threads, check, kThreads, kNoThreads);
    const std::function<void(const MeasureOptions&)> measure = [&](const MeasureOptions& o) {
      measureMesh(points, mapped.triangles, o);
    };
    EXPECT_RANGE(MeasureOptions(), threads, measure, kThreads, kNoThreads);
  }
}

TEST(OptionExtremes, MapsAnswerOrNameTheOption) {
  for (const Positions& points : clouds()) {
    const Mapped mapped(points);
    const std::function<void(const SphereMapOptions&)> map = [&](const SphereMapOptions& o) {
      const SphereMap result = computeSphereMap(points, mapped.triangles, mapped.sphere, o);
      EXPECT_EQ(result.distortion.flipped_triangles, 0);
    };
    SphereMapOptions few;
    few.sweeps = 2;
    EXPECT_RANGE(few, area_weight, map, Reals{0.0, kTiny, 1.0},
                 Reals{-kTiny, 1.0000000000000002, kInfinity, kNan});
    EXPECT_RANGE(few, sweeps, map, Ints{0, 1}, Ints{-1, 1001, kLeastInt, kMostInt});
    EXPECT_RANGE(few, threads, map, kThreads, kNoThreads);

    const std::function<void(const SphereSurfaceOptions&)> make =
        [&](const SphereSurfaceOptions& o) {
          const SphereSurface made(points, mapped.triangles, mapped.sphere, o);
          made.evaluate(Eigen::Vector3d(kTiny, 0.0, 0.0));
          made.evaluate(Eigen::Vector3d(kHuge, -kHuge, kTiny));
        };
    EXPECT_VALUES(SphereSurfaceOptions(), fit, 2, make);
    EXPECT_RANGE(SphereSurfaceOptions(), threads, make, kThreads, kNoThreads);

    const SphereSurface surface(points, mapped.triangles, mapped.sphere);
    const std::function<void(const MorphOptions&)> morph = [&](const MorphOptions& o) {
      const MorphResult result = morphSurfaces(surface, surface, o);
      EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(result.first.cols())));
    };
    MorphOptions plain;
    plain.align = false;
    plain.samples = 100;
    EXPECT_VALUES(plain, connectivity, 2, morph);
    EXPECT_RANGE(plain, threads, morph, kThreads, kNoThreads);
    EXPECT_RANGE(plain, samples, morph, std::vector<std::size_t>{12},
                 std::vector<std::size_t>{0, 11, (std::size_t{1} << 24) + 1,
                                          std::numeric_limits<std::size_t>::max()});
    plain.pairs.assign(4097, {});
    EXPECT_NE(refusalOf([&] { morph(plain); }).find("pairs"), std::string::npos);
    plain.pairs = {{kLeastInt, 0}, {0, kMostInt}, {-1, -1}, {0, 0}};
    EXPECT_EQ(morphSurfaces(surface, surface, plain).impossible.size(), 3U);

    const std::function<void(const TextureAtlasOptions&)> lay_out =
        [&](const TextureAtlasOptions& o) {
          bakeCheckerboard(makeTextureAtlas(mapped.triangles, mapped.sphere, o), mapped.sphere, 8,
                           {16, 0, 0});
          chartCoordinates(o, Eigen::Vector3d(0.0, kTiny, -kHuge));
        };
    EXPECT_VALUES(TextureAtlasOptions(), chart, 3, lay_out);
    EXPECT_RANGE(TextureAtlasOptions(), margin, lay_out, Reals{0.0, 0.2499},
                 Reals{-kTiny, 0.25, kInfinity, kNan});
    EXPECT_NE(refusalOf([&] {
                chartCoordinates({static_cast<SphereChart>(3), 0.0}, Eigen::Vector3d::UnitX());
              }).find("chart"),
              std::string::npos);
    const TextureAtlas atlas = makeTextureAtlas(mapped.triangles, mapped.sphere);
    const std::function<void(const BakeOptions&)> bake = [&](const BakeOptions& o) {
      bakeCheckerboard(atlas, mapped.sphere, 8, o);
    };
    const BakeOptions small{16, 0, 0};
    EXPECT_RANGE(small, height, bake, Ints{16, 17}, Ints{15, 16385, kLeastInt, kMostInt});
    EXPECT_RANGE(small, gutter, bake, Ints{0, 256}, Ints{-1, 257, kLeastInt, kMostInt});
    EXPECT_RANGE(small, threads, bake, kThreads, kNoThreads);

    for (const int degree : {-1, 513, kLeastInt, kMostInt}) {
      EXPECT_THROW(computeSphericalHarmonics(surface, degree), InvalidInput) << degree;
      EXPECT_THROW(sphericalHarmonicsAt(Eigen::Vector3d::UnitX(), degree), InvalidInput) << degree;
    }
    EXPECT_EQ(sphericalHarmonicsAt(Eigen::Vector3d::UnitX(), 512).size(), 513 * 513);
    for (const int frequency : {0, -1, kLeastInt, kMostInt})
      for (const int grid : {0, 1, 2, -1})
        EXPECT_THROW(makeGridSphere(static_cast<SphereGrid>(grid), frequency), InvalidInput);
    EXPECT_THROW(makeGridSphere(static_cast<SphereGrid>(2), 1), InvalidInput);
    for (const std::size_t count : {std::size_t{0}, (std::size_t{1} << 24) + 1})
      EXPECT_THROW(sampleEvenly(surface, count), InvalidInput) << count;
    for (const int side : {kLeastInt, -1, 0, 1, 2, 4, 16386, 16387, kMostInt})
      EXPECT_THROW(makeGeometryImage(surface, side), InvalidInput) << side;
  }
}

TEST(OptionExtremes, DiagnosisAnswersOrNamesTheOption) {
  for (const Positions& points : clouds()) {
    const Mapped mapped(points);
    const Graph graph = graphOf(points);
    const std::function<void(const DiagnosisOptions&)> diagnose = [&](const DiagnosisOptions& o) {
      diagnoseSurface(points, mapped.triangles, graph, {}, o);
    };
    const DiagnosisOptions options;
    EXPECT_RANGE(options, lid_diameter, diagnose, Reals{kTiny, kHuge, kInfinity},
                 Reals{0.0, -1.0, kNan});
    EXPECT_RANGE(options, part_gap, diagnose, Reals{kTiny, kHuge, kInfinity},
                 Reals{0.0, -1.0, kNan});
    EXPECT_RANGE(options, handle_steps, diagnose, Ints{3, 100}, Ints{2, 101, kLeastInt, kMostInt});
    EXPECT_RANGE(options, threads, diagnose, kThreads, kNoThreads);
  }
}

// --- Data that do not fit
// -------------------------------------------------------------------------

TEST(BrokenData, GraphsThatDoNotFitAreInvalidInput) {
  const Positions points = randomSphere(30, 2);
  const Mapped mapped(points);
  const Graph good = graphOf(points);
  std::vector<Graph> broken(6, good);
  broken[0].offsets.clear();
  broken[1].lengths.pop_back();
  broken[2].neighbors[5] = 30;
  broken[3].neighbors[5] = -1;
  std::swap(broken[4].offsets[3], broken[4].offsets[4]);
  broken[5].offsets[0] = 1;
  for (std::size_t i = 0; i < broken.size(); ++i) {
    const Graph& graph = broken[i];
    EXPECT_THROW(buildGraphHierarchy(graph), InvalidInput) << i;
    EXPECT_THROW(embedOnSphere(graph, points), InvalidInput) << i;
    EXPECT_THROW(embedMultilevel(graph, GraphHierarchy()), InvalidInput) << i;
    EXPECT_THROW(meanTangentialLaplacian(graph, mapped.sphere, EdgeWeights::Uniform), InvalidInput)
        << i;
    EXPECT_THROW(optimizeMesh(points, mapped.triangles, graph), InvalidInput) << i;
  }
  HierarchyOptions coarsening;
  coarsening.coarsest_size = 4;
  const GraphHierarchy hierarchy = buildGraphHierarchy(good, coarsening);
  ASSERT_FALSE(hierarchy.levels.empty());
  std::vector<GraphHierarchy> wrong(4, hierarchy);
  wrong[0].levels[0].aggregate_of[7] = 30;
  wrong[1].levels[0].seeds[0] = -1;
  wrong[2].levels[0].prolongation.resize(29, 3);
  wrong[3].levels[0].graph.neighbors[0] = 1000;
  for (const GraphHierarchy& other : wrong)
    EXPECT_THROW(embedMultilevel(good, other), InvalidInput);
}

TEST(BrokenData, MeshesAndAtlasesThatDoNotFitAreInvalidInput) {
  const Mapped mapped(randomSphere(30, 2));
  for (const Index index : {-1, 30, kLeastInt, kMostInt}) {
    Triangles triangles = mapped.triangles;
    triangles(1, 7) = index;
    EXPECT_THROW(signedVolume(mapped.points, triangles), InvalidInput) << index;
    EXPECT_THROW(surfaceArea(mapped.points, triangles), InvalidInput) << index;
    EXPECT_THROW(areaWeightedNormals(mapped.points, triangles), InvalidInput) << index;
  }
  const TextureAtlas good = makeTextureAtlas(mapped.triangles, mapped.sphere);
  std::vector<TextureAtlas> broken(5, good);
  broken[0].vertices[3].vertices[1] = -1;
  broken[1].triangles(0, 0) = static_cast<Index>(good.vertices.size());
  broken[2].coordinate_triangles(2, 4) = -5;
  broken[3].coordinates(0, 2) = kNan;
  broken[4].chart = static_cast<SphereChart>(17);
  for (const TextureAtlas& atlas : broken)
    EXPECT_THROW(bakeCheckerboard(atlas, mapped.sphere, 8, {16, 0, 0}), InvalidInput);
  MorphResult morph;
  morph.first.resize(3, 4);
  morph.second.resize(3, 5);
  EXPECT_THROW(inBetween(morph, 0.5), InvalidInput);
}

// --- Progress callbacks that end the work --------------------------------------------------------

/// What no library throws.
struct CallersFault {
  int number;
};

using Callback = std::function<bool(double)>;
using Outcome = std::pair<Triangles, Positions>;
using Work = std::function<Outcome(const Callback&)>;

bool areSame(const Outcome& a, const Outcome& b) {
  return a.first == b.first && a.second == b.second;
}

/// Throws, and cancels, at every call of the callback, or at some `most` of them where one takes
/// long: what comes out is that, and the next call works as the first one did.
void expectEndsAtEveryCall(const Work& work, int most = std::numeric_limits<int>::max()) {
  const Outcome plain = work({});
  int calls = 0;
  const auto caller = std::this_thread::get_id();
  EXPECT_TRUE(areSame(plain, work([&](double) {
                        EXPECT_EQ(std::this_thread::get_id(), caller);
                        ++calls;
                        return true;
                      })));
  ASSERT_GT(calls, 0);
  const int step = 1 + (calls - 1) / most;
  for (int k = 0; k < calls; k += step)
    for (const bool throws : {true, false}) {
      int seen = 0;
      const Callback at_k = [&](double) {
        EXPECT_LE(seen, k) << "called again after it ended the work";
        if (seen++ < k)
          return true;
        if (throws)
          throw CallersFault{k};
        return false;
      };
      try {
        work(at_k);
        ADD_FAILURE() << "call " << k << " of " << calls << " did not end the work";
      } catch (const CallersFault& fault) {
        EXPECT_TRUE(throws);
        EXPECT_EQ(fault.number, k);
      } catch (const Cancelled&) {
        EXPECT_FALSE(throws);
      }
    }
  EXPECT_TRUE(areSame(plain, work({})));
}

/// reconstruct() as such work.
Work reconstruction(const Positions& points, Options options) {
  return [points, options](const Callback& callback) {
    Options with = options;
    if (callback)
      with.progress = [&](const Progress& progress) { return callback(progress.fraction); };
    const Result result = reconstruct(points, bruteForceNeighbors(points, 12), with);
    return Outcome(result.triangles, result.sphere);
  };
}

Positions noisySphere() {
  return withNoise(spiralSphere(60), 0.1, 3);
}

TEST(ProgressCallback, EndsReconstructAtEveryCall) {
  Options options;
  options.smoothing_steps = 2;
  options.history.vertices = 10;
  expectEndsAtEveryCall(reconstruction(tetrahedron(), options));
  expectEndsAtEveryCall(reconstruction(noisySphere(), options));
  Options of_paper;
  of_paper.graph = GraphMethod::NearestNeighbors;
  of_paper.solver = EmbeddingMethod::Iterative;
  of_paper.hull = TriangulationMethod::Qhull;
  of_paper.max_iterations = 20;
  expectEndsAtEveryCall(reconstruction(noisySphere(), of_paper));
}

TEST(ProgressCallback, EndsReconstructBySearchAtEveryCall) {
  const Positions points = noisySphere();
  expectEndsAtEveryCall([&](const Callback& callback) {
    Options options;
    if (callback)
      options.progress = [&](const Progress& progress) { return callback(progress.fraction); };
    const Result result = reconstruct(
        points,
        [](const Positions& nodes, const std::vector<Index>&) { return bruteForceSearch(nodes); },
        options);
    return Outcome(result.triangles, result.sphere);
  });
}

TEST(ProgressCallback, EndsStagesAtEveryCall) {
  const Positions points = noisySphere();
  const NeighborLists lists = bruteForceNeighbors(points, 12);
  const Graph graph = graphOf(points);
  const Mapped mapped(points);
  const Triangles none(3, 0);
  expectEndsAtEveryCall([&](const Callback& callback) {
    LocalDelaunayOptions options;
    options.progress = callback;
    const NeighborGraph made = buildLocalDelaunayGraph(points, lists, options);
    return Outcome(none, Positions::Constant(3, 1, static_cast<double>(made.graph.edgeCount())));
  });
  expectEndsAtEveryCall([&](const Callback& callback) {
    EmbeddingOptions options;
    options.max_iterations = 10;
    if (callback)
      options.progress = [&](int, double residual) { return callback(residual); };
    return Outcome(none, embedOnSphere(graph, points, options).directions);
  });
  expectEndsAtEveryCall([&](const Callback& callback) {
    HierarchyOptions coarsening;
    coarsening.coarsest_size = 10;
    coarsening.progress = callback;
    MultilevelOptions options;
    options.tolerance = 1e-6;
    if (callback)
      options.progress = [&](double share, double) { return callback(share); };
    return Outcome(
        none, embedMultilevel(graph, buildGraphHierarchy(graph, coarsening), options).directions);
  });
  for (const auto method : {TriangulationMethod::Qhull, TriangulationMethod::Incremental})
    expectEndsAtEveryCall([&](const Callback& callback) {
      TriangulationOptions options;
      options.method = method;
      options.progress = callback;
      return Outcome(triangulateSphere(mapped.sphere, options).triangles, Positions(3, 0));
    });
  for (const auto method :
       {OptimizationMethod::None, OptimizationMethod::Flips, OptimizationMethod::Full})
    expectEndsAtEveryCall([&](const Callback& callback) {
      OptimizationOptions options;
      options.method = method;
      // This one may throw, and has no other say.
      if (callback)
        options.progress = [&](double share) {
          if (!callback(share))
            throw Cancelled("optimizeMesh");
        };
      return Outcome(optimizeMesh(points, mapped.triangles, graph, options).triangles,
                     Positions(3, 0));
    });
  expectEndsAtEveryCall([&](const Callback& callback) {
    SelfIntersectionOptions options;
    options.progress = callback;
    const auto pairs = findSelfIntersections(points, mapped.triangles, options);
    return Outcome(none, Positions::Constant(3, 1, static_cast<double>(pairs.size())));
  });
}

TEST(ProgressCallback, EndsMapsAndMorphsAtEveryCall) {
  const Positions points = noisySphere();
  const Mapped mapped(points);
  expectEndsAtEveryCall([&](const Callback& callback) {
    SphereMapOptions options;
    options.sweeps = 3;
    options.progress = callback;
    return Outcome(Triangles(3, 0),
                   computeSphereMap(points, mapped.triangles, mapped.sphere, options).sphere);
  });
  const Mapped other(randomSphere(40, 5));
  const SphereSurface from(points, mapped.triangles, mapped.sphere);
  const SphereSurface to(other.points, other.triangles, other.sphere);
  for (const auto connectivity : {MorphConnectivity::AllVertices, MorphConnectivity::Resampled})
    expectEndsAtEveryCall(
        [&](const Callback& callback) {
          MorphOptions options;
          options.connectivity = connectivity;
          options.samples = 100;
          options.align = connectivity == MorphConnectivity::AllVertices;
          options.pairs = {{0, 0}, {7, 20}};
          options.progress = callback;
          const MorphResult result = morphSurfaces(from, to, options);
          return Outcome(result.triangles, result.second);
        },
        8);
}

TEST(ProgressCallback, EndsOneOfSeveralThreadsAlone) {
  const Positions points = noisySphere();
  const Work work = reconstruction(points, Options());
  const Outcome plain = work({});
  // Not of bool: the answers of threads must not share a byte.
  const auto good = runTogether(6, [&](std::size_t i) -> int {
    const auto caller = std::this_thread::get_id();
    int calls = 0;
    bool is_from_caller = true;
    const Callback callback = [&](double) {
      is_from_caller = is_from_caller && std::this_thread::get_id() == caller;
      if (i % 3 == 1 && ++calls > 5)
        throw CallersFault{static_cast<int>(i)};
      return i % 3 != 2 || ++calls <= 9;
    };
    try {
      const bool is_right = areSame(work(callback), plain);
      return i % 3 == 0 && is_right && is_from_caller ? 1 : 0;
    } catch (const CallersFault& fault) {
      return i % 3 == 1 && fault.number == static_cast<int>(i) && is_from_caller ? 1 : 0;
    } catch (const Cancelled&) {
      return i % 3 == 2 && is_from_caller ? 1 : 0;
    }
  });
  for (std::size_t i = 0; i < good.size(); ++i)
    EXPECT_EQ(good[i], 1) << i;
}

}  // namespace
}  // namespace spherical_param::test
