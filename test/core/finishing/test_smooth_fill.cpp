#include "smooth_fill.h"

#include "core/reconstructions.h"
#include "indexed.h"

namespace spherical_param::test {
namespace {

TEST(SmoothFill, OfASphereWithoutCapsIsNearlyTheSphere) {
  const Positions points = pointsWhere(
      spiralSphere(3000), [](const Eigen::Vector3d& p) { return std::abs(p.z()) < 0.8; });
  const Surface flat = surfaceOf(points, given("surface", "closed", "fill", "flat"));
  const Surface smooth = surfaceOf(points, given("surface", "closed", "fill", "smooth"));
  ASSERT_EQ(flat.added_vertices, 0U);
  const Eigen::Index n = points.cols();
  ASSERT_EQ(smooth.points.cols(), static_cast<Eigen::Index>(smooth.vertexCount()));
  EXPECT_EQ(smooth.points.leftCols(n), points);
  const auto added = static_cast<std::size_t>(smooth.points.cols() - n);
  EXPECT_EQ(smooth.added_vertices, added);
  // The caps have a fifth of the sphere's area, and so of its points.
  EXPECT_GT(added, 200U);
  EXPECT_LT(added, 1200U);
  const auto radii = smooth.points.rightCols(smooth.points.cols() - n).colwise().norm();
  EXPECT_LT((radii.array() - 1.0).abs().maxCoeff(), 0.04);  // 0.2 if flat: the height of the caps
  EXPECT_TRUE(checkTopology(smooth.triangles, smooth.vertexCount()).isSphere());
  EXPECT_TRUE(findSelfIntersections(smooth.points, smooth.triangles).empty());
  EXPECT_EQ(smooth.verdict.substr(smooth.verdict.find(';')),
            "; " + std::to_string(added) + " vertices added in 2 filled openings.");
  // All triangles at added vertices are over openings.
  std::vector<char> is_over(columnCount(smooth.triangles), 0);
  for (const Opening& opening : smooth.openings)
    for (const Index t : opening.triangles)
      is_over.at(static_cast<std::size_t>(t)) = 1;
  for (Index t = 0; t < smooth.triangles.cols(); ++t)
    EXPECT_TRUE(smooth.triangles.col(t).maxCoeff() < n || is_over[static_cast<std::size_t>(t)]);
  EXPECT_NEAR(smooth.measures.volume, 4.0 / 3.0 * kPi, 0.07);  // 0.24 if flat
  EXPECT_EQ(smooth.duplicates(), 0U);
}

/// Rings of 40 vertices in the plane z = 0 around an opening, over which a fan has the triangles.
struct Plate : Surface {
  Plate() {
    points.resize(3, 120);
    triangles.resize(3, 198);
    openings.resize(1);
    input_of_vertex = range(0, 123);
    for (Index i = 0; i < 120; ++i)
      points.col(i) = onCircle(2.0 * kPi * (i % 40) / 40.0, 1.0 + 0.15 * (i / 40));
    for (Index i = 0; i < 80; ++i) {
      const Index next = i % 40 == 39 ? i - 39 : i + 1;
      triangles.col(2 * i) << i, i + 40, next + 40;
      triangles.col(2 * i + 1) << i, next + 40, next;
    }
    for (Index i = 0; i < 38; ++i) {
      triangles.col(160 + i) << 0, i + 1, i + 2;
      openings[0].triangles.push_back(160 + i);
    }
  }
};

Surface filled(Surface mesh, std::optional<double> time_limit = std::nullopt) {
  fillSmoothly({1, {}, time_limit}, mesh);
  return mesh;
}

TEST(SmoothFill, IntersectsNoMoreThanTheFlatOneAndLeavesOtherOpenings) {
  // A sheet close above the plate, whose boundary rises: the bent fill would pass through it.
  Plate plate;
  for (Index i = 0; i < 120; ++i)
    plate.points(2, i) = -0.3 * (i / 40);
  const Positions below = plate.points;
  plate.points.conservativeResize(3, 123);
  plate.points.rightCols(3) << -3, 3, 0, -3, -3, 3, 0.02, 0.02, 0.02;
  plate.triangles.conservativeResize(3, 199);
  plate.triangles.col(198) << 120, 121, 122;
  const Surface fill = filled(plate);
  EXPECT_GT(fill.points.cols(), 123);
  EXPECT_TRUE(fill.self_intersections.empty());
  EXPECT_TRUE(findSelfIntersections(fill.points, fill.triangles).empty());
  plate.points = below;
  plate.triangles.conservativeResize(3, 198);
  EXPECT_GT(filled(plate).points.row(2).maxCoeff(), 0.1);
  plate.openings[0].triangles.clear();
  EXPECT_EQ(filled(plate).triangles, plate.triangles);
}

TEST(SmoothFill, LosesNoSurfaceToATimeLimit) {
  const Plate plate;
  const Surface flat = filled(plate, 0.0);
  EXPECT_TRUE(flat.is_out_of_time);
  EXPECT_EQ(flat.triangles, plate.triangles);
  const Positions band = pointsWhere(
      spiralSphere(900), [](const Eigen::Vector3d& p) { return std::abs(p.z()) < 0.8; });
  const Positions points = inARow(4, 4.0, band);
  const Options closed = given("surface", "closed", "parts", "each");
  for (const double limit : {0.0, 0.05, 0.3, 1e3}) {
    const Result result = reconstruct(points, given(closed, "fill", "smooth", "time_limit", limit));
    ASSERT_EQ(result.surfaces.size(), 4U) << limit;
    for (const Surface& surface : result.surfaces) {
      EXPECT_TRUE(surface.topology.isSphere());
      EXPECT_TRUE(surface.is_out_of_time || surface.smoothly_filled == 2);
      EXPECT_TRUE(limit < 1e3 || !surface.is_out_of_time);
    }
  }
}

TEST(SmoothFill, WhatIsNoDiscStays) {
  // The outer ring is over an opening, and wide.
  Plate plate;
  plate.points.rightCols(40) *= 3.0;
  plate.openings[0].triangles = range(80, 160);
  const Surface fill = filled(plate);
  EXPECT_EQ(fill.points, plate.points);
  EXPECT_EQ(fill.triangles, plate.triangles);
  // Without two triangles it is a disc.
  plate.openings[0].triangles.resize(78);
  EXPECT_GT(filled(plate).points.cols(), 120);
}

}  // namespace
}  // namespace spherical_param::test
