#include "spherical_param/reconstruct.h"

#include "embedding_starts.h"
#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/self_intersection.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using test::bruteForceNeighbors;
using test::bruteForceSearch;
using test::horizontally;
using test::isSphereOverAll;
using test::randomSphere;
using test::spiralSphere;

constexpr EdgeWeights kAllWeights[] = {EdgeWeights::Uniform, EdgeWeights::InverseLength,
                                       EdgeWeights::Adaptive};

/// The method as it was published.
Options paper() {
  Options options;
  options.graph.method = GraphMethod::NearestNeighbors;
  options.embedding.method = EmbeddingMethod::Iterative;
  options.triangulation.method = TriangulationMethod::Qhull;
  return options;
}

/// Both methods, whole.
const std::vector<Options>& bothMethods() {
  static const std::vector<Options> methods = {Options(), paper()};
  return methods;
}

Result mesh(const Positions& points, const Options& options = {}) {
  return reconstruct(points, bruteForceNeighbors(points, neighborsToSearch(options.graph)), options,
                     bruteForceSearch(points));
}

/// For clouds that no run meshes well: a single one, without the search for a better mesh.
Options quick(Options options = {}) {
  options.retries = 0;
  options.optimization.method = OptimizationMethod::Flips;
  return options;
}

Positions verticesOf(const Positions& points, const Result& result) {
  Positions vertices(3, static_cast<Eigen::Index>(result.vertexCount()));
  for (Eigen::Index v = 0; v < vertices.cols(); ++v)
    vertices.col(v) = points.col(result.input_of_vertex[static_cast<std::size_t>(v)]);
  return vertices;
}

bool isWarnedOf(const Result& result, const std::string& text) {
  return std::any_of(
      result.warnings.begin(), result.warnings.end(),
      [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
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
  EXPECT_EQ(result.duplicates(), static_cast<std::size_t>(points.cols() - v));
  Positions vertices = verticesOf(points, result);
  EXPECT_EQ(result.self_intersections, findSelfIntersections(vertices, result.triangles));
  EXPECT_EQ(std::count_if(result.runs.begin(), result.runs.end(),
                          [](const RunReport& run) { return run.chosen; }),
            1);
  const auto are_vertices = [&](const std::vector<Index>& indices) {
    return std::is_sorted(indices.begin(), indices.end()) &&
           (indices.empty() || (indices.front() >= 0 && indices.back() < v));
  };
  for (const FilledHole& hole : result.diagnosis.filled_holes)
    EXPECT_TRUE(are_vertices(hole.vertices));
  for (const CollapsedHandle& handle : result.diagnosis.handles)
    EXPECT_TRUE(are_vertices(handle.vertices));
  for (const PartBridge& bridge : result.diagnosis.bridges)
    EXPECT_TRUE(are_vertices(bridge.vertices));
  EXPECT_FALSE(result.diagnosis.summary.empty());
  EXPECT_GE(result.measures.volume, 0.0);
  vertices.colwise() -= Eigen::Vector3d(vertices.col(0));
  const double volume = test::volumeOf(vertices, result.triangles);
  EXPECT_NEAR(result.measures.volume, volume,
              1e-9 * std::pow(vertices.colwise().norm().maxCoeff(), 3.0));
  EXPECT_LT((result.sphere.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
}

Positions ellipsoid(Index n, double a, double b, double c) {
  return Eigen::Vector3d(a, b, c).asDiagonal() * spiralSphere(n);
}

TEST(Reconstruct, EllipsoidIsMeshedTruly) {
  const Positions points = ellipsoid(800, 1.0, 0.7, 0.5);
  for (Options options : bothMethods())
    for (const EdgeWeights weights : kAllWeights) {
      options.embedding.weights = weights;
      const Result result = mesh(points, options);
      expectGuarantees(points, result);
      // An inscribed polyhedron of 800 points: volume and area of the ellipsoid less about 1 %.
      EXPECT_NEAR(result.measures.volume, 4.0 / 3.0 * test::kPi * 0.35, 0.03);
      EXPECT_LT(result.diagnosis.edges_outside_graph, 1e-9);
      EXPECT_EQ(result.triangulation.hull_vertices, 800);
    }
}

TEST(Reconstruct, SphereIsItsOwnConvexHull) {
  const Positions points = spiralSphere(500);
  Options options = paper();
  options.embedding.max_iterations = 0;
  const Result result = mesh(points, options);
  expectGuarantees(points, result);
  EXPECT_EQ(test::canonical(result.triangles),
            test::canonical(triangulateSphere(internal::projectFromCentroid(points)).triangles));
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
      for (const Options& options : bothMethods())
        expectGuarantees(points, mesh(points, seed < 3 ? options : quick(options)));
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
    for (Options options : bothMethods())
      for (const EdgeWeights weights : kAllWeights) {
        SCOPED_TRACE("set " + std::to_string(s));
        options.embedding.weights = weights;
        options.embedding.max_iterations = 200;
        const Result result = mesh(sets[s], quick(options));
        EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(result.vertexCount())));
        EXPECT_TRUE(std::isfinite(result.embedding.residual));
        EXPECT_TRUE(std::isfinite(result.measures.volume) && std::isfinite(result.measures.area));
      }
}

TEST(Reconstruct, DuplicatesBecomeOneVertexAndAreReported) {
  const Positions base = ellipsoid(300, 1.0, 0.8, 0.6);
  const Positions points = horizontally(base, base.leftCols(120));
  const Result result = mesh(points);
  expectGuarantees(points, result);
  EXPECT_EQ(result.duplicates(), 120U);
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
  const Result result = reconstruct(points, lists, paper());
  EXPECT_EQ(result.triangles, mesh(base, paper()).triangles);
  // The search is asked in terms of input points, and never of a repetition.
  const NeighborSearch search = bruteForceSearch(points);
  lists = bruteForceNeighbors(base, 5);
  lists.offsets.insert(lists.offsets.end(), 50, lists.offsets.back());
  bool asked = false;
  const Result again =
      reconstruct(points, lists, {}, [&](const std::vector<Index>& queries, int count) {
        asked = true;
        EXPECT_LT(*std::max_element(queries.begin(), queries.end()), 300);
        return search(queries, count);
      });
  EXPECT_TRUE(asked);
  expectGuarantees(points, again);
}

TEST(Reconstruct, FindsTheNeighboursThatTheCallerWouldFind) {
  const Positions base = 5.0 * ellipsoid(400, 1.0, 0.7, 0.5);
  for (Options options : bothMethods()) {
    options.threads = 1;
    const NeighborLists lists = findNearestNeighbors(base, neighborsToSearch(options.graph));
    const Result expected = reconstruct(base, lists, options, makeNeighborSearch(base));
    const Result result = reconstruct(base, options);
    expectGuarantees(base, result);
    EXPECT_EQ(result.triangles, expected.triangles);
    EXPECT_EQ(result.sphere, expected.sphere);
    // Repeated points are merged before neighbours are sought.
    const Result repeated = reconstruct(horizontally(base, base.leftCols(50)), options);
    EXPECT_EQ(repeated.duplicates(), 50U);
    EXPECT_EQ(repeated.triangles, expected.triangles);
  }
}

TEST(Reconstruct, ExceptionsOfTheSearchArePassedOn) {
  const Positions points = ellipsoid(100, 1.0, 0.7, 0.5);
  const auto failing = [](const std::vector<Index>&, int) -> NeighborLists {
    throw std::runtime_error("no search today");
  };
  EXPECT_THROW(reconstruct(points, bruteForceNeighbors(points, 4), {}, failing),
               std::runtime_error);
}

TEST(Reconstruct, ThousandCopiesOfFourPointsAreATetrahedron) {
  const Positions points = randomSphere(4, 1).replicate(1, 1000);
  const Result result = reconstruct(points, bruteForceNeighbors(points, 5));
  EXPECT_EQ(result.vertexCount(), 4U);
  EXPECT_TRUE(isSphereOverAll(result.triangles, 4));
}

TEST(Reconstruct, CollapseIsReportedAndItsSphereIsNotTheMesh) {
  const Positions points = horizontally(spiralSphere(400), Eigen::Vector3d(1e6, 0.0, 0.0));
  Options options = quick(paper());
  options.embedding.max_iterations = 0;
  const Result result = mesh(points, options);
  expectGuarantees(points, result);
  EXPECT_EQ(result.embedding.stop_reason, StopReason::Collapsed);
  EXPECT_TRUE(result.embedding.fallback_start);
  // The sphere of the result is not the collapsed one, and the figures are those of the former.
  const Graph graph =
      buildNeighborGraph(points, bruteForceNeighbors(points, 25), test::nearest()).graph;
  EXPECT_NEAR(result.embedding.residual,
              meanTangentialLaplacian(graph, result.sphere, options.embedding.weights), 1e-12);
  EXPECT_NEAR(result.embedding.centroid_norm, result.sphere.rowwise().mean().norm(), 1e-12);
  EXPECT_LT(result.sphere.rowwise().mean().norm(), 0.8);
  bool is_warned = false;
  for (const std::string& warning : result.warnings)
    is_warned = is_warned || warning.find("collapsed") != std::string::npos;
  EXPECT_TRUE(is_warned);
}

TEST(Reconstruct, SeveralPartsAreJoinedAndReported) {
  Positions second = spiralSphere(200);
  second.colwise() += Eigen::Vector3d(3.0, 0.0, 0.0);
  const Positions points = horizontally(spiralSphere(200), second);
  for (Options options : bothMethods()) {
    options.graph.k = 10;
    const Result result = mesh(points, quick(options));
    expectGuarantees(points, result);
    EXPECT_EQ(result.graph.components, 2);
    ASSERT_FALSE(result.graph.bridges.empty());
    for (const Bridge& bridge : result.graph.bridges) {
      EXPECT_DOUBLE_EQ(bridge.length, (points.col(bridge.from) - points.col(bridge.to)).norm());
      EXPECT_NE(bridge.from < 200, bridge.to < 200);
    }
    bool is_warned = false;
    for (const std::string& warning : result.warnings)
      is_warned = is_warned || warning.find("2 pieces") != std::string::npos;
    EXPECT_TRUE(is_warned);
  }
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
  for (Options options : bothMethods()) {
    options.graph.k = 10;
    const Result result = mesh(points, quick(options));
    expectGuarantees(points, result);
    EXPECT_GT(result.diagnosis.edges_outside_graph, 0.01);
    EXPECT_FALSE(result.warnings.empty());
    EXPECT_FALSE(result.diagnosis.looksClosedGenus0());
  }
}

TEST(Reconstruct, OpenBowlIsClosedAndReported) {
  const Positions sphere = spiralSphere(1500);  // from top to bottom
  const Positions points = sphere.rightCols(1100);
  for (const Options& options : bothMethods()) {
    const Result result = mesh(points, options);
    expectGuarantees(points, result);
    EXPECT_GT(result.diagnosis.edges_outside_graph, 0.001);
    EXPECT_LT(mesh(sphere, options).diagnosis.edges_outside_graph, 1e-9);
    EXPECT_EQ(result.diagnosis.kind, SurfaceKind::Open);
    EXPECT_EQ(result.diagnosis.openings(), 1U);
    EXPECT_TRUE(isWarnedOf(result, result.diagnosis.summary));
  }
}

TEST(Reconstruct, ScaleByAPowerOfTwoAndShiftOfIndicesChangeNothing) {
  const Positions points = ellipsoid(300, 1.0, 0.7, 0.5);
  for (const Options& options : bothMethods()) {
    const Result result = mesh(points, options);
    for (const double scale : {std::ldexp(1.0, 60), std::ldexp(1.0, -70)}) {
      const Result scaled = mesh(points * scale, options);
      EXPECT_EQ(result.triangles, scaled.triangles);
      EXPECT_EQ(result.sphere, scaled.sphere);
      EXPECT_DOUBLE_EQ(scaled.measures.volume, result.measures.volume * scale * scale * scale);
      EXPECT_DOUBLE_EQ(scaled.measures.area, result.measures.area * scale * scale);
    }
  }
}

/// Fraction of the triangles of one mesh that the other has as well, vertices renamed.
double commonTriangles(const Result& result, const Result& moved, const std::vector<Index>& order) {
  Triangles renamed =
      moved.triangles.unaryExpr([&](Index i) { return order[static_cast<std::size_t>(i)]; });
  const auto one = test::canonical(result.triangles);
  const auto other = test::canonical(renamed);
  std::vector<std::array<Index, 3>> common;
  std::set_intersection(one.begin(), one.end(), other.begin(), other.end(),
                        std::back_inserter(common));
  return static_cast<double>(common.size()) / static_cast<double>(one.size());
}

TEST(Reconstruct, MovedAndPermutedCloudGivesTheSameMesh) {
  const Index n = 3000;
  const test::Tube tube = test::bentTube(20.0, 3.0, 14);
  // No ties: points of a regular tube would be on common circles.
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> jitter(-0.1, 0.1);
  for (Positions points : {ellipsoid(n, 1.0, 0.7, 0.5), tube.points}) {
    points = points.unaryExpr([&](double x) { return x + 0.2 * jitter(random) * 0.45; });
    std::vector<Index> order(static_cast<std::size_t>(points.cols()));
    std::iota(order.begin(), order.end(), Index{0});
    std::shuffle(order.begin(), order.end(), random);
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
    Positions moved(3, points.cols());
    for (Index i = 0; i < points.cols(); ++i)
      moved.col(i) = 7.0 * (rotation * points.col(order[static_cast<std::size_t>(i)])) +
                     Eigen::Vector3d(3.0, -2.0, 5.0);
    for (const bool converge : {false, true}) {
      Options options;
      if (converge)
        options.embedding.tolerance = 1e-9;
      const Result result = mesh(points, options);
      expectGuarantees(points, result);
      EXPECT_GE(commonTriangles(result, mesh(moved, options), order), 0.995);
    }
  }
}

TEST(Reconstruct, ConvergedLaplacianVanishesOnTheOutput) {
  const Positions points = ellipsoid(2000, 1.0, 0.7, 0.5);
  for (const GraphMethod method : {GraphMethod::LocalDelaunay, GraphMethod::NearestNeighbors}) {
    Options options;
    options.graph.method = method;
    options.embedding.tolerance = 1e-10;
    const Result result = mesh(points, options);
    EXPECT_EQ(result.embedding.stop_reason, StopReason::Converged);
    const NeighborLists lists = bruteForceNeighbors(points, neighborsToSearch(options.graph));
    const Graph graph =
        buildNeighborGraph(points, lists, options.graph, bruteForceSearch(points)).graph;
    EXPECT_LT(meanTangentialLaplacian(graph, result.sphere, EdgeWeights::Adaptive), 1e-10);
    EXPECT_EQ(result.embedding.residuals.back(), result.embedding.residual);
  }
}

TEST(Reconstruct, MethodsCanBeMixed) {
  const Positions points = ellipsoid(600, 1.0, 0.7, 0.5);
  for (const GraphMethod graph : {GraphMethod::NearestNeighbors, GraphMethod::LocalDelaunay})
    for (const EmbeddingMethod solver : {EmbeddingMethod::Iterative, EmbeddingMethod::Multilevel})
      for (const TriangulationMethod hull :
           {TriangulationMethod::Qhull, TriangulationMethod::Incremental}) {
        Options options;
        options.graph.method = graph;
        options.embedding.method = solver;
        options.triangulation.method = hull;
        const Result result = mesh(points, options);
        expectGuarantees(points, result);
        EXPECT_LT(result.diagnosis.edges_outside_graph, 1e-9);
        // A planar graph has three edges a node, that of 25 neighbours far more.
        EXPECT_EQ(result.graph.edges < 1900, graph == GraphMethod::LocalDelaunay);
        EXPECT_EQ(result.embedding.levels.empty(), solver == EmbeddingMethod::Iterative);
      }
}

TEST(Reconstruct, AWrongAnswerOfTheSearchIsInvalidInput) {
  const Positions points = randomSphere(60, 1);
  const NeighborLists few = bruteForceNeighbors(points, 4);
  const auto answers = [&](const NeighborLists& answer) {
    return [answer](const std::vector<Index>&, int) { return answer; };
  };
  NeighborLists wrong;
  EXPECT_THROW(reconstruct(points, few, {}, answers(wrong)), InvalidInput);
  wrong = few;
  wrong.indices[7] = 60;
  EXPECT_THROW(reconstruct(points, few, {}, answers(wrong)), InvalidInput);
}

TEST(Reconstruct, MirroredCloudIsOrientedOutward) {
  Positions points = ellipsoid(300, 1.0, 0.7, 0.5);
  points.row(0) *= -1.0;
  const Result result = mesh(points);
  expectGuarantees(points, result);
  EXPECT_GT(result.measures.volume, 1.0);
  EXPECT_GT(test::volumeOf(result.sphere, result.triangles), 3.5);
}

TEST(Reconstruct, KLargerThanTheCloudUsesAllOthers) {
  const Positions points = randomSphere(12, 1);
  Options options = paper();
  options.graph.k = 1000;
  const Result result = mesh(points, options);
  EXPECT_EQ(result.graph.edges, 12U * 11U / 2U);
  expectGuarantees(points, result);
}

TEST(Reconstruct, StagesComeInOrderAndEachCanBeCancelled) {
  const Positions points = ellipsoid(300, 1.0, 0.7, 0.5);
  std::vector<std::string> names;
  Options options;
  options.smoothing.steps = 1;
  options.progress = [&](const Progress& progress) {
    EXPECT_GE(progress.fraction, 0.0);
    EXPECT_LE(progress.fraction, 1.0);
    if (names.empty() || names.back() != progress.stage)
      names.emplace_back(progress.stage);
    return true;
  };
  const Result result = reconstruct(points, options);
  ASSERT_EQ(result.runs.size(), 1U);
  EXPECT_EQ(names, (std::vector<std::string>{"neighbors", "graph", "embedding", "triangulation",
                                             "optimization", "smoothing", "quality"}));
  ASSERT_EQ(result.stages.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_GE(result.stages[i].seconds, 0.0);
    EXPECT_EQ(result.stages[i].name, names[i]);
  }
  for (const std::string& stage : names) {
    options.progress = [&](const Progress& progress) { return progress.stage != stage; };
    EXPECT_THROW(reconstruct(points, options), Cancelled) << stage;
  }
}

TEST(Reconstruct, EveryStageOfALargeCloudReportsWhileItWorks) {
  const Positions points = spiralSphere(300000);
  std::map<std::string, std::vector<double>> fractions;
  Options options;
  options.progress = [&](const Progress& progress) {
    fractions[progress.stage].push_back(progress.fraction);
    return true;
  };
  reconstruct(points, test::spiralNeighbors(points, 12), options);
  const std::map<std::string, std::size_t> least{{"neighbors", 4},     {"graph", 10},
                                                 {"embedding", 30},    {"triangulation", 8},
                                                 {"optimization", 20}, {"quality", 2}};
  ASSERT_EQ(fractions.size(), least.size());
  for (const auto& [stage, of_stage] : fractions) {
    EXPECT_TRUE(test::areFractions(of_stage)) << stage;
    EXPECT_EQ(of_stage.back(), 1.0) << stage;
    EXPECT_GE(of_stage.size(), least.at(stage)) << stage;
  }
}

TEST(Reconstruct, EveryOptionReachesItsStage) {
  const Positions points = ellipsoid(200, 1.0, 0.7, 0.5);
  Options options = paper();
  options.embedding.max_iterations = 7;
  EXPECT_EQ(mesh(points, options).embedding.residuals.size(), 8U);
  options.embedding.tolerance = 1.0;
  EXPECT_EQ(mesh(points, options).embedding.stop_reason, StopReason::Converged);
  const Result by_default = mesh(points, paper());
  options = paper();
  options.embedding.damping = 0.3;
  EXPECT_NE(mesh(points, options).embedding.residuals[1], by_default.embedding.residuals[1]);
  options = paper();
  options.graph.k = 5;
  EXPECT_LT(mesh(points, options).graph.edges, by_default.graph.edges);
  options = paper();
  options.embedding.stagnation_window = 0;
  options.embedding.max_iterations = 3000;
  options.embedding.tolerance = 0.0;
  EXPECT_EQ(mesh(points, options).embedding.iterations, 3000);
}

TEST(Reconstruct, EveryOptionReachesTheMultilevelSolver) {
  const Positions points = ellipsoid(12000, 1.0, 0.7, 0.5);
  const Graph graph = test::graphOfMesh(points, triangulateSphere(spiralSphere(12000)).triangles);
  NeighborLists lists;
  lists.offsets = graph.offsets;
  lists.indices = graph.neighbors;
  const auto sphere = [&](const auto& change) {
    Options options;
    options.graph.method = GraphMethod::NearestNeighbors;
    change(options);
    return reconstruct(points, lists, options);
  };
  const Result by_default = sphere([](Options&) {});
  EXPECT_EQ(by_default.embedding.stop_reason, StopReason::Unfinished);
  EXPECT_EQ(by_default.embedding.starts, 2);
  EXPECT_EQ(by_default.sphere, sphere([](Options&) {}).sphere);
  EXPECT_NE(by_default.sphere, sphere([](Options& o) { o.embedding.damping = 0.3; }).sphere);
  EXPECT_NE(by_default.sphere, sphere([](Options& o) { o.embedding.exponent = 4.0; }).sphere);
  EXPECT_NE(by_default.sphere, sphere([](Options& o) { o.seed = 2; }).sphere);
  EXPECT_NE(by_default.sphere,
            sphere([](Options& o) { o.embedding.weights = EdgeWeights::Uniform; }).sphere);
  EXPECT_EQ(sphere([](Options& o) { o.embedding.starts = 3; }).embedding.starts, 3);
  const Result converged = sphere([](Options& o) { o.embedding.tolerance = 1e-9; });
  EXPECT_EQ(converged.embedding.stop_reason, StopReason::Converged);
  EXPECT_LE(converged.embedding.residual, 1e-9);
  EXPECT_TRUE(converged.warnings.empty());
  EXPECT_TRUE(by_default.warnings.empty());
}

// --- Optimisation, retries, smoothing, measures
// ---------------------------------------------------

/// A sphere with noise of so many distances of its points.
Positions noisySphere(Index n, double noise, std::uint64_t seed) {
  const double spacing = std::sqrt(8.0 * test::kPi / (std::sqrt(3.0) * n));
  return test::withNoise(spiralSphere(n), noise * spacing, seed);
}

TEST(Reconstruct, ACleanCloudIsMeshedInOneRun) {
  for (const Positions& points : {ellipsoid(600, 1.0, 0.7, 0.5), test::cubeGrid(8)})
    for (const Options& options : bothMethods()) {
      const Result result = mesh(points, options);
      expectGuarantees(points, result);
      EXPECT_TRUE(result.self_intersections.empty());
      ASSERT_EQ(result.runs.size(), 1U);
      EXPECT_TRUE(result.runs[0].chosen);
      EXPECT_EQ(result.runs[0].self_intersections, 0U);
      EXPECT_EQ(result.runs[0].energy, result.optimization.energy);
      EXPECT_TRUE(result.diagnosis.looksClosedGenus0());
      EXPECT_TRUE(result.smoothed.cols() == 0);
      EXPECT_EQ(result.smoothing.volume_before, 0.0);
      EXPECT_FALSE(isWarnedOf(result, "intersect"));
    }
}

TEST(Reconstruct, ACleanCloudIsNotTakenForANoisyOneWhateverItsGraph) {
  for (const Options& options : bothMethods()) {
    const Result result = mesh(ellipsoid(400, 1.0, 0.7, 0.5), options);
    EXPECT_LT(result.optimization.rough, 0.1);
    EXPECT_EQ(result.optimization.noise_steps, 0);
    EXPECT_FALSE(isWarnedOf(result, "nois"));
  }
}

TEST(Reconstruct, OptimizationMethodIsThatAskedFor) {
  const Positions points = randomSphere(400, 5);
  Options options;
  options.optimization.method = OptimizationMethod::None;
  const Result none = mesh(points, options);
  EXPECT_TRUE(none.optimization.phases.empty());
  options.optimization.method = OptimizationMethod::Flips;
  const Result flips = mesh(points, options);
  ASSERT_EQ(flips.optimization.phases.size(), 1U);
  EXPECT_EQ(flips.optimization.phases[0].name, "flips");
  const Result full = mesh(points);
  EXPECT_GT(full.optimization.phases.size(), 1U);
  for (const Result& result : {none, flips, full}) {
    expectGuarantees(points, result);
    EXPECT_GT(result.optimization.energy, 0.0);
  }
  EXPECT_LT(flips.optimization.energy, none.optimization.energy);
  EXPECT_EQ(none.sphere, full.sphere);
}

TEST(Reconstruct, CreasesOfACubeAreItsEdges) {
  const int m = 9;
  const Positions points = test::cubeGrid(m);
  const Result result = mesh(points);
  expectGuarantees(points, result);
  // Corners are cut if any crease is missing.
  EXPECT_NEAR(result.measures.volume, 1.0, 1e-12);
  EXPECT_NEAR(result.measures.area, 6.0, 1e-12);
}

/// Checks that the runs are different, that the best was chosen, and that only the last may be
/// without self-intersections.
void expectBestOfRuns(const Result& result) {
  const auto best = std::min_element(result.runs.begin(), result.runs.end(),
                                     [](const RunReport& one, const RunReport& other) {
                                       return std::pair(one.self_intersections, one.energy) <
                                              std::pair(other.self_intersections, other.energy);
                                     });
  EXPECT_TRUE(best->chosen);
  EXPECT_EQ(best->energy, result.optimization.energy);
  EXPECT_EQ(result.runs[0].description, "as asked");
  std::set<std::string> descriptions;
  for (std::size_t i = 0; i < result.runs.size(); ++i) {
    descriptions.insert(result.runs[i].description);
    EXPECT_GT(result.runs[i].energy, 0.0);
    EXPECT_TRUE(i + 1 == result.runs.size() || result.runs[i].self_intersections > 0);
  }
  EXPECT_EQ(descriptions.size(), result.runs.size());
}

TEST(Reconstruct, RetriesAreMadeWhileTrianglesIntersectAndTheBestCounts) {
  // Seen from its centroid, a bent tube hides so much of itself that its mesh stays tangled.
  std::vector<Positions> clouds{test::bentTube(8.0, 2.0, 20).points};
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    Positions points(3, seed % 2 == 0 ? 8 : 16);
    clouds.emplace_back(points.unaryExpr([&](double) { return uniform(random); }));
  }
  std::size_t most = 0;
  for (const Positions& points : clouds)
    for (const int retries : {0, points.cols() > 16 ? 1 : 3}) {  // the tube takes long
      Options options;
      options.embedding.method = EmbeddingMethod::Iterative;
      options.embedding.max_iterations = 0;
      options.retries = retries;
      const Result result = mesh(points, options);
      expectGuarantees(points, result);
      expectBestOfRuns(result);
      EXPECT_LE(result.runs.size(), static_cast<std::size_t>(retries) + 1);
      most = std::max(most, result.runs.size());
    }
  EXPECT_GE(most, 2U);
}

TEST(Reconstruct, NoRetryIsMadeOnceNoTrianglesIntersect) {
  int clean = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> radius(0.7, 1.3);
    Positions points = randomSphere(40, seed + 1);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      points.col(i) *= radius(random);
    Options options;
    options.retries = 0;
    const Result once = mesh(points, options);
    if (!once.self_intersections.empty())
      continue;
    ++clean;
    options.retries = 3;
    const Result result = mesh(points, options);
    EXPECT_EQ(result.runs.size(), 1U);
    EXPECT_EQ(result.runs[0].self_intersections, 0U);
    EXPECT_EQ(result.triangles, once.triangles);
  }
  EXPECT_GE(clean, 3);
}

TEST(Reconstruct, ACloudThatIsNoClosedSurfaceIsTriedOnce) {
  Positions second = spiralSphere(60);
  second.colwise() += Eigen::Vector3d(6.0, 0.0, 0.0);
  const Positions points = horizontally(spiralSphere(80), second);
  const Result result = mesh(points);
  expectGuarantees(points, result);
  EXPECT_EQ(result.diagnosis.kind, SurfaceKind::SeveralParts);
  EXPECT_EQ(result.runs.size(), 1U);
  ASSERT_FALSE(result.diagnosis.bridges.empty());
  EXPECT_EQ(result.diagnosis.bridges[0].points, 60U);
  EXPECT_EQ(result.diagnosis.bridges[0].other_points, 80U);
  EXPECT_NEAR(result.diagnosis.bridges[0].center.x(), 3.0, 0.2);
  for (const Index v : result.diagnosis.bridges[0].vertices)
    EXPECT_LT(std::abs(points(0, v) - 3.0), 3.0);  // the ends look at each other
}

TEST(Reconstruct, SmoothingMovesTheSmoothedPointsAlone) {
  const Positions points = noisySphere(500, 0.15, 6);
  const Result rough = mesh(points);
  EXPECT_EQ(rough.smoothed.cols(), 0);
  Options options;
  options.smoothing.steps = 3;
  const Result result = mesh(points, options);
  expectGuarantees(points, result);
  ASSERT_EQ(result.smoothed.cols(), points.cols());
  // Without intersections on the smoothed points the triangles are those without smoothing.
  EXPECT_EQ(result.smoothing.self_intersections, 0U);
  EXPECT_EQ(result.triangles, rough.triangles);
  EXPECT_EQ(result.sphere, rough.sphere);
  EXPECT_EQ(result.measures.volume, rough.measures.volume);
  const Eigen::VectorXd moved = (result.smoothed - points).colwise().norm();
  EXPECT_GT(moved.minCoeff(), 0.0);
  EXPECT_NEAR(result.smoothing.max_displacement, moved.maxCoeff(), 1e-12);
  EXPECT_NEAR(result.smoothing.mean_displacement, moved.mean(), 1e-12);
  EXPECT_NEAR(result.smoothing.rms_displacement, std::sqrt(moved.squaredNorm() / 500.0), 1e-12);
  const double volume = test::volumeOf(result.smoothed, result.triangles);
  EXPECT_NEAR(result.smoothing.volume_before, result.measures.volume, 1e-12);
  EXPECT_NEAR(result.smoothing.volume_after, volume, 1e-12);
  EXPECT_NEAR(volume, result.measures.volume, 1e-3 * result.measures.volume);
  const auto deviation = [](const Positions& of) {
    return (of.colwise().norm().array() - 1.0).matrix().norm();
  };
  EXPECT_LT(deviation(result.smoothed), 0.5 * deviation(points));
}

TEST(Reconstruct, ANoisySphereIsSmoothedWithoutSelfIntersections) {
  for (const double noise : {0.3, 0.5}) {
    const Positions points = noisySphere(600, noise, 7);
    Options options;
    options.smoothing.steps = 5;
    const Result result = mesh(points, options);
    expectGuarantees(points, result);
    EXPECT_EQ(result.smoothing.self_intersections, 0U);
    EXPECT_TRUE(findSelfIntersections(result.smoothed, result.triangles).empty());
    EXPECT_GT(result.optimization.noise_steps, 0);
    const double volume = test::volumeOf(result.smoothed, result.triangles);
    EXPECT_NEAR(volume, result.smoothing.volume_after, 1e-12);
    EXPECT_NEAR(volume, 4.0 / 3.0 * test::kPi, 0.3);
  }
}

TEST(Reconstruct, NoiseIsWarnedOfUnlessItIsSmoothed) {
  const Positions points = noisySphere(200, 0.4, 7);
  const Result rough = mesh(points);
  expectGuarantees(points, rough);
  EXPECT_GT(rough.optimization.noise_steps, 0);
  EXPECT_TRUE(isWarnedOf(rough, "nois"));
  Options options;
  options.smoothing.steps = 5;
  EXPECT_FALSE(isWarnedOf(mesh(points, options), "nois"));
}

TEST(Reconstruct, SmoothedPointsOfRepeatedInputsAreOfTheirVertex) {
  const Positions base = ellipsoid(300, 1.0, 0.8, 0.6);
  const Positions points = horizontally(base.leftCols(50), base);
  Options options;
  options.smoothing.steps = 1;
  const Result result = mesh(points, options);
  ASSERT_EQ(result.smoothed.cols(), 300);
  const Positions vertices = verticesOf(points, result);
  // Each near its own point, none in the place of another.
  EXPECT_LT((result.smoothed - vertices).colwise().norm().maxCoeff(), 0.1);
  EXPECT_LT((result.smoothed - vertices).colwise().norm().maxCoeff(),
            1.0001 * result.smoothing.max_displacement);
}

TEST(Reconstruct, MeasuresOfAShiftedCubeAreThoseOfACube) {
  const Eigen::Vector3d shift(5.0, -3.0, 7.0);
  Positions points = 2.0 * test::cubeGrid(7);
  points.colwise() += shift;
  const Result result = mesh(points);
  expectGuarantees(points, result);
  const MeshMeasures& measures = result.measures;
  EXPECT_NEAR(measures.volume, 8.0, 1e-12);
  EXPECT_NEAR(measures.area, 24.0, 1e-12);
  EXPECT_EQ(measures.box_min, shift);
  EXPECT_EQ(measures.box_max, Eigen::Vector3d(shift.array() + 2.0));
  EXPECT_LT((measures.centroid - shift - Eigen::Vector3d::Ones()).norm(), 1e-12);
  // m a^2 / 6
  EXPECT_LT((measures.inertia - 8.0 * 4.0 / 6.0 * Eigen::Matrix3d::Identity()).norm(), 1e-11);
}

/// Everything that has a unit, with its power.
std::vector<std::pair<double, int>> quantitiesOf(const Result& result) {
  std::vector<std::pair<double, int>> all = {{result.measures.volume, 3},
                                             {result.measures.area, 2},
                                             {result.measures.mean_edge_length, 1},
                                             {result.measures.inertia.trace(), 5},
                                             {result.optimization.energy, 1},
                                             {result.optimization.alignment, 0},
                                             {result.optimization.unevenness, 0},
                                             {result.optimization.rough, 0},
                                             {result.runs[0].energy, 1},
                                             {result.smoothing.max_displacement, 1},
                                             {result.smoothing.mean_displacement, 1},
                                             {result.smoothing.rms_displacement, 1},
                                             {result.smoothing.volume_before, 3},
                                             {result.smoothing.volume_after, 3},
                                             {result.diagnosis.edges_outside_graph, 0}};
  for (const OptimizationPhase& phase : result.optimization.phases) {
    all.emplace_back(phase.energy_before, 1);
    all.emplace_back(phase.energy, 1);
  }
  for (const FilledHole& hole : result.diagnosis.filled_holes) {
    all.emplace_back(hole.area, 2);
    all.emplace_back(hole.boundary_length, 1);
    all.emplace_back(hole.diameter, 1);
    all.emplace_back(hole.spacing, 1);
    all.emplace_back(hole.center.norm(), 1);
  }
  for (int axis = 0; axis < 3; ++axis) {
    all.emplace_back(result.measures.box_min[axis], 1);
    all.emplace_back(result.measures.box_max[axis], 1);
    all.emplace_back(result.measures.centroid[axis], 1);
  }
  if (result.smoothed.cols() > 0)
    all.emplace_back(result.smoothed.norm(), 1);
  return all;
}

void expectScaled(const Result& result, const Result& scaled, double scale, double tolerance) {
  const auto one = quantitiesOf(result);
  const auto other = quantitiesOf(scaled);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    const double expected = one[i].first * std::pow(scale, one[i].second);
    EXPECT_NEAR(other[i].first, expected,
                tolerance * std::max(std::abs(expected), std::pow(scale, one[i].second)))
        << i;
  }
}

TEST(Reconstruct, QuantitiesWithAUnitScaleWithIt) {
  // Open at one end, so that there is a filled hole to measure.
  const Positions sphere = test::withNoise(spiralSphere(500), 0.003, 8);
  const Positions points = sphere.rightCols(400);
  Options options;
  options.smoothing.steps = 2;
  const Result result = mesh(points, options);
  ASSERT_FALSE(result.diagnosis.filled_holes.empty());
  const Result twice = mesh(4.0 * points, options);
  EXPECT_EQ(twice.triangles, result.triangles);
  EXPECT_EQ(twice.smoothed, 4.0 * result.smoothed);
  expectScaled(result, twice, 4.0, 1e-15);
  // 1000 is no power of two: coordinates round anew, but no decision is so close.
  const Result thousand = mesh(1000.0 * points, options);
  ASSERT_EQ(test::canonical(thousand.triangles), test::canonical(result.triangles));
  expectScaled(result, thousand, 1000.0, 1e-9);
  EXPECT_NEAR(thousand.measures.volume, 1e9 * result.measures.volume,
              1e-3 * thousand.measures.volume);
  EXPECT_NE(thousand.diagnosis.summary, result.diagnosis.summary);
}

TEST(Reconstruct, FarLargerUnitsAreMeasuredAllTheSame) {
  Options options;
  options.smoothing.steps = 1;
  const Positions points = test::withNoise(ellipsoid(300, 1.0, 0.7, 0.5), 0.002, 9);
  const Result result = mesh(points, options);
  for (const double scale : {1e50, 1e-50}) {
    const Result scaled = mesh(scale * points, options);
    expectGuarantees(scale * points, scaled);
    EXPECT_EQ(test::canonical(scaled.triangles), test::canonical(result.triangles));
    expectScaled(result, scaled, scale, 1e-9);
    EXPECT_EQ(scaled.self_intersections.size(), 0U);
  }
}

TEST(Reconstruct, SameBitsForAnyNumberOfThreads) {
  const Positions points = test::withNoise(ellipsoid(2600, 1.0, 0.7, 0.5), 0.012, 10);
  const NeighborLists lists = bruteForceNeighbors(points, 24);
  Options options;
  options.threads = 1;
  options.smoothing.steps = 2;
  const Result one = reconstruct(points, lists, options);
  for (const int threads : {2, 4}) {
    options.threads = threads;
    const Result other = reconstruct(points, lists, options);
    EXPECT_EQ(one.triangles, other.triangles);
    EXPECT_EQ(one.sphere, other.sphere);
    EXPECT_EQ(one.smoothed, other.smoothed);
    EXPECT_EQ(one.self_intersections, other.self_intersections);
    EXPECT_EQ(one.warnings, other.warnings);
    EXPECT_EQ(one.diagnosis.summary, other.diagnosis.summary);
    EXPECT_EQ(quantitiesOf(one), quantitiesOf(other));
  }
}

/// A dented ellipsoid, shuffled, with some of its points twice.
Positions shuffledWithRepetitions(Index n) {
  Positions points = ellipsoid(n, 1.0, 0.8, 0.6);
  for (Index i = 0; i < n; ++i)
    points.col(i) *= 1.0 + 0.2 * std::sin(4.0 * points(0, i));
  points = horizontally(points, points.leftCols(n / 10));
  std::vector<Index> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), Index{0});
  std::mt19937_64 random(7);
  std::shuffle(order.begin(), order.end(), random);
  Positions shuffled(3, points.cols());
  for (Index i = 0; i < points.cols(); ++i)
    shuffled.col(i) = points.col(order[static_cast<std::size_t>(i)]);
  return shuffled;
}

Options watched(Options options) {
  options.embedding.history.vertices = 300;
  options.embedding.history.frames = 25;
  options.details = true;
  return options;
}

TEST(Reconstruct, LookingOnChangesNothing) {
  const Positions points = shuffledWithRepetitions(1500);
  for (const Options& options : bothMethods()) {
    const Result alone = mesh(points, options);
    const Result seen = mesh(points, watched(options));
    EXPECT_TRUE(alone.history.frames.empty());
    EXPECT_TRUE(alone.history.vertices.empty());
    EXPECT_TRUE(alone.vertex_residuals.empty());
    EXPECT_TRUE(alone.diagnosis.triangle_marks.empty());
    EXPECT_FALSE(seen.history.frames.empty());
    EXPECT_EQ(alone.triangles, seen.triangles);
    EXPECT_EQ(alone.sphere, seen.sphere);
    EXPECT_EQ(quantitiesOf(alone), quantitiesOf(seen));
  }
}

TEST(Reconstruct, HistoryEndsAtTheSphereOfItsVerticesHoweverThePointsAreNumbered) {
  const Positions points = shuffledWithRepetitions(1500);
  for (const Options& options : bothMethods()) {
    const Result result = mesh(points, watched(options));
    const EmbeddingHistory& history = result.history;
    ASSERT_GT(history.vertices.size(), 100U);
    ASSERT_LE(history.vertices.size(), 300U);
    ASSERT_GE(history.frames.size(), 5U);
    ASSERT_LE(history.frames.size(), 25U);
    EXPECT_EQ(std::set<Index>(history.vertices.begin(), history.vertices.end()).size(),
              history.vertices.size());
    for (const HistoryFrame& frame : history.frames) {
      ASSERT_EQ(frame.sphere.cols(), static_cast<Index>(history.vertices.size()));
      EXPECT_LT((frame.sphere.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-12);
    }
    EXPECT_EQ(history.frames.back().step, EmbeddingStep::End);
    EXPECT_EQ(history.frames.back().residual, result.embedding.residual);
    for (std::size_t i = 0; i < history.vertices.size(); ++i)
      EXPECT_EQ(history.frames.back().sphere.col(static_cast<Index>(i)),
                result.sphere.col(history.vertices[i]));
  }
}

TEST(Reconstruct, HistoryOfAMirroredOrCollapsedEmbeddingEndsAtTheSphereThatCounts) {
  Positions mirrored = ellipsoid(800, 1.0, 0.8, 0.6);
  mirrored.row(0) *= -1.0;
  const Positions& straight = ellipsoid(800, 1.0, 0.8, 0.6);
  Options collapsing = quick(paper());
  collapsing.embedding.weights = EdgeWeights::Uniform;
  collapsing.embedding.max_iterations = 20000;
  collapsing.graph.k = 3;
  Options radial = paper();
  radial.embedding.max_iterations = 0;
  for (const Positions& points : {straight, mirrored})
    for (const Options& options : {Options(), radial, collapsing}) {
      const Result result = mesh(points, watched(options));
      const EmbeddingHistory& history = result.history;
      ASSERT_FALSE(history.frames.empty());
      for (std::size_t i = 0; i < history.vertices.size(); ++i)
        EXPECT_EQ(history.frames.back().sphere.col(static_cast<Index>(i)),
                  result.sphere.col(history.vertices[i]));
    }
}

TEST(Reconstruct, ResidualsOfVerticesAreThoseOfTheEmbedding) {
  const Positions points = shuffledWithRepetitions(1200);
  for (const Options& options : bothMethods()) {
    const Result result = mesh(points, watched(options));
    ASSERT_EQ(result.vertex_residuals.size(), result.vertexCount());
    const double mean =
        std::accumulate(result.vertex_residuals.begin(), result.vertex_residuals.end(), 0.0) /
        static_cast<double>(result.vertexCount());
    EXPECT_NEAR(mean, result.embedding.residual, 1e-9 * result.embedding.residual);
  }
  // The graph of nearest neighbours can be made again, with the numbers of the vertices.
  Options options = quick(paper());
  options.embedding.max_iterations = 3;
  const Positions distinct = verticesOf(points, mesh(points, options));
  const Result result = mesh(distinct, watched(options));
  const Positions vertices = verticesOf(distinct, result);
  const Graph graph =
      buildNeighborGraph(vertices, bruteForceNeighbors(vertices, 25), test::nearest()).graph;
  const std::vector<double> expected =
      tangentialLaplacianLengths(graph, result.sphere, options.embedding.weights);
  double largest = 0.0;
  for (std::size_t v = 0; v < expected.size(); ++v)
    largest = std::max(largest, std::abs(expected[v] - result.vertex_residuals[v]));
  const auto [low, high] = std::minmax_element(expected.begin(), expected.end());
  EXPECT_LT(largest, 1e-6 * (*high - *low));
}

TEST(Reconstruct, MarksShowIntersectionsAndFilledHoles) {
  // A sphere without its cap.
  const Positions sphere = spiralSphere(3000);
  const Positions bowl = sphere.rightCols(2600);
  const Result result = mesh(bowl, watched(quick()));
  const std::vector<std::uint8_t>& marks = result.diagnosis.triangle_marks;
  ASSERT_EQ(marks.size(), static_cast<std::size_t>(result.triangles.cols()));
  ASSERT_EQ(result.diagnosis.filled_holes.size(), 1U);
  const auto count = [&](std::uint8_t bit) {
    return static_cast<std::size_t>(std::count_if(
        marks.begin(), marks.end(), [bit](std::uint8_t mark) { return (mark & bit) != 0; }));
  };
  EXPECT_EQ(count(TriangleMarks::filled_hole), result.diagnosis.filled_holes.front().triangles);
  std::set<Index> intersecting;
  for (const auto& pair : result.self_intersections)
    intersecting.insert(pair.begin(), pair.end());
  EXPECT_EQ(count(TriangleMarks::self_intersection), intersecting.size());
  for (const Index t : intersecting)
    EXPECT_NE(marks[static_cast<std::size_t>(t)] & TriangleMarks::self_intersection, 0);
  EXPECT_GE(count(TriangleMarks::outside_graph), 1U);
  const Positions vertices = verticesOf(bowl, result);
  for (Index t = 0; t < result.triangles.cols(); ++t)
    if ((marks[static_cast<std::size_t>(t)] & TriangleMarks::filled_hole) != 0) {
      // All corners are at the rim, about 0.87 up; the surface has no triangle of this size.
      for (Index k = 0; k < 3; ++k)
        EXPECT_GT(vertices(2, result.triangles(k, t)), 0.6);
    }
}

TEST(Reconstruct, MarksShowHandlesAndBridgesBetweenParts) {
  const auto has = [](const Result& result, std::uint8_t bit) {
    const std::vector<std::uint8_t>& marks = result.diagnosis.triangle_marks;
    return std::any_of(marks.begin(), marks.end(),
                       [bit](std::uint8_t mark) { return (mark & bit) != 0; });
  };
  Positions far = spiralSphere(500);
  far.row(0).array() += 5.0;
  const Result parts = mesh(horizontally(spiralSphere(600), far), watched(quick()));
  EXPECT_EQ(parts.diagnosis.kind, SurfaceKind::SeveralParts);
  EXPECT_TRUE(has(parts, TriangleMarks::part_bridge));
  EXPECT_FALSE(has(parts, TriangleMarks::handle));
  const Result closed = mesh(spiralSphere(600), watched(quick()));
  EXPECT_EQ(
      std::count(closed.diagnosis.triangle_marks.begin(), closed.diagnosis.triangle_marks.end(), 0),
      closed.triangles.cols());
}

TEST(Reconstruct, HistoryAndDetailsHaveTheSameBitsForAnyNumberOfThreads) {
  const Positions points = test::withNoise(ellipsoid(5200, 1.0, 0.7, 0.5), 0.004, 10);
  const NeighborLists lists = bruteForceNeighbors(points, 24);
  for (const EmbeddingMethod solver : {EmbeddingMethod::Multilevel, EmbeddingMethod::Iterative}) {
    Options options = watched(quick());
    options.embedding.method = solver;
    options.embedding.max_iterations = 40;
    options.threads = 1;
    const Result one = reconstruct(points, lists, options);
    for (const int threads : {2, 3}) {
      options.threads = threads;
      const Result other = reconstruct(points, lists, options);
      EXPECT_EQ(one.vertex_residuals, other.vertex_residuals);
      EXPECT_EQ(one.diagnosis.triangle_marks, other.diagnosis.triangle_marks);
      EXPECT_EQ(one.history.vertices, other.history.vertices);
      ASSERT_EQ(one.history.frames.size(), other.history.frames.size());
      for (std::size_t f = 0; f < one.history.frames.size(); ++f)
        EXPECT_EQ(one.history.frames[f].sphere, other.history.frames[f].sphere);
    }
  }
}

TEST(Reconstruct, SmoothingIsAStageOfItsOwn) {
  const Positions points = ellipsoid(200, 1.0, 0.7, 0.5);
  Options options;
  options.smoothing.steps = 1;
  const Result result = mesh(points, options);
  std::vector<std::string> names;
  for (const StageTime& stage : result.stages)
    names.push_back(stage.name);
  EXPECT_EQ(names, (std::vector<std::string>{"neighbors", "graph", "embedding", "triangulation",
                                             "optimization", "smoothing", "quality"}));
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
  expect_reason(three, bruteForceNeighbors(three, 5), {}, "but there are 3");
  Positions plane = good;
  plane.row(1).setConstant(3.0);
  expect_reason(plane, bruteForceNeighbors(plane, 5), {}, "one plane");
  Positions far_plane = 1e-300 * plane;
  far_plane.row(1).setConstant(1e99);  // which no scale brings near together with the rest
  expect_reason(far_plane, bruteForceNeighbors(plane, 5), {}, "one plane");
  Positions bad = good;
  bad(2, 11) = std::numeric_limits<double>::quiet_NaN();
  expect_reason(bad, lists, {}, "point 11 is not finite");
  expect_reason(good * 1e101, lists, {}, "beyond 1e100");
  NeighborLists wrong = lists;
  wrong.indices[0] = 20;
  expect_reason(good, wrong, {}, "neighbour 20 of 20");
  wrong = lists;
  wrong.offsets.pop_back();
  expect_reason(good, wrong, {}, "do not fit 20 points");
  Options options;
  options.graph.k = 2;
  expect_reason(good, lists, options, "k = 2");
  options = Options();
  options.embedding.damping = 1.5;
  expect_reason(good, lists, options, "damping");
  options = Options();
  options.embedding.max_iterations = -1;
  expect_reason(good, lists, options, "max_iterations");
  options = Options();
  options.retries = -1;
  expect_reason(good, lists, options, "retries = -1");
  options = Options();
  options.smoothing.steps = -1;
  expect_reason(good, lists, options, "smoothing = -1");
}

TEST(NeighborSearch, NoPointsAndQueriesThatAreNoIndicesAreRejected) {
  EXPECT_THROW(makeNeighborSearch(Positions(3, 0)), InvalidInput);
  const NeighborSearch search = makeNeighborSearch(Positions::Random(3, 10));
  EXPECT_EQ(search({0, 9}, 3).size(), 2U);
  EXPECT_THROW(search({-1}, 3), InvalidInput);
  EXPECT_THROW(search({10}, 3), InvalidInput);
}

}  // namespace
}  // namespace spherical_param
