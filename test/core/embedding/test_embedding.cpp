#include "embeddings.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using test::randomSphere;

TEST(EmbeddingStart, ProjectionGivesEveryPointADirection) {
  Positions points = test::horizontally(randomSphere(10, 1), -randomSphere(10, 1));
  points = test::horizontally(points, Positions::Zero(3, 1));  // the centroid itself
  for (const double scale : {1.0, 1e-300, 1e300}) {
    const Positions directions = internal::projectFromCentroid(points * scale);
    EXPECT_LT((directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
    EXPECT_LT((directions.leftCols(20) - points.leftCols(20)).cwiseAbs().maxCoeff(), 1e-14);
  }
}

}  // namespace
}  // namespace spherical_param
