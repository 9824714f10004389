#include "outliers.h"

#include "graph_helpers.h"
#include "spherical_param/errors.h"
#include "neighbor_search.h"

#include <Eigen/Eigenvalues>

#include <limits>

namespace spherical_param {
namespace {

using test::bruteForceNeighbors;
using test::horizontally;
using test::randomSphere;
using test::rowOf;
using test::spiralSphere;

constexpr int kListed = 25;

Outliers outliersOf(const Positions& points) {
  return findOutliers(points, findNearestNeighbors(points, kListed));
}

/// Points of a sphere of the given radius, far from each other: outliers of the unit sphere.
Positions shell(double radius, Index n) {
  return radius * spiralSphere(n);
}

/// The upper half of a dense spiral and the lower of one with a tenth of its points.
Positions halfDenseSphere(Index n) {
  return horizontally(spiralSphere(2 * n).leftCols(n), spiralSphere(n / 5).rightCols(n / 10));
}

std::vector<Index> lastOf(Eigen::Index all, Eigen::Index count) {
  std::vector<Index> result(static_cast<std::size_t>(count));
  std::iota(result.begin(), result.end(), static_cast<Index>(all - count));
  return result;
}

TEST(Outliers, AreThePointsOffTheSurfaceAndNoOthers) {
  const auto expect_found = [](const Positions& surface, const Positions& outliers) {
    const Positions points = horizontally(surface, outliers);
    EXPECT_EQ(outliersOf(points).indices, lastOf(points.cols(), outliers.cols()));
  };
  for (const Positions& sphere : {spiralSphere(2000), randomSphere(2000, 1)}) {  // 0.08 apart
    for (const double radius : {0.6, 1.4, 2.0})
      expect_found(sphere, shell(radius, 6));
    // Far ones do not hide near ones.
    expect_found(sphere, horizontally(shell(1.4, 4), shell(1e6, 4)));
    // Groups of three.
    expect_found(sphere, horizontally(horizontally(shell(1.5, 6), shell(1.51, 6)), shell(1.52, 6)));
  }
  expect_found(halfDenseSphere(1500), shell(1.8, 6));
}

TEST(Outliers, ShapesWithoutHaveNoneHoweverUnevenTheirSampling) {
  Positions ellipsoid = spiralSphere(2000);
  ellipsoid.row(0) *= 6.0;
  for (const Positions& points :
       {spiralSphere(2000), randomSphere(2000, 2), test::cubeGrid(15), ellipsoid,
        test::bentTube(20.0, 2.0, 16).points, halfDenseSphere(1500)}) {
    const Outliers outliers = outliersOf(points);
    EXPECT_TRUE(outliers.indices.empty());
    EXPECT_EQ(outliers.rounds, 1);
  }
}

/// From the definition in the header, for lists in order of which enough is always left.
Outliers byDefinition(const Positions& points, const NeighborLists& lists,
                      const OutlierOptions& options) {
  const auto n = static_cast<std::size_t>(points.cols());
  const auto k = static_cast<std::size_t>(options.k);
  std::vector<bool> is_outlier(n, false);
  const auto neighbors = [&](std::size_t i) {
    std::vector<Index> left = rowOf(lists, static_cast<Index>(i));
    left.erase(std::remove_if(left.begin(), left.end(),
                              [&](Index j) { return is_outlier[static_cast<std::size_t>(j)]; }),
               left.end());
    left.resize(std::min(k, left.size()));
    return left;
  };
  const auto mean_distance = [&](std::size_t i) {
    double sum = 0.0;
    for (const Index j : neighbors(i))
      sum += (points.col(j) - points.col(static_cast<Index>(i))).norm();
    return sum / static_cast<double>(neighbors(i).size());
  };
  Outliers result;
  result.scores.resize(n);
  for (bool found = true; found;) {
    found = false;
    ++result.rounds;
    std::vector<double> distance(n);
    for (std::size_t i = 0; i < n; ++i)
      distance[i] = mean_distance(i);
    std::vector<double> counted;
    for (std::size_t i = 0; i < n; ++i) {
      if (is_outlier[i])
        continue;
      std::vector<double> around;
      for (const Index j : neighbors(i))
        around.push_back(distance[static_cast<std::size_t>(j)]);
      std::sort(around.begin(), around.end());
      const double median = around[around.size() / 2];
      Positions plane(3, 0);
      for (const Index j : neighbors(i))
        if (distance[static_cast<std::size_t>(j)] <= 2.0 * median)
          plane = horizontally(plane, points.col(j));
      const Eigen::Vector3d centroid = plane.rowwise().mean();
      plane.colwise() -= centroid;
      const Eigen::Matrix3d scatter = plane * plane.transpose();
      const Eigen::Vector3d normal =
          Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
      result.scores[i] =
          std::abs(normal.dot(points.col(static_cast<Index>(i)) - centroid)) / median;
      counted.push_back(std::min(result.scores[i], 1.0));
    }
    const Eigen::Map<const Eigen::ArrayXd> values(counted.data(),
                                                  static_cast<Eigen::Index>(counted.size()));
    result.mean = values.mean();
    result.standard_deviation = std::sqrt((values - result.mean).square().mean());
    result.threshold =
        std::max(result.mean + options.sigma * result.standard_deviation, options.least_score);
    for (std::size_t i = 0; i < n; ++i)
      if (!is_outlier[i] && result.scores[i] > result.threshold) {
        is_outlier[i] = true;
        found = true;
      }
  }
  for (std::size_t i = 0; i < n; ++i)
    if (is_outlier[i])
      result.indices.push_back(static_cast<Index>(i));
  return result;
}

TEST(Outliers, AreThoseOfTheDefinition) {
  const Positions points = horizontally(horizontally(randomSphere(600, 4), shell(1.3, 9)),
                                        horizontally(shell(1.33, 9), shell(1.6, 5)));
  const NeighborLists lists = bruteForceNeighbors(points, 60);
  OutlierOptions lenient;
  lenient.k = 8;
  lenient.sigma = 0.0;
  OutlierOptions strict;
  strict.sigma = 3.0;
  strict.least_score = 0.2;
  OutlierOptions none;
  none.sigma = 1000.0;
  for (const OutlierOptions& options : {OutlierOptions(), lenient, strict, none}) {
    const Outliers expected = byDefinition(points, lists, options);
    const Outliers outliers = findOutliers(points, lists, options);
    EXPECT_EQ(outliers.indices, expected.indices);
    EXPECT_EQ(outliers.rounds, expected.rounds);
    EXPECT_EQ(expected.rounds == 1, options.sigma == 1000.0);
    EXPECT_NEAR(outliers.mean, expected.mean, 1e-12);
    EXPECT_NEAR(outliers.standard_deviation, expected.standard_deviation, 1e-12);
    EXPECT_NEAR(outliers.threshold, expected.threshold, 1e-12);
    ASSERT_EQ(outliers.scores.size(), expected.scores.size());
    for (std::size_t i = 0; i < expected.scores.size(); ++i)
      EXPECT_NEAR(outliers.scores[i], expected.scores[i], 1e-9);
  }
}

TEST(Outliers, OrderAndRepetitionOfAListDoNotMatter) {
  const Positions points = horizontally(randomSphere(600, 7), shell(1.5, 4));
  const NeighborLists lists = bruteForceNeighbors(points, kListed);
  const Outliers tidy = findOutliers(points, lists);
  const Outliers untidy = findOutliers(points, test::untidy(lists));
  EXPECT_EQ(tidy.indices, untidy.indices);
  EXPECT_EQ(tidy.scores, untidy.scores);
}

TEST(Outliers, SameBitsForAnyNumberOfThreads) {
  const Positions points = horizontally(spiralSphere(6000), shell(1.5, 50));
  const NeighborLists lists = findNearestNeighbors(points, 12);
  const Outliers one = findOutliers(points, lists, {}, test::onThreads(1));
  EXPECT_EQ(one.indices.size(), 50U);
  for (const int threads : {2, 5, 0}) {
    const Outliers several = findOutliers(points, lists, {}, test::onThreads(threads));
    EXPECT_EQ(one.indices, several.indices);
    EXPECT_EQ(one.scores, several.scores);
    EXPECT_EQ(one.mean, several.mean);
    EXPECT_EQ(one.threshold, several.threshold);
  }
}

TEST(Outliers, NeighboursOnALineOrInOnePlaceAreNoDanger) {
  Positions line = Eigen::Vector3d(1.0, 2.0, -1.0) * Eigen::RowVectorXd::LinSpaced(60, 0.0, 59.0);
  EXPECT_TRUE(outliersOf(line).indices.empty());
  line.col(30) += Eigen::Vector3d(60.0, 0.0, 60.0);  // across
  EXPECT_EQ(outliersOf(line).indices, std::vector<Index>{30});
  const Outliers same = outliersOf(Positions::Constant(3, 40, 0.1));
  EXPECT_TRUE(same.indices.empty());
  EXPECT_EQ(same.mean, 0.0);
}

TEST(Outliers, PointsOfWhichNothingIsKnownAreNone) {
  EXPECT_TRUE(findOutliers(Positions(3, 0), NeighborLists()).indices.empty());
  const Positions points = randomSphere(40, 9);
  for (const int k : {0, 1, 2}) {
    const Outliers outliers = findOutliers(points, bruteForceNeighbors(points, k));
    EXPECT_EQ(outliers.scores, std::vector<double>(40, 0.0));
    EXPECT_TRUE(outliers.indices.empty());
  }
  // With no bound at all, points for a surface are left.
  OutlierOptions all;
  all.sigma = 0.0;
  all.least_score = 0.0;
  EXPECT_LT(findOutliers(points, bruteForceNeighbors(points, 8), all).indices.size(), 40U);
}

TEST(Outliers, BadInputIsInvalidInput) {
  const Positions points = randomSphere(30, 11);
  const NeighborLists lists = bruteForceNeighbors(points, 8);
  EXPECT_THROW(findOutliers(points.leftCols(29), lists), InvalidInput);
  NeighborLists bad = lists;
  bad.indices[7] = 30;
  EXPECT_THROW(findOutliers(points, bad), InvalidInput);
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Positions broken = points;
    broken(2, 17) = value;
    EXPECT_THROW(findOutliers(broken, lists), InvalidInput);
    EXPECT_THROW(findOutliers(broken), InvalidInput);
  }
  OutlierOptions options;
  options.k = 2;
  EXPECT_THROW(findOutliers(points, options), InvalidInput);
}

TEST(OutliersOfACloud, AreThoseOfTwiceKNeighboursRepeatedPointsAllOrNone) {
  // So many neighbours that outliers are among them, and others step in.
  const Positions base = horizontally(shell(1.3, 6), randomSphere(1500, 14));
  OutlierOptions options;
  options.k = 40;
  const Outliers expected = findOutliers(base, bruteForceNeighbors(base, 80), options);
  const Outliers found = findOutliers(horizontally(base, base.leftCols(26)), options);
  EXPECT_EQ(expected.indices, (std::vector<Index>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(found.indices,
            (std::vector<Index>{0, 1, 2, 3, 4, 5, 1506, 1507, 1508, 1509, 1510, 1511}));
  ASSERT_EQ(found.scores.size(), 1532U);
  for (std::size_t i = 0; i < 1532; ++i) {
    const std::size_t first = i < 1506 ? i : i - 1506;
    if (first < 6)  // stray points: their distance instead
      EXPECT_GT(found.scores[i], expected.scores[first]);
    else
      EXPECT_NEAR(found.scores[i], expected.scores[first], 1e-9);
  }
}

TEST(OutliersOfACloud, FewerThanFourPositionsHaveNone) {
  for (Index n = 0; n < 4; ++n) {
    const Positions points = randomSphere(n, 15).replicate(1, 3);
    const Outliers found = findOutliers(points);
    EXPECT_TRUE(found.indices.empty());
    EXPECT_EQ(found.scores.size(), static_cast<std::size_t>(points.cols()));
  }
}

}  // namespace
}  // namespace spherical_param
