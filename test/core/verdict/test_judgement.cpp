#include "core/reconstructions.h"
#include "handle_shapes.h"
#include "indexed.h"

namespace spherical_param::test {
namespace {

TEST(Judgement, ThePapersMethodMeshesWhatIsNoSphereAsOneAndReportsIt) {
  const Positions torus = torusCloud(40, 20, 1.0, 0.5);
  const Positions bowl = spiralSphere(1500).rightCols(1100);  // without its top
  for (const auto& [points, k, finding] :
       {std::tuple(torus, 10, "the mesh is folded"),
        {bowl, 25, "the mesh is folded"},
        {twoSpheres(200, 160, 6.0), 25, "2 separate parts (160 and 200 points)"}}) {
    const Surface result = mesh(points, given(paper(), "k", k));
    expectGuarantees(points, result);
    EXPECT_TRUE(isFound(result, finding));
    EXPECT_TRUE(hasFault(result.findings));
  }
}

TEST(Judgement, PartsOnARingAreCountedOnce) {
  const Positions pair = twoSpheres(200, 200, 4.0);
  const Positions ring = horizontally(pair, pair.colwise() + Eigen::Vector3d(0.0, 4.0, 0.0));
  const SurfaceDiagnosis diagnosis = mesh(ring, sphere()).diagnosis;
  EXPECT_EQ(diagnosis.bridges.size(), 4U);
  EXPECT_EQ(diagnosis.joined_parts, 4U);
}

TEST(Judgement, WhatIsNotUsableHasASampleOfItsIntersections) {
  const Positions points = randomCube(6000, 1);
  const Surface result = mesh(points, quick());
  EXPECT_TRUE(result.intersections_are_sampled);
  EXPECT_FALSE(result.isUsable());
  EXPECT_NE(result.verdict.find("faults: at least "), std::string::npos) << result.verdict;
  const auto all = findSelfIntersections(points, result.triangles);
  const auto& sample = result.self_intersections;
  EXPECT_LT(sample.size(), all.size());
  EXPECT_TRUE(std::includes(all.begin(), all.end(), sample.begin(), sample.end()));
  EXPECT_EQ(result.intersecting_triangles, countTriangles(sample));
}

TEST(Judgement, TheMeanOfTheResidualsOfVerticesIsThatOfTheEmbedding) {
  for (const Options& options : {sphere(), quick(given(paper(), "max_iterations", 3))}) {
    const Surface result = mesh(ellipsoid(600), withDetails(options));
    ASSERT_EQ(result.vertex_residuals.size(), 600U);
    const double sum =
        std::accumulate(result.vertex_residuals.begin(), result.vertex_residuals.end(), 0.0);
    EXPECT_NEAR(sum / 600.0, result.embedding.residual, 1e-9 * sum);
  }
}

TEST(Judgement, MarksAreThoseOfTheFindings) {
  const auto marked = [](const Surface& surface, std::uint8_t bit) {
    std::set<Index> triangles;
    const std::vector<std::uint8_t>& marks = surface.diagnosis.triangle_marks;
    EXPECT_EQ(marks.size(), columnCount(surface.triangles));
    for (std::size_t t = 0; t < marks.size(); ++t)
      if (marks[t] & bit)
        triangles.insert(static_cast<Index>(t));
    return triangles;
  };
  const Surface tangled =
      mesh(noisySphere(300, 1.0), withDetails(quick(given("consolidation", "none"))));
  std::set<Index> intersecting;
  for (const auto& pair : tangled.self_intersections)
    intersecting.insert(pair.begin(), pair.end());
  EXPECT_FALSE(intersecting.empty());
  EXPECT_EQ(marked(tangled, triangle_mark::self_intersection), intersecting);
  for (const char* fill : {"flat", "smooth"}) {
    const Surface filled =
        mesh(sphereWithHoles(3000, 1, 0.4), withDetails(given("surface", "closed", "fill", fill)));
    const std::vector<Index>& over = filled.openings.at(0).triangles;
    EXPECT_FALSE(over.empty());
    EXPECT_EQ(marked(filled, triangle_mark::filled_hole),
              std::set<Index>(over.begin(), over.end()));
  }
  const Surface uncertain = surfaceOf(sphereWithHoles(3000, 1, 0.15), withDetails());
  EXPECT_TRUE(uncertain.openings.at(0).is_filled);
  EXPECT_TRUE(marked(uncertain, triangle_mark::filled_hole).empty());
  EXPECT_TRUE(marked(mesh(ellipsoid(300), withDetails()), 0xff).empty());
}

TEST(Judgement, SmoothingMovesThePointsAlone) {
  const Positions base = noisySphere(500, 0.15);
  const Positions points = horizontally(base.leftCols(50), base);
  const Surface rough = mesh(points);
  const Surface result = mesh(points, given("smoothing", 3));
  expectGuarantees(points, result);
  ASSERT_EQ(result.points.cols(), 500);
  // Without intersections on the smoothed points the triangles are those without smoothing.
  EXPECT_TRUE(result.self_intersections.empty());
  EXPECT_EQ(result.triangles, rough.triangles);
  EXPECT_EQ(result.sphere, rough.sphere);
  const Positions vertices = verticesOf(points, result);
  const Eigen::VectorXd moved = (result.points - vertices).colwise().norm();
  EXPECT_GT(moved.minCoeff(), 0.0);
  EXPECT_NEAR(result.smoothing->max_displacement, moved.maxCoeff(), 1e-12);
  EXPECT_NEAR(result.smoothing->volume_before, rough.measures.volume, 1e-12);
  EXPECT_NEAR(result.smoothing->volume_after, result.measures.volume, 1e-12);
}

}  // namespace
}  // namespace spherical_param::test
