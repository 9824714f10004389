#include "core/reconstructions.h"
#include "depth_images.h"
#include "indexed.h"
#include "open_shapes.h"
#include "spherical_param/mesh_measures.h"

namespace spherical_param::test {
namespace {

Options seenFrom(const Eigen::Vector3d& place) {
  Options options;
  options.view = ViewMode::Place;
  options.viewpoint = place;
  return options;
}

/// Sound surfaces of all points but those that are left out, that face the place.
void expectViews(const Positions& points, const Result& result) {
  ASSERT_TRUE(result.view);
  std::size_t inputs = result.left_out.not_finite.size() + result.left_out.outliers.size() +
                       result.left_out.other_parts.size() + result.left_out.unmeshed.size();
  for (const Surface& surface : result.surfaces) {
    EXPECT_TRUE(surface.topology.manifold());
    EXPECT_TRUE(surface.topology.oriented);
    EXPECT_TRUE(surface.topology.unused_vertices.empty());
    EXPECT_EQ(surface.faced_by, FacedBy::Viewpoint);
    const Positions vertices = verticesOf(points, surface);
    EXPECT_TRUE(findSelfIntersections(vertices, surface.triangles).empty());
    for (const auto& t : surface.triangles.colwise()) {
      const Eigen::Vector3d a = vertices.col(t[0]);
      const Eigen::Vector3d b = vertices.col(t[1]);
      ASSERT_GE((b - a).cross(vertices.col(t[2]) - a).dot(result.view->place - a), 0.0);
    }
    for (Index v = 0; v < vertices.cols(); ++v)
      ASSERT_LT(
          (surface.sphere.col(v) - (vertices.col(v) - result.view->place).normalized()).norm(),
          1e-6);
    inputs += surface.inputs.size();
  }
  EXPECT_EQ(inputs, columnCount(points));
}

TEST(ViewReconstruction, OfADepthImageHasItsSurfaces) {
  const Positions points = withDepthNoise(depthImage(80, 60, boxBeforeWall), 0.001, 2);
  const Result result = reconstruct(points);
  expectViews(points, result);
  EXPECT_EQ(result.view->source, ViewSource::Origin);
  EXPECT_EQ(result.view->place, Eigen::Vector3d::Zero());
  ASSERT_EQ(result.surfaces.size(), 2U);
  EXPECT_EQ(result.verdict, "Seen from one place: 2 surfaces with openings, all sound.");
  EXPECT_EQ(result.surfaces[0].boundary.size(), 2U);
  EXPECT_EQ(result.surfaces[1].openings.size(), 1U);
  EXPECT_EQ(result.stages.front().name, "view");
  EXPECT_FALSE(reconstruct(points, given("view", "none")).view);
  EXPECT_FALSE(reconstruct(points, sphere()).view);
}

TEST(ViewReconstruction, OfAnImageHalfOfWhichIsNotFinite) {
  Positions points = depthImage(80, 60, boxBeforeWall);
  for (Index i = 0; i < points.cols(); i += 2)
    points.col(i).setConstant(std::nan(""));
  const Result result = reconstruct(points);
  expectViews(points, result);
  EXPECT_EQ(result.left_out.not_finite.size(), 2400U);
  EXPECT_EQ(result.surfaces.size(), 2U);
}

TEST(ViewReconstruction, OfAFewPointsAndOfPointsAtThePlace) {
  Positions five(3, 5);
  five << 0, 1, 0, -1, 0,  //
      0, 0, 1, 0, -1,      //
      4, 5, 5, 5, 5;
  const Result few = reconstruct(five, seenFrom(Eigen::Vector3d::Zero()));
  expectViews(five, few);
  EXPECT_EQ(few.surface().triangles.cols(), 4);
  // The sensor among the points: a point there is hidden.
  const Positions image = depthImage(30, 30, boxBeforeWall);
  const Positions points = horizontally(image, Positions::Zero(3, 1));
  const Result result = reconstruct(points, seenFrom(Eigen::Vector3d::Zero()));
  EXPECT_EQ(result.surfaces.size(), 2U);
  EXPECT_EQ(result.surfaces[0].vertexCount() + result.surfaces[1].vertexCount(), 900U);
}

TEST(ViewReconstruction, OfUtmCoordinatesKeepsThem) {
  const Eigen::Vector3d origin(468000.25, 5421000.5, 300.0);
  const Positions points = (20.0 * depthImage(60, 50, ballInRoom)).colwise() + origin;
  const Result result = reconstruct(points, seenFrom(origin));
  ASSERT_TRUE(result.view);
  EXPECT_EQ(result.view->place, origin);
  expectViews(points, result);
}

TEST(ViewReconstruction, OptionsKeepTheirMeaning) {
  const Positions points = depthImage(60, 40, boxBeforeWall);
  const auto run = [&](Options options) {
    options.view = ViewMode::Place;
    return reconstruct(points, options);
  };
  EXPECT_EQ(run(given("parts", "all")).surfaces.size(), 1U);
  EXPECT_EQ(run(given("parts", "all")).surface().topology.components, 2U);
  const Result largest = run(given("parts", "largest"));
  ASSERT_EQ(largest.surfaces.size(), 1U);
  EXPECT_EQ(largest.left_out.other_parts.size(), 2400U - largest.surface().inputs.size());
  EXPECT_EQ(run(given("min_points", 1000)).surfaces.size(), 1U);
  EXPECT_THROW(run(given("parts", "each", "min_points", 3000)), InvalidInput);
  EXPECT_EQ(run(given("time_limit", 0.0)).surfaces.size(), 2U);
  const std::size_t hole = largest.surface().boundary[1].size();
  // The wall stays open where the box is.
  EXPECT_EQ(run(given("fill_holes", static_cast<int>(hole))).surface().boundary.size(), 2U);
  for (const Options& options : {given("smoothing", 5), given("consolidation", "auto"),
                                 given("outliers", 4.0), given("intersections", "keep")}) {
    EXPECT_FALSE(reconstruct(points, options).view);
    EXPECT_THROW(run(options), InvalidInput);
  }
}

TEST(ViewReconstruction, FilledGapsAreListedAndMayBeSmooth) {
  const Positions image = depthImage(60, 60, [](double x, double) { return 2.0 + 0.2 * x * x; });
  const Positions points =
      pointsWhere(image, [](const Eigen::Vector3d& p) { return p.head<2>().norm() > 0.4; });
  Options options = seenFrom(Eigen::Vector3d::Zero());
  EXPECT_EQ(reconstruct(points, options).surface().boundary.size(), 2U);
  options.fill_holes = 200;
  options.details = true;
  const Surface flat = reconstruct(points, options).surface();
  EXPECT_EQ(flat.boundary.size(), 1U);
  EXPECT_EQ(flat.filledOpenings(), 1U);
  EXPECT_EQ(std::count(flat.diagnosis.triangle_marks.begin(), flat.diagnosis.triangle_marks.end(),
                       triangle_mark::filled_hole),
            static_cast<std::ptrdiff_t>(flat.openings.back().triangles.size()));
  options.fill = FillMode::Smooth;
  EXPECT_GT(reconstruct(points, options).surface().added_vertices, 30U);
}

TEST(ViewReconstruction, OfASphereIsItsMapFromAGivenPlace) {
  const Positions points = ellipsoid(500);
  Options options = sphere(seenFrom(Eigen::Vector3d(0.1, 0.0, 0.1)));
  const Surface closed = surfaceOf(points, options);
  expectGuarantees(points, closed);
  for (Index v = 0; v < 500; ++v) {
    const Eigen::Vector3d ray = points.col(v) - options.viewpoint;
    EXPECT_LT((closed.sphere.col(v) - ray.normalized()).norm(), 1e-12);
  }
  // From outside it is a sphere as well, whatever it looks like.
  options.viewpoint = Eigen::Vector3d(0.0, 0.0, 9.0);
  expectGuarantees(points, surfaceOf(points, options));
  // Nothing jumps where the place is inside.
  const Surface inside = surfaceOf(points, seenFrom(Eigen::Vector3d::Zero()));
  EXPECT_TRUE(inside.isClosed());
  EXPECT_EQ(inside.faced_by, FacedBy::Outward);
  EXPECT_GT(inside.measures.volume, 0.0);
}

TEST(ViewReconstruction, OfPointsInOnePlaneIsThePatchAndOfThoseOnALineIsRefused) {
  EXPECT_EQ(reconstruct(flatPatch(10), given("view", "up")).surface().boundary.size(), 1U);
  // Seen from one end it is one ray.
  const Positions line = pointsAt(60, [](Index i) { return Eigen::Vector3d(0.0, 0.0, 1.0 + i); });
  for (const double x : {0.0, 5.0})
    EXPECT_THROW(reconstruct(line, seenFrom(Eigen::Vector3d(x, 0.0, 0.0))), InvalidInput);
}

TEST(ViewReconstruction, HasTheSameBytesForAnyNumberOfThreads) {
  const Positions points = elsewhere(withDepthNoise(depthImage(160, 130, ballInRoom), 0.002, 1));
  Options options;
  options.threads = 1;
  const Result one = reconstruct(points, options);
  options.threads = 4;
  const Result four = reconstruct(points, options);
  ASSERT_EQ(one.surfaces.size(), four.surfaces.size());
  ASSERT_TRUE(one.view && four.view);
  EXPECT_EQ(one.view->place, four.view->place);
  for (std::size_t i = 0; i < one.surfaces.size(); ++i)
    EXPECT_EQ(one.surfaces[i].triangles, four.surfaces[i].triangles);
}

TEST(ViewReconstruction, OfAnyNoiseNoTrianglesOfAllSurfacesIntersect) {
  for (const double sigma : {0.001, 0.01, 0.03})
    for (const char* const parts : {"each", "all"}) {
      const Positions points = withDepthNoise(depthImage(80, 60, boxBeforeWall), sigma, 2);
      const Result result =
          reconstruct(points, given(seenFrom(Eigen::Vector3d::Zero()), "parts", parts));
      ASSERT_TRUE(result.view);
      const JoinedMesh all = joined(result);
      EXPECT_TRUE(findSelfIntersections(all.points, all.triangles).empty()) << sigma << parts;
    }
}

TEST(ViewReconstruction, WithNormalsFacesAsTheyDo) {
  const Positions points = depthImage(60, 40, boxBeforeWall);
  CloudInfo info;
  info.normals = points;  // away from the sensor
  const auto run = [&] { return reconstruct(points, seenFrom(Eigen::Vector3d::Zero()), {}, info); };
  for (const Surface& surface : run().surfaces) {
    EXPECT_EQ(surface.faced_by, FacedBy::Normals);
    EXPECT_GT(areaWeightedNormals(surface.points, surface.triangles).row(2).sum(), 0.0);
  }
  for (Index i = 0; i < points.cols(); i += 2)  // no common side
    info.normals.col(i) *= -1.0;
  for (const Surface& surface : run().surfaces)
    EXPECT_EQ(surface.faced_by, FacedBy::Viewpoint);
}

}  // namespace
}  // namespace spherical_param::test
