#include "component_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <random>
#include <tuple>
#include <vector>

namespace spherical_param::internal {
namespace {

using Pair = ComponentTree::Pair;

std::tuple<double, Index, Index> contentOf(const Pair& pair) {
  return {pair.squared_distance, pair.from, pair.to};
}

/// Points of a small lattice, several in most of its places: distances are full of ties.
Positions latticePoints(Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Positions points(3, n);
  for (Index i = 0; i < n; ++i)
    for (int axis = 0; axis < 3; ++axis)
      points(axis, i) = static_cast<double>(random() % 5U);
  return points;
}

TEST(ComponentTree, EveryQuestionIsAnsweredAsByBruteForce) {
  std::mt19937_64 random(1);
  for (const Index n : {1, 2, 8, 9, 17, 200}) {
    const Positions points = latticePoints(n, static_cast<std::uint64_t>(n));
    const auto below = [&](Index end) {
      return static_cast<Index>(random() % static_cast<unsigned>(end));
    };
    const ComponentTree whole(points);  // every point is a component
    ComponentTree tree(points);
    for (const Index parts : {1, 2, 5}) {
      std::vector<Index> component(static_cast<std::size_t>(n));
      for (Index i = 0; i < n; ++i)
        // Halves of space, so that whole subtrees are of one component, or any at all.
        component[static_cast<std::size_t>(i)] =
            parts == 2 ? (points(0, i) > 2.0 ? 1 : 0) : below(parts);
      tree.setComponents(component);
      const auto of = [&](Index i) { return component[static_cast<std::size_t>(i)]; };
      for (Index i = 0; i < n; ++i) {
        const std::vector<Index> excluded{below(n), below(n), below(n)};
        // A better pair than there is stays, of equally long ones that of lower indices.
        const Pair start = i % 2 == 0 ? Pair() : Pair{static_cast<double>(below(3)), below(n), n};
        const auto expect = [&](Pair found, const std::function<bool(Index)>& accepts) {
          Pair best = start;
          for (Index j = 0; j < n; ++j)
            if (accepts(j) && std::find(excluded.begin(), excluded.end(), j) == excluded.end())
              best = std::min(best, Pair{(points.col(i) - points.col(j)).squaredNorm(),
                                         std::min(i, j), std::max(i, j)});
          EXPECT_EQ(contentOf(found), contentOf(best));
        };
        Pair other = start;
        tree.nearestOther(i, excluded, other);
        expect(other, [&](Index j) { return of(j) != of(i); });
        Pair any = start;
        whole.nearestOther(i, excluded, any);
        expect(any, [&](Index j) { return j != i; });
        for (Index c = 0; c < parts; ++c) {
          Pair in = start;
          tree.nearestIn(c, i, excluded, in);
          expect(in, [&](Index j) { return of(j) == c; });
        }
      }
    }
  }
}

}  // namespace
}  // namespace spherical_param::internal
