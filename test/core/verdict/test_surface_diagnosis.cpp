#include "surface_diagnosis.h"

#include "graphs.h"
#include "open_shapes.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::test {
namespace {

/// A cloud to diagnose, with a mesh that is a sphere and a graph that shows what the cloud is.
struct Scene {
  Positions points;
  Triangles triangles;
  NeighborGraph graph;
};

/// A star-shaped cloud and its mesh: the convex hull of the directions.
Scene starShaped(const Positions& directions, const Positions& points) {
  return {points, triangulateSphere(directions), localDelaunayGraph(points)};
}

/// A sphere without the cap beyond x = height.
Scene openSphere(Index n, double height) {
  const Positions open =
      pointsWhere(spiralSphere(n), [&](const Eigen::Vector3d& p) { return p.x() < height; });
  return starShaped(open, open);
}

/// A torus whose mesh is cut through the tube and closed by two flat discs there: a sphere. The
/// graph is that of the whole torus; 2 x ring of its edges cross the cut.
Scene cutTorus(int rings, int ring, double tube_radius) {
  const auto n = static_cast<Index>(rings * ring);
  Scene torus{{}, Triangles(3, 2 * n - 4), {}};
  torus.points = gridOf(rings, ring, [=](int r, int k) {
    const double angle = 2.0 * kPi * k / ring;
    return onCircle(2.0 * kPi * r / rings, 1.0 + tube_radius * std::cos(angle),
                    tube_radius * std::sin(angle));
  });
  const Triangles whole = torusTriangles(rings, ring);
  // The last ring of quads makes place for two polygons, cut in zigzag.
  const Index kept = 2 * (n - ring);
  torus.triangles.leftCols(kept) = whole.leftCols(kept);
  Eigen::Index t = kept;
  for (int low = 0, high = ring - 1; high - low >= 2;) {
    const Index next = low <= ring - 1 - high ? low + 1 : high - 1;
    torus.triangles.col(t++) << low, next, high;
    torus.triangles.col(t++) << n - ring + low, n - ring + high, n - ring + next;
    (next == low + 1 ? low : high) = next;
  }
  torus.graph.graph = graphOfMesh(torus.points, whole);
  return torus;
}

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

/// The same scene under a mesh of shuffled vertices.
Scene folded(Scene scene) {
  const std::vector<Index> shuffled = shuffledRange(scene.points.cols(), 3);
  scene.triangles =
      scene.triangles.unaryExpr([&](Index v) { return shuffled[static_cast<std::size_t>(v)]; })
          .eval();
  return scene;
}

/// The openings of the graph are filled.
SurfaceDiagnosis diagnose(const Scene& scene, const DiagnosisOptions& options = {}) {
  std::vector<Opening> openings = openingsOf(scene.points, scene.graph.graph).openings;
  for (Opening& opening : openings)
    opening.is_filled = true;
  return diagnoseSurface(scene.points, scene.triangles, scene.graph.graph, scene.graph.bridges,
                         openings, options, 1);
}

void expectClosed(const char* what, const Scene& scene) {
  const SurfaceDiagnosis diagnosis = diagnose(scene);
  EXPECT_FALSE(diagnosis.isFolded()) << what;
  EXPECT_TRUE(diagnosis.bridges.empty()) << what;
  EXPECT_EQ(diagnosis.joined_parts, 0U) << what;
}

TEST(SurfaceDiagnosis, ClosedSurfacesRaiseNoAlarm) {
  const Positions even = spiralSphere(1200);
  expectClosed("even", starShaped(even, even));
  const Positions random = randomSphere(1200, 7);
  expectClosed("random", starShaped(random, random));
  const Positions cube = cubeGrid(13);
  expectClosed("cube", starShaped((cube.array() - 0.5).matrix().colwise().normalized(), cube));
  const Mesh tube = bentTube(12.0, 2.0, 20);
  expectClosed("tube", {tube.points, tube.triangles, localDelaunayGraph(tube.points)});
  expectClosed("4 times denser in one direction",
               starShaped(even, Eigen::Vector3d(4.0, 1.0, 1.0).asDiagonal() * even));
  Positions crowded = even;
  for (Eigen::Index i = 0; i < crowded.cols(); ++i) {
    // The Moebius transform of the sphere that scales the plane beneath by sqrt(12).
    const Eigen::Vector3d p = crowded.col(i);
    const Eigen::Vector2d plane = std::sqrt(12.0) * p.head<2>() / (1.0 - p.z());
    const double square = plane.squaredNorm();
    crowded.col(i) << 2.0 * plane / (square + 1.0), (square - 1.0) / (square + 1.0);
  }
  expectClosed("12 times denser at one end", starShaped(crowded, crowded));
  const int fine = 8 * 7 + 1;
  const Positions creased =
      pointsWhere(cubeGrid(fine).array() - 0.5, [&](const Eigen::Vector3d& p) {
        const Eigen::Array3i step = ((p.array() + 0.5) * (fine - 1)).round().cast<int>();
        return (step / 8 * 8 == step).all() || (step == 0 || step == fine - 1).count() >= 2;
      });
  expectClosed("8 times denser along edges", starShaped(creased.colwise().normalized(), creased));
}

TEST(SurfaceDiagnosis, FalseNeighborsOfThinSheetsAreNoFold) {
  const Positions directions = spiralSphere(1500);
  const Triangles hull = triangulateSphere(directions);
  const Positions points = Eigen::Vector3d(1.0, 1.0, 0.04).asDiagonal() * directions;
  // Edges from the top to the bottom, in the middle, where the way round is long.
  Triangles edges(3, 2 * hull.cols());
  edges << hull, hull;
  for (Eigen::Index t = hull.cols(); t < edges.cols(); ++t) {
    const Eigen::Vector3d p = points.col(edges(0, t));
    if (p.z() < 0.0 || p.head<2>().norm() > 0.3)
      continue;
    double nearest = 1.0;
    for (Index j = 0; j < points.cols(); ++j)
      if (points(2, j) < 0.0 && (points.col(j) - p).norm() < nearest) {
        nearest = (points.col(j) - p).norm();
        edges(2, t) = j;
      }
  }
  expectClosed("sheets", {points, hull, {graphOfMesh(points, edges), {}, {}}});
}

TEST(SurfaceDiagnosis, FilledOpeningsAreMarkedIfTheyAreCertain) {
  const Scene scene = openSphere(1000, 2.0);
  DiagnosisOptions options;
  options.mark_triangles = true;
  for (const double certainty : {0.9, 1.0})
    for (const bool is_flat : {false, true})
      for (const bool is_filled : {false, true}) {
        Opening opening;
        opening.certainty = certainty;
        opening.is_flat = is_flat;
        opening.is_filled = is_filled;
        if (is_filled)
          opening.triangles = {3, 5};
        const SurfaceDiagnosis diagnosis = diagnoseSurface(
            scene.points, scene.triangles, scene.graph.graph, {}, {opening}, options, 1);
        const bool is_fault = is_filled && opening.isCertain();
        ASSERT_EQ(diagnosis.triangle_marks.size(), columnCount(scene.triangles));
        for (std::size_t t = 0; t < diagnosis.triangle_marks.size(); ++t)
          EXPECT_EQ(diagnosis.triangle_marks[t],
                    is_fault && (t == 3 || t == 5) ? triangle_mark::filled_hole : 0);
      }
}

TEST(SurfaceDiagnosis, EdgesOutsideTheGraphAreCounted) {
  // Of a cut torus those over the cut, which are too few for a fold.
  const Scene torus = cutTorus(60, 24, 0.4);
  ASSERT_TRUE(isSphereOverAll(torus.triangles, static_cast<Index>(torus.points.cols())));
  for (const auto& [scene, is_folded] :
       {std::pair(torus, false), {folded(torus), true}, {folded(openSphere(1000, 2.0)), true}}) {
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
  for (const Scene& scene : {cutTorus(60, 24, 0.4), joinedSpheres(600, 400, 3.5)}) {
    DiagnosisOptions options;
    options.max_vertices = 7;
    const SurfaceDiagnosis few = diagnose(scene, options);
    EXPECT_TRUE(few.triangle_marks.empty());
    options.max_vertices = 100000;
    options.mark_triangles = true;
    const SurfaceDiagnosis all = diagnose(scene, options);
    const auto expect_marked = [&](std::uint8_t mark, const auto& is_expected) {
      for (Eigen::Index t = 0; t < scene.triangles.cols(); ++t)
        EXPECT_EQ((all.triangle_marks[static_cast<std::size_t>(t)] & mark) != 0, is_expected(t));
    };
    // The marks of bridges are those of the triangles at their vertices.
    const auto expect_listed = [&](const auto& shortened, const auto& complete, std::uint8_t mark) {
      std::set<Index> at;
      for (std::size_t i = 0; i < complete.size(); ++i) {
        const std::vector<Index>& some = shortened[i].vertices;
        const std::vector<Index>& of = complete[i].vertices;
        EXPECT_EQ(some.size(), std::min<std::size_t>(7, of.size()));
        EXPECT_TRUE(std::is_sorted(of.begin(), of.end()));
        EXPECT_TRUE(std::includes(of.begin(), of.end(), some.begin(), some.end()));
        at.insert(of.begin(), of.end());
      }
      expect_marked(mark, [&](Eigen::Index t) {
        const auto corners = scene.triangles.col(t);
        return at.count(corners[0]) + at.count(corners[1]) + at.count(corners[2]) > 0;
      });
    };
    expect_listed(few.bridges, all.bridges, triangle_mark::part_bridge);
    expect_marked(triangle_mark::outside_graph, [&](Eigen::Index t) {
      return fractionBeyondTwoSteps(scene.graph.graph, scene.triangles.col(t)) > 0.0;
    });
  }
}

}  // namespace
}  // namespace spherical_param::test
