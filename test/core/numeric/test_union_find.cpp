#include "union_find.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <random>
#include <vector>

namespace spherical_param::internal {
namespace {

TEST(UnionFind, SetsAreThoseOfLabelsAndNamedByTheirLowest) {
  constexpr Index n = 60;
  std::mt19937_64 random(3);
  UnionFind sets(n);
  std::vector<Index> label(n);
  std::iota(label.begin(), label.end(), Index{0});
  for (int k = 0; k < 90; ++k) {
    const auto i = static_cast<std::size_t>(random() % n);
    const auto j = static_cast<std::size_t>(random() % n);
    const Index low = std::min(label[i], label[j]);
    const Index high = std::max(label[i], label[j]);
    EXPECT_EQ(sets.unite(static_cast<Index>(i), static_cast<Index>(j)), low != high);
    std::replace(label.begin(), label.end(), high, low);
    for (std::size_t v = 0; v < n; ++v)
      ASSERT_EQ(sets.find(static_cast<Index>(v)), label[v]);
  }
}

}  // namespace
}  // namespace spherical_param::internal
