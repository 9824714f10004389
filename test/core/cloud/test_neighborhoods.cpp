#include "neighborhoods.h"

#include "core/reconstructions.h"

#include <stdexcept>

namespace spherical_param::test {
namespace {

TEST(Neighborhoods, WrongAnswersAndExceptionsOfTheSearchComeOut) {
  const Positions points = horizontally(randomSphere(60, 1), randomSphere(60, 1));
  const NeighborLists lists = bruteForceNeighbors(points.leftCols(60), 12);
  const auto mesh_with = [&](const NeighborSearch& search) {
    reconstruct(points, {}, [&](const std::vector<Index>&) { return search; });
  };
  EXPECT_NO_THROW(mesh_with([&](const std::vector<Index>& queries, int count) {
    return bruteForceSearch(points.leftCols(60).eval())(queries, count);
  }));
  for (const Index wrong : {-1, 120, 60}) {  // the last repeats point 0, which the search is not of
    NeighborLists answer = lists;
    answer.indices[7] = wrong;
    EXPECT_THROW(mesh_with([&](const std::vector<Index>&, int) { return answer; }), InvalidInput);
  }
  EXPECT_THROW(mesh_with([](const std::vector<Index>&, int) { return NeighborLists(); }),
               InvalidInput);
  EXPECT_THROW(mesh_with([](const std::vector<Index>&, int) -> NeighborLists {
                 throw std::runtime_error("no search today");
               }),
               std::runtime_error);
}

}  // namespace
}  // namespace spherical_param::test
