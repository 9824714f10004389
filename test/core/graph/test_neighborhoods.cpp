#include "neighborhoods.h"

#include "../reconstructions.h"
#include "graph_helpers.h"
#include "local_delaunay_graph.h"

#include <tuple>

namespace spherical_param::internal {
namespace {

using test::horizontally;
using test::range;
using test::rowOf;

/// About a fraction of some points.
std::vector<Index> someOf(const std::vector<Index>& points, double fraction) {
  std::mt19937_64 random(5);
  std::bernoulli_distribution is_kept(fraction);
  std::vector<Index> some;
  std::copy_if(points.begin(), points.end(), std::back_inserter(some),
               [&](Index) { return is_kept(random); });
  return some;
}

auto starOf(const Stars& stars, std::size_t i) {
  const StarKind& kind = stars.kind[i];
  return std::tuple(
      std::vector<Index>(stars.nodes.begin() + static_cast<std::ptrdiff_t>(stars.begin[i]),
                         stars.nodes.begin() + static_cast<std::ptrdiff_t>(stars.endOf(i))),
      kind.candidates, kind.tangent_plane, kind.certified, stars.nearest[i]);
}

void expectSameStars(const Neighborhoods& found, const Neighborhoods& expected) {
  ASSERT_EQ(found.points(), expected.points());
  ASSERT_EQ(found.stars().size(), expected.stars().size());
  for (std::size_t i = 0; i < expected.stars().size(); ++i)
    ASSERT_EQ(starOf(found.stars(), i), starOf(expected.stars(), i)) << i;
  EXPECT_EQ(test::edgesOf(found.agreed()), test::edgesOf(expected.agreed()));
}

/// Answers far points first, without the query, and with none beyond a radius.
NeighborSearchFactory shortSearchOf(const Positions& points, double radius) {
  return [&points, radius](const std::vector<Index>& some) -> NeighborSearch {
    return [&points, radius, search = test::bruteForceFactory(points)(some)](
               const std::vector<Index>& queries, int count) {
      const NeighborLists found = search(queries, count);
      NeighborLists lists;
      for (std::size_t q = 0; q < queries.size(); ++q) {
        std::vector<Index> list = rowOf(found, static_cast<Index>(q));
        std::reverse(list.begin(), list.end());
        for (const Index j : list)
          if ((points.col(j) - points.col(queries[q])).norm() < radius)
            lists.indices.push_back(j);
        lists.offsets.push_back(lists.indices.size());
      }
      return lists;
    };
  };
}

/// Two spheres, points around them, and some points twice.
Positions twoSpheresAndMore() {
  const Positions second = test::randomSphere(200, 2).colwise() + Eigen::Vector3d(2.5, 0.0, 0.0);
  const Positions points = horizontally(horizontally(test::randomSphere(400, 1), second),
                                        1.6 * test::randomSphere(30, 3));
  return horizontally(points, points.leftCols(50));
}

TEST(Neighborhoods, OfSomePointsAreThoseOfThesePointsAlone) {
  const Positions spheres = twoSpheresAndMore();
  const Positions ball = test::withNoise(Positions::Zero(3, 500), 1.0, 4);  // without planes
  for (const Positions& cloud : {spheres, ball}) {
    for (const NeighborSearchFactory& search_of :
         {NeighborSearchFactory(), test::bruteForceFactory(cloud), shortSearchOf(cloud, 0.4)})
      for (const int k : {5, 12, 31}) {
        Options options;
        options.method = Method::Paper;
        options.paper.k = k;
        const auto alone = [&](const std::vector<Index>& inputs) {
          auto result =
              std::make_unique<Neighborhoods>(cloud, inputs, options, search_of, Execution());
          result->findStars({});
          return result;
        };
        const std::vector<Index> inputs = range(0, cloud.cols());
        const auto all = alone(inputs);
        for (const std::vector<Index>& some :
             {range(0, 400), someOf(inputs, 0.98), someOf(inputs, 0.5), range(0, 20)}) {
          Neighborhoods kept(cloud, some, options, *all, {});
          kept.findStars({});
          expectSameStars(kept, *alone(some));
          const std::vector<Index> fewer = someOf(some, 0.8);
          Neighborhoods part(cloud, fewer, options, kept, {});
          part.findStars({});
          expectSameStars(part, *alone(fewer));
        }
      }
  }
}

}  // namespace
}  // namespace spherical_param::internal
