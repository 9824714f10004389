#include "spherical_param/map/resampling.h"

#include "charts.h"
#include "map_shapes.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

constexpr SphereGrid kGrids[] = {SphereGrid::Icosahedral, SphereGrid::Octahedral};

SphereSurface bumpySurface(Index n) {
  return test::bumpy(test::randomSphere(n, 1)).surface(SurfaceFit::Smooth);
}

TEST(GridSphere, IsAClosedMeshThatCoversTheSphereOnce) {
  for (const SphereGrid kind : kGrids)
    for (const int frequency : {1, 2, 3, 7, 12}) {
      const GridSphere grid = makeGridSphere(kind, frequency);
      const int factor = kind == SphereGrid::Icosahedral ? 10 : 4;
      EXPECT_EQ(grid.frequency, frequency);
      ASSERT_EQ(grid.directions.cols(), factor * frequency * frequency + 2);
      EXPECT_EQ(gridVertices(kind, frequency), static_cast<std::size_t>(grid.directions.cols()));
      EXPECT_TRUE(
          test::isSphereOverAll(grid.triangles, static_cast<Index>(grid.directions.cols())));
      EXPECT_TRUE(test::isOneToOne(grid.directions, grid.triangles));
      double least = 4.0 * test::kPi;
      double most = 0.0;
      for (Eigen::Index t = 0; t < grid.triangles.cols(); ++t) {
        const double area = test::sphericalArea(grid.directions, grid.triangles, t);
        least = std::min(least, area);
        most = std::max(most, area);
        // Those of the octahedron stay in their octant.
        const Eigen::Matrix3d corners = grid.directions(Eigen::all, grid.triangles.col(t));
        for (Index axis = 0; axis < 3; ++axis)
          EXPECT_TRUE(kind == SphereGrid::Icosahedral ||
                      corners.row(axis).minCoeff() * corners.row(axis).maxCoeff() >= 0.0);
      }
      EXPECT_LT(most / least, kind == SphereGrid::Icosahedral ? 1.25 : 6.0);
    }
}

TEST(GridSphere, FrequencyIsTheOneWhoseVerticesAreNearest) {
  for (const SphereGrid kind : kGrids)
    for (std::size_t n = 0; n < 3000; n += 7) {
      const int f = gridFrequency(kind, n);
      const auto distance = [&](int frequency) {
        return std::abs(static_cast<double>(gridVertices(kind, frequency)) -
                        static_cast<double>(n));
      };
      EXPECT_LE(distance(f), distance(f + 1));
      EXPECT_TRUE(f == 1 || distance(f) <= distance(f - 1));
    }
}

TEST(ResampleSurface, HasTheSurfaceAtEachDirectionAndIsAMapAgain) {
  const SphereSurface surface = bumpySurface(500);
  for (const SphereGrid kind : kGrids) {
    const GridSphere grid = makeGridSphere(kind, 9);
    const ResampledMesh mesh = resampleSurface(surface, grid);
    EXPECT_EQ(mesh.directions, grid.directions);
    EXPECT_EQ(mesh.triangles, grid.triangles);
    const SurfaceSamples samples = surface.evaluate(grid.directions);
    EXPECT_EQ(mesh.points, samples.positions);
    EXPECT_EQ(mesh.normals, samples.normals);
    EXPECT_GT(test::volumeOf(mesh.points, mesh.triangles), 0.0);
    const SphereSurface again(mesh.points, mesh.triangles, mesh.directions);
    EXPECT_EQ(again.evaluate(mesh.directions).positions, mesh.points);
  }
}

TEST(GeometryImage, IsTheMeshOfTheGridLaidOutAsTheOctahedralChart) {
  for (const int frequency : {1, 2, 10}) {
    const ResampledMesh mesh =
        resampleSurface(bumpySurface(500), makeGridSphere(SphereGrid::Octahedral, frequency));
    const GeometryImage image = geometryImageOfMesh(mesh);
    const int side = 2 * frequency + 1;
    ASSERT_EQ(image.side, side);
    ASSERT_EQ(image.positions.cols(), side * side);
    ResampledMesh directions = mesh;  // the image of the directions is the chart
    directions.points = mesh.directions;
    const Positions chart = geometryImageOfMesh(directions).positions;
    for (int row = 0; row < side; ++row)
      for (int column = 0; column < side; ++column) {
        const Vector3d expected = test::directionAt(
            {SphereChart::Octahedral}, {column / (side - 1.0), 1.0 - row / (side - 1.0)});
        EXPECT_LT((chart.col(row * side + column) - expected).norm(), 1e-15);
      }
    // Each vertex is a pixel; pairs on the border are the same.
    for (Eigen::Index v = 0; v < mesh.points.cols(); ++v)
      EXPECT_EQ((image.positions.colwise() - mesh.points.col(v)).colwise().norm().minCoeff(), 0.0);
    for (int i = 0; i < side; ++i) {
      EXPECT_EQ(image.positions.col(i), image.positions.col(side - 1 - i));
      EXPECT_EQ(image.positions.col(side * i), image.positions.col(side * (side - 1 - i)));
    }
  }
}

}  // namespace
}  // namespace spherical_param
