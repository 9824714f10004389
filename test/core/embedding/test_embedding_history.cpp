#include "embedding_history.h"

#include "embeddings.h"
#include "ordered_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::buildGraphHierarchy;
using internal::EmbeddingRecorder;
using internal::GraphHierarchy;

/// Settings that record a history of bounded size.
test::Setting limits(Index vertices, int frames) {
  test::Setting options;
  options.history_vertices = vertices;
  options.history_frames = frames;
  return options;
}

TEST(EmbeddingHistory, ShowsEveryLevelFromTheStartToTheEnd) {
  const Graph graph = test::dentedCloud(6000).graph;
  const GraphHierarchy hierarchy = buildGraphHierarchy(graph, 1, 200);
  test::Setting options = limits(6000, 1000);
  options.starts = 4;
  const Embedding seen = test::embedByLevels(graph, hierarchy, options);
  const std::vector<HistoryFrame>& frames = seen.history.frames;
  ASSERT_FALSE(frames.empty());
  EXPECT_EQ(frames.front().level, hierarchy.levels.size());
  EXPECT_EQ(frames.front().step, EmbeddingStep::Start);
  EXPECT_EQ(frames.back().step, EmbeddingStep::End);
  EXPECT_EQ(frames.back().residual, seen.report.residual);
  EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end(),
                             [](const auto& a, const auto& b) { return a.level > b.level; }));
  options.history_vertices = 0;
  EXPECT_EQ(seen.directions, test::embedByLevels(graph, hierarchy, options).directions);
}

TEST(EmbeddingHistory, KeepsAtMostTheLimitAndAlwaysBothEnds) {
  const Graph graph = test::dentedCloud(3000).graph;
  const GraphHierarchy hierarchy = buildGraphHierarchy(graph, 1, 200);
  for (const auto& [vertices, frames] : std::vector<std::pair<Index, int>>{
           {1, 2}, {4, 3}, {150, 7}, {250, 40}, {700, 12}, {1500, 40}, {2999, 5}, {60000, 1000}}) {
    const Embedding embedding = test::embedByLevels(graph, hierarchy, limits(vertices, frames));
    const EmbeddingHistory& history = embedding.history;
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

TEST(EmbeddingRecorder, SpreadsItsNodesOverTheGraph) {
  const Positions sphere = internal::orderPoints(test::randomSphere(6000, 3), 1).points;
  for (const Index vertices : {400, 900, 1500}) {
    EmbeddingRecorder recorder(6000, limits(vertices, 10));
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
