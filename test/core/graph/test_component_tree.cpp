#include "component_tree.h"

#include "helpers.h"

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

/// The least pair of point i with an accepted one, by comparing with each of them.
Pair byBruteForce(const Positions& points, Index i, const std::function<bool(Index)>& accepts) {
  Pair best;
  for (Index j = 0; j < points.cols(); ++j)
    if (accepts(j))
      best = std::min(best, Pair{(points.col(i) - points.col(j)).squaredNorm(), std::min(i, j),
                                 std::max(i, j)});
  return best;
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
    ComponentTree tree(points);
    for (const unsigned parts : {1U, 2U, 5U}) {
      std::vector<Index> component(static_cast<std::size_t>(n));
      for (Index i = 0; i < n; ++i)
        // Halves of space, so that whole subtrees are of one component, or any at all.
        component[static_cast<std::size_t>(i)] = static_cast<Index>(
            parts == 2 ? (points(0, i) > 2.0 ? 1U : 0U) : static_cast<unsigned>(random() % parts));
      tree.setComponents(component);
      const auto of = [&](Index i) { return component[static_cast<std::size_t>(i)]; };
      for (Index i = 0; i < n; ++i) {
        std::vector<Index> excluded;
        for (int k = 0; k < 3; ++k)
          excluded.push_back(static_cast<Index>(random() % static_cast<unsigned>(n)));
        const auto is_free = [&](Index j) {
          return std::find(excluded.begin(), excluded.end(), j) == excluded.end();
        };
        Pair other;
        tree.nearestOther(i, excluded, other);
        EXPECT_EQ(contentOf(other), contentOf(byBruteForce(points, i, [&](Index j) {
                    return of(j) != of(i) && is_free(j);
                  })));
        for (Index c = 0; c < static_cast<Index>(parts); ++c) {
          Pair in;
          tree.nearestIn(c, i, excluded, in);
          EXPECT_EQ(contentOf(in), contentOf(byBruteForce(points, i, [&](Index j) {
                      return of(j) == c && is_free(j);
                    })));
        }
        Pair any;
        tree.nearestExcept(i, excluded, any);
        EXPECT_EQ(contentOf(any), contentOf(byBruteForce(
                                      points, i, [&](Index j) { return j != i && is_free(j); })));
      }
    }
  }
}

TEST(ComponentTree, ABetterPairStays) {
  Positions points(3, 3);
  points << 0.0, 1.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  ComponentTree tree(points);
  tree.setComponents({0, 1, 1});
  Pair best{0.5, 7, 8};
  tree.nearestOther(0, {}, best);
  EXPECT_EQ(contentOf(best), contentOf({0.5, 7, 8}));
  // Of equally long ones the lower indices.
  best = {1.0, 1, 2};
  tree.nearestOther(0, {}, best);
  EXPECT_EQ(contentOf(best), contentOf({1.0, 0, 1}));
}

}  // namespace
}  // namespace spherical_param::internal
