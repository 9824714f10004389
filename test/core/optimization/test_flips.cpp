#include "flips.h"

#include "optimization_cases.h"

namespace spherical_param::test {
namespace {

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

TEST(Flips, AroundAFlippedEdgeFlipItBack) {
  const Case of = ellipsoid(200, 0.8, 0.6);
  EnergyMesh mesh = meshOf(of);
  Flips flips(mesh);
  flips.flipAll();
  const double least = energyOf(of.points, mesh.mesh().triangles());
  int flipped = 0;
  for (Index t = 0; t < mesh.mesh().size(); t += 10) {
    const Index o = mesh.mesh().neighbor(t, 0);
    flipped += mesh.flip(t, 0, mesh.flipGain(t, 0, -1e9)) ? 1 : 0;
    flips.flipAround({t, o});
    EXPECT_LE(energyOf(of.points, mesh.mesh().triangles()), least * (1.0 + 1e-9));
  }
  EXPECT_GT(flipped, 10);
}

}  // namespace
}  // namespace spherical_param::test
