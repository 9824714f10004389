#include "neighbor_search.h"

#include "graph_helpers.h"
#include "spherical_param/errors.h"

namespace spherical_param::test {
namespace {

/// List k holds `count` nearest points of queries[k], the point itself among them.
void expectNearest(const Positions& points, const std::vector<Index>& queries, int count,
                   const NeighborLists& lists) {
  ASSERT_EQ(lists.size(), queries.size());
  for (std::size_t k = 0; k < queries.size(); ++k) {
    std::vector<double> all;
    for (Index j = 0; j < points.cols(); ++j)
      all.push_back((points.col(queries[k]) - points.col(j)).norm());
    std::vector<double> found;
    const std::vector<Index> list = rowOf(lists, static_cast<Index>(k));
    for (const Index j : list)
      found.push_back(all[static_cast<std::size_t>(j)]);
    EXPECT_EQ(std::set<Index>(list.begin(), list.end()).size(), list.size());
    EXPECT_EQ(std::count(list.begin(), list.end(), queries[k]), 1);
    std::sort(all.begin(), all.end());
    all.resize(std::min(all.size(), static_cast<std::size_t>(count) + 1));
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, all);
  }
}

TEST(NeighborSearch, FindsTheNearestPointsOfEachQuery) {
  for (const Positions& points : {randomSphere(300, 1), cubeGrid(6)}) {
    const NeighborSearch search = makeNeighborSearch(points);
    const std::vector<Index> queries{7, 0, 7, 120, 3};
    for (const int count : {0, 1, 12, 140, 10000})
      expectNearest(points, queries, count, search(queries, count));
    expectNearest(points, range(0, points.cols()), 5, findNearestNeighbors(points, 5));
  }
  EXPECT_EQ(findNearestNeighbors(Positions(3, 0), 5).size(), 0U);
  EXPECT_EQ(findNearestNeighbors(Positions::Zero(3, 1), 5).indices, std::vector<Index>{0});
  // 50,000 lists of as many entries are more than 2^31.
  EXPECT_THROW(findNearestNeighbors(spiralSphere(50000), 50000), InvalidInput);
}

}  // namespace
}  // namespace spherical_param::test
