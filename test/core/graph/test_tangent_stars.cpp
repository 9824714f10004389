#include "tangent_stars.h"

#include "graph_helpers.h"

#include <Eigen/Eigenvalues>

namespace spherical_param::test {
namespace {

/// Voronoi neighbours of point i among a list of others, in the plane of its ten nearest, from the
/// definition: on the bisector there is a piece that is nearer to no other site. The cell ends at
/// the reach of the list.
std::set<Index> bruteForceStar(const Positions& points, Index i, const std::vector<Index>& list) {
  Positions offsets = points(Eigen::all, list).colwise() - points.col(i);
  Positions nearest = offsets.leftCols(10);
  nearest.colwise() -= Eigen::Vector3d(nearest.rowwise().mean());
  const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(nearest * nearest.transpose()).eigenvectors();
  const double reach = offsets.colwise().norm().maxCoeff();
  std::vector<std::pair<Index, Eigen::Vector2d>> sites{{-1, {2.0 * reach, 0.0}},
                                                       {-1, {-2.0 * reach, 0.0}},
                                                       {-1, {0.0, 2.0 * reach}},
                                                       {-1, {0.0, -2.0 * reach}}};
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Eigen::Vector3d local = axes.transpose() * offsets.col(static_cast<Eigen::Index>(k));
    if (std::abs(local[0]) <= 0.85 * local.norm())
      sites.emplace_back(list[k], local.tail<2>().normalized() * local.norm());
  }
  std::set<Index> star;
  for (const auto& [j, site] : sites) {
    const Eigen::Vector2d along(-site.y(), site.x());
    double low = -1e300;
    double high = 1e300;
    for (const auto& [k, other] : sites) {
      // (site / 2 + t along) . other <= other^2 / 2
      const double slope = along.dot(other);
      const double room = 0.5 * other.squaredNorm() - 0.5 * site.dot(other);
      if (slope > 0.0)
        high = std::min(high, room / slope);
      else if (slope < 0.0)
        low = std::max(low, room / slope);
    }
    if (j >= 0 && low < high)
      star.insert(j);
  }
  return star;
}

TEST(TangentStars, HaveTheHeightOfThePointOverItsPlane) {
  // Over the middle of ten points on a circle of radius 1: across it, their variance is 1 / 2.
  const Positions points = pointsAt(11, [](Index i) {
    const double angle = 2.0 * kPi * i / 10.0;
    return i < 10 ? Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)
                  : Eigen::Vector3d(0.0, 0.0, 0.25);
  });
  const Stars stars = findStars(points, {findNearestNeighbors(points, 10), {}}, {});
  EXPECT_TRUE(stars[10].tangent_plane);
  EXPECT_NEAR(stars[10].height, 0.25 / std::sqrt(0.5), 1e-6);
}

TEST(TangentStars, AreTheVoronoiNeighborsInTheTangentPlane) {
  // A closed surface, and one with a boundary, where cells are not bounded.
  Positions dome = randomSphere(200, 1);
  dome.row(2) = 0.5 * dome.row(2).cwiseAbs();
  for (const Positions& points : {randomSphere(150, 1), dome}) {
    const Stars stars =
        test::starsOf(points, bruteForceNeighbors(points, 12), bruteForceSearch(points));
    const NeighborLists lists = bruteForceNeighbors(points, 32);
    for (const Index i : indicesOf(stars)) {
      const std::set<Index> expected = bruteForceStar(points, i, rowOf(lists, i));
      EXPECT_EQ(std::vector<Index>(stars.of(i).begin(), stars.of(i).end()),
                std::vector<Index>(expected.begin(), expected.end()));
    }
    EXPECT_EQ(countUncertified(stars) > 0, points.cols() == 200);
    EXPECT_EQ(countWithoutPlane(stars), 0);
  }
}

TEST(TangentStars, SearchIsAskedOnceARoundForThePointsThatAreNotCertified) {
  const Positions points = randomSphere(150, 2);
  const auto uncertified = [&](int k) {
    const Stars stars = test::starsOf(points, bruteForceNeighbors(points, k));
    std::vector<Index> result;
    for (const Index i : indicesOf(stars))
      if (stars[i].wants_more)
        result.push_back(i);
    return result;
  };
  std::vector<std::pair<std::vector<Index>, int>> asked;
  test::starsOf(points, bruteForceNeighbors(points, 12),
                [&](const std::vector<Index>& some, int count) {
                  asked.emplace_back(some, count);
                  return bruteForceSearch(points)(some, count);
                });
  std::vector<std::pair<std::vector<Index>, int>> expected;
  for (const auto& [known, count] : {std::pair(12, 24), std::pair(24, 32)})
    if (!uncertified(known).empty())
      expected.emplace_back(uncertified(known), count);
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(asked, expected);
}

/// Number of edges of the agreed graph that join a point before `first` and one from it on.
Index countAcross(const Positions& points, Index first) {
  const Stars stars =
      test::starsOf(points, bruteForceNeighbors(points, 12), makeNeighborSearch(points));
  Index count = 0;
  for (const Index i : indicesOf(stars))
    for (const Index j : stars.of(i))
      count += i < first && j >= first && stars.of(j).contains(i) ? 1 : 0;
  return count;
}

TEST(TangentStars, SeparateSheetsThatAreNearerThanTwoSpacings) {
  // Two spheres with points 1 apart, their radii 1.3 and 1.6 spacings apart.
  constexpr double radius = 9.0;
  for (const double gap : {1.3, 1.6}) {
    const auto sphere = [](double r) -> Positions {
      return r * spiralSphere(static_cast<Index>(4.0 * kPi * r * r));
    };
    const Positions inner = sphere(radius);
    const Positions outer = sphere(radius + gap);
    EXPECT_EQ(countAcross(horizontally(inner, outer), static_cast<Index>(inner.cols())), 0) << gap;
  }
}

}  // namespace
}  // namespace spherical_param::test
