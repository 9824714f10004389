#include "open_surface.h"

#include "core/reconstructions.h"
#include "handle_shapes.h"

namespace spherical_param::test {
namespace {

Options leftOpen(const char* mode = "open") {
  return given("surface", mode);
}

TEST(OpenSurface, HasTheOpeningsOfTheCloud) {
  test::expectSound(surfaceOf(hemisphere(700), leftOpen()), 0, 1);
  test::expectSound(surfaceOf(tube(20, 40), leftOpen()), 0, 2);
  for (const Index holes : {1, 2, 20})
    test::expectSound(surfaceOf(sphereWithHoles(4000, holes, 0.2), leftOpen()), 0,
                      static_cast<std::size_t>(holes));
  // An opening of more than half of the sphere.
  const Positions bowl =
      pointsWhere(spiralSphere(3000), [](const Eigen::Vector3d& p) { return p.z() < -0.4; });
  test::expectSound(surfaceOf(bowl, leftOpen()), 0, 1);
  test::expectSound(surfaceOf(spiralSphere(600), leftOpen()), 0, 0);
}

TEST(OpenSurface, OfRandomSamplesDoesNotIntersectItself) {
  // Ragged boundaries, near which some points have no triangle at first.
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Positions wave = randomCube(1500, seed);
    wave.row(2) = 0.2 * (5.0 * wave.row(0)).array().sin();
    const Surface result = surfaceOf(
        pointsWhere(wave, [](const Eigen::Vector3d& p) { return p.head<2>().norm() > 0.4; }),
        leftOpen());
    EXPECT_GE(result.boundary.size(), 2U) << seed;
    test::expectSound(result, 0, result.boundary.size());
  }
}

TEST(OpenSurface, ItsIntersectionsAreCountedExactly) {
  // Noise of half the points' distance: the optimisation smooths the positions. It finishes on the
  // given ones unless they are smoothed after it.
  const Positions points = withNoise(hemisphere(1500), 0.5 * std::sqrt(2.0 * kPi / 1500), 3);
  for (const int smoothing : {0, 3}) {
    const Surface result =
        surfaceOf(points, given(leftOpen(), "smoothing", smoothing, "consolidation", "none"));
    EXPECT_FALSE(result.isClosed());
    EXPECT_TRUE(result.is_noisy);
    EXPECT_EQ(result.smoothing.has_value(), smoothing > 0);
    EXPECT_EQ(result.self_intersections, findSelfIntersections(result.points, result.triangles));
  }
}

TEST(OpenSurface, OfAFlatPatchIsThePatch) {
  const Positions patch = pointsWhere(flatPatch(40), [](const Eigen::Vector3d& p) {
    return (p - Eigen::Vector3d(20.0, 20.0, 0.0)).norm() > 6.0;
  });
  for (const char* const mode : {"open", "auto"}) {
    const Surface result = surfaceOf(patch, leftOpen(mode));
    test::expectSound(result, 0, 2);
    const Positions vertices = verticesOf(patch, result);
    double enclosed = 0.0;  // twice the area within the boundary
    for (const auto& [v, w] : boundaryOf(result.triangles))
      enclosed += vertices.col(v).cross(vertices.col(w)).z();
    EXPECT_NEAR(result.measures.area, std::abs(enclosed) / 2.0, 1e-9);
  }
  // Patches of two and three rows are no wider than the gap that counts elsewhere.
  for (const int rows : {2, 3})
    test::expectSound(surfaceOf(patchOf(9, rows), leftOpen()), 0, 1);
  // Of a line there is no surface.
  const Positions line = Eigen::Vector3d::UnitX() * Eigen::RowVectorXd::LinSpaced(50, 0.0, 1.0);
  EXPECT_THROW(reconstruct(line, leftOpen()), InvalidInput);
}

TEST(OpenSurface, AClosedMeshHasRoomForTheOpeningsAndTrianglesOverThem) {
  const Positions points = sphereWithHoles(3000, 2, 0.4);
  const Surface closed = surfaceOf(points, withDetails(sphere()));
  const Surface open = surfaceOf(points, withDetails(leftOpen()));
  // In a closed mesh, openings have the same room on the sphere.
  EXPECT_EQ(closed.sphere, open.sphere);
  EXPECT_TRUE(closed.isClosed());
  EXPECT_EQ(closed.filledOpenings(), 2U);
  ASSERT_EQ(closed.openings.size(), 2U);
  Indexed<int> count(columnCount(closed.triangles), 0);
  for (std::size_t i = 0; i < 2; ++i) {
    const Opening& opening = closed.openings[i];
    EXPECT_EQ(opening.loop, open.openings[i].loop);
    EXPECT_TRUE(open.openings[i].triangles.empty());
    EXPECT_NEAR(static_cast<double>(opening.triangles.size()),
                static_cast<double>(opening.loop.size()), 10.0);
    for (const Index t : opening.triangles) {
      ++count[t];
      const Eigen::Vector3d center = points(Eigen::all, closed.triangles.col(t)).rowwise().mean();
      EXPECT_LT((center - opening.center).norm(), 0.7 * opening.width);
    }
  }
  for (const Index t : indicesOf(count)) {
    EXPECT_LE(count[t], 1);
    EXPECT_EQ(closed.diagnosis.triangle_marks[static_cast<std::size_t>(t)] &
                  triangle_mark::filled_hole,
              count[t] * triangle_mark::filled_hole);
  }
  // Beside the openings an open mesh may lack a few more, where it would be no manifold.
  EXPECT_NEAR(
      static_cast<double>(closed.triangles.cols() - std::accumulate(count.begin(), count.end(), 0)),
      static_cast<double>(open.triangles.cols()), 10.0);
}

TEST(OpenSurface, AutoFillsWhatIsSmallOrFlat) {
  const Surface small = surfaceOf(sphereWithHoles(3000, 1, 0.15), leftOpen("auto"));
  test::expectSound(small, 0, 0);
  ASSERT_EQ(small.openings.size(), 1U);
  EXPECT_TRUE(small.openings[0].is_filled);
  test::expectSound(surfaceOf(sphereWithHoles(3000, 1, 0.4), leftOpen("auto")), 0, 1);
  // A tube without ends may be one with flat ends.
  const Surface tube = surfaceOf(test::tube(20, 40), leftOpen("auto"));
  test::expectSound(tube, 0, 0);
  EXPECT_EQ(tube.openings.size(), 2U);
}

TEST(OpenSurface, HolesAreFilledUpToASize) {
  const Positions points =
      pointsWhere(sphereWithHoles(4000, 2, 0.2), [](const auto& p) { return p.y() > -0.8; });
  const Surface open = surfaceOf(points, leftOpen());
  ASSERT_EQ(open.openings.size(), 3U);
  const Opening& second = open.openings[1];
  const auto filled = [&](int edges) {
    return surfaceOf(points, given(leftOpen(), "fill_holes", edges));
  };
  test::expectSound(filled(static_cast<int>(second.loop.size())), 0, 1);
  test::expectSound(filled(1000), 0, 0);
}

TEST(OpenSurface, AHandleThatIsCutAndASurfaceOfOneSideAreReported) {
  const Positions holed = pointsWhere(torusCloud(80, 30, 2.5, 1.0), [](const Eigen::Vector3d& p) {
    return (p - Eigen::Vector3d(3.5, 0.0, 0.0)).norm() > 0.7;
  });
  const Positions band = moebiusBand(160, 12);
  for (const auto& [points, handles] :
       {std::pair(holed, "none"), std::pair(band, "none"), std::pair(band, "auto")}) {
    const Surface result = surfaceOf(points, given(leftOpen(), "handles", handles));
    EXPECT_TRUE(result.topology.manifold());
    EXPECT_EQ(result.diagnosis.is_one_sided, points.cols() == band.cols());
    EXPECT_TRUE(result.diagnosis.is_one_sided || result.diagnosis.cut_handles == 1);
    EXPECT_TRUE(hasFault(result.findings));
  }
}

TEST(OpenSurface, IsManifoldWhereOpeningsTouch) {
  // Discs around two points that are a little less apart than the discs are wide.
  const Eigen::Vector3d a(0.0, 0.0, 1.0);
  const Eigen::Vector3d b = Eigen::Vector3d(0.6, 0.0, 0.8).normalized();
  for (const double radius : {0.27, 0.29, 0.31}) {
    const Positions points = pointsWhere(spiralSphere(3000), [&](const Eigen::Vector3d& p) {
      return std::min((p - a).norm(), (p - b).norm()) > radius;
    });
    const Surface result = surfaceOf(points, leftOpen());
    test::expectSound(result, 0, result.boundary.size());
    EXPECT_GE(result.boundary.size(), 1U);
    EXPECT_LE(result.boundary.size(), 2U);
  }
}

}  // namespace
}  // namespace spherical_param::test
