#include "consolidation.h"

#include "core/reconstructions.h"
#include "neighbor_search.h"

namespace spherical_param::test {
namespace {

/// Root mean square distance from the unit sphere.
double roughnessOf(const Positions& points) {
  return std::sqrt((points.colwise().norm().array() - 1.0).square().mean());
}

double shortestDistance(const Positions& points) {
  const NeighborLists lists = findNearestNeighbors(points, 1);
  double shortest = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < points.cols(); ++i)
    for (const Index j : rowOf(lists, i))
      if (j != i)
        shortest = std::min(shortest, (points.col(i) - points.col(j)).norm());
  return shortest;
}

/// Points that came together are numbered by the first of them, and all are in use.
void expectConsistent(const Positions& input, const Consolidation& result) {
  ASSERT_EQ(result.point_of_input.size(), columnCount(input));
  Index next = 0;
  for (const Index point : result.point_of_input) {
    ASSERT_LE(point, next);
    next = std::max(next, point + 1);
  }
  ASSERT_EQ(next, result.points.cols());
}

Eigen::ArrayXd displacementsOf(const Positions& input, const Consolidation& result) {
  const Positions steps = result.points(Eigen::all, result.point_of_input) - input;
  return steps.colwise().norm().transpose().array();
}

TEST(Consolidation, NoiseIsTakenOffAndMeasuredAndLayersBecomeOne) {
  const Positions noisy = withNoise(randomSphere(5000, 3), 0.01, 4);
  // As two scans of one surface that do not quite fit.
  const Positions layers =
      horizontally(0.985 * randomSphere(4000, 1), 1.015 * randomSphere(4000, 2));
  // Noise of two spacings is merged away; of one and a half it leaves more resolution.
  const Positions thick = withNoise(randomSphere(60000, 5), 0.03, 6);
  const Positions medium = withNoise(randomSphere(12000, 3), 0.045, 4);
  struct Case {
    const Positions& points;
    double roughness;   ///< that is left
    Index least, most;  ///< points that are merged
  };
  for (const auto& [points, roughness, least, most] :
       {Case{noisy, 0.45, 1, 1000}, Case{layers, 0.6, 1, 8000}, Case{thick, 0.5, 30000, 60000},
        Case{medium, 0.2, 1, 11000}}) {
    const Consolidation result = consolidate(points);
    expectConsistent(points, result);
    EXPECT_LT(roughnessOf(result.points), roughness * roughnessOf(points));
    EXPECT_GE(result.report.merged, static_cast<std::size_t>(least));
    EXPECT_LT(result.report.merged, static_cast<std::size_t>(most));
  }
  EXPECT_NEAR(consolidate(noisy).report.noise, 0.01, 0.002);
  EXPECT_GT(shortestDistance(consolidate(layers).points), 0.002);
  const Surface mesh = surfaceOf(layers, given("consolidation", "auto"));
  EXPECT_TRUE(mesh.self_intersections.empty());
  EXPECT_LT(mesh.measures.area, 1.03 * 4.0 * kPi);
}

TEST(Consolidation, ThinLimbsAreNoThickNoise) {
  // Six points around: the two sides are as near as points of one side.
  constexpr Index n = 1800;
  const Positions tube = gridOf(n / 6, 6, [](int ring, int i) {
    return onCircle(2.0 * kPi * (i + 0.5 * (ring % 2)) / 6.0, 0.1, 0.09 * ring);
  });
  const Consolidation result = consolidate(tube);
  expectConsistent(tube, result);
  EXPECT_LT(result.report.merged, n / 10);
  EXPECT_LT(displacementsOf(tube, result).mean(), 0.05);
}

TEST(Consolidation, FewPointsDuplicatesAndLonePointsStay) {
  EXPECT_EQ(consolidate(Positions(3, 0)).points.cols(), 0);
  const Positions few = horizontally(spiralSphere(10), spiralSphere(10).leftCols(2));
  const Consolidation result = consolidate(few);
  EXPECT_EQ(result.points, few.leftCols(10));
  EXPECT_EQ(result.point_of_input[10], 0);
  EXPECT_EQ(result.point_of_input[11], 1);
  EXPECT_EQ(result.report.merged, 0U);
  EXPECT_EQ(displacementsOf(few, result).maxCoeff(), 0.0);

  const Eigen::Vector3d lone(2.0, 0.0, 0.0);
  const Positions with_lone = horizontally(withNoise(spiralSphere(2000), 0.01, 7), lone);
  EXPECT_EQ(consolidate(with_lone).points.rightCols<1>(), lone);
}

TEST(Consolidation, TheMeshIsThatOfTheConsolidatedPoints) {
  const Positions base = withNoise(randomSphere(2000, 10), 0.02, 11);
  const Positions points = horizontally(base, base.leftCols(50));
  const Options options = given(sphere(), "consolidation", "auto");
  const Surface mesh = surfaceOf(points, options);
  const Consolidation expected = consolidate(points);
  EXPECT_EQ(mesh.points, expected.points);
  EXPECT_EQ(mesh.vertex_of_input, expected.point_of_input);
  EXPECT_EQ(mesh.triangles, surfaceOf(expected.points, sphere()).triangles);
  EXPECT_EQ(mesh.duplicates(), 50U);
  EXPECT_EQ(mesh.consolidation->merged, expected.report.merged);
  EXPECT_EQ(mesh.vertexCount() + mesh.consolidation->merged, 2000U);
  EXPECT_TRUE(mesh.topology.isSphere());
  ASSERT_TRUE(std::is_sorted(mesh.input_of_vertex.begin(), mesh.input_of_vertex.end()));
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v)
    EXPECT_EQ(mesh.vertex_of_input[static_cast<std::size_t>(mesh.input_of_vertex[v])],
              static_cast<Index>(v));

  // Neighbours of the points as they were say nothing about where they are now.
  const Surface with_search =
      surfaceOf(points, options, [](const std::vector<Index>&) -> NeighborSearch {
        ADD_FAILURE() << "searched";
        return {};
      });
  EXPECT_EQ(with_search.triangles, mesh.triangles);
}

TEST(Consolidation, NoisyPartsOfAScanAreConsolidatedByDefault) {
  const Positions noisy = withNoise(randomSphere(4000, 3), 0.04, 4);
  const Result result = reconstruct(noisy, Options());
  ASSERT_TRUE(result.surface().consolidation);
  const ConsolidationReport& report = *result.surface().consolidation;
  EXPECT_GT(report.distance_95, 0.05);
  EXPECT_LT(report.distance_95, 0.12);
  EXPECT_NE(result.verdict.find("; consolidated: "), std::string::npos) << result.verdict;
  EXPECT_TRUE(result.left_out.text().empty());
  EXPECT_TRUE(result.surface().topology.isSphere());
  EXPECT_FALSE(surfaceOf(noisy, given("consolidation", "none")).consolidation);
  const Surface through_all = surfaceOf(noisy, sphere());
  EXPECT_FALSE(through_all.consolidation);
  EXPECT_EQ(through_all.vertexCount(), 4000U);
}

TEST(Consolidation, CleanPointsAndTwoSheetsAreNotNoisy) {
  const double spacing = std::sqrt(4.0 * kPi / 3000.0);
  for (const double noise : {0.0, 0.1, 0.5})
    EXPECT_EQ(
        surfaceOf(withNoise(spiralSphere(3000), noise * spacing, 5)).consolidation.has_value(),
        noise == 0.5);
  EXPECT_LT(consolidate(spiralSphere(3000)).report.noise, 0.02 * spacing);
  const Positions nested =
      horizontally(spiralSphere(3000), (1.0 - 1.6 * spacing) * spiralSphere(2600));
  for (const Surface& surface : reconstruct(nested, Options()).surfaces)
    EXPECT_FALSE(surface.consolidation);
}

TEST(Consolidation, AnyPointsHaveAClosedMesh) {
  const Options options = given("consolidation", "auto", "intersections", "keep");
  for (const Index n : {4, 19, 20, 25, 100, 400}) {
    const Positions blob = withNoise(Positions::Zero(3, n), 1.0, static_cast<std::uint64_t>(n));
    EXPECT_TRUE(surfaceOf(blob, options).topology.isSphere()) << n;
    Positions line = 1e-3 * blob;
    line.row(0).setLinSpaced(0.0, 1.0);
    EXPECT_TRUE(surfaceOf(line, options).topology.isSphere()) << n;
  }
}

}  // namespace
}  // namespace spherical_param::test
