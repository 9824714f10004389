// Progress and cancellation: what Execution::progress promises, in reconstruct() and in each stage.

#include "consolidation.h"
#include "mesh_optimization.h"
#include "outliers.h"
#include "reconstructions.h"
#include "sphere_triangulation.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/sphere_map.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

const std::vector<std::string> kStages{"neighbors",     "graph",        "openings",  "embedding",
                                       "triangulation", "optimization", "smoothing", "quality"};

Positions roughSphere() {
  return test::withNoise(test::spiralSphere(60), 0.1, 3);
}

TEST(StageClock, StagesComeInOrderAndEachCanBeCancelled) {
  std::vector<std::string> names;
  Options options;
  options.smoothing = 1;
  options.progress = [&](const Progress& progress) {
    if (names.empty() || names.back() != progress.stage)
      names.emplace_back(progress.stage);
    return true;
  };
  const Positions points = test::spiralSphere(200);
  const Surface result = reconstruct(points, options);
  EXPECT_EQ(names, kStages);
  ASSERT_EQ(result.stages.size(), kStages.size());
  for (std::size_t i = 0; i < kStages.size(); ++i) {
    EXPECT_EQ(result.stages[i].name, kStages[i]);
    EXPECT_GE(result.stages[i].seconds, 0.0);
    options.progress = [&](const Progress& progress) { return progress.stage != kStages[i]; };
    EXPECT_THROW(reconstruct(points, options), Cancelled) << kStages[i];
  }
}

TEST(StageClock, EveryStageOfALargeCloudReportsWhileItWorks) {
  const Positions points = test::spiralSphere(40000);
  std::map<std::string, std::vector<double>> fractions;
  Options options;
  options.progress = [&](const Progress& progress) {
    fractions[progress.stage].push_back(progress.fraction);
    return true;
  };
  test::surfaceOf(points, options);
  ASSERT_EQ(fractions.size(), 7U);
  for (const auto& [stage, of_stage] : fractions) {
    EXPECT_TRUE(test::areFractions(of_stage)) << stage;
    EXPECT_EQ(of_stage.front(), 0.0) << stage;
    EXPECT_EQ(of_stage.back(), 1.0) << stage;
    EXPECT_GE(of_stage.size(), 4U) << stage;  // two of them its begin and end
  }
}

/// What no library throws.
struct CallersFault {
  int number;
};

using Callback = std::function<bool(double)>;
using Outcome = std::pair<Triangles, Positions>;
using Work = std::function<Outcome(const Callback&)>;

/// Throws, and cancels, at every call of the callback: what comes out is that, no call follows, and
/// the next work is as the first one.
void expectEndsAtEveryCall(const Work& work) {
  const Outcome plain = work({});
  int calls = 0;
  const auto caller = std::this_thread::get_id();
  EXPECT_EQ(work([&](double) {
              EXPECT_EQ(std::this_thread::get_id(), caller);
              ++calls;
              return true;
            }),
            plain);
  ASSERT_GT(calls, 0);
  for (int k = 0; k < calls; ++k)
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
  EXPECT_EQ(work({}), plain);
}

TEST(ProgressCallback, EndsReconstructAtEveryCall) {
  Options smoothed;
  smoothed.smoothing = 2;
  smoothed.embedding.history_vertices = 10;
  Options paper = test::paper();
  paper.embedding.max_iterations = 20;
  for (const Positions& points : {test::randomSphere(4, 1), roughSphere()})
    for (Options options : {smoothed, paper})
      expectEndsAtEveryCall([&](const Callback& callback) {
        options.progress = test::reportingTo(callback).progress;
        const Surface result = test::surfaceOf(points, options);
        return Outcome(result.triangles, result.sphere);
      });
}

TEST(ProgressCallback, EndsEachStageAtEveryCall) {
  const Positions points = roughSphere();
  const NeighborLists lists = test::bruteForceNeighbors(points, 12);
  const Graph graph = test::graphOf(points, lists).graph;
  const Positions sphere = points.colwise().normalized();
  const Triangles triangles = triangulateSphere(sphere);
  const auto number = [](std::size_t count) {
    return Outcome(Triangles(3, 0), Positions::Constant(3, 1, static_cast<double>(count)));
  };
  const auto mesh = [](const Triangles& made) { return Outcome(made, Positions(3, 0)); };
  using Stage = std::function<Outcome(const Execution&)>;
  std::vector<Stage> stages{
      [&](const Execution& e) {
        return number(test::graphOf(points, lists, {}, {}, e).graph.edgeCount());
      },
      [&](const Execution& e) {
        return number(findSelfIntersections(points, triangles, e).size());
      },
      [&](const Execution& e) { return number(findOutliers(points, {}, e).indices.size()); },
      [&](const Execution& e) {
        SphereMapOptions options;
        options.sweeps = 3;
        options.progress = e.progress;
        return Outcome(triangles, computeSphereMap(points, triangles, sphere, options).sphere);
      }};
  for (const auto method : {EmbeddingMethod::Iterative, EmbeddingMethod::Multilevel})
    stages.emplace_back([&, method](const Execution& e) {
      EmbeddingOptions options;
      options.method = method;
      options.max_iterations = 10;
      options.tolerance = 1e-6;
      return Outcome(triangles, embed(graph, points, options, 1, e).directions);
    });
  for (const auto method : {TriangulationMethod::Qhull, TriangulationMethod::Incremental})
    stages.emplace_back([&, method](const Execution& e) {
      return mesh(triangulateSphere(sphere, method, e).triangles);
    });
  for (const auto method :
       {OptimizationMethod::None, OptimizationMethod::Flips, OptimizationMethod::Full})
    stages.emplace_back([&, method](const Execution& e) {
      return mesh(optimizeMesh(points, triangles, graph, {method, true}, 1, e).triangles);
    });
  for (std::size_t i = 0; i < stages.size(); ++i) {
    SCOPED_TRACE(i);
    expectEndsAtEveryCall(
        [&](const Callback& callback) { return stages[i](test::reportingTo(callback)); });
  }
}

}  // namespace
}  // namespace spherical_param
