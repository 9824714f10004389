#include "spherical_param/embedding.h"

#include "embedding_energy.h"
#include "embedding_newton.h"
#include "graph_hierarchy.h"
#include "helpers.h"
#include "iterative_embedding.h"
#include "multigrid.h"
#include "multilevel_embedding.h"
#include "planar_start.h"
#include "spherical_param/errors.h"
#include "spherical_param/sphere_triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <random>
#include <set>
#include <thread>

namespace spherical_param {
namespace {

using internal::buildGraphHierarchy;
using internal::EmbeddingEnergy;
using internal::GraphHierarchy;
using internal::HierarchyLevel;
using internal::TangentBasis;
using internal::TangentVector;
using test::bentTube;
using test::fractionBeyondTwoSteps;
using test::graphOfMesh;
using test::randomSphere;
using test::spiralSphere;
using test::Tube;

constexpr EdgeWeights kAllWeights[] = {EdgeWeights::Uniform, EdgeWeights::InverseLength,
                                       EdgeWeights::Adaptive};

const internal::EdgeWeightLaw kAdaptive(EdgeWeights::Adaptive, 3.0);

/// An ellipsoid with dents and its true edges.
struct Cloud {
  Positions points;
  Triangles triangles;
  Graph graph;
};

Cloud dentedCloud(Index n) {
  const Positions sphere = spiralSphere(n);
  Cloud cloud;
  cloud.points = sphere;
  for (Index i = 0; i < n; ++i)
    cloud.points.col(i) *= 1.0 + 0.3 * std::sin(4.0 * sphere(0, i)) * std::cos(3.0 * sphere(1, i));
  cloud.points.row(2) *= 1.7;
  cloud.triangles = triangulateSphere(sphere).triangles;
  cloud.graph = graphOfMesh(cloud.points, cloud.triangles);
  return cloud;
}

struct Setting : EmbeddingOptions, Execution {};

Embedding embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy,
                        const Setting& setting = {}) {
  return internal::embedByLevels(graph, hierarchy, setting, {}, setting);
}

Embedding solve(const Graph& graph, const Setting& setting = {}, Index coarsest_size = 200,
                std::uint32_t seed = 1) {
  return embedByLevels(graph, buildGraphHierarchy(graph, seed, coarsest_size), setting);
}

Setting converging(double tolerance, EdgeWeights weights = EdgeWeights::Adaptive) {
  Setting options;
  options.tolerance = tolerance;
  options.weights = weights;
  return options;
}

/// Moves unit vectors along tangent vectors.
Positions moved(const Positions& u, const std::vector<TangentBasis>& bases,
                const TangentVector& step, double fraction) {
  Positions result = u;
  for (Eigen::Index i = 0; i < u.cols(); ++i)
    result.col(i) += bases[static_cast<std::size_t>(i)] * (fraction * step.segment<2>(2 * i));
  result.colwise().normalize();
  return result;
}

TangentVector randomTangent(Eigen::Index n, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  TangentVector result(2 * n);
  for (double& entry : result)
    entry = normal(generator);
  return result;
}

struct EnergyCase {
  EdgeWeights weights;
  double exponent;
  bool barrier;
};

class EnergyDerivatives : public testing::TestWithParam<EnergyCase> {};

TEST_P(EnergyDerivatives, AgreeWithDifferences) {
  const Cloud cloud = dentedCloud(60);
  const auto [weights, exponent, barrier] = GetParam();
  const internal::EdgeWeightLaw law(weights, exponent);
  EmbeddingEnergy energy(cloud.graph, law, 1);
  if (barrier)
    energy.addBarrier(randomSphere(60, 8));
  const Positions u = randomSphere(60, 3);
  const std::vector<TangentBasis> bases = internal::tangentBases(u);
  Positions gradient;
  energy.gradient(u, gradient);
  EmbeddingEnergy::Hessian hessian;
  energy.hessian(u, bases, hessian);
  const double scale = energy.value(u);
  constexpr double h = 1e-4;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const TangentVector step = randomTangent(60, seed);
    double slope = 0.0;
    for (Eigen::Index i = 0; i < 60; ++i)
      slope += gradient.col(i).dot(bases[static_cast<std::size_t>(i)] * step.segment<2>(2 * i));
    const double forward = energy.value(moved(u, bases, step, h));
    const double backward = energy.value(moved(u, bases, step, -h));
    EXPECT_NEAR((forward - backward) / (2.0 * h), slope, 1e-5 * scale);

    // To second order the normalised path is a geodesic.
    TangentVector product;
    internal::multiply(hessian.matrix, step, product, 1);
    double second = step.dot(product);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < 60; ++i) {
      second -= hessian.curvature[i] * step.segment<2>(2 * i).squaredNorm();
      if (barrier)
        mean += hessian.masses[i] * bases[static_cast<std::size_t>(i)] * step.segment<2>(2 * i);
    }
    if (barrier)
      second += mean.dot(hessian.barrier * mean);
    EXPECT_NEAR((forward - 2.0 * energy.value(u) + backward) / (h * h), second, 1e-4 * scale);
  }
}

INSTANTIATE_TEST_SUITE_P(Energies, EnergyDerivatives,
                         testing::Values(EnergyCase{EdgeWeights::Adaptive, 3.0, false},
                                         EnergyCase{EdgeWeights::Adaptive, 4.5, false},
                                         EnergyCase{EdgeWeights::Uniform, 3.0, false},
                                         EnergyCase{EdgeWeights::InverseLength, 3.0, false},
                                         EnergyCase{EdgeWeights::Uniform, 3.0, true},
                                         EnergyCase{EdgeWeights::Adaptive, 3.0, true}));

TEST(EmbeddingEnergy, GradientIsTheTangentialLaplacianTimesTheWeights) {
  const Cloud cloud = dentedCloud(200);
  const Positions u = randomSphere(200, 4);
  Positions gradient;
  const EmbeddingEnergy energy(cloud.graph, kAdaptive, 1);
  EXPECT_NEAR(energy.gradient(u, gradient).absolute,
              meanTangentialLaplacian(cloud.graph, u, EdgeWeights::Adaptive), 1e-14);
  for (Eigen::Index i = 0; i < 200; ++i)
    EXPECT_NEAR(gradient.col(i).dot(u.col(i)), 0.0, 1e-13);
}

TEST(PlanarStart, IsUnfolded) {
  // Tutte's theorem: only the outer face may be turned over. A few large triangles next to it may
  // be as well, since straight edges in the plane are not great circles on the sphere.
  const Tube tube = bentTube(20.0, 3.0, 12);
  const Graph graph = graphOfMesh(tube.points, tube.triangles);
  const Positions u = internal::planarStart(graph, internal::centralNodes(graph).front());
  int outward = 0;
  for (Eigen::Index t = 0; t < tube.triangles.cols(); ++t) {
    const Eigen::Vector3d a = u.col(tube.triangles(0, t));
    const Eigen::Vector3d b = u.col(tube.triangles(1, t));
    const Eigen::Vector3d c = u.col(tube.triangles(2, t));
    outward += a.dot((b - a).cross(c - a)) > 0.0 ? 1 : 0;
  }
  EXPECT_LT(static_cast<double>(std::min<Eigen::Index>(outward, tube.triangles.cols() - outward)),
            0.02 * static_cast<double>(tube.triangles.cols()));
  EXPECT_LT(u.rowwise().mean().norm(), 0.06);
}

TEST(PlanarStart, CentralNodesOfATubeAreInItsMiddle) {
  const Tube tube = bentTube(30.0, 0.0, 10);
  const Graph graph = graphOfMesh(tube.points, tube.triangles);
  EXPECT_NEAR(tube.points(0, internal::centralNodes(graph).front()), 15.0, 2.0);
}

TEST(MultigridPreconditioner, IsSymmetricAndSolvesDirectlyWithoutLevels) {
  const Cloud cloud = dentedCloud(1500);
  const GraphHierarchy hierarchy = buildGraphHierarchy(cloud.graph, 1, 100);
  const Positions u = solve(cloud.graph).directions;
  const std::vector<TangentBasis> bases = internal::tangentBases(u);
  EmbeddingEnergy::Hessian hessian;
  EmbeddingEnergy(cloud.graph, kAdaptive, 1).hessian(u, bases, hessian);
  internal::MultigridPreconditioner cycle(hierarchy, 0, 1);
  cycle.compute(hessian.matrix, bases);
  const TangentVector x = randomTangent(1500, 1);
  const TangentVector y = randomTangent(1500, 2);
  TangentVector cycled_x;
  TangentVector cycled_y;
  cycle.apply(x, cycled_x);
  cycle.apply(y, cycled_y);
  EXPECT_NEAR(x.dot(cycled_y), y.dot(cycled_x), 1e-9 * std::abs(x.dot(cycled_x)));
  EXPECT_GT(x.dot(cycled_x), 0.0);

  const GraphHierarchy none;
  internal::MultigridPreconditioner direct(none, 0, 1);
  direct.compute(hessian.matrix, bases);
  TangentVector solution;
  TangentVector product;
  direct.apply(x, solution);
  internal::multiply(hessian.matrix, solution, product, 1);
  EXPECT_LT((product - x).norm(), 1e-6 * x.norm());
}

Eigen::MatrixXd dense(const internal::BlockMatrix& matrix) {
  const auto n = static_cast<Eigen::Index>(matrix.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (std::size_t i = 0; i < matrix.size(); ++i)
    for (std::size_t e = matrix.offsets[i]; e < matrix.offsets[i + 1]; ++e)
      result.block<2, 2>(2 * static_cast<Eigen::Index>(i), 2 * matrix.columns[e]) =
          matrix.blocks[e];
  return result;
}

/// The same V-cycle with dense matrices: x such that cycle(matrix, level) b = x.
Eigen::VectorXd denseCycle(const GraphHierarchy& hierarchy, std::size_t level,
                           const Eigen::MatrixXd& matrix, const std::vector<TangentBasis>& bases,
                           const Eigen::VectorXd& b) {
  if (level == hierarchy.levels.size())
    return matrix.ldlt().solve(b);
  const HierarchyLevel& next = hierarchy.levels[level];
  const auto coarse = static_cast<Eigen::Index>(next.seeds.size());
  std::vector<TangentBasis> coarse_bases;
  for (const Index seed : next.seeds)
    coarse_bases.push_back(bases[static_cast<std::size_t>(seed)]);
  const Eigen::MatrixXd weights = next.prolongation;
  Eigen::MatrixXd prolongation(matrix.rows(), 2 * coarse);
  for (Eigen::Index i = 0; i < weights.rows(); ++i)
    for (Eigen::Index c = 0; c < coarse; ++c)
      prolongation.block<2, 2>(2 * i, 2 * c) = weights(i, c) *
                                               bases[static_cast<std::size_t>(i)].transpose() *
                                               coarse_bases[static_cast<std::size_t>(c)];
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  const auto solve_row = [&](Eigen::Index i) {
    const Eigen::Vector2d rest = b.segment<2>(2 * i) - matrix.middleRows<2>(2 * i) * x;
    x.segment<2>(2 * i) += matrix.block<2, 2>(2 * i, 2 * i).inverse() * rest;
  };
  for (Eigen::Index i = 0; i < weights.rows(); ++i)
    solve_row(i);
  x += prolongation * denseCycle(hierarchy, level + 1,
                                 prolongation.transpose() * matrix * prolongation, coarse_bases,
                                 prolongation.transpose() * (b - matrix * x));
  for (Eigen::Index i = weights.rows(); i-- > 0;)
    solve_row(i);
  return x;
}

TEST(MultigridPreconditioner, IsTheCycleOfDenseMatricesForEachMatrixInTurn) {
  const Cloud cloud = dentedCloud(300);
  const GraphHierarchy hierarchy = buildGraphHierarchy(cloud.graph, 1, 10);
  ASSERT_GE(hierarchy.levels.size(), 2U);
  Positions u = solve(cloud.graph).directions;
  internal::MultigridPreconditioner cycle(hierarchy, 0, 1);
  const GraphHierarchy none;
  internal::MultigridPreconditioner direct(none, 0, 1);
  for (unsigned turn = 0; turn < 3; ++turn) {
    const std::vector<TangentBasis> bases = internal::tangentBases(u);
    EmbeddingEnergy::Hessian hessian;
    EmbeddingEnergy(cloud.graph, kAdaptive, 1).hessian(u, bases, hessian);
    // Well above the rotations, for which the matrix is nearly singular.
    for (std::size_t i = 0; i < hessian.matrix.size(); ++i)
      for (std::size_t e = hessian.matrix.offsets[i]; e < hessian.matrix.offsets[i + 1]; ++e)
        if (static_cast<std::size_t>(hessian.matrix.columns[e]) == i)
          hessian.matrix.blocks[e] *= 1.1;
    const Eigen::MatrixXd matrix = dense(hessian.matrix);
    const TangentVector b = randomTangent(300, turn);
    TangentVector x;
    cycle.compute(hessian.matrix, bases);
    cycle.apply(b, x);
    const Eigen::VectorXd expected = denseCycle(hierarchy, 0, matrix, bases, b);
    EXPECT_LT((x - expected).norm(), 1e-8 * expected.norm());
    direct.compute(hessian.matrix, bases);
    direct.apply(b, x);
    EXPECT_LT((matrix * x - b).norm(), 1e-8 * b.norm());
    u = moved(u, bases, randomTangent(300, 10 + turn), 0.02);
  }
}

TEST(MinimizeByNewton, EndsWhereNothingKeepsTheEmbeddingFromCollapsing) {
  const Cloud cloud = dentedCloud(300);
  Positions u = solve(cloud.graph).directions * 0.1;
  u.row(2).array() += 1.0;
  u.colwise().normalize();
  const EmbeddingEnergy energy(cloud.graph, kAdaptive, 1);
  const GraphHierarchy none;
  internal::NewtonOptions options;
  options.relative_tolerance = 1e-4;
  const auto steps = [&](double longest_mean) {
    internal::MultigridPreconditioner direct(none, 0, 1);
    options.longest_mean = longest_mean;
    Positions trial = u;
    const int iterations = minimizeByNewton(energy, direct, options, trial).iterations;
    EXPECT_GT(trial.rowwise().mean().norm(), 0.99);
    return iterations;
  };
  EXPECT_EQ(steps(0.99), 0);
  EXPECT_GT(steps(1.0), 10);
}

TEST(MultilevelEmbedding, IcosahedronByHand) {
  const double golden = (1.0 + std::sqrt(5.0)) / 2.0;
  Positions points(3, 12);
  Index column = 0;
  for (const double one : {-1.0, 1.0})
    for (const double other : {-golden, golden}) {
      points.col(column++) << one, other, 0.0;
      points.col(column++) << other, 0.0, one;
      points.col(column++) << 0.0, one, other;
    }
  points.colwise().normalize();
  const Graph graph = graphOfMesh(points, triangulateSphere(points).triangles);
  const Embedding result = solve(graph, converging(1e-12));
  ASSERT_TRUE(result.report.converged());
  const Eigen::MatrixXd cosines = result.directions.transpose() * result.directions;
  const Eigen::MatrixXd expected = points.transpose() * points;
  EXPECT_LT((cosines - expected).cwiseAbs().maxCoeff(), 1e-9);
  // 30 edges as long on the sphere as in space, of squared length 4 / (golden + 2).
  EXPECT_NEAR(result.report.energy, 30.0 * 4.0 / (golden + 2.0) / 3.0, 1e-9);
}

TEST(MultilevelEmbedding, TangentialLaplacianVanishes) {
  const Cloud cloud = dentedCloud(12000);
  const Embedding result = solve(cloud.graph, converging(1e-12));
  EXPECT_TRUE(result.report.converged());
  EXPECT_LT(meanTangentialLaplacian(cloud.graph, result.directions, EdgeWeights::Adaptive), 1e-12);
  EXPECT_LT((result.directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
  EXPECT_EQ(result.report.residuals.back(), result.report.residual);
  EXPECT_GT(result.report.residuals.front(), 1e-5);
}

TEST(MultilevelEmbedding, OtherExponentsConverge) {
  const Cloud cloud = dentedCloud(2000);
  for (const double exponent : {2.5, 4.0, 6.0}) {
    Setting options = converging(1e-11);
    options.exponent = exponent;
    const Embedding result = solve(cloud.graph, options);
    EXPECT_TRUE(result.report.converged()) << exponent;
    EXPECT_LT(
        meanTangentialLaplacian(cloud.graph, result.directions, EdgeWeights::Adaptive, exponent),
        1e-11);
    EXPECT_LT(fractionBeyondTwoSteps(cloud.graph, triangulateSphere(result.directions).triangles),
              1e-3);
  }
}

TEST(MultilevelEmbedding, SameMinimumWhateverTheStart) {
  const Cloud cloud = dentedCloud(3000);
  const Embedding one = solve(cloud.graph, converging(1e-12), 200, 1);
  for (const std::uint32_t seed : {2U, 3U, 4U}) {
    Setting options = converging(1e-12);
    options.starts = 1;
    const Embedding other = solve(cloud.graph, options, 300, seed);
    EXPECT_NEAR(other.report.energy, one.report.energy, 1e-9 * one.report.energy);
    // Up to a rotation or reflection: the angles between nodes are the same.
    for (Eigen::Index i = 0; i + 7 < 3000; i += 7)
      EXPECT_NEAR(one.directions.col(i).dot(one.directions.col(i + 7)),
                  other.directions.col(i).dot(other.directions.col(i + 7)), 1e-6);
  }
}

TEST(MultilevelEmbedding, UnfoldsABentTubeThatTheIterationFolds) {
  const Tube tube = bentTube(25.0, 4.0, 16);
  const Graph graph = graphOfMesh(tube.points, tube.triangles);
  const auto folded = [&](const Positions& directions) {
    return fractionBeyondTwoSteps(graph, triangulateSphere(directions).triangles);
  };
  EXPECT_GT(folded(internal::embedIteratively(graph, tube.points, {}, {}, {}).directions), 0.01);
  EXPECT_LT(folded(solve(graph).directions), 0.001);
  EXPECT_LT(folded(solve(graph, converging(1e-9)).directions), 0.001);
}

TEST(MultilevelEmbedding, LongTubesDoNotUnderflow) {
  // Along a tube of radius r the map shrinks like exp(-s / (r sqrt 2)): 6e-10 from the middle of
  // this one to its ends.
  for (const double turn : {0.0, 3.0}) {
    const Tube tube = bentTube(60.0, turn, 12);
    const Graph graph = graphOfMesh(tube.points, tube.triangles);
    const Embedding result = solve(graph, {}, 1000, 1);
    ASSERT_NE(result.report.stop_reason, StopReason::Collapsed);
    const SphereTriangulation sphere = triangulateSphere(result.directions);
    EXPECT_EQ(sphere.report.coincident, 0);
    EXPECT_LT(fractionBeyondTwoSteps(graph, sphere.triangles), 0.01);
  }
}

TEST(MultilevelEmbedding, AllWeightsUnfoldWithoutCollapse) {
  const Cloud cloud = dentedCloud(4000);
  for (const EdgeWeights weights : kAllWeights)
    for (const bool converge : {false, true}) {
      Setting options = converging(1e-10, weights);
      if (!converge)
        options.tolerance.reset();
      const Embedding result = solve(cloud.graph, options);
      if (!converge) {
        EXPECT_EQ(result.report.stop_reason, StopReason::Unfinished);
      } else {
        // The pull of the barrier is left to the weights that need one.
        EXPECT_LT(result.report.residual, weights == EdgeWeights::Adaptive ? 1e-10 : 1e-4);
        EXPECT_EQ(result.report.converged(), result.report.residual <= 1e-10);
      }
      EXPECT_LT(result.report.centroid_norm, 0.3);
      EXPECT_NEAR(result.report.residual,
                  meanTangentialLaplacian(cloud.graph, result.directions, weights), 1e-12);
      EXPECT_LT(fractionBeyondTwoSteps(cloud.graph, triangulateSphere(result.directions).triangles),
                1e-3);
    }
}

TEST(MultilevelEmbedding, StepsDoNotGrowWithTheGraph) {
  const auto steps = [](Index n) {
    const Cloud cloud = dentedCloud(n);
    return solve(cloud.graph, converging(1e-10)).report.levels.front().linear_iterations;
  };
  const int small = steps(3000);
  EXPECT_GT(small, 0);
  EXPECT_LE(steps(48000), small + small / 2);
}

TEST(MultilevelEmbedding, ReportsItsLevels) {
  const Cloud cloud = dentedCloud(5000);
  const GraphHierarchy hierarchy = buildGraphHierarchy(cloud.graph, 1, 200);
  const Embedding result = embedByLevels(cloud.graph, hierarchy, converging(1e-9));
  ASSERT_EQ(result.report.levels.size(), hierarchy.levels.size() + 1);
  EXPECT_EQ(result.report.levels[0].nodes, 5000U);
  EXPECT_EQ(result.report.levels[0].edges, cloud.graph.edgeCount());
  EXPECT_GT(result.report.levels[0].newton_iterations, 0);
  for (std::size_t l = 1; l < result.report.levels.size(); ++l) {
    EXPECT_EQ(result.report.levels[l].nodes, hierarchy.levels[l - 1].graph.size());
    EXPECT_EQ(result.report.levels[l].edges, hierarchy.levels[l - 1].graph.edgeCount());
    EXPECT_GT(result.report.levels[l].newton_iterations, 0);
    EXPECT_LT(result.report.levels[l].residual, 1e-4);
  }
  EXPECT_EQ(result.report.starts, 2);
  EXPECT_EQ(result.report.collapsed_starts, 0);
}

TEST(MultilevelEmbedding, SameBitsForAnyNumberOfThreads) {
  // More nodes than single passes need to be shared among threads.
  const Cloud cloud = dentedCloud(60000);
  const GraphHierarchy hierarchy = buildGraphHierarchy(cloud.graph, 1);
  for (const EdgeWeights weights : {EdgeWeights::Adaptive, EdgeWeights::Uniform}) {
    Setting options = converging(1e-7, weights);
    options.threads = 1;
    const Embedding one = embedByLevels(cloud.graph, hierarchy, options);
    options.threads = 3;
    const Embedding three = embedByLevels(cloud.graph, hierarchy, options);
    EXPECT_EQ(one.directions, three.directions);
    EXPECT_EQ(one.report.residuals, three.report.residuals);
    EXPECT_EQ(one.report.energy, three.report.energy);
  }
}

TEST(MultilevelEmbedding, GraphsOfAllSizes) {
  for (Index n = 4; n <= 40; ++n) {
    const Positions points = randomSphere(n, static_cast<std::uint64_t>(n));
    const Graph graph = graphOfMesh(points, triangulateSphere(points).triangles);
    const Embedding result = solve(graph, converging(1e-10), 4, 1);
    EXPECT_NE(result.report.stop_reason, StopReason::Unfinished) << n;
    if (result.report.stop_reason != StopReason::Collapsed) {
      ASSERT_EQ(result.directions.cols(), n);
      EXPECT_LT((result.directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14) << n;
    }
  }
  EXPECT_EQ(embed(Graph(), Positions(3, 0)).directions.cols(), 0);
}

TEST(MultilevelEmbedding, CollapsedStartsAreRejectedAndABarrierIsAdded) {
  // A path: nothing holds its ends apart.
  Graph path;
  constexpr Index n = 30;
  for (Index i = 0; i < n; ++i) {
    for (const Index j : {i - 1, i + 1})
      if (j >= 0 && j < n) {
        path.neighbors.push_back(j);
        path.lengths.push_back(1.0);
      }
    path.offsets.push_back(path.neighbors.size());
  }
  const Embedding result = solve(path);
  EXPECT_EQ(result.report.starts, 4);
  EXPECT_EQ(result.report.collapsed_starts, 2);
  EXPECT_TRUE(result.report.added_barrier);
  ASSERT_EQ(result.directions.cols(), n);
  EXPECT_LT(result.report.centroid_norm, 0.9);
  EXPECT_FALSE(solve(dentedCloud(2000).graph).report.added_barrier);
}

TEST(MultilevelEmbedding, OpenSurfacesDoNotSlipOffTheSphere) {
  // The lower two thirds of a sphere: the rim is a hole to pull the sphere through.
  const Cloud cloud = dentedCloud(3000);
  const Index kept = 2000;
  Graph open;
  for (std::size_t i = 1000; i < 3000; ++i) {
    for (std::size_t e = cloud.graph.offsets[i]; e < cloud.graph.offsets[i + 1]; ++e)
      if (cloud.graph.neighbors[e] >= 1000) {
        open.neighbors.push_back(cloud.graph.neighbors[e] - 1000);
        open.lengths.push_back(cloud.graph.lengths[e]);
      }
    open.offsets.push_back(open.neighbors.size());
  }
  const std::array<Setting, 2> all_options = {Setting(), converging(1e-9)};
  for (const Setting& options : all_options) {
    const Embedding result = solve(open, options);
    ASSERT_EQ(result.directions.cols(), kept);
    EXPECT_LT(result.report.centroid_norm, 0.95);
    EXPECT_LT(fractionBeyondTwoSteps(open, triangulateSphere(result.directions).triangles), 0.1);
  }
}

TEST(MultilevelEmbedding, ProgressIsReportedAndCancels) {
  const Cloud cloud = dentedCloud(3000);
  Setting options = converging(1e-9);
  int calls = 0;
  options.progress = [&](const Progress& progress) {
    EXPECT_GE(progress.fraction, 0.0);
    EXPECT_LE(progress.fraction, 1.0);
    ++calls;
    return true;
  };
  solve(cloud.graph, options);
  EXPECT_GT(calls, 5);
  for (int stop = 1; stop < calls; stop += 3) {
    int count = 0;
    options.progress = [&](const Progress&) { return ++count < stop; };
    EXPECT_THROW(solve(cloud.graph, options), Cancelled);
    EXPECT_EQ(count, stop);
  }
}

TEST(MultilevelEmbedding, OnlyTheCallingThreadReportsStarts) {
  const Cloud cloud = dentedCloud(1200);
  Setting options;
  options.starts = 5;
  options.threads = 1;
  const Embedding one = solve(cloud.graph, options, 1000, 1);
  const std::thread::id caller = std::this_thread::get_id();
  int calls = 0;
  options.threads = 3;
  options.progress = [&](const Progress&) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    ++calls;
    return true;
  };
  const Embedding several = solve(cloud.graph, options, 1000, 1);
  EXPECT_EQ(several.report.starts, 5);
  EXPECT_EQ(several.directions, one.directions);
  EXPECT_EQ(several.report.levels.back().newton_iterations,
            one.report.levels.back().newton_iterations);
  for (int last = 0; last < calls; last += 3) {
    int left = last;
    options.progress = [&](const Progress&) { return left-- > 0; };
    EXPECT_THROW(solve(cloud.graph, options, 1000, 1), Cancelled);
  }
}

}  // namespace
}  // namespace spherical_param
