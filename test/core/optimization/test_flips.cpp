#include "flips.h"

#include "optimization_cases.h"

#include <stdexcept>

namespace spherical_param::test {
namespace {

/// Ends work that reports more often.
FractionReport reportUpTo(int most) {
  return [most, calls = 0](double) mutable {
    if (++calls > most)
      throw std::runtime_error("too many reports: it may go on forever");
  };
}

TEST(Flips, EndWhenNoFlipGains) {
  // By the energy of the whole mesh, flip by flip.
  for (const Bend bend : {Bend::Angle, Bend::Power, Bend::Excess})
    for (const std::uint64_t seed : {1U, 2U}) {
      const Case of = scrambledEllipsoid(60, 0.4, 80, seed);
      EnergyMesh mesh = meshOf(of, bend, 0.8);
      Flips flips(mesh);
      EXPECT_GT(flips.flipAll(), 0U);
      const Triangles flipped = mesh.mesh().triangles();
      EXPECT_TRUE(isSphereOverAll(flipped, 60));
      const double least = energyOf(of.points, flipped, bend, 0.8);
      EXPECT_LT(least, energyOf(of.points, of.triangles, bend, 0.8));
      int tried = 0;
      for (Index t = 0; t < flipped.cols(); ++t)
        for (int k = 0; k < 3; ++k) {
          SphereMesh other(flipped, 60);
          if (!other.flip(t, k))
            continue;
          ++tried;
          EXPECT_GT(energyOf(of.points, other.triangles(), bend, 0.8), least * (1.0 - 1e-7));
        }
      EXPECT_GT(tried, 200);
      EXPECT_EQ(flips.flipAll(), 0U);
    }
}

TEST(Flips, NoFlipIsMadeForRoundingAlone) {
  // Beside lengths this small, all that is rounded off looks like a gain: of the two diagonals of a
  // rectangle, each may gain on the other. Of 600,000 turned boxes it does on these.
  const Case cube = radialStart(cubeGrid(2));
  for (const std::uint64_t seed :
       {67289U, 88198U, 107940U, 132340U, 164943U, 270944U, 524909U, 559612U}) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.5, 2.0);
    const auto next = [&] {
      const double x = uniform(random);
      const double y = uniform(random);
      return Eigen::Vector3d(x, y, uniform(random));
    };
    Case of = scrambled(cube, 10, seed);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(uniform(random), next().normalized()).toRotationMatrix();
    of.points = (turn * next().asDiagonal() * cube.points).eval();
    std::fill(of.graph.lengths.begin(), of.graph.lengths.end(), 1e-30);
    EnergyMesh mesh = meshOf(of);
    EXPECT_NO_THROW(Flips(mesh).flipAll(reportUpTo(2)));
  }
}

TEST(Flips, EnergiesBeyondTheRangeOfDoubleAreNoGain) {
  // The difference of two of them is no number: the same flips were made for ever.
  for (const double scale : {1e100, 1e150, 1e160, 1e300})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Case of = scrambledEllipsoid(30, 0.4, 40, seed);
      std::mt19937_64 random(seed);
      for (Index v = 0; v < 30; ++v)
        if (random() % 2 == 0)
          of.points.col(v) *= scale;
      std::fill(of.graph.lengths.begin(), of.graph.lengths.end(), seed % 2 == 0 ? 1.0 : 1e200);
      EnergyMesh mesh = meshOf(of);
      EXPECT_NO_THROW(Flips(mesh).flipAll(reportUpTo(2)));
      EXPECT_TRUE(isSphereOverAll(mesh.mesh().triangles(), 30));
    }
}

}  // namespace
}  // namespace spherical_param::test
