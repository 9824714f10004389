#include "local_intersections.h"

#include "optimization_cases.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::test {
namespace {

Face faceOf(const Positions& points, const Triangles& triangles, Index t) {
  Face face{{points.col(triangles(0, t)), points.col(triangles(1, t)), points.col(triangles(2, t))},
            0.0,
            {triangles(0, t), triangles(1, t), triangles(2, t)},
            t};
  face.size = boxOf(face.corners).sizes().maxCoeff();
  return face;
}

/// Holds all triangles of a mesh.
LocalIntersections intersectionsOf(const Positions& points, const Triangles& triangles) {
  LocalIntersections local;
  local.begin(static_cast<std::size_t>(triangles.cols()));
  for (Index t = 0; t < triangles.cols(); ++t)
    local.set(faceOf(points, triangles, t));
  return local;
}

/// How many other triangles each one intersects.
std::vector<std::size_t> countsOf(const Positions& points, const Triangles& triangles) {
  std::vector<std::size_t> counts(static_cast<std::size_t>(triangles.cols()), 0);
  for (const auto& [t, u] : findSelfIntersections(points, triangles)) {
    ++counts[static_cast<std::size_t>(t)];
    ++counts[static_cast<std::size_t>(u)];
  }
  return counts;
}

TEST(LocalIntersections, CountsAreThoseOfTheWholeMeshAlsoAfterChanges) {
  const Case of = scrambledEllipsoid(300, 0.3, 400, 1);
  Triangles triangles = of.triangles;
  const auto m = static_cast<Index>(triangles.cols());
  LocalIntersections local = intersectionsOf(of.points, triangles);
  std::mt19937_64 random(3);
  for (int round = 0; round < 20; ++round) {
    const std::vector<std::size_t> counts = countsOf(of.points, triangles);
    for (Index t = 0; t < m; ++t) {
      const Face face = faceOf(of.points, triangles, t);
      const auto expected = static_cast<int>(counts[static_cast<std::size_t>(t)]);
      EXPECT_EQ(local.count(face, t), expected);
      EXPECT_EQ(local.count(local.face(t), t, 0), std::min(expected, 1));
      EXPECT_EQ(local.intersects(face), expected > 0);
      std::vector<Index> others;
      local.appendIntersecting(face, others);
      EXPECT_EQ(others.size(), static_cast<std::size_t>(expected));
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
