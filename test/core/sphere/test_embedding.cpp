#include "embedding.h"

#include "embeddings.h"

namespace spherical_param::test {
namespace {

TEST(Embedding, ProjectsFromTheCentroidWhateverTheExtent) {
  const Positions half = randomSphere(100, 1);
  const Positions even = horizontally(half, -half);  // around 0
  for (const double scale : {1.0, 1e-300, 1e307})
    EXPECT_LT((projectFromCentroid(scale * even) - even).colwise().norm().maxCoeff(), 1e-12);
  const Positions with_center = horizontally(even, Eigen::Vector3d::Zero());
  EXPECT_NEAR(projectFromCentroid(with_center).col(200).norm(), 1.0, 1e-15);
}

TEST(Embedding, TangentialLaplacianByHand) {
  // A node at the pole, and two on the equator at a right angle; lengths 1 and 3.
  Graph graph = unitGraph(3, {{0, 1}, {0, 2}});
  graph.lengths = {1.0, 3.0, 1.0, 3.0};
  const Positions directions{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  using Lengths = std::vector<double>;
  EXPECT_EQ(tangentialLaplacianLengths(graph, directions, EdgeWeights::Uniform),
            (Lengths{std::sqrt(0.5), 1.0, 1.0}));
  for (const EdgeWeights weights : {EdgeWeights::InverseLength, EdgeWeights::Adaptive})
    EXPECT_NEAR(meanTangentialLaplacian(graph, directions, weights),
                (std::hypot(0.75, 0.25) + 2.0) / 3.0, 1e-15);
}

TEST(Embedding, OfNoNodesIsEmptyAndAtOnePlaceOrNowhereCollapsed) {
  EXPECT_EQ(embed(Graph(), Positions(3, 0)).directions.cols(), 0);
  EXPECT_FALSE(isCollapsed({0.0, 0.9, 0.0}));
  EXPECT_TRUE(isCollapsed({0.0, 0.99, 0.0}));
  EXPECT_TRUE(isCollapsed(Eigen::Vector3d::Constant(std::nan(""))));
}

}  // namespace
}  // namespace spherical_param::test
