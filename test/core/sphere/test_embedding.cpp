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

}  // namespace
}  // namespace spherical_param::test
