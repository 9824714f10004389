#include "spherical_param/map/handle_cutting.h"

#include "charts.h"
#include "handle_shapes.h"
#include "indexed.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/reconstruct.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using test::Mesh;

/// The grid's own triangles.
Mesh torus(int rings, int around) {
  Mesh mesh{test::torusCloud(rings, around), test::torusTriangles(rings, around)};
  if (signedVolume(mesh.points, mesh.triangles) < 0.0)
    flipOrientation(mesh.triangles);
  return mesh;
}

Mesh meshed(const Positions& points) {
  const Result result = reconstruct(points);
  EXPECT_EQ(result.surface().vertex_of_input.size(), static_cast<std::size_t>(points.cols()));
  return {points(Eigen::all, result.surface().input_of_vertex), result.surface().triangles};
}

/// Without one triangle in `step`, where it touches no opening. Cuts can hardly avoid such
/// openings.
Mesh perforated(const Mesh& mesh, Eigen::Index step) {
  std::set<Index> touched;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corners = mesh.triangles.col(t);
    const bool may_go =
        std::none_of(corners.begin(), corners.end(), [&](Index v) { return touched.count(v) > 0; });
    if (t % step == 0 && may_go)
      touched.insert(corners.begin(), corners.end());
    else
      kept.push_back(t);
  }
  return {mesh.points, mesh.triangles(Eigen::all, kept)};
}

std::vector<Mesh> meshes() {
  const Mesh torus_of_grid = torus(24, 8);
  std::vector<Mesh> all = {torus(3, 3),
                           torus_of_grid,
                           perforated(torus_of_grid, 1),
                           perforated(torus_of_grid, 382),
                           meshed(test::doubleTorus(0.2)),
                           meshed(test::plateWithHoles(0.2))};
  for (const Eigen::Index step : {1, 50})
    all.push_back(perforated(all[5], step));
  return all;
}

TEST(HandleCutting, TheMeshBecomesAPieceOfGenusZeroWithTheSameTriangles) {
  for (const Mesh& mesh : meshes()) {
    SCOPED_TRACE(mesh.points.cols());
    const CutMesh cut = cutHandles(mesh.points, mesh.triangles);
    ASSERT_EQ(cut.points.cols(), static_cast<Eigen::Index>(cut.vertex_of.size()));
    EXPECT_TRUE(checkTopology(cut.triangles, cut.vertex_of.size()).isOpenSurface());
    EXPECT_EQ(cut.points.leftCols(mesh.points.cols()), mesh.points);
    EXPECT_EQ(*std::max_element(cut.vertex_of.begin(), cut.vertex_of.end()) + 1,
              mesh.points.cols());
    Triangles back = cut.triangles;
    for (Index& v : back.reshaped()) {
      const Index copy = v;
      v = cut.vertex_of[static_cast<std::size_t>(copy)];
      EXPECT_EQ(cut.points.col(copy), mesh.points.col(v));
    }
    EXPECT_EQ(back, mesh.triangles);
  }
}

TEST(HandleCutting, CutsAreTheShortestLoopsAndEachMakesTwoOpenings) {
  // Around the tube there are 8 vertices; around its axis 24, and farther apart.
  const Mesh mesh = torus(24, 8);
  const CutMesh cut = cutHandles(mesh.points, mesh.triangles);
  EXPECT_EQ(cut.vertex_of.size(), mesh.points.cols() + 8U);
  const auto loops = [](const CutMesh& c) {
    return checkTopology(c.triangles, c.vertex_of.size()).boundary_loops;
  };
  EXPECT_EQ(loops(cut), 2U);
  for (const double unit : {1e200, 1e-200})
    EXPECT_EQ(cutHandles(unit * mesh.points, mesh.triangles).triangles, cut.triangles);
  const Mesh two = meshed(test::doubleTorus(0.2));
  EXPECT_EQ(loops(cutHandles(two.points, two.triangles)), 4U);
}

TEST(HandleCutting, AMeshWithoutHandlesStaysWhatItIs) {
  for (const test::Mapped& mesh : {test::octasphere(4), test::openBumpy(300)}) {
    const CutMesh cut = cutHandles(mesh.points, mesh.triangles);
    EXPECT_EQ(cut.points, mesh.points);
    EXPECT_EQ(cut.triangles, mesh.triangles);
    EXPECT_EQ(cut.vertex_of.size(), static_cast<std::size_t>(mesh.points.cols()));
  }
}

TEST(HandleCutting, OtherMeshesAreRefused) {
  Mesh mesh = torus(6, 5);
  Triangles two(3, 2 * mesh.triangles.cols());
  two << mesh.triangles, mesh.triangles.array() + 30;
  const Positions points = test::horizontally(mesh.points, mesh.points);
  EXPECT_THROW(cutHandles(points, two), InvalidInput);
  EXPECT_THROW(cutHandles(points, mesh.triangles), InvalidInput);
  const CutMesh cut = cutHandles(mesh.points, mesh.triangles);
  EXPECT_THROW(joinCuts({}, cut), InvalidInput);
  const SphereMap map = computeSphereMap(cut.points, cut.triangles, {});
  const TextureAtlas atlas = makeTextureAtlas(cut.triangles, map.sphere);
  const std::vector<std::function<void(TextureAtlas&, CutMesh&)>> faults = {
      [](TextureAtlas&, CutMesh& c) { c.vertex_of.back() = -1; },
      [](TextureAtlas&, CutMesh& c) { c.vertex_of.back() = 30; },
      [](TextureAtlas&, CutMesh& c) { c.vertex_of.clear(); },
      [](TextureAtlas&, CutMesh& c) { c.vertex_of[3] = 2; },
      [](TextureAtlas& a, CutMesh&) { a.source.pop_back(); },
      [](TextureAtlas& a, CutMesh&) { a.vertices.resize(5); },
      [](TextureAtlas& a, CutMesh&) { a.vertices[40].vertices[1] = 1000; },
      [](TextureAtlas& a, CutMesh&) { a.triangles(0, 7) = -1; },
      [](TextureAtlas& a, CutMesh&) { a.triangles(0, 7) = a.triangles(0, 9); },
      [](TextureAtlas& a, CutMesh&) { a.coordinate_triangles.resize(3, 4); }};
  for (std::size_t i = 0; i < faults.size(); ++i) {
    TextureAtlas wrong_atlas = atlas;
    CutMesh wrong_cut = cut;
    faults[i](wrong_atlas, wrong_cut);
    EXPECT_THROW(joinCuts(wrong_atlas, wrong_cut), InvalidInput) << i;
  }
  mesh.points(0, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(cutHandles(mesh.points, mesh.triangles), InvalidInput);
}

using JoinedAtlasOfChart = test::EachChart;

INSTANTIATE_TEST_SUITE_P(EachChart, JoinedAtlasOfChart, test::kEachChart, test::chartName);

double areaOf(const TextureAtlas& atlas) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t)
    sum += test::doubledArea(test::placesOf(atlas, t)) / 2.0;
  return sum;
}

TEST_P(JoinedAtlasOfChart, NoCutOpensTheSurfaceAndTheImageKeepsThem) {
  for (const Mesh& mesh : meshes()) {
    SCOPED_TRACE(mesh.points.cols());
    const CutMesh cut = cutHandles(mesh.points, mesh.triangles);
    const SphereMap map = computeSphereMap(cut.points, cut.triangles, {});
    const TextureAtlas before = makeTextureAtlas(cut.triangles, map.sphere, options());
    const TextureAtlas atlas = joinCuts(before, cut);
    const MeshTopology topology = checkTopology(atlas.triangles, atlas.vertices.size());
    const MeshTopology wanted = checkTopology(mesh.triangles, test::columnCount(mesh.points));
    EXPECT_TRUE(topology.isSurface());
    EXPECT_EQ(topology.genus, wanted.genus);
    EXPECT_EQ(topology.boundary_loops, wanted.boundary_loops);
    const Positions points = atCutVertices(atlas, mesh.points);
    EXPECT_EQ(points.leftCols(mesh.points.cols()), mesh.points);
    EXPECT_NEAR(surfaceArea(points, atlas.triangles) / surfaceArea(mesh.points, mesh.triangles),
                1.0, 1e-12);
    EXPECT_NEAR(areaOf(atlas), areaOf(before), 1e-12);
    for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t)
      EXPECT_GE(test::doubledArea(test::placesOf(atlas, t)), -4e-16) << t;
    for (const Index t : atlas.source)
      ASSERT_TRUE(t >= 0 && t < mesh.triangles.cols());
  }
}

TEST_P(JoinedAtlasOfChart, EdgesOnACutAreDividedAlikeOnBothSides) {
  const Mesh mesh = torus(24, 8);
  const CutMesh cut = cutHandles(mesh.points, mesh.triangles);
  const SphereMap map = computeSphereMap(cut.points, cut.triangles, {});
  const TextureAtlas before = makeTextureAtlas(cut.triangles, map.sphere, options());
  const TextureAtlas atlas = joinCuts(before, cut);
  // Those of both sides, and no more.
  EXPECT_EQ(before.vertices.size() - atlas.vertices.size(), 8U);
  EXPECT_GE(atlas.triangles.cols(), before.triangles.cols());
  EXPECT_EQ(atlas.triangles.cols(), 2 * static_cast<Eigen::Index>(atlas.vertices.size()));
}

}  // namespace
}  // namespace spherical_param
