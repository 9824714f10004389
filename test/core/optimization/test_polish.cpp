#include "polish.h"

#include "helpers.h"
#include "optimization_cases.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

Triangles polished(const Case& of, double alignment, double unevenness) {
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
  internal::polish(bench, {alignment, unevenness});
  return bench.mesh.mesh().triangles();
}

/// Flips alone.
Triangles flipped(const Case& of, double alignment, double unevenness) {
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
  internal::flipFor(bench, {alignment, unevenness}, 0.8);
  return bench.mesh.mesh().triangles();
}

TEST(Polish, RelocatesVerticesOfUnevenSamplingsAlone) {
  const Case of = noisySphere(300, 0.5, 2);
  EXPECT_EQ(polished(of, 0.1, 0.1), flipped(of, 0.1, 0.1));
  EXPECT_NE(polished(of, 0.4, 0.1), flipped(of, 0.4, 0.1));
  EXPECT_NE(polished(of, 0.1, 0.4), flipped(of, 0.1, 0.4));
}

TEST(Polish, EndsWhenNoFlipGainsByTheEnergyOfTheSampling) {
  const Case of = noisySphere(300, 0.5, 2);
  const auto expect_least = [&](const Triangles& result, Bend bend, double mu) {
    EXPECT_TRUE(isSphereOverAll(result, 300));
    Case again = of;
    again.triangles = result;
    internal::EnergyMesh mesh = meshOf(again, bend, mu);
    EXPECT_EQ(internal::Flips(mesh).flipAll(), 0U);
  };
  expect_least(polished(of, 0.1, 0.1), Bend::Excess, 4.0);
  expect_least(polished(of, 0.4, 0.1), Bend::Power, 0.8);
  expect_least(polished(of, 0.1, 0.4), Bend::Power, 0.8);
}

}  // namespace
}  // namespace spherical_param::test
