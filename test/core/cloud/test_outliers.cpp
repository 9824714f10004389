#include "outliers.h"

#include "core/graph/graph_helpers.h"

#include <Eigen/Eigenvalues>

namespace spherical_param::test {
namespace {

void expectFound(const Positions& surface, const Positions& outliers) {
  const Positions points = horizontally(surface, outliers);
  for (const OutlierMode mode : {OutlierMode::Auto, OutlierMode::Deviation})
    EXPECT_EQ(outliersOf(points, mode), range(surface.cols(), points.cols()));
}

/// The upper half of a dense spiral and the lower of one with a tenth of its points.
Positions halfDenseSphere(Index n) {
  return horizontally(spiralSphere(2 * n).leftCols(n), spiralSphere(n / 5).rightCols(n / 10));
}

TEST(Outliers, AreThePointsOffTheSurfaceAndNoOthers) {
  for (const Positions& sphere : {spiralSphere(2000), randomSphere(2000, 1)}) {  // 0.08 apart
    for (const double radius : {0.6, 1.4, 2.0, 1e6})
      expectFound(sphere, radius * spiralSphere(6));
    // Far ones do not hide near ones; of points at one position all or none are left out.
    const Positions both = horizontally(1.4 * spiralSphere(4), 1e6 * spiralSphere(4));
    expectFound(sphere, horizontally(both, both.rightCols(2)));
    // Groups of three.
    expectFound(sphere, horizontally(1.5 * spiralSphere(6), 1.51 * spiralSphere(6),
                                     1.52 * spiralSphere(6)));
  }
  expectFound(halfDenseSphere(1500), 1.8 * spiralSphere(6));
}

TEST(Outliers, ShapesHaveNoneHoweverTheyAreSampled) {
  Positions ellipsoid = spiralSphere(2000);
  ellipsoid.row(0) *= 6.0;
  for (const Positions& points :
       {randomSphere(4, 15), randomSphere(31, 15), randomSphere(60, 5), randomSphere(2000, 2),
        cubeGrid(15), ellipsoid, bentTube(20.0, 2.0, 16).points, halfDenseSphere(1500),
        spiralSphere(2000).leftCols(900).eval(),
        horizontally(spiralSphere(2000), movedTo(3.0, spiralSphere(300)))})
    for (const OutlierMode mode : {OutlierMode::Auto, OutlierMode::Deviation})
      EXPECT_TRUE(outliersOf(points, mode).empty()) << points.cols() << " points";
}

/// From the definition in the header, for lists in order of which enough is always left.
DeviatingPoints byDefinition(const Positions& points, const NeighborLists& lists, double sigma) {
  const auto n = static_cast<Index>(points.cols());
  std::set<Index> outliers;
  const auto neighbors = [&](Index i) {
    std::vector<Index> left;
    for (const Index j : rowOf(lists, i))
      if (left.size() < 16 && outliers.count(j) == 0)
        left.push_back(j);
    return left;
  };
  DeviatingPoints result;
  result.scores.resize(columnCount(points));
  Eigen::Map<Eigen::ArrayXd> scores(result.scores.data(), n);
  for (bool found = true; found;) {
    Eigen::ArrayXd distance(n);
    for (Index i = 0; i < n; ++i)
      distance[i] =
          (points(Eigen::all, neighbors(i)).colwise() - points.col(i)).colwise().norm().mean();
    std::vector<double> counted;
    for (Index i = 0; i < n; ++i) {
      if (outliers.count(i) > 0)
        continue;
      Eigen::ArrayXd around = distance(neighbors(i));
      std::sort(around.begin(), around.end());
      Positions plane(3, 0);
      for (const Index j : neighbors(i))
        if (distance[j] <= 2.0 * around[8])
          plane = horizontally(plane, points.col(j));
      const Eigen::Vector3d centroid = plane.rowwise().mean();
      plane.colwise() -= centroid;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(plane * plane.transpose());
      const Eigen::Vector3d normal = axes.eigenvectors().col(0);
      scores[i] = std::abs(normal.dot(points.col(i) - centroid)) / around[8];
      counted.push_back(std::min(scores[i], 1.0));
    }
    const Eigen::Map<const Eigen::ArrayXd> values(counted.data(),
                                                  static_cast<Eigen::Index>(counted.size()));
    const double deviation = std::sqrt((values - values.mean()).square().mean());
    result.threshold = std::max(values.mean() + sigma * deviation, 1.0);
    const std::size_t before = outliers.size();
    for (Index i = 0; i < n; ++i)
      if (scores[i] > result.threshold)
        outliers.insert(i);
    found = outliers.size() > before;
  }
  result.indices.assign(outliers.begin(), outliers.end());
  return result;
}

TEST(DeviatingPoints, AreThoseOfTheDefinitionHoweverTheListsAreOrdered) {
  const Positions points = horizontally(randomSphere(600, 4), 1.3 * spiralSphere(9),
                                        1.33 * spiralSphere(9), 1.6 * spiralSphere(5));
  const NeighborLists lists = bruteForceNeighbors(points, 60);
  for (const double sigma : {0.0, 4.0, 12.0, 1000.0}) {
    const DeviatingPoints expected = byDefinition(points, lists, sigma);
    EXPECT_EQ(expected.indices.empty(), sigma == 1000.0);
    const DeviatingPoints found = deviatingPoints(points, lists, sigma, {});
    EXPECT_EQ(found.indices, expected.indices);
    EXPECT_NEAR(found.threshold, expected.threshold, 1e-12);
    ASSERT_EQ(found.scores.size(), expected.scores.size());
    for (std::size_t i = 0; i < expected.scores.size(); ++i)
      EXPECT_NEAR(found.scores[i], expected.scores[i], 1e-9);
    EXPECT_EQ(deviatingPoints(points, untidy(lists), sigma, {}).scores, found.scores);
  }
}

TEST(DeviatingPoints, LinesAndShortListsAreNoDanger) {
  Positions line = Eigen::Vector3d(1.0, 2.0, -1.0) * Eigen::RowVectorXd::LinSpaced(60, 0.0, 59.0);
  EXPECT_TRUE(deviatingPoints(line, bruteForceNeighbors(line, 25), 4.0, {}).indices.empty());
  line.col(30) += Eigen::Vector3d(60.0, 0.0, 60.0);  // across
  EXPECT_EQ(deviatingPoints(line, bruteForceNeighbors(line, 25), 4.0, {}).indices, range(30, 31));
  const Positions points = randomSphere(40, 9);
  for (const int k : {0, 1, 2})
    EXPECT_EQ(deviatingPoints(points, bruteForceNeighbors(points, k), 4.0, {}).scores,
              std::vector<double>(40, 0.0));
}

}  // namespace
}  // namespace spherical_param::test
