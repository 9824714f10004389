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

TEST(TangentStars, SeparateSheetsThatAreNearerThanTwoSpacings) {
  // Two spheres with points 1 apart, their radii 1.3 spacings apart.
  const Positions inner = 9.0 * spiralSphere(1017);
  const Positions points = horizontally(inner, 10.3 * spiralSphere(1333));
  const Stars stars =
      test::starsOf(points, bruteForceNeighbors(points, 12), makeNeighborSearch(points));
  for (const auto& [i, j] : edgesOf(agreedGraph(points, stars, {})))
    EXPECT_EQ(i < 1017, j < 1017) << i << " " << j;
}

}  // namespace
}  // namespace spherical_param::test
