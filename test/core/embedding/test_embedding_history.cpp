#include "embedding_history.h"

#include "embeddings.h"
#include "iterative_embedding.h"
#include "multilevel_embedding.h"
#include "sphere_triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::buildGraphHierarchy;
using internal::EmbeddingObserver;
using internal::EmbeddingRecorder;
using internal::EmbeddingState;
using internal::GraphHierarchy;
using test::graphOfMesh;
using test::spiralSphere;

struct Observed : test::Setting {
  EmbeddingObserver observer;
};

Embedding embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy,
                        const Observed& setting) {
  return internal::embedByLevels(graph, hierarchy, setting, {}, setting.observer, setting);
}

Embedding iterate(const Graph& graph, const Positions& start, const Observed& setting) {
  return internal::embedIteratively(graph, start, setting, setting.observer, setting);
}

EmbeddingOptions limits(Index vertices, int frames) {
  EmbeddingOptions options;
  options.history_vertices = vertices;
  options.history_frames = frames;
  return options;
}

struct Seen {
  std::size_t level;
  EmbeddingStep step;
  int iteration;
  std::optional<double> residual;
  Positions directions;
};

EmbeddingObserver into(std::vector<Seen>& states) {
  return [&states, caller = std::this_thread::get_id()](const EmbeddingState& state) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    states.push_back(
        {state.level, state.step, state.iteration, state.residual, state.directions()});
    EXPECT_EQ(states.back().directions.cols(), static_cast<Index>(state.nodes));
    EXPECT_LT((states.back().directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-12);
  };
}

TEST(EmbeddingObserver, SeesEveryLevelFromTheStartToTheEnd) {
  const Graph graph = test::dentedCloud(6000).graph;
  const GraphHierarchy hierarchy = buildGraphHierarchy(graph, 1, 200);
  for (const EdgeWeights weights : {EdgeWeights::Adaptive, EdgeWeights::Uniform}) {
    Observed options;
    options.weights = weights;
    options.starts = 4;
    std::vector<Seen> states;
    options.observer = into(states);
    const Embedding seen = embedByLevels(graph, hierarchy, options);
    ASSERT_FALSE(states.empty());
    EXPECT_EQ(states.front().level, hierarchy.levels.size());
    EXPECT_EQ(states.front().step, EmbeddingStep::Start);
    EXPECT_EQ(states.back().step, EmbeddingStep::End);
    EXPECT_EQ(states.back().directions, seen.directions);
    EXPECT_EQ(states.back().residual, seen.report.residual);
    EXPECT_TRUE(std::is_sorted(states.begin(), states.end(),
                               [](const Seen& a, const Seen& b) { return a.level > b.level; }));
    // Each level goes on from where the coarser one ended: its seeds are where they were.
    for (std::size_t i = 1; i < states.size(); ++i)
      if (states[i].level < states[i - 1].level) {
        EXPECT_EQ(states[i].step, EmbeddingStep::Start);
        const std::vector<Index>& seeds = hierarchy.levels[states[i].level].seeds;
        for (std::size_t node = 0; node < seeds.size(); ++node)
          EXPECT_LT((states[i].directions.col(seeds[node]) -
                     states[i - 1].directions.col(static_cast<Index>(node)))
                        .norm(),
                    1e-12);
      }
  }
}

TEST(EmbeddingObserver, SeesEveryIterationOfThePapersSolver) {
  const Graph graph = test::dentedCloud(5000).graph;
  Observed options;
  options.max_iterations = 12;
  options.threads = 3;
  std::vector<Seen> states;
  options.observer = into(states);
  const Embedding seen = iterate(graph, spiralSphere(5000), options);
  ASSERT_EQ(states.size(), 14U);
  for (int i = 0; i < 13; ++i) {
    const Seen& state = states[static_cast<std::size_t>(i)];
    EXPECT_EQ(state.step, EmbeddingStep::Iteration);
    EXPECT_EQ(state.iteration, i);
    EXPECT_EQ(state.residual, seen.report.residuals[static_cast<std::size_t>(i)]);
    // The residual reported is that of the state.
    EXPECT_NEAR(meanTangentialLaplacian(graph, state.directions, options.weights), *state.residual,
                1e-9 * *state.residual);
  }
  EXPECT_EQ(states.back().step, EmbeddingStep::End);
  EXPECT_EQ(states.back().directions, seen.directions);
}

TEST(EmbeddingRecorder, KeepsAtMostTheLimitAndAlwaysBothEnds) {
  const Graph graph = test::dentedCloud(3000).graph;
  const GraphHierarchy hierarchy = buildGraphHierarchy(graph, 1, 200);
  std::vector<Seen> states;
  Observed options;
  options.observer = into(states);
  const Embedding embedding = embedByLevels(graph, hierarchy, options);
  for (const auto& [vertices, frames] : std::vector<std::pair<Index, int>>{
           {1, 2}, {4, 3}, {150, 7}, {250, 40}, {700, 12}, {1500, 40}, {2999, 5}, {60000, 1000}}) {
    EmbeddingRecorder recorder(graph.size(), hierarchy, limits(vertices, frames));
    options.observer = std::ref(recorder);
    embedByLevels(graph, hierarchy, options);
    const EmbeddingHistory history = recorder.take();
    EXPECT_LE(history.vertices.size(), static_cast<std::size_t>(vertices));
    EXPECT_GE(3 * history.vertices.size(),
              static_cast<std::size_t>(std::min(vertices, Index{3000})));
    EXPECT_EQ(std::set<Index>(history.vertices.begin(), history.vertices.end()).size(),
              history.vertices.size());
    ASSERT_GE(history.frames.size(), 2U);
    EXPECT_LE(history.frames.size(), static_cast<std::size_t>(frames));
    EXPECT_EQ(history.frames.front().level, hierarchy.levels.size());
    EXPECT_EQ(history.frames.front().step, EmbeddingStep::Start);
    EXPECT_EQ(history.frames.back().step, EmbeddingStep::End);
    EXPECT_EQ(history.frames.back().residual, embedding.report.residual);
    for (std::size_t i = 0; i < history.vertices.size(); ++i)
      EXPECT_EQ(history.frames.back().sphere.col(static_cast<Index>(i)),
                embedding.directions.col(history.vertices[i]));
  }
}

TEST(EmbeddingRecorder, CarriesCoarseStatesAsTheSolverDoes) {
  const Graph graph = test::dentedCloud(6000).graph;
  const GraphHierarchy hierarchy = buildGraphHierarchy(graph, 1, 200);
  ASSERT_GE(hierarchy.levels.size(), 2U);
  for (const Index vertices : {300, 6000}) {
    EmbeddingRecorder recorder(graph.size(), hierarchy, limits(vertices, 10));
    const Positions coarse =
        test::randomSphere(static_cast<Index>(hierarchy.levels.back().graph.size()), 3);
    recorder({hierarchy.levels.size(), 0, EmbeddingStep::Start, 0, std::nullopt,
              [&] { return coarse; }});
    Positions expected = coarse;
    for (std::size_t l = hierarchy.levels.size(); l-- > 0;) {
      Positions finer = expected * hierarchy.levels[l].prolongation.transpose();
      finer.colwise().normalize();
      expected = finer;
    }
    const EmbeddingHistory history = recorder.take();
    ASSERT_EQ(history.frames.size(), 1U);
    for (std::size_t i = 0; i < history.vertices.size(); ++i)
      EXPECT_LT(
          (history.frames[0].sphere.col(static_cast<Index>(i)) - expected.col(history.vertices[i]))
              .norm(),
          1e-9);
  }
}

TEST(EmbeddingRecorder, SpreadsItsNodesOverTheGraph) {
  const Positions sphere = spiralSphere(6000);
  const Graph graph = graphOfMesh(sphere, triangulateSphere(sphere));
  const GraphHierarchy hierarchy = buildGraphHierarchy(graph, 1, 200);
  for (const Index vertices : {400, 900, 1500}) {
    EmbeddingRecorder recorder(graph.size(), hierarchy, limits(vertices, 10));
    const EmbeddingHistory history = recorder.take();
    // No place of the sphere is further from the next node than some of their even distances.
    const double even = std::sqrt(4.0 * test::kPi / static_cast<double>(history.vertices.size()));
    for (Index i = 0; i < 6000; ++i) {
      double nearest = 2.0;
      for (const Index v : history.vertices)
        nearest = std::min(nearest, (sphere.col(i) - sphere.col(v)).norm());
      EXPECT_LT(nearest, 2.5 * even);
    }
  }
}

}  // namespace
}  // namespace spherical_param
