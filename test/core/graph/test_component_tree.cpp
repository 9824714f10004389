#include "component_tree.h"

#include <gtest/gtest.h>

namespace spherical_param::internal {
namespace {

// Which pairs are the nearest, bridges of graphs show.
TEST(ComponentTree, OfEquallyLongPairsThatOfLowerIndicesIsFound) {
  Positions line(3, 3);
  line << 0, 1, -1,  //
      0, 0, 0,       //
      0, 0, 0;
  ComponentTree::Pair pair{1.0, 1, 2};
  ComponentTree(line).nearestOther(0, {}, pair);
  EXPECT_EQ(pair.from, 0);
  EXPECT_EQ(pair.to, 1);
}

}  // namespace
}  // namespace spherical_param::internal
