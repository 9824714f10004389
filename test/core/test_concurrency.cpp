// Calls from several threads share nothing. A program of its own, so that the thread sanitizer has
// no more to build than this.

#include "qhull.h"
#include "reconstructions.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/sphere_triangulation.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace spherical_param {
namespace {

constexpr std::size_t kCount = 4;

Positions ellipsoid(std::size_t i) {
  return Eigen::Vector3d(1.0, 0.8, 0.5).asDiagonal() *
         test::spiralSphere(200 + 50 * static_cast<Index>(i));
}

template <typename Run>
void expectTheSameAlone(const Run& run) {
  const auto together = test::runTogether(kCount, run);
  for (std::size_t i = 0; i < kCount; ++i)
    EXPECT_EQ(together[i], run(i)) << i;
}

TEST(Concurrency, ReconstructionsTriangulationsAndMapsAgreeWithSingleOnes) {
  expectTheSameAlone([](std::size_t i) {
    Options options;
    options.threads = 1;
    return test::surfaceOf(ellipsoid(i), options).sphere;
  });
  expectTheSameAlone(
      [](std::size_t i) { return triangulateSphere(ellipsoid(i).colwise().normalized()); });
  expectTheSameAlone(
      [](std::size_t i) { return internal::hullByQhull(ellipsoid(i).colwise().normalized()); });
  expectTheSameAlone([](std::size_t i) {
    const Positions start = ellipsoid(i).colwise().normalized();
    SphereMapOptions options;
    options.threads = 1;
    return computeSphereMap(ellipsoid(i), triangulateSphere(start), start, options).sphere;
  });
  const Positions sphere = ellipsoid(3).colwise().normalized();
  const SphereSurface shared(ellipsoid(3), triangulateSphere(sphere), sphere);
  const Positions directions = test::randomSphere(300, 7);
  expectTheSameAlone([&](std::size_t) { return shared.evaluate(directions).positions; });
}

TEST(Concurrency, CallsOfSeveralThreadsEachAgreeWithThoseOfOne) {
  const auto run = [](std::size_t i, int threads) {
    Options options;
    options.threads = threads;
    // Enough points for several threads.
    return test::surfaceOf(Eigen::Vector3d(1.0, 0.8, 0.5).asDiagonal() *
                               test::spiralSphere(5000 + 500 * static_cast<Index>(i)),
                           options);
  };
  const auto together = test::runTogether(2, [&](std::size_t i) { return run(i, 3); });
  for (std::size_t i = 0; i < together.size(); ++i) {
    const Surface alone = run(i, 1);
    EXPECT_EQ(together[i].triangles, alone.triangles) << i;
    EXPECT_EQ(together[i].sphere, alone.sphere) << i;
  }
}

TEST(Concurrency, EndingOneCallLeavesTheOthersAlone) {
  struct Fault {};
  // 0: done, 1: its own exception, 2: cancelled; negative: reported from another thread.
  const auto outcomes = test::runTogether(6, [](std::size_t i) -> int {
    const auto caller = std::this_thread::get_id();
    int calls = 0;
    int sign = 1;
    Options options;
    options.progress = [&](const Progress&) {
      sign = std::this_thread::get_id() == caller ? sign : -1;
      if (i % 3 == 1 && ++calls > 5)
        throw Fault();
      return i % 3 != 2 || ++calls <= 9;
    };
    try {
      test::surfaceOf(ellipsoid(0), options);
      return 0;
    } catch (const Fault&) {
      return sign;
    } catch (const Cancelled&) {
      return 2 * sign;
    }
  });
  EXPECT_EQ(outcomes, (std::vector<int>{0, 1, 2, 0, 1, 2}));
}

}  // namespace
}  // namespace spherical_param
