#include "reconstructions.h"

namespace spherical_param::test {
namespace {

TEST(Reconstruct, CleanCloudsAreMeshedTrulyAndWithoutFaultsByBothMethods) {
  for (const Options& options : bothMethods())
    for (const Positions& points : {ellipsoid(800), cubeGrid(8)}) {
      const Surface result = mesh(points, options);
      expectGuarantees(points, result);
      EXPECT_TRUE(result.self_intersections.empty());
      EXPECT_TRUE(result.openings.empty() && result.diagnosis.bridges.empty());
      EXPECT_FALSE(result.is_noisy);
      EXPECT_FALSE(result.consolidation || result.smoothing);
      EXPECT_EQ(result.embedding.levels.empty(), options.method == Method::Paper);
      EXPECT_EQ(result.verdict, "A sound mesh.");
      EXPECT_FALSE(hasFault(result.findings));
      if (points.cols() == 800) {
        // An inscribed polyhedron of 800 points: volume of the ellipsoid less about 1 %.
        EXPECT_NEAR(result.measures.volume, 4.0 / 3.0 * kPi * 0.35, 0.03);
        EXPECT_LT(result.diagnosis.edges_outside_graph, 1e-9);
      }
    }
  // Corners are cut if any crease is missing.
  const MeshMeasures cube = mesh(cubeGrid(9)).measures;
  EXPECT_NEAR(cube.volume, 1.0, 1e-12);
  EXPECT_NEAR(cube.area, 6.0, 1e-12);
}

std::vector<Positions> nastySets() {
  std::vector<Positions> sets{cubeGrid(6), spiralSphere(200) * 1e-300, spiralSphere(200) * 1e100};
  Positions circle = spiralSphere(100);
  circle.row(2).setZero();
  circle.colwise().normalize();
  sets.push_back(horizontally(circle, Eigen::Vector3d(0.0, 0.0, 0.5)));  // coplanar but one
  const Positions line = Eigen::Vector3d::UnitX() * Eigen::RowVectorXd::LinSpaced(100, 0.0, 99.0);
  sets.push_back(horizontally(line, Eigen::Matrix<double, 3, 2>{{5, 7}, {1, 0}, {0, 1}}));
  sets.push_back(horizontally(spiralSphere(200), Eigen::Vector3d(1e9, 0.0, 0.0)));
  sets.push_back(twoSpheres(150, 150, 1e6));
  sets.push_back(horizontally(spiralSphere(150), randomSphere(150, 1) * 1e-12));
  Positions utm = spiralSphere(200);
  utm.colwise() += Eigen::Vector3d(5e7, -3e7, 1e7);
  sets.push_back(utm);
  Positions flat = randomSphere(200, 2);
  flat.row(2) *= 1e-14;
  sets.push_back(flat);
  // Products of their differences underflow: inexact predicates made the optimisation endless.
  Positions pair = Positions::Zero(3, 2);
  pair(2, 1) = std::numeric_limits<double>::denorm_min();
  sets.push_back(horizontally(randomSphere(20, 1), pair));
  sets.push_back(horizontally(randomSphere(20, 2), pair));
  // Repeated points become one vertex.
  sets.push_back(horizontally(ellipsoid(300), ellipsoid(300).leftCols(120)));
  sets.push_back(randomSphere(4, 1).replicate(1, 1000));
  for (Index n = 4; n <= 10; ++n)
    for (std::uint64_t seed = 0; seed < 3; ++seed)
      sets.push_back(randomCube(n, seed));
  return sets;
}

TEST(Reconstruct, NastySetsAreMeshed) {
  const std::vector<Positions> sets = nastySets();
  for (std::size_t s = 0; s < sets.size(); ++s)
    for (Options options : bothMethods())
      for (const EdgeWeights weights :
           {EdgeWeights::Adaptive,
            s % 2 == 0 ? EdgeWeights::Uniform : EdgeWeights::InverseLength}) {
        SCOPED_TRACE("set " + std::to_string(s));
        options.paper.weights = weights;
        options.paper.max_iterations = 200;
        const Surface result =
            mesh(sets[s], weights == EdgeWeights::Adaptive ? options : quick(options));
        expectGuarantees(sets[s], result);
        EXPECT_TRUE(std::isfinite(result.embedding.residual));
        EXPECT_TRUE(std::isfinite(result.measures.volume) && std::isfinite(result.measures.area));
      }
}

TEST(Reconstruct, OfASpaceCurveEnds) {
  const Positions curve = pointsAt(200, [](Index i) {
    const double t = i / 99.5 - 1.0;
    return Eigen::Vector3d(t, t * t, t * t * t);
  });
  for (const char* surface : {"auto", "open"})
    EXPECT_EQ(surfaceOf(curve, given("surface", surface)).vertexCount(), 200U);
  expectGuarantees(curve, mesh(curve, sphere()));
}

TEST(Reconstruct, ACollapseOfThePapersEmbeddingIsReportedUnlessCentringUndoesIt) {
  // Seen from the centroid, the sphere is one place and the far point the opposite one. Centring
  // spreads the one place over the sphere again within a few steps.
  const Positions points = horizontally(spiralSphere(400), Eigen::Vector3d(1e6, 0.0, 0.0));
  const Surface result = mesh(points, given(paper(), "max_iterations", 0));
  expectGuarantees(points, result);
  EXPECT_EQ(result.embedding.stop_reason, StopReason::Collapsed);
  EXPECT_FALSE(result.embedding.fallback_start);
  EXPECT_TRUE(isFound(result, "collapsed"));
  const Surface centred = mesh(points, given(paper(), "k", 10, "tolerance", 1e-8));
  EXPECT_NE(centred.embedding.stop_reason, StopReason::Collapsed);
  EXPECT_LT(centred.embedding.centroid_norm, 0.1);
}

TEST(Reconstruct, MirroredCloudIsOrientedOutward) {
  Positions mirrored = ellipsoid(600);
  mirrored.row(0) *= -1.0;
  const Options collapsing = given(paper(), "weights", "uniform", "max_iterations", 20000, "k", 3);
  const Options radial = given(paper(), "max_iterations", 0);
  for (const Positions& points : {ellipsoid(600), mirrored})
    for (const Options& options : {Options(), paper(), radial, collapsing}) {
      const Surface result = mesh(points, withDetails(options));
      expectGuarantees(points, result);
      EXPECT_GT(result.measures.volume, 1.0);
      EXPECT_GT(volumeOf(result.sphere, result.triangles), 3.5);
    }
}

TEST(Reconstruct, EveryOptionReachesItsStage) {
  using Change = std::pair<std::string, OptionValue>;
  const Positions points = ellipsoid(1500);
  const Options published = given(paper(), "max_iterations", 20);
  const std::vector<std::pair<Options, std::vector<Change>>> changes{
      {sphere(), {{"method", "paper"}, {"tolerance", 1e-9}, {"seed", std::int64_t{2}}}},
      {published,
       {{"k", std::int64_t{5}},
        {"weights", "uniform"},
        {"weights", "inverse"},
        {"damping", 0.3},
        {"tolerance", 1e-1},
        {"max_iterations", std::int64_t{7}}}}};
  for (const auto& [from, of_method] : changes) {
    const Positions sphere = surfaceOf(points, quick(from)).sphere;
    for (const auto& [name, value] : of_method) {
      const Options options = given(quick(from), name.c_str(), value);
      EXPECT_TRUE(surfaceOf(points, options).sphere != sphere) << name;
    }
  }
  EXPECT_EQ(surfaceOf(points).embedding.stop_reason, StopReason::Unfinished);
  const Options endless = given(published, "max_iterations", 2000, "tolerance", 0.0);
  EXPECT_EQ(mesh(ellipsoid(100), endless).embedding.iterations, 2000);
  const Positions rough = noisySphere(300, 0.5);
  EXPECT_TRUE(surfaceOf(rough, quick()).triangles != surfaceOf(rough).triangles);
  const Positions few = randomSphere(12, 1);
  expectGuarantees(few, mesh(few, given(paper(), "k", 1000)));  // all others
}

TEST(Reconstruct, ATimeLimitIsReportedAndTheMeshIsAsPromised) {
  const Positions points = noisySphere(1500, 0.5);
  for (const int smoothing : {0, 5}) {
    const Options options = given("smoothing", smoothing, "consolidation", "none");
    const Surface result = surfaceOf(points, quick(options));
    EXPECT_TRUE(isSphereOverAll(result.triangles, 1500));
    EXPECT_TRUE(result.is_out_of_time);
    EXPECT_TRUE(isFound(result, "time limit"));
    const Surface unhurried = surfaceOf(points, given(options, "time_limit", 1e9));
    EXPECT_FALSE(unhurried.is_out_of_time);
    EXPECT_EQ(unhurried.triangles, surfaceOf(points, options).triangles);
  }
  const Positions more = withNoise(ellipsoid(6000), 0.002, 5);
  for (const double limit : {0.0, 1e-6, 0.01, 0.05}) {
    const Surface result = surfaceOf(more, given(sphere(), "time_limit", limit));
    EXPECT_TRUE(isSphereOverAll(result.triangles, 6000)) << limit;
  }
}

TEST(Reconstruct, TheJoinedMeshHasAllSurfacesAsTheyAre) {
  const Positions band = pointsWhere(
      spiralSphere(900), [](const Eigen::Vector3d& p) { return std::abs(p.z()) < 0.8; });
  const Positions points = horizontally(spiralSphere(400), movedTo(4.0, band));
  const Result result =
      reconstruct(points, given("surface", "closed", "parts", "each", "fill", "smooth"));
  ASSERT_EQ(result.surfaces.size(), 2U);
  const JoinedMesh mesh = joined(result);
  EXPECT_EQ(mesh.sphere.cols(), 0);  // added vertices have no place there
  Index vertex = 0;
  Eigen::Index triangle = 0;
  for (const Surface& surface : result.surfaces) {
    const auto given = static_cast<Index>(surface.vertexCount() - surface.added_vertices);
    for (Index v = 0; v < surface.points.cols(); ++v, ++vertex) {
      const auto at = static_cast<std::size_t>(vertex);
      EXPECT_EQ(mesh.points.col(vertex), surface.points.col(v));
      EXPECT_EQ(mesh.is_added.at(at), v < given ? 0 : 1);
      EXPECT_TRUE(v >= given || mesh.points.col(vertex) == points.col(mesh.input_of_vertex.at(at)));
    }
    for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t, ++triangle)
      EXPECT_EQ(mesh.points(Eigen::all, mesh.triangles.col(triangle)),
                surface.points(Eigen::all, surface.triangles.col(t)));
  }
  EXPECT_EQ(mesh.points.cols(), vertex);
  EXPECT_EQ(mesh.triangles.cols(), triangle);
  EXPECT_TRUE(std::count(mesh.is_added.begin(), mesh.is_added.end(), 1) > 0);
  Options embedded = given("parts", "each", "surface", "closed");
  embedded.details = true;
  EXPECT_EQ(joined(reconstruct(points, embedded)).sphere.cols(), points.cols());
  EXPECT_EQ(joined({}).points.cols(), 0);
}

}  // namespace
}  // namespace spherical_param::test
