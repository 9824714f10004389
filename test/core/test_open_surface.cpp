#include "open_surface.h"

#include "open_shapes.h"
#include "reconstructions.h"
#include "spherical_param/errors.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param {
namespace {

using test::sphereWithHoles;

Options leftOpen(SurfaceMode mode = SurfaceMode::Open) {
  Options options;
  options.surface = mode;
  return options;
}

/// A manifold over all vertices whose boundary is as an independent walk finds it.
void expectSound(const Surface& result, std::size_t boundaries) {
  EXPECT_TRUE(result.topology.manifold());
  EXPECT_TRUE(result.topology.oriented);
  EXPECT_TRUE(result.topology.unused_vertices.empty());
  EXPECT_EQ(result.topology.components, 1U);
  EXPECT_EQ(result.topology.euler_characteristic, 2 - static_cast<long long>(boundaries));
  EXPECT_TRUE(result.self_intersections.empty());
  EXPECT_EQ(result.boundary.size(), boundaries);
  EXPECT_EQ(result.isClosed(), boundaries == 0);
  const std::map<Index, Index> next = test::boundaryOf(result.triangles);
  std::size_t vertices = 0;
  for (const std::vector<Index>& loop : result.boundary) {
    for (std::size_t i = 0; i < loop.size(); ++i)
      EXPECT_EQ(next.at(loop[i]), loop[(i + 1) % loop.size()]);
    vertices += loop.size();
  }
  EXPECT_EQ(vertices, next.size());
}

TEST(OpenSurface, HasTheOpeningsOfTheCloud) {
  expectSound(test::surfaceOf(test::hemisphere(700), leftOpen()), 1);
  expectSound(test::surfaceOf(test::tube(20, 40), leftOpen()), 2);
  for (const Index holes : {1, 2, 20})
    expectSound(test::surfaceOf(sphereWithHoles(4000, holes, 0.2), leftOpen()),
                static_cast<std::size_t>(holes));
  // An opening of more than half of the sphere.
  expectSound(
      test::surfaceOf(test::pointsWhere(test::spiralSphere(3000),
                                        [](const Eigen::Vector3d& p) { return p.z() < -0.4; }),
                      leftOpen()),
      1);
  expectSound(test::surfaceOf(test::spiralSphere(600), leftOpen()), 0);
}

TEST(OpenSurface, OfRandomSamplesDoesNotIntersectItself) {
  // Ragged rims, near which some points have no triangle at first.
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Positions wave = test::randomCube(1500, seed);
    wave.row(2) = 0.2 * (5.0 * wave.row(0)).array().sin();
    const Surface result = test::surfaceOf(
        test::pointsWhere(wave, [](const Eigen::Vector3d& p) { return p.head<2>().norm() > 0.4; }),
        leftOpen());
    EXPECT_GE(result.boundary.size(), 2U) << seed;
    expectSound(result, result.boundary.size());
  }
}

TEST(OpenSurface, ItsIntersectionsAreCountedExactly) {
  // Noise of half the points' distance: the optimisation smooths the positions. It finishes on the
  // given ones unless they are smoothed after it.
  const Positions points =
      test::withNoise(test::hemisphere(1500), 0.5 * std::sqrt(2.0 * test::kPi / 1500), 3);
  for (const int smoothing : {0, 3}) {
    Options options = leftOpen();
    options.smoothing = smoothing;
    const Surface result = test::surfaceOf(points, options);
    EXPECT_FALSE(result.isClosed());
    EXPECT_TRUE(result.is_noisy);
    EXPECT_TRUE(smoothing == 0 || !result.self_intersections.empty());
    EXPECT_EQ(result.smoothed.cols(), smoothing == 0 ? 0 : result.sphere.cols());
    EXPECT_EQ(result.self_intersections,
              findSelfIntersections(points(Eigen::all, result.input_of_vertex), result.triangles));
  }
}

TEST(OpenSurface, IsManifoldWhereOpeningsTouch) {
  // Discs around two points that are a little less apart than the discs are wide.
  for (const double radius : {0.27, 0.29, 0.31}) {
    const Eigen::Vector3d a(0.0, 0.0, 1.0);
    const Eigen::Vector3d b = Eigen::Vector3d(0.6, 0.0, 0.8).normalized();
    const Surface result = test::surfaceOf(
        test::pointsWhere(test::spiralSphere(3000),
                          [&](const Eigen::Vector3d& p) {
                            return std::min((p - a).norm(), (p - b).norm()) > radius;
                          }),
        leftOpen());
    expectSound(result, result.boundary.size());
    EXPECT_GE(result.boundary.size(), 1U);
    EXPECT_LE(result.boundary.size(), 2U);
  }
}

TEST(OpenSurface, OfAFlatPatchIsThePatch) {
  const Positions patch = test::pointsWhere(test::flatPatch(40), [](const Eigen::Vector3d& p) {
    return (p - Eigen::Vector3d(20.0, 20.0, 0.0)).norm() > 6.0;
  });
  EXPECT_THROW(reconstruct(patch, test::sphere()), InvalidInput);
  for (const SurfaceMode mode : {SurfaceMode::Open, SurfaceMode::Auto}) {
    const Surface result = test::surfaceOf(patch, leftOpen(mode));
    expectSound(result, 2);
    double rim = 0.0;  // twice the area that the boundary encloses
    for (const auto& loop : result.boundary)
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const auto v = result.input_of_vertex[static_cast<std::size_t>(loop[i])];
        const auto w =
            result.input_of_vertex[static_cast<std::size_t>(loop[(i + 1) % loop.size()])];
        rim += patch(0, v) * patch(1, w) - patch(1, v) * patch(0, w);
      }
    EXPECT_NEAR(result.measures.area, std::abs(rim) / 2.0, 1e-9);
  }
  // Patches of two and three rows are no wider than the gap that counts elsewhere.
  for (const int rows : {2, 3}) {
    Positions narrow(3, 9 * rows);
    for (int i = 0; i < 9 * rows; ++i)
      narrow.col(i) << i / rows + 0.01 * (i * i % 7), i % rows + 0.01 * (i * i % 5), 0.0;
    expectSound(test::surfaceOf(narrow, leftOpen()), 1);
  }
  // Of a line there is no surface.
  Positions line = Positions::Zero(3, 50);
  line.row(0).setLinSpaced(0.0, 1.0);
  EXPECT_THROW(reconstruct(line, leftOpen()), InvalidInput);
}

TEST(OpenSurface, IsTheClosedOneWithoutOpenings) {
  const Positions points = test::randomSphere(1500, 3);
  const Surface closed = test::surfaceOf(points, test::sphere());
  EXPECT_TRUE(closed.openings.empty());
  for (const SurfaceMode mode : {SurfaceMode::Open, SurfaceMode::Auto})
    EXPECT_EQ(test::surfaceOf(points, leftOpen(mode)).triangles, closed.triangles);
}

TEST(OpenSurface, AClosedMeshHasRoomForTheOpeningsAndTrianglesOverThem) {
  const Positions points = sphereWithHoles(3000, 2, 0.4);
  Options options = test::sphere();
  options.details = true;
  const Surface closed = test::surfaceOf(points, options);
  const Surface open = test::surfaceOf(points, leftOpen());
  // In a closed mesh, openings have the same room on the sphere.
  EXPECT_EQ(closed.sphere, open.sphere);
  EXPECT_TRUE(closed.isClosed());
  EXPECT_EQ(closed.filledOpenings(), 2U);
  ASSERT_EQ(closed.openings.size(), 2U);
  std::vector<int> count(static_cast<std::size_t>(closed.triangles.cols()), 0);
  for (std::size_t i = 0; i < 2; ++i) {
    const Opening& opening = closed.openings[i];
    EXPECT_EQ(opening.loop, open.openings[i].loop);
    EXPECT_TRUE(open.openings[i].triangles.empty());
    EXPECT_NEAR(static_cast<double>(opening.triangles.size()),
                static_cast<double>(opening.loop.size()), 10.0);
    for (const Index t : opening.triangles) {
      ++count[static_cast<std::size_t>(t)];
      const Eigen::Vector3d center = points(Eigen::all, closed.triangles.col(t)).rowwise().mean();
      EXPECT_LT((center - opening.center).norm(), 0.7 * opening.width);
    }
  }
  for (Eigen::Index t = 0; t < closed.triangles.cols(); ++t) {
    const int of_openings = count[static_cast<std::size_t>(t)];
    EXPECT_LE(of_openings, 1);
    EXPECT_EQ(closed.diagnosis.triangle_marks[static_cast<std::size_t>(t)] &
                  triangle_mark::filled_hole,
              of_openings * triangle_mark::filled_hole);
  }
  // Beside the openings an open mesh may lack a few more, where it would be no manifold.
  EXPECT_NEAR(
      static_cast<double>(closed.triangles.cols() - std::accumulate(count.begin(), count.end(), 0)),
      static_cast<double>(open.triangles.cols()), 10.0);
}

TEST(OpenSurface, AutoFillsWhatIsSmallOrFlat) {
  const Surface small =
      test::surfaceOf(sphereWithHoles(3000, 1, 0.15), leftOpen(SurfaceMode::Auto));
  expectSound(small, 0);
  ASSERT_EQ(small.openings.size(), 1U);
  EXPECT_TRUE(small.openings[0].is_filled);
  expectSound(test::surfaceOf(sphereWithHoles(3000, 1, 0.4), leftOpen(SurfaceMode::Auto)), 1);
  // A tube without ends may be one with flat ends.
  const Surface tube = test::surfaceOf(test::tube(20, 40), leftOpen(SurfaceMode::Auto));
  expectSound(tube, 0);
  EXPECT_EQ(tube.openings.size(), 2U);
}

TEST(OpenSurface, HolesAreFilledUpToASize) {
  Positions points = sphereWithHoles(4000, 2, 0.2);
  points = test::pointsWhere(points, [](const Eigen::Vector3d& p) { return p.y() > -0.8; });
  const Surface open = test::surfaceOf(points, leftOpen());
  ASSERT_EQ(open.openings.size(), 3U);
  const Opening& second = open.openings[1];
  Options by_edges = leftOpen();
  by_edges.fill_holes = static_cast<int>(second.loop.size());
  expectSound(test::surfaceOf(points, by_edges), 1);
  Options by_area = leftOpen();
  by_area.fill_holes_area = 1.01 * second.area;
  expectSound(test::surfaceOf(points, by_area), 1);
  by_area.fill_holes_area = 10.0;
  expectSound(test::surfaceOf(points, by_area), 0);
}

TEST(OpenSurface, DoesNotDependOnOrderPlaceAndScale) {
  const Positions points = sphereWithHoles(2500, 3, 0.3);
  const Surface result = test::surfaceOf(points, leftOpen());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  const Surface moved =
      test::surfaceOf((turn * points).colwise() + Eigen::Vector3d(7.0, -3.0, 11.0), leftOpen());
  ASSERT_EQ(moved.openings.size(), 3U);
  const Surface scaled = test::surfaceOf(64.0 * points, leftOpen());
  EXPECT_EQ(scaled.triangles, result.triangles);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(scaled.openings[i].width, 64.0 * result.openings[i].width);
    EXPECT_EQ(scaled.openings[i].area, 4096.0 * result.openings[i].area);
    EXPECT_EQ(moved.openings[i].loop.size(), result.openings[i].loop.size());
  }
  const Surface reversed = test::surfaceOf(points.rowwise().reverse(), leftOpen());
  const auto last = static_cast<Index>(points.cols()) - 1;
  EXPECT_EQ(test::canonical(reversed.triangles.unaryExpr([=](Index v) { return last - v; })),
            test::canonical(result.triangles));
}

TEST(OpenSurface, WithAHandleOrOneSideIsSaidToBeNone) {
  // A torus with a hole, and a Moebius band.
  Positions torus(3, 80 * 30);
  Positions band(3, 160 * 12);
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 30; ++j) {
      const double u = 2.0 * test::kPi * (i + 0.5 * (j % 2)) / 80;
      const double v = 2.0 * test::kPi * j / 30;
      torus.col(i * 30 + j) << (2.5 + std::cos(v)) * std::cos(u), (2.5 + std::cos(v)) * std::sin(u),
          std::sin(v);
    }
  for (int i = 0; i < 160; ++i)
    for (int j = 0; j < 12; ++j) {
      const double u = 2.0 * test::kPi * (i + 0.5 * (j % 2)) / 160;
      const double v = 0.1 * (j - 5.5);
      const double radius = 2.5 + v * std::cos(u / 2.0);
      band.col(i * 12 + j) << radius * std::cos(u), radius * std::sin(u), v * std::sin(u / 2.0);
    }
  const Positions holed = test::pointsWhere(torus, [](const Eigen::Vector3d& p) {
    return (p - Eigen::Vector3d(3.5, 0.0, 0.0)).norm() > 0.7;
  });
  Options options = leftOpen();
  options.handles = HandleMode::None;
  for (const Positions& points : {holed, band}) {
    const Surface result = test::surfaceOf(points, options);
    EXPECT_TRUE(result.topology.manifold());
    EXPECT_NE(result.diagnosis.kind, SurfaceKind::ClosedGenus0);
    EXPECT_NE(result.diagnosis.kind, SurfaceKind::Open);
    EXPECT_FALSE(result.findings.empty());
  }
}

}  // namespace
}  // namespace spherical_param
