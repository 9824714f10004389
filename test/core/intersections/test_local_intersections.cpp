#include "local_intersections.h"

#include "core/optimization/optimization_cases.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::test {
namespace {

Face faceOf(const Positions& points, const Triangles& triangles, Index t) {
  return internal::faceOf(points, 1.0, {triangles(0, t), triangles(1, t), triangles(2, t)}, t);
}

TEST(LocalIntersections, CountsAreThoseOfTheWholeMeshAlsoAfterChanges) {
  const Case of = scrambledEllipsoid(300, 0.3, 400, 1);
  Triangles triangles = of.triangles;
  const auto m = static_cast<Index>(triangles.cols());
  LocalIntersections local;
  local.begin(columnCount(triangles));
  for (Index t = 0; t < m; ++t)
    local.set(faceOf(of.points, triangles, t));
  std::mt19937_64 random(3);
  for (int round = 0; round < 20; ++round) {
    Indexed<std::vector<Index>> expected(columnCount(triangles));
    for (const auto& [t, u] : findSelfIntersections(of.points, triangles)) {
      expected[t].push_back(u);
      expected[u].push_back(t);
    }
    for (Index t = 0; t < m; ++t) {
      const Face face = faceOf(of.points, triangles, t);
      const auto count = static_cast<int>(expected[t].size());
      EXPECT_EQ(local.count(face, t), count);
      EXPECT_EQ(local.count(local.face(t), t, 0), std::min(count, 1));
      EXPECT_EQ(local.intersects(face), count > 0);
      std::vector<Index> others;
      local.appendIntersecting(face, others);
      std::sort(others.begin(), others.end());
      EXPECT_EQ(others, expected[t]);
    }
    const auto changed = static_cast<Index>(random() % static_cast<std::uint64_t>(m));
    const auto corner = static_cast<Index>(random() % 300);
    if (corner == triangles(1, changed) || corner == triangles(2, changed))
      continue;
    triangles(0, changed) = corner;
    if (round % 2 == 0) {
      local.remove(changed);
      EXPECT_FALSE(local.contains(changed));
    }
    local.set(faceOf(of.points, triangles, changed));
  }
}

}  // namespace
}  // namespace spherical_param::test
