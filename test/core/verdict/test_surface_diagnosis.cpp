#include "surface_diagnosis.h"

#include "graphs.h"
#include "handle_shapes.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::test {
namespace {

/// A cloud to diagnose, with a mesh that is a sphere and a graph that shows what the cloud is.
struct Scene {
  Positions points;
  Triangles triangles;
  NeighborGraph graph;
};

/// Two spheres, joined by a tube of six triangles.
Scene joinedSpheres(Index n, Index m, double distance) {
  const Triangles of_a = triangulateSphere(spiralSphere(n));
  const Triangles of_b = triangulateSphere(spiralSphere(m)).array() + n;
  Scene scene{horizontally(spiralSphere(n), movedTo(distance, spiralSphere(m))),
              Triangles(3, of_a.cols() + of_b.cols() + 4),
              {}};
  const Eigen::Vector3i p = of_a.col(of_a.cols() - 1);
  const Eigen::Vector3i q = of_b.col(of_b.cols() - 1);
  const Eigen::Index tube = of_a.cols() + of_b.cols() - 2;
  scene.triangles.leftCols(tube) << of_a.leftCols(of_a.cols() - 1), of_b.leftCols(of_b.cols() - 1);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    scene.triangles.col(tube + 2 * k) << p[k], p[next], q[(3 - k) % 3];
    scene.triangles.col(tube + 2 * k + 1) << p[next], q[(3 - next) % 3], q[(3 - k) % 3];
  }
  scene.graph = localDelaunayGraph(scene.points);
  return scene;
}

/// A sphere under a mesh of shuffled vertices.
Scene foldedSphere() {
  const Positions points = spiralSphere(1000);
  const std::vector<Index> shuffled = shuffledRange(1000, 3);
  return {points, triangulateSphere(points).unaryExpr([&](Index v) {
            return shuffled[static_cast<std::size_t>(v)];
          }),
          localDelaunayGraph(points)};
}

SurfaceDiagnosis diagnose(const Scene& scene, const DiagnosisOptions& options = {}) {
  return diagnoseSurface(scene.points, scene.triangles, scene.graph.graph, scene.graph.bridges,
                         options, 1);
}

TEST(SurfaceDiagnosis, EdgesOutsideTheGraphAreCounted) {
  // The tube between two spheres is too small for a fold.
  for (const auto& [scene, is_folded] :
       {std::pair(joinedSpheres(60, 40, 3.5), false), {foldedSphere(), true}}) {
    const SurfaceDiagnosis diagnosis = diagnose(scene);
    EXPECT_GT(diagnosis.edges_outside_graph, is_folded ? 0.5 : 0.0);
    EXPECT_DOUBLE_EQ(diagnosis.edges_outside_graph,
                     fractionBeyondTwoSteps(scene.graph.graph, scene.triangles));
    EXPECT_EQ(diagnosis.isFolded(), is_folded);
  }
}

TEST(SurfaceDiagnosis, PartsAreCountedWithGapAndPlace) {
  const Index n = 600;
  const Index m = 400;
  const Scene scene = joinedSpheres(n, m, 3.5);
  ASSERT_TRUE(isSphereOverAll(scene.triangles, n + m));
  const SurfaceDiagnosis diagnosis = diagnose(scene);
  EXPECT_EQ(diagnosis.joined_parts, 2U);
  ASSERT_EQ(diagnosis.bridges.size(), 1U);
  const PartBridge& bridge = diagnosis.bridges.front();
  EXPECT_EQ(bridge.points, static_cast<std::size_t>(m));
  EXPECT_EQ(bridge.other_points, static_cast<std::size_t>(n));
  double gap = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < n; ++i)
    for (Index j = n; j < n + m; ++j)
      gap = std::min(gap, (scene.points.col(i) - scene.points.col(j)).norm());
  EXPECT_DOUBLE_EQ(bridge.gap, gap);
  EXPECT_NEAR(bridge.spacing, sphereSpacing(m), 0.3 * sphereSpacing(m));
  // In the middle between the two, to within the distance of the points.
  EXPECT_LT((bridge.center - Eigen::Vector3d(1.75, 0.0, 0.0)).norm(), 2.0 * sphereSpacing(m));
  std::set<Index> ends;
  for (const Bridge& edge : scene.graph.bridges)
    ends.insert({edge.from, edge.to});
  EXPECT_EQ(bridge.vertices, std::vector<Index>(ends.begin(), ends.end()));
}

TEST(SurfaceDiagnosis, ListsAreShortenedAndMarksAreComplete) {
  const Scene scene = joinedSpheres(600, 400, 3.5);
  DiagnosisOptions options;
  options.max_vertices = 4;
  const SurfaceDiagnosis few = diagnose(scene, options);
  EXPECT_TRUE(few.triangle_marks.empty());
  options.max_vertices = 100000;
  options.mark_triangles = true;
  const SurfaceDiagnosis all = diagnose(scene, options);
  const std::vector<Index>& some = few.bridges.at(0).vertices;
  const std::vector<Index>& of = all.bridges.at(0).vertices;
  ASSERT_GT(of.size(), 4U);
  EXPECT_EQ(some.size(), 4U);
  EXPECT_TRUE(std::includes(of.begin(), of.end(), some.begin(), some.end()));
  // The marks of bridges are those of the triangles at their vertices.
  for (Eigen::Index t = 0; t < scene.triangles.cols(); ++t) {
    bool is_at_bridge = false;
    for (const Index v : scene.triangles.col(t))
      is_at_bridge = is_at_bridge || std::binary_search(of.begin(), of.end(), v);
    const std::uint8_t marks = all.triangle_marks[static_cast<std::size_t>(t)];
    EXPECT_EQ((marks & triangle_mark::part_bridge) != 0, is_at_bridge);
    EXPECT_EQ((marks & triangle_mark::outside_graph) != 0,
              fractionBeyondTwoSteps(scene.graph.graph, scene.triangles.col(t)) > 0.0);
  }
}

TEST(SurfaceDiagnosis, OneSideNeedsAMeshThatIsTornWhereItTurnsOver) {
  const int rings = 160;
  const int across = 12;
  const Positions band = moebiusBand(rings, across);
  Triangles torn(3, 2 * (rings - 1) * (across - 1));
  Eigen::Index t = 0;
  for (int i = 0; i + 1 < rings; ++i)
    for (int j = 0; j + 1 < across; ++j) {
      const int a = i * across + j;
      torn.col(t++) << a, a + across, a + 1;
      torn.col(t++) << a + 1, a + across, a + across + 1;
    }
  DiagnosisOptions options;
  const auto is_one_sided = [&](const Positions& points, const Triangles& triangles) {
    return diagnose({points, triangles, localDelaunayGraph(points)}, options).is_one_sided;
  };
  EXPECT_FALSE(is_one_sided(band, torn));
  options.may_be_one_sided = true;
  EXPECT_TRUE(is_one_sided(band, torn));
  // The two sides of a thin plate are no single sheet.
  const Positions plate = Eigen::Vector3d(1.0, 1.0, 0.05).asDiagonal() * spiralSphere(1200);
  EXPECT_FALSE(is_one_sided(plate, triangulateSphere(spiralSphere(1200))));
}

}  // namespace
}  // namespace spherical_param::test
