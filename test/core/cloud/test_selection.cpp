#include "selection.h"

#include "core/reconstructions.h"
#include "handle_shapes.h"

namespace spherical_param::test {
namespace {

/// Two noisy spheres, points of no surface, repeated points and points that are not finite.
Positions mixedCloud() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Positions points = horizontally(withNoise(randomSphere(300, 1), 0.01, 2),
                                  movedTo(4.0, withNoise(randomSphere(150, 3), 0.01, 4)));
  points = horizontally(points, 2.0 * spiralSphere(6));
  points = horizontally(points, points.middleCols(280, 176), Positions::Constant(3, 2, nan));
  return points(Eigen::all, shuffledRange(points.cols(), 7));
}

/// Every point is in one list, and each list is ascending.
void expectPartition(const Positions& points, const Result& result) {
  std::vector<std::vector<Index>> lists{result.left_out.not_finite, result.left_out.outliers,
                                        result.left_out.other_parts};
  for (const Surface& surface : result.surfaces)
    lists.push_back(surface.inputs);
  std::vector<Index> all;
  for (const std::vector<Index>& list : lists) {
    EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
    all.insert(all.end(), list.begin(), list.end());
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(all, range(0, points.cols()));
  for (const Index i : result.left_out.not_finite)
    EXPECT_FALSE(points.col(i).allFinite());
}

/// A surface in the numbers of the cloud is that of its points alone.
void expectAlone(const Positions& points, const Surface& surface, const Options& options) {
  const Surface alone = surfaceOf(points(Eigen::all, surface.inputs),
                                  given(options, "outliers", "none", "parts", "all", "threads", 1));
  EXPECT_EQ(surface.triangles, alone.triangles);
  EXPECT_EQ(surface.sphere, alone.sphere);
  EXPECT_EQ(surface.points, alone.points);
  EXPECT_EQ(surface.vertex_of_input, alone.vertex_of_input);
  for (std::size_t v = 0; v < alone.vertexCount(); ++v)
    EXPECT_EQ(surface.input_of_vertex.at(v),
              surface.inputs[static_cast<std::size_t>(alone.input_of_vertex[v])]);
  for (std::size_t i = 0; i < surface.inputs.size(); ++i)
    EXPECT_EQ(surface.vertexOf(surface.inputs[i]), alone.vertex_of_input[i]);
}

TEST(Topology, OfAScanIsWhatTheCloudShowsAndASphereHasEveryPoint) {
  const Positions points =
      horizontally(ellipsoid(500), movedTo(3.0, hemisphere(400)), movedTo(6.0, torusCloud(40, 16)),
                   Eigen::Vector3d(0.0, 9.0, 0.0));
  const Result scan = reconstruct(points);
  EXPECT_EQ(scan.verdict,
            "3 surfaces, 1 with openings, 1 with handles, all sound; 1 stray point left out.");
  EXPECT_EQ(scan.surface().genus(), 1U);
  EXPECT_EQ(reconstruct(points, given("surface", "closed", "parts", "largest")).verdict,
            "A sound mesh with 1 handle; 58 % of the points left out: 1 stray point, 900 points in "
            "other parts.");
  const Surface sphere = surfaceOf(points, quick(test::sphere()));
  EXPECT_TRUE(isSphereOverAll(sphere.triangles, static_cast<Index>(points.cols())));
  EXPECT_EQ(withTopology(paper()).parts, PartsMode::All);
}

TEST(Topology, OfWholeObjectsIsASphereInBothWays) {
  for (const Positions& points : {ellipsoid(600), noisySphere(800, 0.2), randomSphere(700, 5),
                                  bentTube(6.0, 1.0, 12).points, twoSpheres(30, 30, 0.5)}) {
    const Result scan = reconstruct(points);
    EXPECT_TRUE(scan.left_out.text().empty());
    const auto sphere = canonical(surfaceOf(points, test::sphere()).triangles);
    EXPECT_EQ(canonical(scan.surface().triangles), sphere);
    EXPECT_EQ(canonical(surfaceOf(points, given("surface", "open")).triangles), sphere);
  }
}

TEST(Topology, PointsThatSampleWhatIsOpenAreNoStrayPoints) {
  const Positions object =
      pointsWhere(spiralSphere(3000), [](const Eigen::Vector3d& p) { return p.z() > -0.6; });
  Positions few = 0.4 * spiralSphere(5);
  few.row(2).setConstant(-0.6);
  EXPECT_TRUE(reconstruct(horizontally(object, few)).left_out.text().empty());
  few(2, 0) = 0.0;
  EXPECT_EQ(reconstruct(horizontally(object, few)).left_out.outliers.size(), 5U);
}

TEST(Selection, EverySurfaceIsThatOfItsPointsAlone) {
  const Positions points = mixedCloud();
  for (const char* parts : {"all", "largest", "each"})
    for (const OptionValue& outliers : {OptionValue("none"), OptionValue("auto"), OptionValue(4.0)})
      for (const char* consolidation : {"none", "auto"})
        for (const int threads : {1, 3}) {
          const Options options = given(quick(), "parts", parts, "outliers", outliers,
                                        "consolidation", consolidation, "threads", threads);
          const Result result = reconstruct(points, options);
          expectPartition(points, result);
          EXPECT_EQ(result.surfaces.size(), options.parts == PartsMode::Each ? 2U : 1U);
          EXPECT_EQ(result.left_out.not_finite.size(), 2U);
          EXPECT_EQ(result.left_out.outliers, findOutliers(points, options));
          EXPECT_EQ(result.left_out.outliers.size(), outliers == OptionValue("none") ? 0U : 12U);
          for (std::size_t i = 0; i < result.surfaces.size(); ++i) {
            expectAlone(points, result.surfaces[i], options);
            if (options.parts != PartsMode::All) {
              EXPECT_EQ(result.surfaces[i].inputs, findParts(points, options)[i]);
            }
          }
        }
}

TEST(Selection, APartThatCannotBeMeshedIsLeftOutUnlessNoneCanBe) {
  const Positions square = patchOf(10, 10);  // of which there is no closed surface
  const Options options = given("parts", "each", "surface", "closed");
  const Result result = reconstruct(horizontally(movedTo(9.0, square), spiralSphere(80)), options);
  ASSERT_EQ(result.surfaces.size(), 1U);
  EXPECT_EQ(result.surface().inputs.front(), 100);
  EXPECT_EQ(result.left_out.other_parts.size(), 100U);
  ASSERT_EQ(result.failures.size(), 1U);
  EXPECT_EQ(result.failures[0].find("1 part (100 points) cannot be meshed: all points lie"), 0U);
  EXPECT_THROW(reconstruct(horizontally(square, movedTo(30.0, square)), options), InvalidInput);
}

TEST(Selection, TheCallersSearchIsMadeOnceOfTheFirstPointAtEachPosition) {
  const Positions points = mixedCloud();
  for (const bool takes_apart : {false, true})
    for (Options options : bothMethods()) {
      options = quick(options);
      options.paper.max_iterations = 50;
      options.parts = takes_apart ? PartsMode::Each : PartsMode::All;
      options.outliers = takes_apart ? OutlierMode::Auto : OutlierMode::None;
      int made = 0;
      const Result result = reconstruct(points, options, [&](const std::vector<Index>& some) {
        ++made;
        EXPECT_TRUE(std::is_sorted(some.begin(), some.end()));
        EXPECT_EQ(some.size(), 456U);
        for (const Index i : some)
          for (Index j = 0; j < i; ++j)
            EXPECT_NE(points.col(j), points.col(i));
        return [&, some, search = bruteForceFactory(points)(some)](
                   const std::vector<Index>& queries, int count) {
          for (const Index query : queries)
            EXPECT_TRUE(std::binary_search(some.begin(), some.end(), query));
          return search(queries, count);
        };
      });
      EXPECT_EQ(made, 1);
      const Result expected = reconstruct(points, options);
      ASSERT_EQ(result.surfaces.size(), takes_apart ? 2U : 1U);
      for (std::size_t i = 0; i < result.surfaces.size(); ++i) {
        EXPECT_EQ(result.surfaces[i].triangles, expected.surfaces.at(i).triangles);
        expectAlone(points, result.surfaces[i], options);
      }
    }
}

TEST(Selection, PartsShareOneTimeLimit) {
  const Positions points = inARow(8, 4.0, noisySphere(100, 0.5));
  const Options each = given("parts", "each");
  for (const auto& [limit, expected] : {std::pair(0.0, 8), std::pair(1e9, 0)}) {
    const Result result = reconstruct(points, given(each, "time_limit", limit));
    EXPECT_EQ(result.surfaces.size(), 8U);
    EXPECT_EQ(std::count_if(result.surfaces.begin(), result.surfaces.end(),
                            [](const Surface& surface) { return surface.is_out_of_time; }),
              expected);
  }
  // All have a mesh, also those after one that takes all the time.
  Options options = given(each, "time_limit", 0.05);
  options.progress = [](const Progress& progress) {
    if (progress.part == 2)
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    return true;
  };
  EXPECT_EQ(reconstruct(points, options).surfaces.size(), 8U);
}

}  // namespace
}  // namespace spherical_param::test
