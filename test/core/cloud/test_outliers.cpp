#include "outliers.h"

#include "core/graph/graph_helpers.h"

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

// The score of a point above a plane is its height in median mean distances of its neighbours.
TEST(DeviatingPoints, HaveTheScoreAndTheThresholdOfTheDefinition) {
  const Index last = 21 * 21;
  const Positions points = horizontally(sheet(21, 0.0, 0.2, 1), Eigen::Vector3d(10.3, 9.6, 5.0));
  const NeighborLists lists = bruteForceNeighbors(points, 40);
  const auto nearest = [&](Index i) {
    std::vector<Index> list = rowOf(lists, i);
    list.resize(16);
    return list;
  };
  std::vector<double> distances;
  for (const Index i : nearest(last))
    distances.push_back(
        (points(Eigen::all, nearest(i)).colwise() - points.col(i)).colwise().norm().mean());
  const DeviatingPoints found = deviatingPoints(points, untidy(lists), 10.0, {});
  EXPECT_EQ(found.indices, range(last, last + 1));
  EXPECT_NEAR(found.scores.back(), 5.0 / medianOf(distances), 1e-9);
  EXPECT_LT(*std::max_element(found.scores.begin(), found.scores.end() - 1), 1e-9);
  const Eigen::ArrayXd counted =
      Eigen::Map<const Eigen::ArrayXd>(found.scores.data(), points.cols()).min(1.0);
  const double deviation = std::sqrt((counted - counted.mean()).square().mean());
  EXPECT_NEAR(found.threshold, std::max(1.0, counted.mean() + 10.0 * deviation), 1e-9);
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
