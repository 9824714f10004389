#include "spherical_param/map/texture_atlas.h"

#include "charts.h"
#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::doubledArea;
using test::Mapped;
using test::placesOf;
using TextureAtlasOfChart = test::EachChart;

INSTANTIATE_TEST_SUITE_P(EachChart, TextureAtlasOfChart, test::kEachChart, test::chartName);

std::vector<Mapped> meshes() {
  const Mapped tetrahedron = test::mapped(test::regularTetrahedron());
  const Eigen::Matrix3d turn = test::someRotation();
  // A face over a pole, a vertex in the pole, an edge through it.
  std::vector<Mapped> all = {tetrahedron, transformed(tetrahedron, turn),
                             transformed(tetrahedron, Eigen::Quaterniond::FromTwoVectors(
                                                          Vector3d(-1, -1, -1), Vector3d::UnitZ())
                                                          .toRotationMatrix())};
  for (const int parts : {1, 2, 8})
    all.push_back(test::octasphere(parts));
  all.push_back(transformed(test::octasphere(8), turn));
  all.push_back(test::mapped(test::cubeDirections(7)));
  // The centre has to be inside, or one triangle covers more than half of the sphere.
  for (const Index n : {4, 7, 12, 50, 400})
    for (const std::uint64_t seed : {1U, 2U})
      all.push_back(
          test::mapped(test::horizontally(test::randomSphere(n, seed), tetrahedron.sphere)));
  const Mapped random = all.back();
  for (const Vector3d& stretch : {Vector3d(1, 1, 300), Vector3d(1, 0.003, 1)})
    all.push_back(transformed(random, turn * stretch.asDiagonal()));
  all.push_back(transformed(random, Vector3d(1, 1, 300).asDiagonal()));
  for (const double height : {1e-2, 1e-5, 1e-9})
    all.push_back(test::rim(200, height, turn));
  all.push_back(test::rim(200, 1e-6, Eigen::Matrix3d::Identity()));
  return all;
}

TEST_P(TextureAtlasOfChart, TheCutMeshIsAClosedSphereOfTheSameAreaAndKeepsItsVertices) {
  for (const Mapped& mesh : meshes()) {
    SCOPED_TRACE(mesh.sphere.cols());
    const TextureAtlas atlas = atlasOf(mesh);
    EXPECT_EQ(atlas.chart, GetParam());
    EXPECT_TRUE(test::isSphereOverAll(atlas.triangles, static_cast<Index>(atlas.vertices.size())));
    ASSERT_EQ(atlas.source.size(), static_cast<std::size_t>(atlas.triangles.cols()));
    const Positions points = atCutVertices(atlas, mesh.sphere);
    EXPECT_EQ(points.leftCols(mesh.sphere.cols()), mesh.sphere);
    for (std::size_t v = 0; v < atlas.vertices.size(); ++v) {
      const CutVertex& vertex = atlas.vertices[v];
      EXPECT_NEAR(vertex.weights.sum(), 1.0, 1e-14);
      EXPECT_GE(vertex.weights.minCoeff(), 0.0);
      Vector3d sum = Vector3d::Zero();
      for (std::size_t k = 0; k < 3; ++k)
        sum += vertex.weights[static_cast<Eigen::Index>(k)] * mesh.sphere.col(vertex.vertices[k]);
      EXPECT_EQ(points.col(static_cast<Eigen::Index>(v)), sum);
    }
    EXPECT_NEAR(surfaceArea(points, atlas.triangles), surfaceArea(mesh.sphere, mesh.triangles),
                1e-11);
    EXPECT_NEAR(test::volumeOf(points, atlas.triangles),
                test::volumeOf(mesh.sphere, mesh.triangles), 1e-11);
    // Each part lies in its triangle.
    for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t)
      for (Eigen::Index k = 0; k < 3; ++k) {
        const CutVertex& vertex = atlas.vertices[static_cast<std::size_t>(atlas.triangles(k, t))];
        const auto whole = mesh.triangles.col(atlas.source[static_cast<std::size_t>(t)]);
        for (std::size_t c = 0; c < 3; ++c)
          EXPECT_TRUE(vertex.weights[static_cast<Eigen::Index>(c)] == 0.0 ||
                      (whole.array() == vertex.vertices[c]).any());
      }
  }
}

TEST_P(TextureAtlasOfChart, NoTriangleWrapsRoundOrIsTurnedOverAndAllAreAtTheirDirections) {
  // The extent of a quarter in longitude, an octant, a face.
  const double width = isEquirectangular() ? 0.25 : isCubeMap() ? 1.0 / 3.0 : 0.5;
  const double height = isEquirectangular() ? 1.0 : 0.5;
  for (const Mapped& mesh : meshes()) {
    SCOPED_TRACE(mesh.sphere.cols());
    const TextureAtlas atlas = atlasOf(mesh);
    const Positions points = atCutVertices(atlas, mesh.sphere);
    EXPECT_GE(atlas.coordinates.minCoeff(), 0.0);
    EXPECT_LE(atlas.coordinates.maxCoeff(), 1.0);
    double sum = 0.0;
    for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
      const std::array<Vector2d, 3> p = placesOf(atlas, t);
      // Coordinates are rounded to 1.1e-16, and a side is no longer than the image.
      EXPECT_GE(doubledArea(p), -4e-16) << t;
      sum += doubledArea(p) / 2.0;
      const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
      const auto [low, high] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
      EXPECT_LE(right - left, width + 1e-15);
      EXPECT_LE(high - low, height + 1e-15);
      // Weights are rounded, and so is the length of a point in a large triangle.
      for (Eigen::Index k = 0; k < 3; ++k)
        EXPECT_LT((test::directionAt(options(), p[static_cast<std::size_t>(k)]) -
                   points.col(atlas.triangles(k, t)).normalized())
                      .norm(),
                  1e-12);
    }
    const double inner = 1.0 - 2.0 * options().margin;
    if (isEquirectangular())
      EXPECT_LT(sum, 1.0);  // at the poles there is nothing beside the triangles
    else
      EXPECT_NEAR(sum, isCubeMap() ? inner * inner : 1.0, 1e-12);
  }
}

TEST_P(TextureAtlasOfChart, PlacesAndDirectionsAreInverse) {
  Positions directions = test::randomSphere(1000, 5);
  for (int i = 0; i < 27; ++i)
    if (i != 13)
      directions.col(i) = Vector3d(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1).normalized();
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const Vector2d place = chartCoordinates(options(), directions.col(i));
    EXPECT_LT((test::directionAt(options(), place) - directions.col(i)).norm(), 1e-14);
    EXPECT_LT((chartCoordinates(options(), 7.0 * directions.col(i)) - place).norm(), 1e-15);
  }
}

TEST(Equirectangular, APoleHasACoordinateInTheMiddleOfEachOfItsTriangles) {
  const Mapped mesh = test::mapped(test::randomSphere(500, 3));
  const TextureAtlas atlas =
      makeTextureAtlas(mesh.triangles, mesh.sphere, {SphereChart::Equirectangular});
  int at_poles = 0;
  for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
    const std::array<Vector2d, 3> p = placesOf(atlas, t);
    for (std::size_t k = 0; k < 3; ++k)
      if (p[k].y() == 0.0 || p[k].y() == 1.0) {
        ++at_poles;
        EXPECT_EQ(p[k].x(), (p[(k + 1) % 3].x() + p[(k + 2) % 3].x()) / 2.0);
      }
  }
  // A pole within a triangle has 3 + 4 edges at least: to the corners and along the quarters.
  EXPECT_GE(at_poles, 14);
  // The seam has both of its sides at the ends of the image.
  EXPECT_EQ(atlas.coordinates.row(0).minCoeff(), 0.0);
  EXPECT_EQ(atlas.coordinates.row(0).maxCoeff(), 1.0);
}

}  // namespace
}  // namespace spherical_param
