// What holds of every public function of core and map: the same bits for any number of threads and
// beside other calls; progress comes from the calling thread and can end the work at every call;
// surfaces do not depend on order, place and scale.

#include "public_functions.h"

#include <iterator>

namespace spherical_param::test {
namespace {

std::vector<Function> allFunctions() {
  return functionsOf({addReconstructions, addFunctionsOfTheCore, addMaps});
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
