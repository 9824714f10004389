#include "component_tree.h"

#include "graphs.h"

namespace spherical_param::test {
namespace {

TEST(ComponentTree, FindsTheNearestPointOfAnotherComponentTiesByIndex) {
  // Points of a grid tie everywhere.
  for (const Positions& points : {randomCube(300, 1), cubeGrid(8)})
    for (const Index components : {300, 40, 3}) {
      ComponentTree tree(points);
      Indexed<Index> component(columnCount(points));
      for (const Index i : indicesOf(component))
        component[i] = (7 * i + i / 5) % components;
      tree.setComponents(component);
      for (const Index i : indicesOf(component))
        for (const Index wanted : {ComponentTree::kAnyOther, (component[i] + 1) % components}) {
          const std::vector<Index> excluded{(i + 1) % 200, (i + 7) % 200};
          ComponentTree::Pair expected;
          for (Index j = 0; j < points.cols(); ++j)
            if ((wanted < 0 ? component[j] != component[i] : component[j] == wanted) &&
                j != excluded[0] && j != excluded[1])
              expected = std::min(expected, {(points.col(i) - points.col(j)).squaredNorm(),
                                             std::min(i, j), std::max(i, j)});
          ComponentTree::Pair found;
          tree.findNearest(i, excluded, found, wanted);
          ASSERT_EQ(std::pair(found.from, found.to), std::pair(expected.from, expected.to));
        }
    }
}

}  // namespace
}  // namespace spherical_param::test
