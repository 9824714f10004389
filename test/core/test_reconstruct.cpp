#include "spherical_param/reconstruct.h"

#include "helpers.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>
#include <map>

namespace spherical_param {
namespace {

using test::bruteForceNeighbors;
using test::horizontally;
using test::isSphereOverAll;
using test::randomSphere;
using test::spiralSphere;

constexpr EdgeWeights kAllWeights[] = {EdgeWeights::Uniform, EdgeWeights::InverseLength,
                                       EdgeWeights::Adaptive};

Result mesh(const Positions& points, Options options = {}) {
  return reconstruct(points, bruteForceNeighbors(points, options.k), options);
}

/// Everything that is guaranteed, recomputed from the output.
void expectGuarantees(const Positions& points, const Result& result) {
  const auto v = static_cast<Index>(result.vertexCount());
  EXPECT_TRUE(isSphereOverAll(result.triangles, v));
  EXPECT_TRUE(result.topology.isSphere());
  EXPECT_EQ(result.sphere.cols(), v);
  ASSERT_EQ(result.vertex_of_input.size(), static_cast<std::size_t>(points.cols()));
  for (Index i = 0; i < points.cols(); ++i) {
    const Index vertex = result.vertex_of_input[static_cast<std::size_t>(i)];
    ASSERT_TRUE(vertex >= 0 && vertex < v);
    EXPECT_EQ(points.col(i), points.col(result.input_of_vertex[static_cast<std::size_t>(vertex)]));
  }
  EXPECT_EQ(result.duplicates, static_cast<std::size_t>(points.cols() - v));
  Positions vertices(3, v);
  for (Index i = 0; i < v; ++i)
    vertices.col(i) = points.col(result.input_of_vertex[static_cast<std::size_t>(i)]);
  EXPECT_GE(result.volume, 0.0);
  vertices.colwise() -= Eigen::Vector3d(vertices.col(0));
  const double volume = test::volumeOf(vertices, result.triangles);
  EXPECT_NEAR(result.volume, volume, 1e-9 * std::pow(vertices.colwise().norm().maxCoeff(), 3.0));
  EXPECT_LT((result.sphere.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
}

Positions ellipsoid(Index n, double a, double b, double c) {
  return Eigen::Vector3d(a, b, c).asDiagonal() * spiralSphere(n);
}

TEST(Reconstruct, EllipsoidIsMeshedTruly) {
  const Positions points = ellipsoid(800, 1.0, 0.7, 0.5);
  for (const EdgeWeights weights : kAllWeights) {
    Options options;
    options.weights = weights;
    const Result result = mesh(points, options);
    expectGuarantees(points, result);
    // An inscribed polyhedron of 800 points: volume and area of the ellipsoid less about 1 %.
    EXPECT_NEAR(result.volume, 4.0 / 3.0 * test::kPi * 0.35, 0.03);
    EXPECT_LT(result.edges_outside_graph, 1e-9);
    EXPECT_EQ(result.triangulation.hull_vertices, 800);
  }
}

TEST(Reconstruct, SphereIsItsOwnConvexHull) {
  const Positions points = spiralSphere(500);
  Options options;
  options.max_iterations = 0;
  const Result result = mesh(points, options);
  expectGuarantees(points, result);
  EXPECT_EQ(test::canonical(result.triangles),
            test::canonical(triangulateSphere(projectFromCentroid(points)).triangles));
  EXPECT_EQ(result.embedding.residuals.size(), 1U);
}

TEST(Reconstruct, FourToTenPointsAreMeshed) {
  for (Index n = 4; n <= 10; ++n)
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      std::mt19937_64 random(seed);
      std::uniform_real_distribution<double> uniform(-1.0, 1.0);
      Positions points(3, n);
      for (Index i = 0; i < n; ++i)
        points.col(i) << uniform(random), uniform(random), uniform(random);
      expectGuarantees(points, mesh(points));
    }
}

TEST(Reconstruct, NastySetsAreMeshed) {
  std::vector<Positions> sets;
  sets.push_back(test::cubeGrid(6));
  Positions circle = spiralSphere(200);
  circle.row(2).setZero();
  circle.colwise().normalize();
  sets.push_back(horizontally(circle, Eigen::Vector3d(0.0, 0.0, 0.5)));  // coplanar but one
  Positions line(3, 100);
  for (Index i = 0; i < 100; ++i)
    line.col(i) << i, 0.0, 0.0;
  sets.push_back(horizontally(line, Eigen::Matrix<double, 3, 2>{{5, 7}, {1, 0}, {0, 1}}));
  sets.push_back(horizontally(spiralSphere(300), Eigen::Vector3d(1e9, 0.0, 0.0)));
  Positions far = spiralSphere(200);
  far.colwise() += Eigen::Vector3d(1e6, 0.0, 0.0);
  sets.push_back(horizontally(spiralSphere(200), far));
  sets.push_back(spiralSphere(200) * 1e-300);
  sets.push_back(spiralSphere(200) * 1e100);
  sets.push_back(horizontally(spiralSphere(200), randomSphere(200, 1) * 1e-12));
  Positions utm = spiralSphere(200);
  utm.colwise() += Eigen::Vector3d(5e7, -3e7, 1e7);
  sets.push_back(utm);
  Positions flat = randomSphere(300, 2);
  flat.row(2) *= 1e-14;
  sets.push_back(flat);
  for (std::size_t s = 0; s < sets.size(); ++s)
    for (const EdgeWeights weights : kAllWeights) {
      SCOPED_TRACE("set " + std::to_string(s));
      Options options;
      options.weights = weights;
      options.max_iterations = 200;
      const Result result = mesh(sets[s], options);
      EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(result.vertexCount())));
      EXPECT_TRUE(std::isfinite(result.embedding.residual));
      EXPECT_TRUE(std::isfinite(result.volume) && std::isfinite(result.area));
    }
}

TEST(Reconstruct, DuplicatesBecomeOneVertexAndAreReported) {
  const Positions base = ellipsoid(300, 1.0, 0.8, 0.6);
  const Positions points = horizontally(base, base.leftCols(120));
  const Result result = mesh(points);
  expectGuarantees(points, result);
  EXPECT_EQ(result.duplicates, 120U);
  for (Index i = 0; i < 120; ++i)
    EXPECT_EQ(result.vertex_of_input[static_cast<std::size_t>(300 + i)], i);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings.front().find("120 points"), std::string::npos);
}

TEST(Reconstruct, ListsOfRepeatedPointsMayBeEmpty) {
  const Positions base = ellipsoid(300, 1.0, 0.8, 0.6);
  const Positions points = horizontally(base, base.leftCols(50));
  NeighborLists lists = bruteForceNeighbors(base, 25);
  lists.offsets.insert(lists.offsets.end(), 50, lists.offsets.back());
  const Result result = reconstruct(points, lists);
  EXPECT_EQ(result.triangles, mesh(base).triangles);
}

TEST(Reconstruct, ThousandCopiesOfFourPointsAreATetrahedron) {
  const Positions points = randomSphere(4, 1).replicate(1, 1000);
  const Result result = reconstruct(points, bruteForceNeighbors(points, 5));
  EXPECT_EQ(result.vertexCount(), 4U);
  EXPECT_TRUE(isSphereOverAll(result.triangles, 4));
}

TEST(Reconstruct, CollapseIsReportedAndItsSphereIsNotTheMesh) {
  const Positions points = horizontally(spiralSphere(400), Eigen::Vector3d(1e6, 0.0, 0.0));
  Options options;
  options.max_iterations = 0;
  const Result result = mesh(points, options);
  expectGuarantees(points, result);
  EXPECT_EQ(result.embedding.stop_reason, StopReason::Collapsed);
  EXPECT_TRUE(result.embedding.fallback_start);
  // The sphere of the result is not the collapsed one, and the figures are those of the former.
  const Graph graph = buildNeighborGraph(points, bruteForceNeighbors(points, options.k)).graph;
  EXPECT_NEAR(result.embedding.residual,
              meanTangentialLaplacian(graph, result.sphere, options.weights), 1e-12);
  EXPECT_NEAR(result.embedding.centroid_norm, result.sphere.rowwise().mean().norm(), 1e-12);
  EXPECT_LT(result.sphere.rowwise().mean().norm(), 0.8);
  bool told = false;
  for (const std::string& warning : result.warnings)
    told = told || warning.find("collapsed") != std::string::npos;
  EXPECT_TRUE(told);
}

TEST(Reconstruct, SeveralPartsAreJoinedAndReported) {
  Positions second = spiralSphere(200);
  second.colwise() += Eigen::Vector3d(3.0, 0.0, 0.0);
  const Positions points = horizontally(spiralSphere(200), second);
  Options options;
  options.k = 10;
  const Result result = mesh(points, options);
  expectGuarantees(points, result);
  EXPECT_EQ(result.graph.components, 2);
  ASSERT_EQ(result.graph.bridges.size(), 1U);
  const Bridge& bridge = result.graph.bridges.front();
  EXPECT_DOUBLE_EQ(bridge.length, (points.col(bridge.from) - points.col(bridge.to)).norm());
  EXPECT_NE(bridge.from < 200, bridge.to < 200);
  bool told = false;
  for (const std::string& warning : result.warnings)
    told = told || warning.find("2 pieces") != std::string::npos;
  EXPECT_TRUE(told);
}

TEST(Reconstruct, TorusIsMeshedAsASphereAndReported) {
  Positions points(3, 40 * 20);
  for (Index i = 0; i < 40; ++i)
    for (Index j = 0; j < 20; ++j) {
      const double a = 2.0 * test::kPi * (i + 0.5 * (j % 2)) / 40.0;
      const double b = 2.0 * test::kPi * j / 20.0;
      points.col(20 * i + j) << (1.0 + 0.5 * std::cos(b)) * std::cos(a),
          (1.0 + 0.5 * std::cos(b)) * std::sin(a), 0.5 * std::sin(b);
    }
  Options options;
  options.k = 10;
  const Result result = mesh(points, options);
  expectGuarantees(points, result);
  EXPECT_GT(result.edges_outside_graph, 0.01);
  EXPECT_FALSE(result.warnings.empty());
}

TEST(Reconstruct, OpenBowlIsLiddedAndReported) {
  const Positions sphere = spiralSphere(1500);  // from top to bottom
  const Positions points = sphere.rightCols(1100);
  const Result result = mesh(points);
  expectGuarantees(points, result);
  EXPECT_GT(result.edges_outside_graph, 0.001);
  EXPECT_LT(mesh(sphere).edges_outside_graph, 1e-9);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings.back().find("not a closed surface"), std::string::npos);
}

TEST(Reconstruct, ScaleByAPowerOfTwoAndShiftOfIndicesChangeNothing) {
  const Positions points = ellipsoid(300, 1.0, 0.7, 0.5);
  const Result result = mesh(points);
  for (const double scale : {std::ldexp(1.0, 60), std::ldexp(1.0, -70)}) {
    const Result scaled = mesh(points * scale);
    EXPECT_EQ(result.triangles, scaled.triangles);
    EXPECT_EQ(result.sphere, scaled.sphere);
    EXPECT_DOUBLE_EQ(scaled.volume, result.volume * scale * scale * scale);
    EXPECT_DOUBLE_EQ(scaled.area, result.area * scale * scale);
  }
}

TEST(Reconstruct, PermutedCloudGivesTheSameMesh) {
  const Positions points = ellipsoid(400, 1.0, 0.7, 0.5);
  std::vector<Index> order(400);
  std::iota(order.begin(), order.end(), Index{0});
  std::mt19937_64 random(3);
  std::shuffle(order.begin(), order.end(), random);
  Positions permuted(3, 400);
  for (Index i = 0; i < 400; ++i)
    permuted.col(i) = points.col(order[static_cast<std::size_t>(i)]);
  Triangles renamed = mesh(permuted).triangles;
  renamed = renamed.unaryExpr([&](Index i) { return order[static_cast<std::size_t>(i)]; }).eval();
  EXPECT_EQ(test::canonical(renamed), test::canonical(mesh(points).triangles));
}

TEST(Reconstruct, MirroredCloudIsOrientedOutward) {
  Positions points = ellipsoid(300, 1.0, 0.7, 0.5);
  points.row(0) *= -1.0;
  const Result result = mesh(points);
  expectGuarantees(points, result);
  EXPECT_GT(result.volume, 1.0);
  EXPECT_GT(test::volumeOf(result.sphere, result.triangles), 3.5);
}

TEST(Reconstruct, KLargerThanTheCloudUsesAllOthers) {
  const Positions points = randomSphere(12, 1);
  Options options;
  options.k = 1000;
  const Result result = mesh(points, options);
  EXPECT_EQ(result.graph.edges, 12U * 11U / 2U);
  expectGuarantees(points, result);
}

TEST(Reconstruct, StagesAreTimedAndTold) {
  const Positions points = ellipsoid(300, 1.0, 0.7, 0.5);
  std::map<std::string, int> ends;
  Options options;
  options.progress = [&](const Progress& progress) {
    EXPECT_GE(progress.fraction, 0.0);
    EXPECT_LE(progress.fraction, 1.0);
    ends[progress.stage] += progress.fraction == 1.0 ? 1 : 0;
    return true;
  };
  const Result result = mesh(points, options);
  ASSERT_EQ(result.stages.size(), 4U);
  for (const StageTime& stage : result.stages) {
    EXPECT_GE(stage.seconds, 0.0);
    EXPECT_EQ(ends[stage.name], 1) << stage.name;
  }
  for (const char* stage : {"graph", "embedding", "triangulation", "check"}) {
    options.progress = [&](const Progress& progress) {
      return std::string(progress.stage) != stage;
    };
    EXPECT_THROW(mesh(points, options), Cancelled) << stage;
  }
}

TEST(Reconstruct, EveryOptionReachesItsStage) {
  const Positions points = ellipsoid(200, 1.0, 0.7, 0.5);
  Options options;
  options.max_iterations = 7;
  EXPECT_EQ(mesh(points, options).embedding.residuals.size(), 8U);
  options.tolerance = 1.0;
  EXPECT_EQ(mesh(points, options).embedding.stop_reason, StopReason::Converged);
  options = Options();
  const Result by_default = mesh(points);
  options.lambda = 0.3;
  EXPECT_NE(mesh(points, options).embedding.residuals[1], by_default.embedding.residuals[1]);
  options = Options();
  options.k = 5;
  EXPECT_LT(mesh(points, options).graph.edges, by_default.graph.edges);
  options = Options();
  options.stagnation_window = 0;
  options.max_iterations = 3000;
  options.tolerance = 0.0;
  EXPECT_EQ(mesh(points, options).embedding.iterations, 3000);
}

TEST(Reconstruct, BadInputIsInvalidInputWithItsReason) {
  const auto expect_reason = [](const Positions& points, const NeighborLists& lists,
                                const Options& options, const std::string& reason) {
    try {
      reconstruct(points, lists, options);
      ADD_FAILURE() << "no exception for: " << reason;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  };
  const Positions good = randomSphere(20, 1);
  const NeighborLists lists = bruteForceNeighbors(good, 5);
  for (Index n = 0; n < 4; ++n)
    expect_reason(good.leftCols(n), bruteForceNeighbors(good.leftCols(n), 5), {}, "at least 4");
  const Positions three = randomSphere(3, 1).replicate(1, 5);
  expect_reason(three, bruteForceNeighbors(three, 5), {}, "3 distinct points");
  Positions plane = good;
  plane.row(1).setConstant(3.0);
  expect_reason(plane, bruteForceNeighbors(plane, 5), {}, "one plane");
  Positions bad = good;
  bad(2, 11) = std::numeric_limits<double>::quiet_NaN();
  expect_reason(bad, lists, {}, "point 11 is not finite");
  expect_reason(good * 1e101, lists, {}, "beyond 1e100");
  NeighborLists wrong = lists;
  wrong.indices[0] = 20;
  expect_reason(good, wrong, {}, "neighbour 20 of 20");
  wrong = lists;
  wrong.offsets.pop_back();
  expect_reason(good, wrong, {}, "n + 1 offsets");
  Options options;
  options.k = 2;
  expect_reason(good, lists, options, "k = 2");
  options = Options();
  options.lambda = 1.5;
  expect_reason(good, lists, options, "lambda");
  options = Options();
  options.max_iterations = -1;
  expect_reason(good, lists, options, "max_iterations");
}

TEST(Reconstruct, OptionsCanBeCheckedBeforehand) {
  EXPECT_NO_THROW(checkOptions({}));
  const auto bad = [](auto change) {
    Options options;
    change(options);
    EXPECT_THROW(checkOptions(options), InvalidInput);
  };
  bad([](Options& options) { options.k = 2; });
  bad([](Options& options) { options.lambda = 0.0; });
  bad([](Options& options) { options.max_iterations = -1; });
  bad([](Options& options) { options.tolerance = -1.0; });
  bad([](Options& options) { options.stagnation_window = 1; });
  bad([](Options& options) { options.threads = 2000; });
}

TEST(Reconstruct, ConcurrentCallsAgreeWithSingleOnes) {
  constexpr std::size_t count = 4;
  Options options;
  options.threads = 1;
  options.max_iterations = 50;
  options.k = 8;
  const auto run = [&](std::size_t i) {
    return mesh(ellipsoid(300 + 50 * static_cast<Index>(i), 1.0, 0.8, 0.5), options);
  };
  std::vector<Result> alone(count);
  for (std::size_t i = 0; i < count; ++i)
    alone[i] = run(i);
  const std::vector<Result> together = test::runTogether(count, run);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(alone[i].triangles, together[i].triangles);
    EXPECT_EQ(alone[i].sphere, together[i].sphere);
    EXPECT_EQ(alone[i].embedding.residuals, together[i].embedding.residuals);
  }
}

}  // namespace
}  // namespace spherical_param
