#include "neighborhoods.h"

#include "core/reconstructions.h"

#include <stdexcept>

namespace spherical_param::test {
namespace {

TEST(Neighborhoods, GroupsOfNodesAreThoseOfTheirInputsTheLargestFirst) {
  Positions cloud = randomSphere(12, 1);
  cloud.col(11) = cloud.col(2);
  Neighborhoods of(cloud, range(2, 12), {}, {}, {});
  EXPECT_TRUE(of.areOf(range(2, 12)));
  const Indexed<Index>& input = of.nodes().input_of_node;  // positions in the inputs
  ASSERT_EQ(input.size(), 9U);
  Indexed<Index> group(9);
  Indexed<char> marked(9);
  for (const Index node : indicesOf(input)) {
    const Index i = input[node] + 2;
    EXPECT_EQ(rowOf(of.neighbors().lists, node).size(), 9U);
    group[node] = i < 4 ? 5 : i < 8 ? 3 : i < 10 ? 0 : -1;
    marked[node] = i < 4 ? 1 : 0;
  }
  using Groups = std::vector<std::vector<Index>>;
  EXPECT_EQ(of.groupInputs(group), (Groups{{4, 5, 6, 7}, {2, 3, 11}, {8, 9}}));
  EXPECT_EQ(of.inputsOf(marked), (std::vector<Index>{2, 3, 11}));
}

TEST(Neighborhoods, KnownNodesAndTheirSearchAreUsed) {
  const Positions cloud = randomSphere(40, 1);
  int questions = 0;
  const SearchedNodes known{orderPoints(cloud, 1),
                            [&](const std::vector<Index>& queries, int count) {
                              ++questions;
                              return bruteForceSearch(orderPoints(cloud, 1).points)(queries, count);
                            }};
  Neighborhoods of(cloud, range(0, 40), {}, {}, {}, known);
  EXPECT_EQ(of.points(), known.nodes.points);
  EXPECT_EQ(questions, 1);
  EXPECT_EQ(of.neighbors().lists.size(), 40U);
  // The caller's search comes first.
  const auto of_caller = [&](const std::vector<Index>&) { return bruteForceSearch(cloud); };
  const Neighborhoods searched(cloud, range(0, 40), {}, of_caller, {}, known);
  EXPECT_EQ(questions, 1);
}

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
