#include "glue.h"

#include "graphs.h"
#include "sphere_mesh.h"

namespace spherical_param::test {
namespace {

constexpr Index kTubeRings = 8;
constexpr Index kTubeAround = 7;
constexpr Index kNodes = kTubeRings * kTubeAround;
constexpr Index kLeft = kNodes + kTubeAround;  // the virtual node of the left rim
constexpr Index kVertices = kNodes + kTubeAround + 2;

/// The tube of the cut torus, with a virtual node over each rim.
Triangles cappedTube() {
  const Triangles torus = torusTriangles(kTubeRings, kTubeAround);
  Triangles tube(3, torus.cols() + 2 * kTubeAround);
  for (Eigen::Index t = 0; t < torus.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      // The triangles of the last ring end at the right copies.
      const Index v = torus(k, t);
      tube(k, t) = t >= torus.cols() - 2 * kTubeAround && v < kTubeAround ? v + kNodes : v;
    }
  for (Index k = 0; k < kTubeAround; ++k) {
    const Index next = (k + 1) % kTubeAround;
    tube.col(torus.cols() + 2 * k) << k, next, kLeft;
    tube.col(torus.cols() + 2 * k + 1) << kNodes + next, kNodes + k, kLeft + 1;
  }
  return tube;
}

/// A torus of the triangles of a tube, cut along its ring 0, whose right copies follow the nodes.
CutGraph cutTorus(const Triangles& tube) {
  CutGraph cut;
  cut.points = spiralSphere(kLeft);
  for (Index v = 0; v < kLeft; ++v)
    cut.node_of.push_back(v % kNodes);
  // The surface is on the left of the ring from ring 0 to ring 1, and of the right copies, from the
  // last ring to them.
  cut.rims = {range(0, kTubeAround), range(kNodes, kLeft)};
  std::reverse(cut.rims[0].begin(), cut.rims[0].end());
  std::vector<std::pair<Index, Index>> edges;
  for (const auto& [v, w] : sidesOf(tube))
    if (v < kLeft && w < kLeft)
      edges.emplace_back(v, w);
  cut.graph = unitGraph(kLeft, edges);
  return cut;
}

TEST(Glue, ACutTorusIsTheTorusAgainAndNothingElse) {
  const Triangles tube = cappedTube();
  ASSERT_TRUE(isSphereOverAll(tube, kVertices));
  const CutGraph cut = cutTorus(tube);
  const auto torus = canonical(torusTriangles(kTubeRings, kTubeAround));
  const std::optional<Triangles> glued = glue(kNodes, cut, tube, 1, kVertices);
  ASSERT_TRUE(glued);
  EXPECT_EQ(canonical(*glued), torus);
  // Also a sphere that came out as a mirror image.
  const Triangles mirrored = tube(std::vector{1, 0, 2}, Eigen::all);
  const std::optional<Triangles> turned = glue(kNodes, cut, mirrored, 1, kVertices);
  ASSERT_TRUE(turned);
  EXPECT_EQ(canonical(*turned), torus);
  // With two spheres there would be no handle, with another node one would be in no triangle.
  EXPECT_FALSE(glue(kNodes, cut, tube, 2, kVertices));
  EXPECT_FALSE(glue(kNodes + 1, cut, tube, 1, kVertices));
}

TEST(Glue, LostRimsAreRecovered) {
  const Triangles tube = cappedTube();
  const CutGraph cut = cutTorus(tube);
  std::mt19937 random(4);
  int recovered = 0;
  for (int trial = 0; trial < 50; ++trial) {
    SphereMesh mesh(tube, kVertices);
    for (int flips = 0; flips < 12; ++flips)
      mesh.flip(static_cast<Index>(random() % static_cast<unsigned>(mesh.size())),
                static_cast<int>(random() % 3));
    const std::optional<Triangles> glued = glue(kNodes, cut, mesh.triangles(), 1, kVertices);
    if (!glued)
      continue;
    ++recovered;
    EXPECT_TRUE(isSurfaceOverAll(*glued, kNodes, 1));
  }
  EXPECT_GE(recovered, 45);
}

}  // namespace
}  // namespace spherical_param::test
