#include "core/reconstructions.h"
#include "handle_shapes.h"
#include "paper_method.h"

namespace spherical_param::test {
namespace {

TEST(Judgement, SurfacesThatAreNoSpheresAreMeshedAsOneAndReported) {
  const Positions torus = torusCloud(40, 20, 1.0, 0.5);
  const Positions bowl = spiralSphere(1500).rightCols(1100);  // without its top
  const Positions parts = twoSpheres(200, 160, 6.0);
  for (Options options : bothMethods()) {
    options.handles = HandleMode::None;
    options.paper.k = 10;
    const Surface of_torus = mesh(torus, options);
    EXPECT_EQ(of_torus.genus(), 0U);
    EXPECT_GT(of_torus.diagnosis.edges_outside_graph, 0.01);
    options.paper.k = 25;
    const Surface of_bowl = mesh(bowl, options);
    // The graph of nearest neighbours shows no openings.
    const bool shows_openings = options.method == Method::Default;
    EXPECT_EQ(of_bowl.filledOpenings(), shows_openings ? 1U : 0U);
    EXPECT_GT(of_bowl.diagnosis.edges_outside_graph, 0.001);
    const Surface of_parts = mesh(parts, options);
    EXPECT_EQ(of_parts.diagnosis.joined_parts, 2U);
    EXPECT_TRUE(isFound(of_parts, "2 separate parts (160 and 200 points)"));
    ASSERT_EQ(of_parts.diagnosis.bridges.size(), 1U);
    EXPECT_EQ(of_parts.diagnosis.bridges[0].points, 160U);
    for (const Index v : of_parts.diagnosis.bridges[0].vertices)
      EXPECT_LT(std::abs(parts(0, v) - 3.0), 3.0);  // the ends look at each other
    for (const auto& [points, result] :
         {std::pair(torus, of_torus), {bowl, of_bowl}, {parts, of_parts}}) {
      expectGuarantees(points, result);
      const bool is_reported = shows_openings || points.cols() != bowl.cols();
      EXPECT_TRUE(hasFault(result.findings));
      EXPECT_TRUE(is_reported || isFound(result, "folded"));
    }
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

TEST(Judgement, ResidualsOfVerticesAreThoseOfTheSphere) {
  const Positions points = ellipsoid(600);
  const Options options = quick(given(paper(), "max_iterations", 3, "weights", "inverse"));
  const Surface result = mesh(points, watched(options));
  const Graph graph =
      internal::paper::nearestNeighborGraph(points, bruteForceNeighbors(points, 25), 25).graph;
  const std::vector<double> expected =
      tangentialLaplacianLengths(graph, result.sphere, options.paper.weights);
  ASSERT_EQ(result.vertex_residuals.size(), expected.size());
  for (std::size_t v = 0; v < expected.size(); ++v)
    EXPECT_NEAR(result.vertex_residuals[v], expected[v], 1e-12);
  const Surface other = mesh(points, watched());
  const double mean =
      std::accumulate(other.vertex_residuals.begin(), other.vertex_residuals.end(), 0.0) / 600.0;
  EXPECT_NEAR(mean, other.embedding.residual, 1e-9 * mean);
}

TEST(Judgement, MarksAreThoseOfTheFindings) {
  const Surface tangled =
      mesh(noisySphere(300, 1.0), watched(quick(given("consolidation", "none"))));
  std::set<Index> intersecting;
  for (const auto& pair : tangled.self_intersections)
    intersecting.insert(pair.begin(), pair.end());
  EXPECT_FALSE(intersecting.empty());
  std::set<Index> marked;
  for (const Index t : indicesOf(tangled.diagnosis.triangle_marks))
    if (tangled.diagnosis.triangle_marks[static_cast<std::size_t>(t)] &
        triangle_mark::self_intersection)
      marked.insert(t);
  EXPECT_EQ(marked, intersecting);
  EXPECT_EQ(mesh(ellipsoid(300), watched()).diagnosis.triangle_marks,
            std::vector<std::uint8_t>(2 * 300 - 4, 0));
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
  EXPECT_NEAR(result.measures.volume, rough.measures.volume, 1e-3 * rough.measures.volume);
  const auto deviation = [](const Positions& of) {
    return (of.colwise().norm().array() - 1.0).matrix().norm();
  };
  EXPECT_LT(deviation(result.points), 0.5 * deviation(vertices));
}

}  // namespace
}  // namespace spherical_param::test
