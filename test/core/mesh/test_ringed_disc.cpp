#include "ringed_disc.h"

#include "boundary_loops.h"
#include "helpers.h"
#include "spherical_param/mesh_topology.h"

namespace spherical_param::test {
namespace {

std::vector<double> evenRim(std::size_t size) {
  std::vector<double> angles;
  for (std::size_t i = 0; i < size; ++i)
    angles.push_back(2.0 * kPi * static_cast<double>(i) / static_cast<double>(size));
  return angles;
}

TEST(RingedDisc, IsADiscBelowItsRim) {
  std::vector<std::vector<double>> rims;
  for (const std::size_t size : {3U, 4U, 9U, 10U, 11U, 64U, 1001U})
    rims.push_back(evenRim(size));
  // All but one of the vertices close together, two of them in one place.
  std::vector<double> uneven = {0.0, 0.0};
  for (int i = 0; i < 60; ++i)
    uneven.push_back(0.001 * i + 0.001);
  uneven.push_back(4.0);
  rims.push_back(uneven);
  for (const std::vector<double>& rim : rims) {
    const RingedDisc disc = ringedDisc(rim);
    const std::size_t count = disc.radii.size();
    ASSERT_EQ(disc.angles.size(), count);
    EXPECT_LE(count, 7 * rim.size() / 2 + 10);
    EXPECT_GE(count, rim.size() < 40 ? rim.size() + 1 : 3 * rim.size());
    EXPECT_TRUE(std::is_sorted(disc.radii.rbegin(), disc.radii.rend()));
    EXPECT_EQ(disc.radii.back(), 0.0);
    const MeshTopology topology = checkTopology(disc.triangles, count);
    EXPECT_TRUE(topology.isOpenSurface());
    EXPECT_EQ(topology.euler_characteristic, 1);
    // The surface outside goes round the rim in the order of the angles, the disc against it.
    const auto loops = boundaryLoops(disc.triangles, count);
    ASSERT_EQ(loops.size(), 1U);
    ASSERT_EQ(loops[0].size(), rim.size());
    for (std::size_t i = 0; i < rim.size(); ++i)
      EXPECT_EQ(loops[0][i], static_cast<Index>((rim.size() - i) % rim.size()));
  }
}

TEST(RingedDisc, HasEdgesThatGrowTowardsThePole) {
  const RingedDisc disc = ringedDisc(evenRim(4));
  ASSERT_EQ(disc.radii.size(), 5U);
  EXPECT_NEAR(disc.distance(0, 1), std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(disc.distance(0, 2), 2.0, 1e-15);
  EXPECT_NEAR(disc.distance(3, 4), 1.0, 1e-15);
  // A ring of 70 in one of 100: 1 - pi / 100 over 1 + pi / 70.
  const RingedDisc large = ringedDisc(evenRim(100));
  EXPECT_NEAR(large.radii[100], (1.0 - kPi / 100) / (1.0 + kPi / 70), 1e-15);
  EXPECT_GT(large.distance(100, 101), 1.3 * large.distance(0, 1));
}

}  // namespace
}  // namespace spherical_param::test
