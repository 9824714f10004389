#include "smoothing.h"

#include "graphs.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::test {
namespace {

constexpr SmoothingMethod kSmoothingMethods[] = {SmoothingMethod::Umbrella,
                                                 SmoothingMethod::Biharmonic};

Mesh noisyMesh(Index n, double noise, std::uint64_t seed) {
  const Positions sphere = spiralSphere(n);
  return {withNoise(sphere, noise, seed), triangulateSphere(sphere)};
}

double largestDifference(const Positions& a, const Positions& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

TEST(Smoothing, WavesOnARegularMeshAreMultipliedByTheGainOfTheirFrequency) {
  // On a torus of six neighbours each, plane waves are eigenvectors of the Laplacian. Of (8, 8) k
  // is 3/2, the most there can be: many steps would blow up what is amplified.
  constexpr Index m = 24;
  const Triangles triangles = torusTriangles(m, m);
  for (const int steps : {1, 20, 300}) {
    SCOPED_TRACE(steps);
    const double half_gain = 1.0 - std::pow(0.5, 1.0 / steps);
    for (const auto& [p, q] : {std::pair(0, 0), {2, 3}, {8, 8}}) {
      const double a = 2.0 * kPi * p / m;
      const double b = 2.0 * kPi * q / m;
      const double k = 1.0 - (std::cos(a) + std::cos(b) + std::cos(a + b)) / 3.0;
      const Positions points = gridOf(m, m, [=](int i, int j) {
        const double phase = a * i + b * j;
        return Eigen::Vector3d(std::cos(phase), std::sin(phase), std::cos(phase + 1.0));
      });
      SmoothingOptions options{SmoothingMethod::Umbrella, steps, false};
      EXPECT_LT(largestDifference(smoothSurface(points, triangles, options).points,
                                  std::pow(1.0 - k, steps) * points),
                1e-13);
      options.method = SmoothingMethod::Biharmonic;
      // The series is cut at 1e-7, twice with the gain at k = 0.
      EXPECT_LT(largestDifference(smoothSurface(points, triangles, options).points,
                                  std::exp2(-(k / half_gain) * (k / half_gain)) * points),
                5e-7);
    }
  }
}

TEST(Smoothing, OneStepOfTheUmbrellaMovesToTheMeanOfTheNeighbours) {
  const Mesh mesh = noisyMesh(100, 0.1, 5);
  const Graph graph = graphOfMesh(mesh.points, mesh.triangles);
  const Positions means = pointsAt(100, [&](Index i) -> Eigen::Vector3d {
    return mesh.points(Eigen::all, rowOf(graph, i)).rowwise().mean();
  });
  EXPECT_LT(
      largestDifference(
          smoothSurface(mesh.points, mesh.triangles, {SmoothingMethod::Umbrella, 1, false}).points,
          means),
      1e-14);
}

TEST(Smoothing, VolumeIsRestored) {
  const Mesh tube = bentTube(12.0, 2.0, 12);
  for (const Mesh& mesh :
       {noisyMesh(300, 0.05, 2), Mesh{withNoise(tube.points, 0.05, 3), tube.triangles}})
    for (const SmoothingMethod method : kSmoothingMethods)
      for (const int steps : {5, 20}) {  // after 20 Newton's method overshoots at first
        const double volume = volumeOf(mesh.points, mesh.triangles);
        const Smoothing smooth = smoothSurface(mesh.points, mesh.triangles, {method, steps});
        // Newton's method ends below 1e-12; the rest is the rounding of the sums.
        EXPECT_NEAR(volumeOf(smooth.points, mesh.triangles) / volume, 1.0, 1e-11);
        EXPECT_NEAR(smooth.report.volume_before / volume, 1.0, 1e-12);
        EXPECT_NEAR(smooth.report.volume_after / volume, 1.0, 1e-11);
      }
}

TEST(Smoothing, ReportedDisplacementsAreThoseOfThePointsOfTriangles) {
  const Mesh mesh = noisyMesh(200, 0.1, 7);
  const Positions stray{{0.5, 7.0}, {0.25, 8.0}, {0.125, 9.0}};
  for (const SmoothingMethod method : kSmoothingMethods) {
    const Smoothing smooth =
        smoothSurface(horizontally(mesh.points, stray), mesh.triangles, {method, 5});
    EXPECT_EQ(smooth.points.rightCols(2), stray);
    EXPECT_EQ(smooth.points.leftCols(200),
              smoothSurface(mesh.points, mesh.triangles, {method, 5}).points);
    const Eigen::ArrayXd moved =
        (smooth.points.leftCols(200) - mesh.points).colwise().norm().transpose().array();
    EXPECT_NEAR(smooth.report.max_displacement, moved.maxCoeff(), 1e-14);
    EXPECT_NEAR(smooth.report.mean_displacement, moved.mean(), 1e-13);
    EXPECT_NEAR(smooth.report.rms_displacement, std::sqrt(moved.square().mean()), 1e-13);
    EXPECT_GT(smooth.report.max_displacement, 0.01);
  }
}

TEST(Smoothing, ZeroStepsAndMeshesWithoutTrianglesOrVolume) {
  Mesh mesh = noisyMesh(80, 0.1, 8);
  mesh.points.array() += 0.1;
  Positions flat = mesh.points;
  flat.row(2).setZero();
  const Positions same = Positions::Constant(3, 80, 0.3);
  const Triangles two_sides{{0, 0}, {1, 2}, {2, 1}};
  for (const SmoothingMethod method : kSmoothingMethods) {
    const Smoothing none = smoothSurface(mesh.points, mesh.triangles, {method, 0});
    EXPECT_EQ(none.points, mesh.points);
    EXPECT_EQ(none.report.max_displacement, 0.0);
    EXPECT_EQ(none.report.volume_after, none.report.volume_before);
    EXPECT_NEAR(none.report.volume_before, volumeOf(mesh.points, mesh.triangles), 1e-12);
    for (const Index n : {0, 2}) {
      const Positions points = mesh.points.leftCols(n);
      EXPECT_EQ(smoothSurface(points, Triangles(3, 0), {method, 5}).points, points);
    }
    const Smoothing smooth = smoothSurface(flat, mesh.triangles, {method, 5});
    EXPECT_TRUE(smooth.points.allFinite());
    EXPECT_EQ(smooth.points.row(2).cwiseAbs().maxCoeff(), 0.0);
    EXPECT_LT(largestDifference(smoothSurface(same, mesh.triangles, {method, 5}).points, same),
              1e-15);
    EXPECT_TRUE(smoothSurface(mesh.points.leftCols(3), two_sides, {method, 5}).points.allFinite());
  }
}

}  // namespace
}  // namespace spherical_param::test
