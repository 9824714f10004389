// What holds of every public function of core and map: the same bits for any number of threads and
// beside other calls; progress comes from the calling thread and can end the work at every call;
// surfaces do not depend on order, place and scale.

#include "public_functions.h"

#include <iterator>
#include <tuple>

namespace spherical_param::test {
namespace {

std::vector<Function> allFunctions() {
  return functionsOf({addReconstructions, addFunctionsOfTheCore, addMaps});
}

// More points than are left to a single thread, also on coarser levels.
TEST(Contract, ThreadsAndReportsChangeNoBit) {
  const Inputs inputs(20000);
  for (const auto& [name, run, last_fraction] : allFunctions()) {
    SCOPED_TRACE(name);
    const Numbers alone = run(inputs, Execution{1});
    EXPECT_FALSE(alone == Numbers());
    EXPECT_TRUE(alone == run(inputs, Execution{2}));
    std::vector<double> fractions;
    const auto see = [&, caller = std::this_thread::get_id()](const Progress& progress) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      fractions.push_back(progress.fraction);
      return true;
    };
    EXPECT_TRUE(alone == run(inputs, Execution{5, see}));
    EXPECT_EQ(areFractions(fractions), last_fraction.has_value());
    EXPECT_TRUE(!last_fraction || fractions.back() == *last_fraction);
  }
}

TEST(Contract, EveryReportCanEndTheWorkByCancellingOrThrowingAndTheNextCallIsClean) {
  struct CallersFault {};  // what no library throws
  const Inputs inputs(100);
  for (const auto& [name, run, last_fraction] : allFunctions()) {
    if (!last_fraction)
      continue;
    SCOPED_TRACE(name);
    std::size_t calls = 0;
    std::size_t last = 0;
    bool throws = false;
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
      throws = false;
      calls = 0;
      EXPECT_THROW(run(inputs, execution), Cancelled) << last;
      EXPECT_EQ(calls, last);  // it was not called again
      throws = true;
      calls = 0;
      EXPECT_THROW(run(inputs, execution), CallersFault) << last;
      EXPECT_EQ(calls, last);
    }
    EXPECT_TRUE(plain == run(inputs, {}));
  }
}

TEST(Concurrency, CallsAgreeWithSingleOnesOfOneThread) {
  const auto expect = [](const std::vector<Function>& functions, const std::vector<Inputs>& inputs,
                         int threads) {
    for (const Function& function : functions) {
      const auto together = runTogether(inputs.size(), [&](std::size_t i) {
        return function.run(inputs[i], Execution{threads});
      });
      for (std::size_t i = 0; i < inputs.size(); ++i)
        EXPECT_TRUE(together[i] == function.run(inputs[i], Execution{1}))
            << function.name << " " << i;
    }
  };
  std::vector<Function> functions = allFunctions();
  expect(functions, {Inputs(150), Inputs(200), Inputs(150), Inputs(250)}, 1);
  functions.resize(2);  // of different methods of the optimisation
  expect(functions, {Inputs(5000), Inputs(5500)}, 3);
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
  const auto ended = runTogether(4, [](std::size_t i) -> std::size_t {
    std::size_t calls = 0;
    Options options;
    options.progress = [&](const Progress&) { return i % 2 == 0 || ++calls < 9; };
    try {
      surfaceOf(ellipsoid(200), options);
    } catch (const Cancelled&) {
      return 1;
    }
    return 0;
  });
  EXPECT_EQ(ended, (std::vector<std::size_t>{0, 1, 0, 1}));
}

using Faces = std::vector<std::array<Index, 3>>;

/// The triangles of all surfaces of a cloud, as indices of its points.
Triangles trianglesOf(const Positions& cloud, const Options& options) {
  const Result result = reconstruct(cloud, options);
  Triangles all(3, 0);
  for (const Surface& surface : result.surfaces) {
    const Eigen::Index before = all.cols();
    all.conservativeResize(3, before + surface.triangles.cols());
    all.rightCols(surface.triangles.cols()) = surface.triangles.unaryExpr(
        [&](Index v) { return surface.input_of_vertex[static_cast<std::size_t>(v)]; });
  }
  return all;
}

TEST(Contract, SurfacesDoNotDependOnOrderPlaceAndScale) {
  const Eigen::Matrix3d turn = rotationBy(1.0, {1.0, 2.0, 3.0});
  const Positions two = twoSpheres(700, 500, 4.0);
  const Positions stray = horizontally(two, 1.5 * spiralSphere(20));
  const Options parts = given("parts", "each", "outliers", 4.0);
  const std::vector<std::tuple<const char*, Positions, Options>> cases = {
      {"ellipsoid", ellipsoid(1000), given(sphere(), "tolerance", 1e-9)},
      {"tube", bentTube(12.0, 2.0, 12).points, sphere()},
      {"openings", sphereWithHoles(2500, 3, 0.3), given("surface", "open")},
      {"handles", plateWithHoles(0.1), {}},
      {"parts", stray, given(parts, "outliers", "auto")},
      {"parts and deviating points", stray, parts},
      {"consolidated", withNoise(two, 0.01, 2), given(parts, "consolidation", "auto")}};
  for (const auto& [name, shape, options] : cases) {
    SCOPED_TRACE(name);
    // Without ties: four points of a regular tube would be on a circle.
    const Positions cloud = withNoise(shape, 0.003, 3);
    const Faces expected = canonical(trianglesOf(cloud, options));
    const std::vector<Index> order = shuffledRange(cloud.cols(), 3);
    const Positions moved =
        (7.0 * turn * cloud(Eigen::all, order)).colwise() + Eigen::Vector3d(3.0, -2.0, 5.0);
    const Faces found = canonical(trianglesOf(moved, options).unaryExpr([&](Index v) {
      return order[static_cast<std::size_t>(v)];
    }));
    Faces common;
    std::set_intersection(expected.begin(), expected.end(), found.begin(), found.end(),
                          std::back_inserter(common));
    EXPECT_GE(common.size() + expected.size() / 200, expected.size());  // rounding decides a few
    EXPECT_EQ(found.size(), expected.size());
    for (const double scale : {0x1p-70, 0x1p6})
      EXPECT_EQ(canonical(trianglesOf(scale * cloud, options)), expected);
  }
}

}  // namespace
}  // namespace spherical_param::test
