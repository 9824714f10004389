#include "spherical_param/outliers.h"

#include "helpers.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>

namespace spherical_param {
namespace {

using test::bruteForceNeighbors;
using test::horizontally;
using test::kPi;

constexpr int kListed = 25;

Outliers outliersOf(const Positions& points, const OutlierOptions& options = {}) {
  return findOutliers(points, bruteForceNeighbors(points, kListed), options);
}

/// A spiral on the unit sphere whose spacing grows from pole to pole.
Positions gradedSphere(Index n) {
  Positions points(3, n);
  for (Index i = 0; i < n; ++i) {
    const double z = 1.0 - 2.0 * std::pow((i + 0.5) / n, 3.0);
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = kPi * (3.0 - std::sqrt(5.0)) * i;
    points.col(i) << radius * std::cos(angle), radius * std::sin(angle), z;
  }
  return points;
}

/// The upper half of a dense spiral and the lower of one with a tenth of its points.
Positions halfDenseSphere(Index n) {
  const Positions dense = test::spiralSphere(2 * n);
  const Positions sparse = test::spiralSphere(2 * (n / 10));
  return horizontally(dense.leftCols(n), sparse.rightCols(n / 10));
}

/// Points of a sphere of the given radius, far from each other: outliers of the unit sphere.
Positions shell(double radius, Index n) {
  return radius * test::spiralSphere(n);
}

std::vector<Index> lastOf(Index all, Index count) {
  std::vector<Index> result(static_cast<std::size_t>(count));
  std::iota(result.begin(), result.end(), all - count);
  return result;
}

TEST(Outliers, PointsOffTheSurfaceAreFoundAndNoOthers) {
  const Index n = 2000;  // 0.08 apart
  for (const Positions& sphere : {test::spiralSphere(n), test::randomSphere(n, 1)})
    for (const double radius : {0.6, 1.4, 2.0}) {
      const Positions points = horizontally(sphere, shell(radius, 6));
      EXPECT_EQ(outliersOf(points).indices, lastOf(n + 6, 6)) << "radius " << radius;
    }
}

TEST(Outliers, FarOutliersDoNotHideNearOnes) {
  const Index n = 2000;
  Positions points = horizontally(test::spiralSphere(n), shell(1.4, 4));
  points = horizontally(points, shell(1e6, 4));
  EXPECT_EQ(outliersOf(points).indices, lastOf(n + 8, 8));
}

TEST(Outliers, PairsAndTripletsAreFound) {
  const Index n = 2000;
  Positions points = horizontally(test::spiralSphere(n), shell(1.5, 6));
  points = horizontally(points, shell(1.51, 6));
  points = horizontally(points, shell(1.52, 6));
  EXPECT_EQ(outliersOf(points).indices, lastOf(n + 18, 18));
}

TEST(Outliers, CleanShapesHaveNone) {
  const test::Tube tube = test::bentTube(20.0, 2.0, 16);
  Positions ellipsoid = test::spiralSphere(2000);
  ellipsoid.row(0) *= 6.0;
  for (const Positions& points :
       {test::spiralSphere(2000), test::randomSphere(2000, 2), test::randomSphere(2000, 3),
        test::cubeGrid(15), ellipsoid, tube.points}) {
    const Outliers outliers = outliersOf(points);
    EXPECT_TRUE(outliers.indices.empty());
    EXPECT_EQ(outliers.rounds, 1);
  }
}

TEST(Outliers, UnevenSamplingHasNone) {
  EXPECT_TRUE(outliersOf(gradedSphere(2000)).indices.empty());
  EXPECT_TRUE(outliersOf(halfDenseSphere(1500)).indices.empty());
  // The plain distance from the centroid would take some of these for outliers: it exceeds the
  // neighbours' mean distances.
  const Positions points = halfDenseSphere(1500);
  const NeighborLists lists = bruteForceNeighbors(points, kListed);
  std::vector<double> mean_distance;
  std::vector<double> from_centroid;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double distances = 0.0;
    for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e) {
      const Eigen::Vector3d offset =
          points.col(lists.indices[e]) - points.col(static_cast<Eigen::Index>(i));
      sum += offset;
      distances += offset.norm();
    }
    mean_distance.push_back(distances / kListed);
    from_centroid.push_back(sum.norm() / kListed);
  }
  Index beyond = 0;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    double around = 0.0;
    for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e)
      around += mean_distance[static_cast<std::size_t>(lists.indices[e])] / kListed;
    beyond += from_centroid[i] > around ? 1 : 0;
  }
  EXPECT_GT(beyond, 0);
}

TEST(Outliers, OutliersOfUnevenSamplingAreFound) {
  const Positions sphere = halfDenseSphere(1500);
  const Positions points = horizontally(sphere, shell(1.8, 6));
  EXPECT_EQ(outliersOf(points).indices, lastOf(static_cast<Index>(points.cols()), 6));
}

TEST(Outliers, ScoreIsTheDistanceFromThePlaneOfTheNeighbours) {
  // A plane grid with one point above, which is in no other list.
  constexpr int m = 21;
  Positions points(3, m * m + 1);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j)
      points.col(i * m + j) << i, j, 0.0;
  points.col(m * m) << 10.2, 9.9, 7.0;
  OutlierOptions options;
  options.k = 12;
  const Outliers outliers = outliersOf(points, options);
  EXPECT_EQ(outliers.indices, std::vector<Index>{m * m});
  // Around it all points have the same twelve steps: 4 of length 1, of root 2, and of 2.
  EXPECT_NEAR(outliers.scores[m * m], 7.0 / ((4.0 + 4.0 * std::sqrt(2.0) + 8.0) / 12.0), 1e-12);
  for (std::size_t i = 0; i < m * m; ++i)
    EXPECT_NEAR(outliers.scores[i], 0.0, 1e-12);
  EXPECT_EQ(outliers.rounds, 2);
}

TEST(Outliers, ReportedStatisticsAreThoseOfTheScores) {
  const Index n = 1000;
  const Positions points = horizontally(test::randomSphere(n, 4), shell(1.6, 5));
  OutlierOptions options;
  options.sigma = 3.0;
  options.least_score = 0.0;
  const Outliers outliers = outliersOf(points, options);
  std::vector<bool> is_outlier(static_cast<std::size_t>(n) + 5, false);
  for (const Index i : outliers.indices)
    is_outlier[static_cast<std::size_t>(i)] = true;
  double sum = 0.0;
  double squared = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < outliers.scores.size(); ++i)
    if (!is_outlier[i]) {
      EXPECT_LE(outliers.scores[i], outliers.threshold);
      sum += std::min(outliers.scores[i], 1.0);
      squared += std::min(outliers.scores[i], 1.0) * std::min(outliers.scores[i], 1.0);
      count += 1.0;
    } else {
      EXPECT_GT(outliers.scores[i], outliers.threshold);
    }
  EXPECT_NEAR(outliers.mean, sum / count, 1e-12);
  EXPECT_NEAR(outliers.standard_deviation, std::sqrt(squared / count - sum * sum / count / count),
              1e-9);
  EXPECT_NEAR(outliers.threshold, outliers.mean + 3.0 * outliers.standard_deviation, 1e-15);
  EXPECT_TRUE(std::is_sorted(outliers.indices.begin(), outliers.indices.end()));
  EXPECT_GE(outliers.indices.size(), 5U);
}

TEST(Outliers, SmallerSigmaFindsMore) {
  const Positions points = test::randomSphere(1500, 5);
  OutlierOptions options;
  options.least_score = 0.0;
  auto last = static_cast<std::size_t>(points.cols()) + 1;
  for (const double sigma : {1.0, 2.0, 4.0, 8.0, 1000.0}) {
    options.sigma = sigma;
    const std::size_t found = outliersOf(points, options).indices.size();
    EXPECT_LT(found, last);
    last = found;
    if (found == 0)
      break;
  }
  EXPECT_EQ(last, 0U);
}

TEST(Outliers, DoNotChangeWithRotationTranslationAndScale) {
  const Positions points = horizontally(test::randomSphere(1000, 6), shell(1.5, 6));
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  const Positions moved = (1e-3 * rotation * points).colwise() + Eigen::Vector3d(10.0, -20.0, 30.0);
  const Outliers here = outliersOf(points);
  const Outliers there = outliersOf(moved);
  EXPECT_EQ(here.indices, there.indices);
  for (std::size_t i = 0; i < here.scores.size(); ++i)
    // Coordinates of 30 are rounded by 4e-15, distances there are 1e-4.
    EXPECT_NEAR(here.scores[i], there.scores[i], 1e-8);
}

TEST(Outliers, OrderAndRepetitionOfAListDoNotMatter) {
  const Positions points = horizontally(test::randomSphere(600, 7), shell(1.5, 4));
  const NeighborLists lists = bruteForceNeighbors(points, kListed);
  NeighborLists shuffled;
  std::mt19937_64 random(8);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    const auto begin = lists.indices.begin() + static_cast<std::ptrdiff_t>(lists.offsets[i]);
    std::vector<Index> list(begin, begin + kListed);
    list.push_back(list[random() % kListed]);
    list.push_back(static_cast<Index>(i));
    std::shuffle(list.begin(), list.end(), random);
    shuffled.indices.insert(shuffled.indices.end(), list.begin(), list.end());
    shuffled.offsets.push_back(shuffled.indices.size());
  }
  const Outliers a = findOutliers(points, lists);
  const Outliers b = findOutliers(points, shuffled);
  EXPECT_EQ(a.indices, b.indices);
  EXPECT_EQ(a.scores, b.scores);
}

TEST(Outliers, SameBitsForAnyNumberOfThreads) {
  // Enough points for several threads.
  const Index n = 6000;
  const Positions points = horizontally(test::spiralSphere(n), shell(1.5, 50));
  const NeighborLists lists = bruteForceNeighbors(points, 12);
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
  Positions line(3, 60);
  for (Index i = 0; i < 60; ++i)
    line.col(i) << i, 2.0 * i, -i;
  EXPECT_TRUE(outliersOf(line).indices.empty());
  line.col(30) += Eigen::Vector3d(60.0, 0.0, 60.0);  // across
  EXPECT_EQ(outliersOf(line).indices, std::vector<Index>{30});
  const Outliers same = outliersOf(Positions::Constant(3, 40, 0.1));
  EXPECT_TRUE(same.indices.empty());
  EXPECT_EQ(same.mean, 0.0);
}

TEST(Outliers, NoPointsAndFewPointsHaveNone) {
  EXPECT_TRUE(findOutliers(Positions(3, 0), NeighborLists()).indices.empty());
  for (Index n = 1; n <= 5; ++n) {
    const Outliers outliers = outliersOf(test::randomSphere(n, 9));
    EXPECT_EQ(outliers.scores.size(), static_cast<std::size_t>(n));
    if (n <= 3) {
      EXPECT_TRUE(outliers.indices.empty());
    }
  }
  // Points that nothing is known about.
  NeighborLists empty;
  empty.offsets.assign(6, 0);
  EXPECT_TRUE(findOutliers(test::randomSphere(5, 10), empty).indices.empty());
}

TEST(Outliers, ListsThatDoNotFitAreInvalidInput) {
  const Positions points = test::randomSphere(30, 11);
  NeighborLists lists = bruteForceNeighbors(points, 8);
  EXPECT_NO_THROW(findOutliers(points, lists));
  EXPECT_THROW(findOutliers(points.leftCols(29), lists), InvalidInput);
  lists.indices[7] = 30;
  EXPECT_THROW(findOutliers(points, lists), InvalidInput);
  lists.indices[7] = -1;
  EXPECT_THROW(findOutliers(points, lists), InvalidInput);
}

TEST(Outliers, CoordinatesThatAreNotFiniteAreInvalidInput) {
  Positions points = test::randomSphere(30, 12);
  const NeighborLists lists = bruteForceNeighbors(points, 8);
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    points(2, 17) = value;
    EXPECT_THROW(findOutliers(points, lists), InvalidInput);
  }
}

TEST(Outliers, OptionsOutOfRangeAreInvalidInput) {
  const Positions points = test::randomSphere(30, 13);
  const auto with = [&](const auto& change) {
    OutlierOptions options;
    change(options);
    return outliersOf(points, options);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double sigma : {-1.0, 1001.0, nan, infinity})
    EXPECT_THROW(with([&](OutlierOptions& o) { o.sigma = sigma; }), InvalidInput);
  for (const double least : {-0.1, nan, infinity})
    EXPECT_THROW(with([&](OutlierOptions& o) { o.least_score = least; }), InvalidInput);
  for (const int k : {2, 0, -5})
    EXPECT_THROW(with([&](OutlierOptions& o) { o.k = k; }), InvalidInput);
  for (const int threads : {-1, 1025})
    EXPECT_THROW(findOutliers(points, {}, test::onThreads(threads)), InvalidInput);
}

// --- Of a cloud: neighbours are found, and repeated points may occur
// -------------------------------

TEST(OutliersOfACloud, AreThoseWithTheNeighboursOfTheCaller) {
  const Positions points = horizontally(test::randomSphere(1500, 14), shell(1.5, 6));
  const Outliers found = findOutliers(points);
  EXPECT_EQ(found.indices, lastOf(1506, 6));
  EXPECT_EQ(found.indices, outliersOf(points).indices);
  EXPECT_EQ(found.scores.size(), 1506U);
}

TEST(OutliersOfACloud, RepeatedPointsAreAllOutliersOrNone) {
  const Positions far = shell(1.5, 6);
  const Positions sphere = test::spiralSphere(1500);
  const Positions points =
      horizontally(horizontally(far, sphere), horizontally(far, sphere.leftCols(20)));
  const Outliers found = findOutliers(points);
  std::vector<Index> expected{0, 1, 2, 3, 4, 5};
  for (Index i = 0; i < 6; ++i)
    expected.push_back(1506 + i);
  EXPECT_EQ(found.indices, expected);
  ASSERT_EQ(found.scores.size(), 1532U);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(found.scores[i], found.scores[1506 + i]);
}

TEST(OutliersOfACloud, FewerThanFourPositionsHaveNone) {
  for (Index n = 0; n < 4; ++n) {
    const Positions points = test::randomSphere(n, 15).replicate(1, 3);
    const Outliers found = findOutliers(points);
    EXPECT_TRUE(found.indices.empty());
    EXPECT_EQ(found.scores.size(), static_cast<std::size_t>(points.cols()));
  }
}

TEST(OutliersOfACloud, CanBeCancelled) {
  const Positions points = test::spiralSphere(2000);
  EXPECT_THROW(findOutliers(points, {}, test::reportingTo([](double) { return false; })),
               Cancelled);
}

}  // namespace
}  // namespace spherical_param
