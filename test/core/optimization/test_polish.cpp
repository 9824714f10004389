#include "polish.h"

#include "helpers.h"
#include "optimization_cases.h"

#include <gtest/gtest.h>

#include <vector>

namespace spherical_param::test {
namespace {

struct Flipped {
  Triangles triangles;
  std::vector<OptimizationPhase> phases;
};

Flipped polished(const Case& of, double alignment, double unevenness) {
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
  internal::polish(bench, {alignment, unevenness});
  return {bench.mesh.mesh().triangles(), bench.log.phases};
}

TEST(Polish, EndsWhenNoFlipGainsByTheEnergyOfTheSampling) {
  const Case of = noisySphere(300, 0.5, 2);
  const auto expect_least = [&](const Flipped& flipped, Bend bend, double mu) {
    EXPECT_TRUE(isSphereOverAll(flipped.triangles, 300));
    Case again = of;
    again.triangles = flipped.triangles;
    internal::EnergyMesh mesh = meshOf(again, bend, mu);
    EXPECT_EQ(internal::Flips(mesh).flipAll(), 0U);
  };
  const Flipped even = polished(of, 0.1, 0.1);
  EXPECT_EQ(even.phases.size(), 1U);
  expect_least(even, Bend::Excess, 4.0);
  for (const Flipped& uneven : {polished(of, 0.4, 0.1), polished(of, 0.1, 0.4)}) {
    EXPECT_GE(uneven.phases.size(), 2U);
    EXPECT_EQ(uneven.phases[1].name, "relocate");
    expect_least(uneven, Bend::Power, 0.8);
  }
}

}  // namespace
}  // namespace spherical_param::test
