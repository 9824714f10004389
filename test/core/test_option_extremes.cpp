#include "embedding_starts.h"
#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/outliers.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/self_intersection.h"

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
      : points(cloud), sphere(internal::projectFromCentroid(cloud)),
        triangles(triangulateSphere(sphere).triangles) {}
  Positions points;
  Positions sphere;
  Triangles triangles;
};

Graph graphOf(const Positions& points) {
  return buildNeighborGraph(points, bruteForceNeighbors(points, 8)).graph;
}

TEST(OptionExtremes, ManyExtremesTogetherAreMeshed) {
  for (const Positions& points : clouds()) {
    Options all;
    all.graph.k = kMostInt;
    all.embedding.damping = kTiny;
    all.embedding.tolerance = 1.0;
    all.embedding.exponent = 16.0;
    all.embedding.starts = 1;
    all.embedding.history = {1 << 24, 10000};
    all.seed = 0xffffffffU;
    all.threads = 1024;
    all.details = true;
    for (const EmbeddingMethod method : {EmbeddingMethod::Multilevel, EmbeddingMethod::Iterative}) {
      all.embedding.method = method;
      const Result result = reconstruct(points, all);
      EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(points.cols())));
      EXPECT_TRUE(result.sphere.allFinite());
      all.embedding.exponent = 3.0;
      all.embedding.max_iterations = kMostInt;
      all.embedding.damping = 0.5;
      all.embedding.tolerance = 1e-2;
    }
  }
}

TEST(OptionExtremes, StagesAnswerOrNameTheOption) {
  for (const Positions& points : clouds()) {
    const NeighborLists lists = bruteForceNeighbors(points, 12);
    const Mapped mapped(points);
    const std::function<void(const GraphOptions&)> build = [&](const GraphOptions& o) {
      buildNeighborGraph(points, lists, o);
    };
    EXPECT_VALUES(GraphOptions(), agreement, 2, build);
    EXPECT_RANGE(GraphOptions(), k, build, Ints{3, kMostInt}, Ints{2, kLeastInt});

    const std::function<void(const OutlierOptions&)> outliers = [&](const OutlierOptions& o) {
      findOutliers(points, lists, o);
    };
    EXPECT_RANGE(OutlierOptions(), sigma, outliers, Reals{0.0, 1000.0},
                 Reals{-kTiny, 1000.1, kInfinity, kNan});
    EXPECT_RANGE(OutlierOptions(), k, outliers, Ints{3, kMostInt}, Ints{2, kLeastInt});
    EXPECT_RANGE(OutlierOptions(), least_score, outliers, Reals{0.0, kHuge}, Reals{-kTiny, kNan});

    const std::function<void(const SmoothingOptions&)> smooth = [&](const SmoothingOptions& o) {
      EXPECT_TRUE(smoothSurface(points, mapped.triangles, o).points.allFinite());
    };
    EXPECT_VALUES(SmoothingOptions(), method, 2, smooth);
    expectRange(
        "smoothing", SmoothingOptions(), [](SmoothingOptions& o, int steps) { o.steps = steps; },
        smooth, Ints{0, 10000}, Ints{-1, 10001, kLeastInt, kMostInt});
  }
}

TEST(OptionExtremes, ThreadsOutOfRangeAreRefusedByEveryStageWhateverItsInput) {
  const Positions points = randomSphere(200, 7);
  const NeighborLists lists = bruteForceNeighbors(points, 12);
  const Graph graph = graphOf(points);
  const Mapped mapped(points);
  const Triangles& triangles = mapped.triangles;
  const auto n = static_cast<std::size_t>(points.cols());
  const std::vector<std::pair<const char*, std::function<void(const Execution&)>>> stages{
      {"reconstruct",
       [&](const Execution& e) {
         Options options;
         options.threads = e.threads;
         reconstruct(points, options);
       }},
      {"findNearestNeighbors without points",
       [&](const Execution& e) { findNearestNeighbors(Positions(3, 0), 12, e); }},
      {"makeNeighborSearch", [&](const Execution& e) { makeNeighborSearch(points, e); }},
      {"findNearestNeighbors", [&](const Execution& e) { findNearestNeighbors(points, 12, e); }},
      {"buildNeighborGraph",
       [&](const Execution& e) { buildNeighborGraph(points, lists, {}, {}, e); }},
      {"buildNeighborGraph of nearest neighbours",
       [&](const Execution& e) { buildNeighborGraph(points, lists, nearest(), {}, e); }},
      {"embed", [&](const Execution& e) { embed(graph, points, {}, 1, e); }},
      {"embed without nodes",
       [&](const Execution& e) { embed(Graph(), Positions(3, 0), {}, 1, e); }},
      {"triangulateSphere", [&](const Execution& e) { triangulateSphere(mapped.sphere, {}, e); }},
      {"optimizeMesh",
       [&](const Execution& e) { optimizeMesh(points, triangles, graph, {}, 1, e); }},
      {"findSelfIntersections",
       [&](const Execution& e) { findSelfIntersections(points, triangles, e); }},
      {"findSelfIntersections without triangles",
       [&](const Execution& e) { findSelfIntersections(points, Triangles(3, 0), e); }},
      {"findSelfIntersectionsOf nothing",
       [&](const Execution& e) { findSelfIntersectionsOf(points, triangles, {}, e); }},
      {"findOutliers", [&](const Execution& e) { findOutliers(points, lists, {}, e); }},
      {"findOutliers without points",
       [&](const Execution& e) { findOutliers(Positions(3, 0), {}, e); }},
      {"smoothSurface",
       [&](const Execution& e) { smoothSurface(points, triangles, {}, e.threads); }},
      {"smoothSurface without triangles",
       [&](const Execution& e) { smoothSurface(points, Triangles(3, 0), {}, e.threads); }},
      {"checkTopology", [&](const Execution& e) { checkTopology(triangles, n, e.threads); }},
      {"measureMesh", [&](const Execution& e) { measureMesh(points, triangles, e.threads); }},
      {"diagnoseSurface",
       [&](const Execution& e) { diagnoseSurface(points, triangles, graph, {}, {}, e.threads); }},
      {"measureMapDistortion without triangles", [&](const Execution& e) {
         measureMapDistortion(points, Triangles(3, 0), mapped.sphere, e.threads);
       }}};
  for (const auto& [name, run] : stages) {
    for (const int threads : kThreads)
      EXPECT_EQ(refusalOf([&, &call = run] { call(onThreads(threads)); }), "") << name;
    for (const int threads : kNoThreads)
      EXPECT_NE(refusalOf([&, &call = run] { call(onThreads(threads)); }).find("threads"),
                std::string::npos)
          << name << " with " << threads;
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
  }
}

TEST(OptionExtremes, MorphsAnswerOrNameTheOption) {
  for (const Positions& points : clouds()) {
    const Mapped mapped(points);
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
  }
}

TEST(OptionExtremes, AtlasesAnswerOrNameTheOption) {
  for (const Positions& points : clouds()) {
    const Mapped mapped(points);
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
  }
}

TEST(OptionExtremes, SeriesAndResamplingRefuseSizesOutOfRange) {
  for (const Positions& points : clouds()) {
    const Mapped mapped(points);
    const SphereSurface surface(points, mapped.triangles, mapped.sphere);
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

// --- Data that do not fit ------------------------------------------------------------------------

TEST(BrokenData, GraphsThatDoNotFitAreInvalidInput) {
  const Positions points = randomSphere(30, 2);
  const Mapped mapped(points);
  const Graph good = graphOf(points);
  std::vector<Graph> broken(10, good);
  broken[0].offsets.clear();
  broken[1].lengths.pop_back();
  broken[2].neighbors[5] = 30;
  broken[3].neighbors[5] = -1;
  std::swap(broken[4].offsets[3], broken[4].offsets[4]);
  broken[5].offsets[0] = 1;
  // Paths over negative lengths would get shorter forever.
  broken[6].lengths[7] = -1.0;
  broken[7].lengths[7] = -std::numeric_limits<double>::min();
  broken[8].lengths[7] = kInfinity;
  broken[9].lengths[7] = kNan;
  for (std::size_t i = 0; i < broken.size(); ++i) {
    const Graph& graph = broken[i];
    EXPECT_THROW(embed(graph, points), InvalidInput) << i;
    EXPECT_THROW(meanTangentialLaplacian(graph, mapped.sphere, EdgeWeights::Uniform), InvalidInput)
        << i;
    EXPECT_THROW(optimizeMesh(points, mapped.triangles, graph), InvalidInput) << i;
  }
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
    const Result result = reconstruct(points, with);
    return Outcome(result.triangles, result.sphere);
  };
}

Positions noisySphere() {
  return withNoise(spiralSphere(60), 0.1, 3);
}

TEST(ProgressCallback, EndsReconstructAtEveryCall) {
  Options options;
  options.smoothing.steps = 2;
  options.embedding.history.vertices = 10;
  expectEndsAtEveryCall(reconstruction(tetrahedron(), options));
  expectEndsAtEveryCall(reconstruction(noisySphere(), options));
  Options of_paper;
  of_paper.graph.method = GraphMethod::NearestNeighbors;
  of_paper.embedding.method = EmbeddingMethod::Iterative;
  of_paper.triangulation.method = TriangulationMethod::Qhull;
  of_paper.embedding.max_iterations = 20;
  expectEndsAtEveryCall(reconstruction(noisySphere(), of_paper));
}

TEST(ProgressCallback, EndsStagesAtEveryCall) {
  const Positions points = noisySphere();
  const NeighborLists lists = bruteForceNeighbors(points, 12);
  const Graph graph = graphOf(points);
  const Mapped mapped(points);
  const Triangles none(3, 0);
  const auto number = [&](std::size_t count) {
    return Outcome(none, Positions::Constant(3, 1, static_cast<double>(count)));
  };
  expectEndsAtEveryCall([&](const Callback& callback) {
    return number(
        buildNeighborGraph(points, lists, {}, {}, reportingTo(callback)).graph.edgeCount());
  });
  for (const auto method : {EmbeddingMethod::Iterative, EmbeddingMethod::Multilevel})
    expectEndsAtEveryCall([&](const Callback& callback) {
      EmbeddingOptions options;
      options.method = method;
      options.max_iterations = 10;
      options.tolerance = 1e-6;
      return Outcome(none, embed(graph, points, options, 1, reportingTo(callback)).directions);
    });
  for (const auto method : {TriangulationMethod::Qhull, TriangulationMethod::Incremental})
    expectEndsAtEveryCall([&](const Callback& callback) {
      const Execution execution = reportingTo(callback);
      return Outcome(triangulateSphere(mapped.sphere, {method}, execution).triangles,
                     Positions(3, 0));
    });
  for (const auto method :
       {OptimizationMethod::None, OptimizationMethod::Flips, OptimizationMethod::Full})
    expectEndsAtEveryCall([&](const Callback& callback) {
      OptimizationOptions options;
      options.method = method;
      const Execution execution = reportingTo(callback);
      return Outcome(optimizeMesh(points, mapped.triangles, graph, options, 1, execution).triangles,
                     Positions(3, 0));
    });
  expectEndsAtEveryCall([&](const Callback& callback) {
    return number(findSelfIntersections(points, mapped.triangles, reportingTo(callback)).size());
  });
  expectEndsAtEveryCall([&](const Callback& callback) {
    return number(findOutliers(points, {}, reportingTo(callback)).indices.size());
  });
}

TEST(ProgressCallback, EndsMapsAndMorphsAtEveryCall) {
  const Positions points = noisySphere();
  const Mapped mapped(points);
  expectEndsAtEveryCall([&](const Callback& callback) {
    SphereMapOptions options;
    options.sweeps = 3;
    options.progress = reportingTo(callback).progress;
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
          options.progress = reportingTo(callback).progress;
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
