#include "embedding_history.h"

#include "embeddings.h"

namespace spherical_param::test {
namespace {

TEST(EmbeddingHistory, KeepsAtMostTheLimitAndEveryLevelFromTheStartToTheEnd) {
  const Graph graph = dentedCloud(3000).graph;
  const auto hierarchy = buildGraphHierarchy(graph, 1, 200);
  Setting options;
  const Positions expected = embedByLevels(graph, hierarchy, options).directions;
  for (const auto& [vertices, most] : std::vector<std::pair<Index, int>>{
           {1, 2}, {4, 3}, {150, 7}, {250, 40}, {700, 12}, {1500, 40}, {2999, 5}, {60000, 1000}}) {
    options.history_vertices = vertices;
    options.history_frames = most;
    const Embedding embedding = embedByLevels(graph, hierarchy, options);
    EXPECT_EQ(embedding.directions, expected);
    const std::vector<Index>& shown = embedding.history.vertices;
    const std::vector<HistoryFrame>& frames = embedding.history.frames;
    EXPECT_LE(shown.size(), static_cast<std::size_t>(vertices));
    EXPECT_GE(3 * shown.size(), static_cast<std::size_t>(std::min(vertices, Index{3000})));
    EXPECT_EQ(std::set<Index>(shown.begin(), shown.end()).size(), shown.size());
    ASSERT_GE(frames.size(), 2U);
    EXPECT_LE(frames.size(), static_cast<std::size_t>(most));
    EXPECT_EQ(frames.front().level, hierarchy.levels.size());
    EXPECT_EQ(frames.front().step, EmbeddingStep::Start);
    EXPECT_EQ(frames.back().step, EmbeddingStep::End);
    EXPECT_EQ(frames.back().residual, embedding.report.residual);
    EXPECT_EQ(frames.back().sphere, embedding.directions(Eigen::all, shown));
    EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end(),
                               [](const auto& a, const auto& b) { return a.level > b.level; }));
  }
}

}  // namespace
}  // namespace spherical_param::test
