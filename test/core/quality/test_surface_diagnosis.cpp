#include "spherical_param/surface_diagnosis.h"

#include "graph_cycles.h"
#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/sphere_triangulation.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace spherical_param {
namespace {

using test::graphOfMesh;
using test::isSphereOverAll;
using test::kPi;
using test::randomSphere;
using test::spiralSphere;

struct Scene {
  Positions points;
  Triangles triangles;
  NeighborGraph graph;
};

NeighborGraph localDelaunayGraph(const Positions& points) {
  return buildNeighborGraph(points, test::bruteForceNeighbors(points, 12), {},
                            test::bruteForceSearch(points));
}

/// A star-shaped cloud and its mesh: the convex hull of the directions.
Scene starShaped(const Positions& directions, const Positions& points) {
  return {points, triangulateSphere(directions, {TriangulationMethod::Incremental}).triangles,
          localDelaunayGraph(points)};
}

SurfaceDiagnosis diagnose(const Scene& scene, const DiagnosisOptions& options = {},
                          int threads = 0) {
  return diagnoseSurface(scene.points, scene.triangles, scene.graph.graph,
                         scene.graph.report.bridges, options, threads);
}

/// Distance of neighbours among so many even points on the unit sphere: a hexagonal grid has
/// sqrt(3) / 2 of its square of area for each point.
double sphereSpacing(Index points) {
  return std::sqrt(4.0 * kPi / (points * std::sqrt(3.0) / 2.0));
}

/// The columns for which keep(point) holds.
template <typename Keep>
Positions filtered(const Positions& points, const Keep& keep) {
  Positions result(3, points.cols());
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (keep(Eigen::Vector3d(points.col(i))))
      result.col(count++) = points.col(i);
  return result.leftCols(count);
}

void expectClosed(const Scene& scene) {
  const SurfaceDiagnosis diagnosis = diagnose(scene);
  EXPECT_EQ(diagnosis.kind, SurfaceKind::ClosedGenus0) << diagnosis.summary;
  EXPECT_TRUE(diagnosis.looksClosedGenus0());
  EXPECT_TRUE(diagnosis.filled_holes.empty() && diagnosis.handles.empty() &&
              diagnosis.bridges.empty());
  EXPECT_EQ(diagnosis.summary, "Looks like a closed genus-0 surface.");
}

TEST(SurfaceDiagnosis, ClosedSurfacesRaiseNoAlarm) {
  const Positions even = spiralSphere(1500);
  expectClosed(starShaped(even, even));
  const Positions random = randomSphere(1500, 7);
  expectClosed(starShaped(random, random));
  const Positions cube = test::cubeGrid(13);
  expectClosed(starShaped((cube.array() - 0.5).matrix().colwise().normalized(), cube));
  const test::Tube tube = test::bentTube(12.0, 2.0, 20);
  expectClosed({tube.points, tube.triangles, localDelaunayGraph(tube.points)});
}

TEST(SurfaceDiagnosis, UnevenSamplingRaisesNoAlarm) {
  const Positions even = spiralSphere(1500);
  // Distances of the points at the two ends that differ as 1 : 12, in all directions.
  Positions crowded = even;
  for (Eigen::Index i = 0; i < crowded.cols(); ++i) {
    // The Moebius transform of the sphere that scales the plane beneath by sqrt(12).
    const Eigen::Vector3d p = crowded.col(i);
    const Eigen::Vector2d plane = std::sqrt(12.0) * p.head<2>() / (1.0 - p.z());
    const double square = plane.squaredNorm();
    crowded.col(i) << 2.0 * plane / (square + 1.0), (square - 1.0) / (square + 1.0);
  }
  expectClosed(starShaped(crowded, crowded));
  // Four times denser in one direction than in the other.
  expectClosed(starShaped(even, Eigen::Vector3d(4.0, 1.0, 1.0).asDiagonal() * even));
}

/// Whether the loops of a filled hole are closed paths along edges of the mesh, each from its
/// lowest vertex, that have together the filled hole's boundary length and its rim.
void expectLoopsOfBoundary(const Scene& scene, const FilledHole& hole) {
  std::set<std::array<Index, 2>> edges;
  for (Eigen::Index t = 0; t < scene.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      edges.insert({scene.triangles(k, t), scene.triangles((k + 1) % 3, t)});
  double total = 0.0;
  double last = std::numeric_limits<double>::infinity();
  std::set<Index> rim;
  for (const std::vector<Index>& loop : hole.loops) {
    ASSERT_GE(loop.size(), 3U);
    EXPECT_EQ(loop.front(), *std::min_element(loop.begin(), loop.end()));
    double length = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Index a = loop[i];
      const Index b = loop[(i + 1) % loop.size()];
      EXPECT_EQ(edges.count({a, b}), 1U) << a << " " << b;
      length += (scene.points.col(a) - scene.points.col(b)).norm();
      rim.insert(a);
    }
    EXPECT_LE(length, last * (1.0 + 1e-12));
    total += last = length;
  }
  EXPECT_NEAR(total, hole.boundary_length, 1e-12 * total);
  EXPECT_EQ(std::vector<Index>(rim.begin(), rim.end()), hole.vertices);
}

/// Sum of the cross products along a loop: twice the area that it goes around, along the normal.
Eigen::Vector3d doubledArea(const Positions& points, const std::vector<Index>& loop) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i)
    sum += Eigen::Vector3d(points.col(loop[i]))
               .cross(Eigen::Vector3d(points.col(loop[(i + 1) % loop.size()])));
  return sum;
}

TEST(SurfaceDiagnosis, OpeningIsFoundWithPlaceAndSize) {
  for (const Index n : {800, 2000}) {
    const double spacing = sphereSpacing(n);
    for (const double across : {8.0, 10.0}) {
      const double radius = across * spacing / 2.0;
      const double height = std::sqrt(1.0 - radius * radius);
      const Positions open =
          filtered(spiralSphere(n), [&](const Eigen::Vector3d& p) { return p.x() < height; });
      const Scene scene = starShaped(open, open);
      const SurfaceDiagnosis diagnosis = diagnose(scene);
      EXPECT_EQ(diagnosis.kind, SurfaceKind::Open) << n << " " << across;
      ASSERT_EQ(diagnosis.filled_holes.size(), 1U) << n << " " << across;
      EXPECT_EQ(diagnosis.openings(), 1U);
      EXPECT_TRUE(diagnosis.handles.empty() && diagnosis.bridges.empty());
      const FilledHole& hole = diagnosis.filled_holes.front();
      EXPECT_EQ(hole.cause, SurfaceKind::Open);
      // The rim is ragged by up to one spacing outward, and its flat triangles may stay out.
      EXPECT_NEAR(hole.diameter, 2.0 * radius, 1.5 * spacing);
      EXPECT_NEAR(std::sqrt(4.0 * hole.area / kPi), 2.0 * radius, 2.0 * spacing);
      EXPECT_NEAR(hole.spacing, spacing, 0.3 * spacing);
      EXPECT_LT((hole.center - height * Eigen::Vector3d::UnitX()).norm(), spacing);
      EXPECT_GE(hole.triangles, hole.vertices.size() - 2);
      expectLoopsOfBoundary(scene, hole);
      ASSERT_EQ(hole.loops.size(), 1U);
      EXPECT_NE(
          diagnosis.summary.find("rim of " + std::to_string(hole.loops.front().size()) + " points"),
          std::string::npos)
          << diagnosis.summary;
      // Seen from outside, the loop goes around counter-clockwise.
      const Eigen::Vector3d doubled = doubledArea(open, hole.loops.front());
      EXPECT_GT(doubled.x(), 0.0);
      EXPECT_NEAR(doubled.norm() / 2.0, hole.area, 0.1 * hole.area);
      for (const Index v : hole.vertices) {
        const Eigen::Vector3d p = open.col(v);
        EXPECT_LT(p.x(), height);
        EXPECT_LT(p.tail<2>().norm(), radius + 1.5 * spacing);
      }
    }
  }
}

TEST(SurfaceDiagnosis, FilledHoleAroundAnIslandHasTwoLoops) {
  // A wide ring without points around a cap: the mesh bridges it all around.
  const Positions open = filtered(
      spiralSphere(3000), [](const Eigen::Vector3d& p) { return p.x() < 0.75 || p.x() > 0.97; });
  Scene scene = starShaped(open, open);
  // As one part, as if a few points had joined the cap to the rest.
  scene.graph.report.bridges.clear();
  DiagnosisOptions options;
  options.max_vertices = 100000;
  const SurfaceDiagnosis diagnosis = diagnose(scene, options);
  ASSERT_EQ(diagnosis.filled_holes.size(), 1U) << diagnosis.summary;
  const FilledHole& hole = diagnosis.filled_holes.front();
  expectLoopsOfBoundary(scene, hole);
  ASSERT_EQ(hole.loops.size(), 2U);
  EXPECT_GT(doubledArea(open, hole.loops[0]).x(), 0.0);
  EXPECT_LT(doubledArea(open, hole.loops[1]).x(), 0.0);
}

TEST(SurfaceDiagnosis, EveryOpeningIsCounted) {
  const Positions open = filtered(spiralSphere(1600), [&](const Eigen::Vector3d& p) {
    return p.x() < 0.9 && p.y() > -0.85 && p.z() > -0.8;
  });
  const SurfaceDiagnosis diagnosis = diagnose(starShaped(open, open));
  EXPECT_EQ(diagnosis.kind, SurfaceKind::Open);
  ASSERT_EQ(diagnosis.openings(), 3U) << diagnosis.summary;
  // By falling area.
  EXPECT_LT(diagnosis.filled_holes[0].center.z(), -0.75);
  EXPECT_LT(diagnosis.filled_holes[1].center.y(), -0.8);
  EXPECT_GT(diagnosis.filled_holes[2].center.x(), 0.85);
  EXPECT_NE(diagnosis.summary.find("3 openings"), std::string::npos) << diagnosis.summary;
  for (const FilledHole& hole : diagnosis.filled_holes)
    EXPECT_EQ(hole.loops.size(), 1U);
  EXPECT_EQ(diagnosis.summary, summaryOf(diagnosis));
}

/// A torus whose mesh is cut through the tube and closed by two flat discs there: a sphere.
/// The graph is that of the whole torus.
struct CutTorus {
  Scene scene;
  std::size_t torn = 0;    ///< edges of the graph across the cut
  Eigen::Vector3d center;  ///< of the cut
};

CutTorus cutTorus(int rings, int ring, double tube_radius) {
  const auto n = static_cast<Index>(rings * ring);
  CutTorus torus{{Positions(3, n), Triangles(3, 2 * n - 4), {}}, 0, Eigen::Vector3d::UnitX()};
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < ring; ++k) {
      const double around = 2.0 * kPi * r / rings;
      const double angle = 2.0 * kPi * k / ring;
      const double radius = 1.0 + tube_radius * std::cos(angle);
      torus.scene.points.col(r * ring + k) << radius * std::cos(around), radius * std::sin(around),
          tube_radius * std::sin(angle);
    }
  Triangles whole(3, 2 * n);
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < ring; ++k) {
      const Index a = r * ring + k;
      const Index b = r * ring + (k + 1) % ring;
      const Index c = (r + 1) % rings * ring + (k + 1) % ring;
      const Index d = (r + 1) % rings * ring + k;
      whole.col(2 * a) << a, d, c;
      whole.col(2 * a + 1) << a, c, b;
    }
  // The last ring of quads makes place for two polygons, cut in zigzag.
  const Index kept = 2 * (n - ring);
  torus.scene.triangles.leftCols(kept) = whole.leftCols(kept);
  Eigen::Index t = kept;
  for (int low = 0, high = ring - 1; high - low >= 2;) {
    const Index next = low <= ring - 1 - high ? low + 1 : high - 1;
    torus.scene.triangles.col(t++) << low, next, high;
    torus.scene.triangles.col(t++) << n - ring + low, n - ring + high, n - ring + next;
    (next == low + 1 ? low : high) = next;
  }
  torus.scene.graph.graph = graphOfMesh(torus.scene.points, whole);
  torus.torn = static_cast<std::size_t>(2 * ring);  // a quad's side and its diagonal
  torus.center = (torus.scene.points.leftCols(ring).rowwise().mean() +
                  torus.scene.points.rightCols(ring).rowwise().mean()) /
                 2.0;
  return torus;
}

TEST(SurfaceDiagnosis, CutHandleIsFoundWithPlaceAndSize) {
  for (const int ring : {12, 24}) {
    const double tube_radius = 0.4;
    const CutTorus torus = cutTorus(5 * ring / 2, ring, tube_radius);
    ASSERT_TRUE(
        isSphereOverAll(torus.scene.triangles, static_cast<Index>(torus.scene.points.cols())));
    const SurfaceDiagnosis diagnosis = diagnose(torus.scene);
    EXPECT_EQ(diagnosis.kind, SurfaceKind::Handles) << diagnosis.summary;
    ASSERT_EQ(diagnosis.handles.size(), 1U);
    const CollapsedHandle& handle = diagnosis.handles.front();
    EXPECT_EQ(handle.edges, torus.torn);
    EXPECT_LT((handle.center - torus.center).norm(), 0.02);
    // The box around the two rims of the cut: square, and as thick as the step between them.
    EXPECT_NEAR(handle.size, std::sqrt(8.0) * tube_radius, 0.1);
    EXPECT_EQ(diagnosis.openings(), 0U);
    EXPECT_TRUE(diagnosis.bridges.empty());
    // Those of the finer torus are wide enough to be seen.
    EXPECT_EQ(diagnosis.filled_holes.size(), ring == 24 ? 2U : 0U);
    for (const FilledHole& hole : diagnosis.filled_holes) {
      EXPECT_EQ(hole.cause, SurfaceKind::Handles);
      EXPECT_NEAR(hole.area, kPi * tube_radius * tube_radius, 0.1);
    }
  }
}

TEST(SurfaceDiagnosis, HandlesAreCountedByTheCyclesOfTheGraph) {
  const CutTorus torus = cutTorus(60, 24, 0.4);
  for (const int reach : {1, 2, 3}) {
    const auto cycles = [reach](const Graph& graph) {
      return internal::countCycles(graph, reach).value_or(-1);
    };
    EXPECT_EQ(cycles(torus.scene.graph.graph), 2) << reach;
    const Positions sphere = spiralSphere(1500);
    const Triangles hull = triangulateSphere(sphere, {TriangulationMethod::Incremental}).triangles;
    EXPECT_EQ(cycles(graphOfMesh(sphere, hull)), 0) << reach;
    // Without the triangles around one point, at both poles, at a third place: openings.
    Triangles open = hull;
    int openings = 0;
    for (const Eigen::Vector3d& center :
         {Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Vector3d(0.0, 0.0, -1.0),
          Eigen::Vector3d(1.0, 0.0, 0.0)}) {
      Eigen::Index kept = 0;
      for (Eigen::Index t = 0; t < open.cols(); ++t) {
        bool far = true;
        for (int k = 0; k < 3; ++k)
          far = far && (Eigen::Vector3d(sphere.col(open(k, t))) - center).norm() > 0.3;
        if (far)
          open.col(kept++) = open.col(t);
      }
      open.conservativeResize(3, kept);
      EXPECT_EQ(cycles(graphOfMesh(sphere, open)), openings++) << reach;
    }
  }
  const SurfaceDiagnosis diagnosis = diagnose(torus.scene);
  ASSERT_TRUE(diagnosis.genus);
  EXPECT_EQ(*diagnosis.genus, 1);
  EXPECT_NE(diagnosis.summary.find("a surface with 1 handle, cut in 1 place"), std::string::npos)
      << diagnosis.summary;
  // All points each other's neighbours but for a few: no surface at all.
  std::mt19937 random(5);
  Graph chaos;
  std::vector<std::set<Index>> rows(400);
  for (std::size_t v = 0; v < rows.size(); ++v)
    for (int i = 0; i < 3; ++i) {
      const std::size_t w = random() % rows.size();
      if (w != v) {
        rows[v].insert(static_cast<Index>(w));
        rows[w].insert(static_cast<Index>(v));
      }
    }
  for (const std::set<Index>& row : rows) {
    chaos.neighbors.insert(chaos.neighbors.end(), row.begin(), row.end());
    chaos.lengths.insert(chaos.lengths.end(), row.size(), 1.0);
    chaos.offsets.push_back(chaos.neighbors.size());
  }
  EXPECT_FALSE(internal::countCycles(chaos, 1));
}

TEST(SurfaceDiagnosis, CyclesOfEdgesInOneDirectionAreNotCounted) {
  // Each names the next three: no row has an entry for the way back.
  Graph graph;
  for (Index v = 0; v < 40; ++v) {
    std::set<Index> row;
    for (Index step = 1; step <= 3; ++step)
      row.insert((v + step) % 40);
    graph.neighbors.insert(graph.neighbors.end(), row.begin(), row.end());
    graph.lengths.insert(graph.lengths.end(), row.size(), 1.0);
    graph.offsets.push_back(graph.neighbors.size());
  }
  for (const int reach : {1, 2, 3})
    EXPECT_FALSE(internal::countCycles(graph, reach));
}

TEST(SurfaceDiagnosis, HandlesAreFoundUnderAFoldedMeshUnlessThereIsAnOpening) {
  const auto folded = [](const Scene& scene) {
    Scene result = scene;
    std::mt19937 random(3);
    std::vector<Index> shuffled(static_cast<std::size_t>(scene.points.cols()));
    std::iota(shuffled.begin(), shuffled.end(), Index{0});
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    result.triangles =
        scene.triangles.unaryExpr([&](Index v) { return shuffled[static_cast<std::size_t>(v)]; })
            .eval();
    return diagnose(result);
  };
  const SurfaceDiagnosis torus = folded(cutTorus(60, 24, 0.4).scene);
  EXPECT_EQ(torus.kind, SurfaceKind::Handles) << torus.summary;
  ASSERT_TRUE(torus.genus);
  EXPECT_EQ(*torus.genus, 1);
  EXPECT_TRUE(torus.filled_holes.empty() && torus.handles.empty());
  const Positions ball = spiralSphere(1000);
  const SurfaceDiagnosis sphere = folded(starShaped(ball, ball));
  EXPECT_EQ(sphere.kind, SurfaceKind::Unclear) << sphere.summary;
  ASSERT_TRUE(sphere.genus);
  EXPECT_EQ(*sphere.genus, 0);
  // Three openings have as many cycles as a handle.
  const Positions open = filtered(
      ball, [](const Eigen::Vector3d& p) { return p.x() < 0.9 && p.y() > -0.9 && p.z() > -0.9; });
  const SurfaceDiagnosis opened = folded(starShaped(open, open));
  EXPECT_EQ(opened.kind, SurfaceKind::Unclear) << opened.summary;
  EXPECT_FALSE(opened.genus);
}

TEST(SurfaceDiagnosis, CutOfFewerPointsThanAnErrorOfTheGraphIsNoHandle) {
  expectClosed(cutTorus(20, 5, 0.4).scene);
}

TEST(SurfaceDiagnosis, DenseCreasesAroundCoarseFacesAreNoOpening) {
  // The grid of a cube, with 8 times as many points along its edges.
  const int m = 8;
  const int fine = 8 * (m - 1) + 1;
  const Positions cube =
      filtered(test::cubeGrid(fine).array() - 0.5, [&](const Eigen::Vector3d& p) {
        int at_end = 0;
        bool coarse = true;
        for (int c = 0; c < 3; ++c) {
          const long step = std::lround((p[c] + 0.5) * (fine - 1));
          at_end += step % (fine - 1) == 0 ? 1 : 0;
          coarse = coarse && step % 8 == 0;
        }
        return coarse || at_end >= 2;
      });
  expectClosed(starShaped(cube.colwise().normalized(), cube));
}

TEST(SurfaceDiagnosis, FalseNeighborsOfThinSheetsAreNoHandle) {
  const Positions directions = spiralSphere(1500);
  const Positions points = Eigen::Vector3d(1.0, 1.0, 0.04).asDiagonal() * directions;
  Scene scene = starShaped(directions, points);
  // Shortcuts from the top to the bottom, in the middle, where the way round is long.
  std::vector<std::pair<Index, Index>> shortcuts;
  for (Index i = 0; i < points.cols(); ++i) {
    Index nearest = -1;
    for (Index j = 0; j < points.cols(); ++j)
      if (points(2, i) > 0.0 && points(2, j) < 0.0 && points.col(i).head<2>().norm() < 0.3 &&
          (nearest < 0 || (points.col(i) - points.col(j)).squaredNorm() <
                              (points.col(i) - points.col(nearest)).squaredNorm()))
        nearest = j;
    if (nearest >= 0)
      shortcuts.emplace_back(i, nearest);
  }
  ASSERT_GT(shortcuts.size(), 20U);
  Graph graph;
  for (Index i = 0; i < points.cols(); ++i) {
    const auto v = static_cast<std::size_t>(i);
    std::vector<Index> row(scene.graph.graph.neighbors.begin() +
                               static_cast<std::ptrdiff_t>(scene.graph.graph.offsets[v]),
                           scene.graph.graph.neighbors.begin() +
                               static_cast<std::ptrdiff_t>(scene.graph.graph.offsets[v + 1]));
    for (const auto& [a, b] : shortcuts)
      if (a == i || b == i)
        row.push_back(a == i ? b : a);
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    for (const Index j : row) {
      graph.neighbors.push_back(j);
      graph.lengths.push_back((points.col(i) - points.col(j)).norm());
    }
    graph.offsets.push_back(graph.neighbors.size());
  }
  scene.graph.graph = graph;
  expectClosed(scene);
}

/// Two spheres, joined by a tube of six triangles.
Scene twoSpheres(Index n, Index m, double distance) {
  const Positions a = spiralSphere(n);
  const Positions b = spiralSphere(m).colwise() + Eigen::Vector3d(distance, 0.0, 0.0);
  Triangles of_a = triangulateSphere(a, {TriangulationMethod::Incremental}).triangles;
  Triangles of_b = triangulateSphere(spiralSphere(m), {TriangulationMethod::Incremental}).triangles;
  of_b.array() += n;
  Scene scene{test::horizontally(a, b), Triangles(3, of_a.cols() + of_b.cols() + 4), {}};
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

TEST(SurfaceDiagnosis, PartsAreCountedWithGapAndPlace) {
  const Index n = 600;
  const Index m = 400;
  const Scene scene = twoSpheres(n, m, 3.5);
  ASSERT_TRUE(isSphereOverAll(scene.triangles, n + m));
  const SurfaceDiagnosis diagnosis = diagnose(scene);
  EXPECT_EQ(diagnosis.kind, SurfaceKind::SeveralParts);
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
  for (const Bridge& edge : scene.graph.report.bridges)
    EXPECT_TRUE(std::binary_search(bridge.vertices.begin(), bridge.vertices.end(), edge.from) &&
                std::binary_search(bridge.vertices.begin(), bridge.vertices.end(), edge.to));
  EXPECT_EQ(diagnosis.openings(), 0U);
}

TEST(SurfaceDiagnosis, FoldedMeshIsUnclear) {
  const Positions points = spiralSphere(500);
  Scene scene = starShaped(points, points);
  std::mt19937 random(3);
  std::vector<Index> shuffled(500);
  std::iota(shuffled.begin(), shuffled.end(), Index{0});
  std::shuffle(shuffled.begin(), shuffled.end(), random);
  scene.triangles =
      scene.triangles.unaryExpr([&](Index v) { return shuffled[static_cast<std::size_t>(v)]; })
          .eval();
  const SurfaceDiagnosis diagnosis = diagnose(scene);
  EXPECT_EQ(diagnosis.kind, SurfaceKind::Unclear) << diagnosis.summary;
  EXPECT_DOUBLE_EQ(diagnosis.edges_outside_graph,
                   test::fractionBeyondTwoSteps(scene.graph.graph, scene.triangles));
  EXPECT_GT(diagnosis.edges_outside_graph, 0.5);
}

TEST(SurfaceDiagnosis, MotionAndScaleChangeNothingButPlaceAndSize) {
  const Positions open =
      filtered(spiralSphere(1000), [&](const Eigen::Vector3d& p) { return p.x() < 0.9; });
  const Scene scene = starShaped(open, open);
  const SurfaceDiagnosis still = diagnose(scene);
  ASSERT_EQ(still.filled_holes.size(), 1U);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(5.0, 6.0, -7.0);
  const double scale = 1e-3;
  Scene moved = scene;
  moved.points = (scale * turn * scene.points).colwise() + shift;
  for (double& length : moved.graph.graph.lengths)
    length *= scale;
  const SurfaceDiagnosis diagnosis = diagnose(moved);
  ASSERT_EQ(diagnosis.filled_holes.size(), 1U);
  EXPECT_EQ(diagnosis.kind, still.kind);
  const FilledHole& a = still.filled_holes.front();
  const FilledHole& b = diagnosis.filled_holes.front();
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.loops, b.loops);
  // The shift costs a factor of 1e4 of the digits.
  EXPECT_NEAR(b.area, scale * scale * a.area, 1e-16);
  EXPECT_NEAR(b.diameter, scale * a.diameter, 1e-13);
  EXPECT_LT((b.center - (scale * turn * a.center + shift)).norm(), 1e-13);
}

TEST(SurfaceDiagnosis, OptionsDecideHowMuchIsListed) {
  const Positions open =
      filtered(spiralSphere(1000), [&](const Eigen::Vector3d& p) { return p.x() < 0.9; });
  const Scene scene = starShaped(open, open);
  DiagnosisOptions options;
  options.max_vertices = 7;
  const SurfaceDiagnosis few = diagnose(scene, options);
  ASSERT_EQ(few.filled_holes.size(), 1U);
  EXPECT_EQ(few.filled_holes.front().vertices.size(), 7U);
  EXPECT_TRUE(std::is_sorted(few.filled_holes.front().vertices.begin(),
                             few.filled_holes.front().vertices.end()));
  ASSERT_EQ(few.filled_holes.front().loops.size(), 1U);
  EXPECT_GT(few.filled_holes.front().loops.front().size(), 7U);
}

TEST(SurfaceDiagnosis, SameForAnyNumberOfThreads) {
  // Enough points for several threads, a hole, and vertices that changed places with others.
  const Positions points =
      filtered(spiralSphere(60000), [](const Eigen::Vector3d& p) { return p.x() < 0.99; });
  Triangles triangles = triangulateSphere(points, {TriangulationMethod::Incremental}).triangles;
  const double long_side = 2.0 * sphereSpacing(60000);
  Triangles along(3, triangles.cols());
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    double longest = 0.0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(
          longest, (points.col(triangles(k, t)) - points.col(triangles((k + 1) % 3, t))).norm());
    if (longest < long_side)
      along.col(count++) = triangles.col(t);
  }
  const Graph graph = graphOfMesh(points, along.leftCols(count));
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (Eigen::Index k = 0; k < 3; ++k)
      if (triangles(k, t) % 1000 < 40)
        triangles(k, t) += triangles(k, t) % 1000 < 20 ? 20 : -20;
  const auto run = [&](int threads) {
    return diagnoseSurface(points, triangles, graph, {}, {}, threads);
  };
  const SurfaceDiagnosis one = run(1);
  EXPECT_FALSE(one.filled_holes.empty());
  // Neighbours are torn apart, but the graph has no cycle that a handle would have.
  EXPECT_EQ(one.genus.value_or(-1), 0);
  EXPECT_TRUE(one.handles.empty());
  const CutTorus torus = cutTorus(400, 150, 0.4);
  for (const int threads : {2, 3, 8}) {
    const SurfaceDiagnosis alone = diagnose(torus.scene, {}, 1);
    ASSERT_EQ(alone.handles.size(), 1U);
    const SurfaceDiagnosis several = diagnose(torus.scene, {}, threads);
    EXPECT_EQ(several.summary, alone.summary);
    ASSERT_EQ(several.handles.size(), 1U);
    EXPECT_EQ(several.handles[0].edges, alone.handles[0].edges);
    EXPECT_EQ(several.handles[0].vertices, alone.handles[0].vertices);
  }
  for (const int threads : {2, 3, 8}) {
    const SurfaceDiagnosis several = run(threads);
    EXPECT_EQ(several.summary, one.summary);
    EXPECT_EQ(several.edges_outside_graph, one.edges_outside_graph);
    ASSERT_EQ(several.filled_holes.size(), one.filled_holes.size());
    for (std::size_t i = 0; i < one.filled_holes.size(); ++i) {
      EXPECT_EQ(several.filled_holes[i].area, one.filled_holes[i].area);
      EXPECT_EQ(several.filled_holes[i].vertices, one.filled_holes[i].vertices);
      EXPECT_EQ(several.filled_holes[i].loops, one.filled_holes[i].loops);
    }
    EXPECT_TRUE(several.handles.empty());
  }
}

TEST(SurfaceDiagnosis, BadInputIsRefused) {
  const Positions points = spiralSphere(50);
  const Scene good = starShaped(points, points);
  const auto expect_refused = [&](const auto& spoil) {
    Scene scene = good;
    DiagnosisOptions options;
    spoil(scene, options);
    EXPECT_THROW(diagnose(scene, options), InvalidInput);
  };
  for (const int threads : {-1, 1025})
    EXPECT_THROW(diagnose(good, {}, threads), InvalidInput);
  expect_refused([](Scene& scene, DiagnosisOptions&) { scene.points = spiralSphere(49); });
  expect_refused([](Scene& scene, DiagnosisOptions&) { scene.triangles.resize(3, 0); });
  expect_refused([](Scene& scene, DiagnosisOptions&) { scene.triangles(1, 3) = 50; });
  expect_refused([](Scene& scene, DiagnosisOptions&) { scene.triangles(1, 3) = -1; });
  expect_refused([](Scene& scene, DiagnosisOptions&) {
    scene.graph.report.bridges.push_back({0, 50, 1.0});
  });
  expect_refused([](Scene& scene, DiagnosisOptions&) { scene.graph.graph.neighbors[3] = 50; });
  expect_refused([](Scene& scene, DiagnosisOptions&) { scene.graph.graph.lengths.pop_back(); });
}

}  // namespace
}  // namespace spherical_param
