#include "ringed_disc.h"

#include "boundary_loops.h"
#include "helpers.h"
#include "spherical_param/mesh_topology.h"

namespace spherical_param::test {
namespace {

std::vector<double> evenAngles(std::size_t size) {
  std::vector<double> angles;
  for (std::size_t i = 0; i < size; ++i)
    angles.push_back(2.0 * kPi * static_cast<double>(i) / static_cast<double>(size));
  return angles;
}

TEST(RingedDisc, IsADiscWithinItsBoundary) {
  std::vector<std::vector<double>> boundaries;
  for (const std::size_t size : {3U, 4U, 9U, 10U, 11U, 64U, 1001U})
    boundaries.push_back(evenAngles(size));
  // All but one of the vertices close together, two of them in one place.
  std::vector<double> uneven = {0.0, 0.0};
  for (int i = 0; i < 60; ++i)
    uneven.push_back(0.001 * i + 0.001);
  uneven.push_back(4.0);
  boundaries.push_back(uneven);
  for (const std::vector<double>& boundary : boundaries) {
    const RingedDisc disc = ringedDisc(boundary);
    const std::size_t count = disc.radii.size();
    ASSERT_EQ(disc.angles.size(), count);
    const std::size_t size = boundary.size();
    EXPECT_LE(count, 7 * size / 2 + 10);
    EXPECT_GE(count, size < 40 ? size + 1 : 3 * size);
    EXPECT_TRUE(std::is_sorted(disc.radii.rbegin(), disc.radii.rend()));
    EXPECT_EQ(disc.radii.back(), 0.0);
    const MeshTopology topology = checkTopology(disc.triangles, count);
    EXPECT_TRUE(topology.isOpenSurface());
    EXPECT_EQ(topology.euler_characteristic, 1);
    // A surface outside goes round the boundary in the order of the angles, the disc against it.
    std::vector<Index> loop = range(0, static_cast<Index>(size));
    std::reverse(loop.begin() + 1, loop.end());
    EXPECT_EQ(boundaryLoops(disc.triangles, count), std::vector<std::vector<Index>>{loop});
  }
}

}  // namespace
}  // namespace spherical_param::test
