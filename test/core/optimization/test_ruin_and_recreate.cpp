#include "ruin_and_recreate.h"

#include "optimization_cases.h"

namespace spherical_param::test {
namespace {

TEST(RuinAndRecreate, MovesThatGainAreKeptAndOthersLeaveTheMesh) {
  int relocated = 0;
  int recreated = 0;
  for (const Case& of : roughCases())
    for (const Bend bend : {Bend::Angle, Bend::Power, Bend::Excess}) {
      EnergyMesh mesh = meshOf(of, bend, 0.8);
      Flips flips(mesh);
      RuinAndRecreate ruins(mesh, flips, 4);
      flips.flipAll();
      // Whether a move was kept, which takes a gain.
      const auto is_kept = [&](const auto& move) {
        const Triangles triangles = mesh.mesh().triangles();
        const double before = energyOf(of.points, triangles, bend, 0.8);
        if (!move()) {
          EXPECT_EQ(mesh.mesh().triangles(), triangles);
          return 0;
        }
        EXPECT_LT(energyOf(of.points, mesh.mesh().triangles(), bend, 0.8), before * (1.0 + 1e-9));
        return 1;
      };
      const auto n = static_cast<Index>(of.points.cols());
      for (Index v = 0; v < n; v += 3)
        relocated += is_kept([&] { return ruins.recreate({v}, isGain); });
      for (Index v = 0; v < n; v += 7)
        recreated += is_kept([&] { return ruins.recreate(ruins.spread({v}, 12), isGain); });
      EXPECT_TRUE(isSphereOverAll(mesh.mesh().triangles(), n));
    }
  EXPECT_GT(relocated, 50);
  EXPECT_GT(recreated, 20);
}

TEST(RuinAndRecreate, TheCallerDecidesWhatIsAccepted) {
  const Case of = noisySphere(300, 0.5, 2);
  EnergyMesh mesh = meshOf(of);
  Flips flips(mesh);
  RuinAndRecreate ruins(mesh, flips, 4);
  for (std::size_t size = 1; size <= 256; size *= 2) {
    const std::vector<Index> part = ruins.spread({static_cast<Index>(size)}, size);
    const Triangles before = mesh.mesh().triangles();
    const double energy = energyOf(of.points, before);
    EXPECT_FALSE(ruins.recreate(part, [](double) { return false; }));
    EXPECT_EQ(mesh.mesh().triangles(), before);
    double change = 0.0;
    ruins.recreate(part, [&](double reported) {
      change = reported;
      return true;
    });
    EXPECT_NEAR(energyOf(of.points, mesh.mesh().triangles()) - energy, change * mesh.unit(),
                1e-7 * energy);
    EXPECT_TRUE(isSphereOverAll(mesh.mesh().triangles(), 300));
  }
}

}  // namespace
}  // namespace spherical_param::test
