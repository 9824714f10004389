// What holds of every public function of core and map, by one table: the same bits for any number
// of threads and beside other calls; progress comes from the calling thread and can end the work at
// every call; surfaces do not depend on order, place and scale.

#include "core/reconstructions.h"
#include "handle_shapes.h"
#include "map/map_shapes.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/result_fields.h"

#include <iterator>
#include <type_traits>

namespace spherical_param::test {
namespace {

/// All numbers of some values, one after the other: equal if the values are, bit by bit.
class Numbers {
public:
  template <typename... Values>
  explicit Numbers(const Values&... values) {
    (add(values), ...);
  }

  template <typename Value>
  void add(const Value& value) {
    if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>)
      numbers_.push_back(static_cast<double>(value));
    else if constexpr (std::is_base_of_v<Eigen::DenseBase<Value>, Value>)
      for (const auto number : value.reshaped())
        add(number);
    else
      for (const auto& part : value)
        add(part);
  }
  template <typename Value>
  void add(const std::optional<Value>& value) {
    add(value.has_value());
    add(value.value_or(0));
  }
  bool operator==(const Numbers& other) const { return numbers_ == other.numbers_; }

private:
  std::vector<double> numbers_;
};

/// A cloud of about n points for each kind of work, and meshes of as many.
struct Inputs {
  explicit Inputs(Index n) : size(n) {
    std::mt19937 random(7);
    for (Index change = 0; change < n / 20; ++change)
      damaged.data()[random() % static_cast<unsigned>(damaged.size())] =
          static_cast<Index>(random() % static_cast<unsigned>(n));
  }

  Index size;
  int rings = static_cast<int>(std::sqrt(2.5 * size));
  Positions cloud = withNoise(ellipsoid(size), 0.1 / std::sqrt(size), 1);
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
};

/// \return all that a function of the library answers.
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

Numbers numbersOf(const Result& result) {
  Numbers numbers;
  const auto add = [&](const ResultField&, const auto& value) { numbers.add(value); };
  visitValues(result.left_out, add);
  for (const Surface& surface : result.surfaces)
    visitValues(surface, add);
  return numbers;
}

void addReconstructions(const Add& add) {
  const auto add_of = [&](const std::string& what, Positions Inputs::*cloud,
                          const Options& options) {
    add("reconstruct(), " + what, 1.0, [=](const Inputs& in, const Execution& e) {
      return numbersOf(reconstruct(in.*cloud, with(options, e)));
    });
  };
  add_of("smoothed", &Inputs::rough, given(watched(), "smoothing", 2));
  add_of("converged", &Inputs::cloud, given("tolerance", 1e-7));
  const Options published = given(watched(paper()), "max_iterations", 5);
  for (const char* const weights : {"uniform", "inverse", "adaptive"})
    add_of("as published", &Inputs::rough, given(published, "weights", weights));
  add_of("open", &Inputs::holed, given("surface", "open"));
  add_of("filled", &Inputs::holed, given("surface", "closed", "fill", "smooth"));
  add_of("with a handle", &Inputs::torus, {});
  add_of("in parts", &Inputs::scattered,
         given("parts", "each", "outliers", 4.0, "consolidation", "auto"));
}

void addFunctionsOfTheCore(const Add& add) {
  for (const Options& options : {given("outliers", "auto"), given("outliers", 4.0)})
    add("findOutliers()", 1.0, [options](const Inputs& in, const Execution& e) {
      return Numbers(findOutliers(in.scattered, with(options, e)));
    });
  add("findParts()", 1.0, [](const Inputs& in, const Execution& e) {
    return Numbers(findParts(in.scattered, with(Options(), e)));
  });
  add("triangulateSphere()", 0.0, [](const Inputs& in, const Execution& e) {
    return Numbers(triangulateSphere(in.cloud.colwise().normalized(), e));
  });
  add("findSelfIntersections()", 1.0, [](const Inputs& in, const Execution& e) {
    const auto& [points, triangles] = in.knot;
    return Numbers(findSelfIntersections(points, triangles, e),
                   findSelfIntersectionsOf(points, triangles, {0, 5}, e));
  });
  add("checkTopology()", {}, [](const Inputs& in, const Execution& e) {
    const MeshTopology of = checkTopology(in.damaged, static_cast<std::size_t>(in.size), e.threads);
    return Numbers(of.vertices, of.edges, of.components, of.oriented, of.euler_characteristic,
                   of.nonmanifold_vertices, of.unused_vertices);
  });
  add("measureMesh()", {}, [](const Inputs& in, const Execution& e) {
    const MeshMeasures of = measureMesh(in.cloud, in.triangles, e.threads);
    return Numbers(of.volume, of.area, of.mean_edge_length, of.centroid, of.inertia);
  });
}

void addMaps(const Add& add) {
  add("computeSphereMap()", 1.0, [](const Inputs& in, const Execution& e) {
    SphereMapOptions options;
    options.sweeps = 2;
    const Mapped& mesh = in.bumps;
    return Numbers(
        computeSphereMap(mesh.points, mesh.triangles, mesh.sphere, with(options, e)).sphere);
  });
  add("morphSurfaces()", 1.0, [](const Inputs& in, const Execution& e) {
    MorphOptions options;
    const Mapped many = firstBlob().over(spiralSphere(in.size / 4));
    for (Index i = 2; i < in.few.points.cols(); i += 48)
      options.pairs.push_back({i, nearestTo(in.few.sphere.col(i), many)});
    const MorphResult of = morphSurfaces(in.few.surface(), many.surface(), with(options, e));
    return Numbers(of.rotation, of.alignment_error, of.first, of.second, of.sphere, of.triangles,
                   of.worst_pair);
  });
  add("measureMapDistortion()", {}, [](const Inputs& in, const Execution& e) {
    const MapDistortion of = measureMapDistortion(randomPositions(in.bumps.points.cols(), 4),
                                                  in.bumps.triangles, in.bumps.sphere, e.threads);
    return Numbers(of.mean_angle_difference, of.stretch_efficiency, of.angle.mean, of.angle.p95,
                   of.area.mean, of.area.max);
  });
  add("SphereSurface", {}, [](const Inputs& in, const Execution& e) {
    const SphereSurface surface = in.bumps.surface(SurfaceFit::Smooth, e.threads);
    const SurfaceSamples of = surface.evaluate(randomSphere(in.size / 4, 2));
    Numbers numbers(surface.area(), of.positions, of.normals);
    for (const SphereLocation& location : of.locations)
      numbers.add(location.weights);
    return numbers;
  });
  add("spherical harmonics", {}, [](const Inputs& in, const Execution& e) {
    const SphericalHarmonics of = computeSphericalHarmonics(in.few.surface(), 12, e.threads);
    return Numbers(of.coefficients, of.rms_residual,
                   evaluateSphericalHarmonics(of, randomSphere(in.size / 4, 2), e.threads));
  });
  for (const SphereChart chart :
       {SphereChart::Equirectangular, SphereChart::Octahedral, SphereChart::CubeMap})
    add("textures", {}, [chart](const Inputs& in, const Execution& e) {
      const TextureAtlas atlas = makeTextureAtlas(in.few.triangles, in.few.sphere, {chart, 0.1});
      const BakeOptions options{100, 5, e.threads};
      const TextureImage colors = bakeColors(atlas, 100.0 * in.few.sphere.cwiseAbs(), options);
      return Numbers(colors.pixels, colors.covered,
                     bakeCheckerboard(atlas, in.few.sphere, 8, options).pixels);
    });
}

std::vector<Function> allFunctions() {
  std::vector<Function> functions;
  const Add add = [&](const std::string& name, std::optional<double> last, const Run& run) {
    functions.push_back({name, run, last});
  };
  addReconstructions(add);
  addFunctionsOfTheCore(add);
  addMaps(add);
  return functions;
}

/// Notes the progress, and whether it is that of the calling thread.
struct Watch {
  std::thread::id caller = std::this_thread::get_id();
  std::vector<double> fractions = {};
  bool is_from_caller = true;

  bool see(const Progress& progress) {
    is_from_caller = is_from_caller && std::this_thread::get_id() == caller;
    fractions.push_back(progress.fraction);
    return true;
  }
};

// More points than are left to a single thread, also on coarser levels.
TEST(Contract, ThreadsAndReportsChangeNoBit) {
  const Inputs inputs(20000);
  for (const auto& [name, run, last_fraction] : allFunctions()) {
    SCOPED_TRACE(name);
    const Numbers alone = run(inputs, Execution{1});
    EXPECT_FALSE(alone == Numbers());
    EXPECT_TRUE(alone == run(inputs, Execution{2}));
    Watch watch;
    const auto see = [&](const Progress& progress) { return watch.see(progress); };
    EXPECT_TRUE(alone == run(inputs, Execution{5, see}));
    EXPECT_TRUE(watch.is_from_caller);
    EXPECT_EQ(areFractions(watch.fractions), last_fraction.has_value());
    EXPECT_TRUE(!last_fraction || watch.fractions.back() == *last_fraction);
  }
}

/// Ends a call of every function at each of its reports, by an exception of the caller's or by
/// cancelling.
void expectEndAtEveryReport(bool throws) {
  struct CallersFault {};  // what no library throws
  const Inputs inputs(100);
  for (const auto& [name, run, last_fraction] : allFunctions()) {
    if (!last_fraction)
      continue;
    SCOPED_TRACE(name);
    std::size_t calls = 0;
    std::size_t last = 0;
    Execution execution;
    execution.progress = [&](const Progress&) {
      if (++calls == last && throws)
        throw CallersFault();
      return calls != last;
    };
    const Numbers plain = run(inputs, execution);
    const std::size_t all = calls;
    EXPECT_GT(all, 0U);
    for (last = 1; last <= all; ++last) {
      calls = 0;
      if (throws)
        EXPECT_THROW(run(inputs, execution), CallersFault) << last;
      else
        EXPECT_THROW(run(inputs, execution), Cancelled) << last;
      EXPECT_EQ(calls, last);  // it was not called again
    }
    EXPECT_TRUE(plain == run(inputs, {}));
  }
}

TEST(Contract, EveryReportCanCancelTheWorkAndTheNextCallIsClean) {
  expectEndAtEveryReport(false);
}

TEST(Contract, WhatAReportThrowsComesOutAndTheNextCallIsClean) {
  expectEndAtEveryReport(true);
}

/// Expects of some functions what they answer alone, on one thread.
void expectTheSameTogether(const std::vector<Function>& functions,
                           const std::vector<Inputs>& inputs, int threads) {
  for (const Function& function : functions) {
    const auto together = runTogether(
        inputs.size(), [&](std::size_t i) { return function.run(inputs[i], Execution{threads}); });
    for (std::size_t i = 0; i < inputs.size(); ++i)
      EXPECT_TRUE(together[i] == function.run(inputs[i], Execution{1}))
          << function.name << " " << i;
  }
}

TEST(Concurrency, CallsOfEveryFunctionAgreeWithSingleOnes) {
  expectTheSameTogether(allFunctions(), {Inputs(150), Inputs(200), Inputs(150), Inputs(250)}, 1);
}

TEST(Concurrency, CallsOfSeveralThreadsEachAgreeWithThoseOfOne) {
  std::vector<Function> functions = allFunctions();
  functions.resize(2);  // of different methods of the optimisation
  expectTheSameTogether(functions, {Inputs(5000), Inputs(5500)}, 3);
}

TEST(Concurrency, ASurfaceIsSharedByThreads) {
  const Mapped bumps = bumpy(spiralSphere(350));
  const SphereSurface shared = bumps.surface();
  const Positions directions = randomSphere(300, 7);
  const auto evaluate = [&](std::size_t) { return shared.evaluate(directions).positions; };
  for (const Positions& positions : runTogether(4, evaluate))
    EXPECT_EQ(positions, evaluate(0));
}

TEST(Concurrency, EndingOneCallLeavesTheOthersAlone) {
  struct Fault {};
  // 0: done, 1: its own exception, 2: cancelled; negative: reported from another thread.
  const auto outcomes = runTogether(6, [](std::size_t i) -> int {
    Watch watch;
    Options options;
    options.progress = [&](const Progress& progress) {
      watch.see(progress);
      if (i % 3 == 1 && watch.fractions.size() > 5)
        throw Fault();
      return i % 3 != 2 || watch.fractions.size() <= 9;
    };
    int outcome = 0;
    try {
      surfaceOf(ellipsoid(200), options);
    } catch (const Fault&) {
      outcome = 1;
    } catch (const Cancelled&) {
      outcome = 2;
    }
    return watch.is_from_caller ? outcome : -1;
  });
  EXPECT_EQ(outcomes, (std::vector<int>{0, 1, 2, 0, 1, 2}));
}

using Faces = std::vector<std::array<Index, 3>>;

/// What a function makes of a cloud, as indices of its points.
struct Finder {
  std::string name;
  Positions cloud;
  std::function<Triangles(const Positions&)> find;
};

/// The triangles of a cloud, and its outliers as triangles of one point.
Triangles trianglesOf(const Positions& cloud, const Options& options) {
  const Result result = reconstruct(cloud, options);
  Triangles all = Eigen::Map<const Eigen::Matrix<Index, 1, Eigen::Dynamic>>(
                      result.left_out.outliers.data(),
                      static_cast<Eigen::Index>(result.left_out.outliers.size()))
                      .replicate(3, 1);
  for (const Surface& surface : result.surfaces) {
    const Eigen::Index before = all.cols();
    all.conservativeResize(3, before + surface.triangles.cols());
    all.rightCols(surface.triangles.cols()) = surface.triangles.unaryExpr(
        [&](Index v) { return surface.input_of_vertex[static_cast<std::size_t>(v)]; });
  }
  return all;
}

std::vector<Finder> finders() {
  std::vector<Finder> all;
  const auto add = [&](const char* name, const Positions& cloud, const Options& options) {
    // Without ties: four points of a regular tube would be on a circle.
    all.push_back({name, withNoise(cloud, 0.003, 3),
                   [options](const Positions& of) { return trianglesOf(of, options); }});
  };
  for (const Options& options : {sphere(), given(sphere(), "tolerance", 1e-9)}) {
    add("ellipsoid", ellipsoid(1000), options);
    add("tube", bentTube(12.0, 2.0, 12).points, options);
  }
  add("openings", sphereWithHoles(2500, 3, 0.3), given("surface", "open"));
  add("handles", plateWithHoles(0.1), {});
  const Positions two = twoSpheres(700, 500, 4.0);
  const Options parts = given("parts", "each", "outliers", 4.0);
  for (const Options& options : {given(parts, "outliers", "auto"), parts})
    add("parts and outliers", horizontally(two, 1.5 * spiralSphere(20)), options);
  add("consolidated", withNoise(two, 0.01, 2), given(parts, "consolidation", "auto"));
  all.push_back({"triangulateSphere()", randomSphere(5000, 1),
                 [](const Positions& of) { return triangulateSphere(of.colwise().normalized()); }});
  return all;
}

TEST(Contract, SurfacesDoNotDependOnOrderPlaceAndScale) {
  const Eigen::Matrix3d turn = rotationBy(1.0, {1.0, 2.0, 3.0});
  for (const auto& [name, cloud, find] : finders()) {
    SCOPED_TRACE(name);
    const Faces expected = canonical(find(cloud));
    const std::vector<Index> order = shuffledRange(cloud.cols(), 3);
    Positions moved = cloud(Eigen::all, order);
    const bool has_place = name != "triangulateSphere()";
    if (has_place)
      moved = (7.0 * turn * moved).colwise() + Eigen::Vector3d(3.0, -2.0, 5.0);
    const Faces found = canonical(
        find(moved).unaryExpr([&](Index v) { return order[static_cast<std::size_t>(v)]; }));
    Faces common;
    std::set_intersection(expected.begin(), expected.end(), found.begin(), found.end(),
                          std::back_inserter(common));
    // Rounding may decide a few.
    EXPECT_GE(common.size() + (has_place ? expected.size() / 200 : 0), expected.size());
    EXPECT_EQ(found.size(), expected.size());
    for (const double scale : {0x1p-70, 0x1p6})
      EXPECT_EQ(canonical(find(scale * cloud)), expected);
  }
}

}  // namespace
}  // namespace spherical_param::test
