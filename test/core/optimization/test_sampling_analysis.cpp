#include "sampling_analysis.h"

#include "graphs.h"

namespace spherical_param::test {
namespace {

/// A grid on the side of a cylinder of radius 1.
Positions cylinderGrid(int around, int along, double spacing_along) {
  return gridOf(along, around, [=](int i, int j) {
    return onCircle(2.0 * kPi * j / around, 1.0, spacing_along * i);
  });
}

Sampling samplingOf(const Positions& points) {
  return analyzeSampling(points, localDelaunayGraph(points).graph, 1);
}

TEST(SamplingAnalysis, AlignmentShowsWhetherPointsAreFartherApartWhereTheSurfaceBendsLess) {
  // A cylinder bends around its axis only: long spacings along it follow the curvature.
  const double spacing = 2.0 * kPi / 40;
  EXPECT_GT(samplingOf(cylinderGrid(40, 25, 2.0 * spacing)).alignment, 0.9);
  EXPECT_LT(samplingOf(cylinderGrid(40, 40, 0.5 * spacing)).alignment, -0.9);
  // A sphere bends in all directions alike: what is measured is chance.
  EXPECT_LT(samplingOf(randomSphere(1200, 30)).alignment, 0.15);
}

TEST(SamplingAnalysis, UnevennessIsTheSpreadOfDistances) {
  // On a line of points 1 and 3 apart by turns: mean 2, standard deviation 1, except at the ends.
  Positions line = Positions::Zero(3, 100);
  Graph graph;
  for (Index i = 0; i < 100; ++i) {
    line(0, i) = 2 * i - i % 2;
    for (const Index j : {i - 1, i + 1})
      if (j >= 0 && j < 100) {
        graph.neighbors.push_back(j);
        graph.lengths.push_back((i + j) / 2 % 2 == 0 ? 1.0 : 3.0);
      }
    graph.offsets.push_back(graph.neighbors.size());
  }
  const Sampling sampling = analyzeSampling(line, graph, 1);
  EXPECT_NEAR(sampling.unevenness, 0.98 * 0.5, 1e-12);
  // Two steps along the line have four points: too few for a quadric.
  EXPECT_EQ(sampling.alignment, 0.0);
}

TEST(SamplingAnalysis, NothingToCompareIsNoAlignment) {
  // No points, and all in one place: no lengths, no tangent plane.
  Graph graph = localDelaunayGraph(spiralSphere(100)).graph;
  std::fill(graph.lengths.begin(), graph.lengths.end(), 0.0);
  for (const Sampling& sampling : {analyzeSampling(Positions(3, 0), Graph(), 1),
                                   analyzeSampling(Positions::Zero(3, 100), graph, 1)}) {
    EXPECT_EQ(sampling.alignment, 0.0);
    EXPECT_EQ(sampling.unevenness, 0.0);
  }
}

}  // namespace
}  // namespace spherical_param::test
