#include "sampling_analysis.h"

#include "helpers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace spherical_param::internal {
namespace {

using test::kPi;

struct Sampled {
  Positions points;
  Graph graph;
};

/// A grid on a cylinder of radius 1 without ends, each point joined to the eight around it.
Sampled cylinderGrid(int around, int along, double spacing_along) {
  Sampled sampled{Positions(3, static_cast<Eigen::Index>(around) * along), {}};
  const auto number = [&](int a, int l) {
    return static_cast<Index>(l * around + (a + around) % around);
  };
  for (int l = 0; l < along; ++l)
    for (int a = 0; a < around; ++a) {
      const double angle = 2.0 * kPi * a / around;
      sampled.points.col(number(a, l)) << std::cos(angle), std::sin(angle), spacing_along * l;
    }
  for (int l = 0; l < along; ++l)
    for (int a = 0; a < around; ++a) {
      std::vector<Index> row;
      for (int dl = -1; dl <= 1; ++dl)
        for (int da = -1; da <= 1; ++da)
          if ((dl != 0 || da != 0) && l + dl >= 0 && l + dl < along)
            row.push_back(number(a + da, l + dl));
      std::sort(row.begin(), row.end());
      for (const Index j : row) {
        sampled.graph.neighbors.push_back(j);
        sampled.graph.lengths.push_back(
            (sampled.points.col(j) - sampled.points.col(number(a, l))).norm());
      }
      sampled.graph.offsets.push_back(sampled.graph.neighbors.size());
    }
  return sampled;
}

TEST(SamplingAnalysis, AlignmentShowsWhetherPointsAreFartherApartWhereTheSurfaceBendsLess) {
  // A cylinder bends around its axis only: long spacings along it follow the curvature.
  constexpr int around = 60;
  constexpr double spacing = 2.0 * kPi / around;
  const Sampled following = cylinderGrid(around, 20, 3.0 * spacing);
  EXPECT_GT(analyzeSampling(following.points, following.graph, 1).alignment, 0.95);
  const Sampled against = cylinderGrid(around, 60, spacing / 3.0);
  EXPECT_LT(analyzeSampling(against.points, against.graph, 1).alignment, -0.95);
}

TEST(SamplingAnalysis, EvenAndRandomSamplingsDoNotFollowTheCurvature) {
  // Independent points on a cylinder and on a torus, as many everywhere as there is area.
  constexpr int n = 1200;
  std::mt19937_64 random(28);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Positions cylinder(3, n);
  Positions torus(3, n);
  for (Index i = 0; i < n; ++i) {
    const double a = 2.0 * kPi * uniform(random);
    cylinder.col(i) << std::cos(a), std::sin(a), 4.0 * uniform(random);
    double b = 2.0 * kPi * uniform(random);
    while (1.4 * uniform(random) > 1.0 + 0.4 * std::cos(b))
      b = 2.0 * kPi * uniform(random);
    const double radius = 1.0 + 0.4 * std::cos(b);
    torus.col(i) << radius * std::cos(a), radius * std::sin(a), 0.4 * std::sin(b);
  }
  const auto sampling = [](const Positions& points) {
    return analyzeSampling(points, test::localDelaunayGraph(points).graph, 1);
  };
  EXPECT_NEAR(sampling(cylinder).alignment, 0.0, 0.15);
  EXPECT_NEAR(sampling(torus).alignment, 0.0, 0.15);
  // A sphere bends in all directions alike: what is measured is chance.
  const Sampling independent = sampling(test::randomSphere(n, 30));
  const Sampling even = sampling(test::spiralSphere(n));
  EXPECT_LT(independent.alignment, 0.15);
  EXPECT_LT(even.alignment, 0.15);
  EXPECT_GT(independent.unevenness, 0.3);
  EXPECT_LT(even.unevenness, 0.3);
  EXPECT_LT(sampling(test::cubeGrid(12)).unevenness, 0.3);
}

TEST(SamplingAnalysis, UnevennessIsTheSpreadOfDistances) {
  // On a line of points 1 and 3 apart by turns: mean 2, standard deviation 1, except at the ends.
  Sampled line{Positions::Zero(3, 100), {}};
  for (Index i = 1; i < 100; ++i)
    line.points(0, i) = line.points(0, i - 1) + (i % 2 == 0 ? 3.0 : 1.0);
  for (Index i = 0; i < 100; ++i) {
    for (const Index j : {i - 1, i + 1})
      if (j >= 0 && j < 100) {
        line.graph.neighbors.push_back(j);
        line.graph.lengths.push_back(std::abs(line.points(0, i) - line.points(0, j)));
      }
    line.graph.offsets.push_back(line.graph.neighbors.size());
  }
  const Sampling sampling = analyzeSampling(line.points, line.graph, 1);
  EXPECT_NEAR(sampling.unevenness, 0.98 * 0.5, 1e-12);
  // Two steps along the line have four points: too few for a quadric.
  EXPECT_EQ(sampling.alignment, 0.0);
}

TEST(SamplingAnalysis, NothingToCompareIsNoAlignment) {
  const Sampling none = analyzeSampling(Positions(3, 0), Graph(), 1);
  EXPECT_EQ(none.alignment, 0.0);
  EXPECT_EQ(none.unevenness, 0.0);
  // All in one place: no lengths, no tangent plane.
  Sampled place = cylinderGrid(10, 10, 0.1);
  place.points.setZero();
  place.graph.lengths.assign(place.graph.lengths.size(), 0.0);
  const Sampling same = analyzeSampling(place.points, place.graph, 1);
  EXPECT_EQ(same.alignment, 0.0);
  EXPECT_EQ(same.unevenness, 0.0);
}

TEST(SamplingAnalysis, SameBitsForAnyNumberOfThreads) {
  const Sampled sampled = cylinderGrid(60, 100, 0.07);
  const Sampling one = analyzeSampling(sampled.points, sampled.graph, 1);
  const Sampling several = analyzeSampling(sampled.points, sampled.graph, 3);
  EXPECT_NE(one.alignment, 0.0);
  EXPECT_EQ(one.alignment, several.alignment);
  EXPECT_EQ(one.unevenness, several.unevenness);
}

}  // namespace
}  // namespace spherical_param::internal
