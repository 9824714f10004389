#include "scan_shapes.h"

#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/reconstruct.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

using Eigen::Vector3d;
using test::kPi;
using test::volumeOf;

Scan scanOf(Shape shape, std::size_t points, double noise = 0.0, std::uint64_t seed = 1) {
  ScanOptions options;
  options.shape = shape;
  options.points = points;
  options.noise = noise;
  options.seed = seed;
  return generateScan(options);
}

/// The length of each column.
Eigen::ArrayXd norms(const Positions& points) {
  return points.colwise().norm().transpose();
}

std::size_t distinctFloats(const Positions& points) {
  std::set<std::array<float, 3>> distinct;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    distinct.insert({static_cast<float>(points(0, i)), static_cast<float>(points(1, i)),
                     static_cast<float>(points(2, i))});
  return distinct.size();
}

/// Vertex normals of a mesh, by the areas of the triangles.
Positions normalsOf(const TruthMesh& mesh) {
  Positions normals = Positions::Zero(3, mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Vector3d { return mesh.vertices.col(mesh.triangles(k, t)); };
    for (int k = 0; k < 3; ++k)
      normals.col(mesh.triangles(k, t)) += (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }
  return normals.colwise().normalized();
}

TEST(ScanShapes, EveryShapeAndPresetIsFoundByItsNameAlone) {
  std::set<std::string_view> names;
  std::set<Shape> shapes;
  int genus_zero = 0;
  for (const ShapeInfo& info : allShapes()) {
    names.insert(info.name);
    shapes.insert(info.shape);
    genus_zero += info.genus_zero ? 1 : 0;
    EXPECT_FALSE(info.description.empty());
    ASSERT_TRUE(findShape(info.name));
    EXPECT_EQ(findShape(info.name)->shape, info.shape);
  }
  EXPECT_EQ(names.size(), 16u);
  EXPECT_EQ(shapes.size(), 16u);
  EXPECT_EQ(genus_zero, 10);
  EXPECT_FALSE(findShape("Sphere") || findShape("") || findPreset("sphere"));
  // The sizes of Table 1 of the paper.
  const std::map<std::string_view, std::size_t> sizes = {
      {"tweety", 19818}, {"max", 52809}, {"igea", 134345}};
  ASSERT_EQ(allPresets().size(), sizes.size());
  for (const ScanPreset& preset : allPresets()) {
    EXPECT_EQ(preset.points, sizes.at(preset.name));
    ASSERT_TRUE(findPreset(preset.name));
    EXPECT_EQ(findPreset(preset.name)->shape, preset.shape);
  }
}

TEST(ScanShapes, ScansHaveExactlyTheNumberOfPointsAskedForAllDifferent) {
  for (const Shape shape : {Shape::Sphere, Shape::Plate, Shape::Pair})
    for (const std::size_t n : {4u, 5u, 26u, 27u, 333u}) {
      const Scan scan = scanOf(shape, n, n % 2 == 0 ? 0.0 : 0.1);
      EXPECT_EQ(scan.points.cols(), static_cast<Eigen::Index>(n));
      EXPECT_EQ(scan.normals.cols(), static_cast<Eigen::Index>(n));
      EXPECT_TRUE(scan.points.allFinite());
      EXPECT_EQ(distinctFloats(scan.points), n);
    }
}

TEST(ScanShapes, OptionsOutOfRangeAreRefused) {
  for (const std::size_t points : {0u, 3u, 100'000'001u})
    EXPECT_THROW(scanOf(Shape::Sphere, points), InvalidInput) << points;
  for (const double noise : {-0.1, 100.1, std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_THROW(scanOf(Shape::Sphere, 10, noise), InvalidInput) << noise;
  EXPECT_THROW(scanOf(static_cast<Shape>(99), 10), InvalidInput);
  for (const std::size_t triangles : {0u, 20'000'001u})
    EXPECT_THROW(referenceMesh(Shape::Sphere, triangles), InvalidInput) << triangles;
}

TEST(ScanShapes, TheSameSeedGivesTheSameScanAndAnotherOtherPoints) {
  const Scan first = scanOf(Shape::Dumbbell, 500, 0.1, 7);
  const Scan again = scanOf(Shape::Dumbbell, 500, 0.1, 7);
  const Scan other = scanOf(Shape::Dumbbell, 500, 0.1, 8);
  EXPECT_EQ(first.points, again.points);
  EXPECT_EQ(first.normals, again.normals);
  EXPECT_EQ(distinctFloats(test::horizontally(first.points, other.points)), 1000u);
}

TEST(ScanShapes, PointsAndNormalsOfAnalyticShapesAreExact) {
  // Rounding: the projection stops at a value of 1e-13.
  const Scan ball = scanOf(Shape::Sphere, 500);
  EXPECT_LT((norms(ball.points) - 0.5).abs().maxCoeff(), 1e-12);
  EXPECT_LT((ball.normals - 2.0 * ball.points).cwiseAbs().maxCoeff(), 1e-11);

  const Scan egg = scanOf(Shape::Ellipsoid, 500);
  const Eigen::Array3d radii(0.5, 0.32, 0.22);
  const Positions unit = egg.points.array().colwise() / radii;
  EXPECT_LT((norms(unit) - 1.0).abs().maxCoeff(), 1e-11);
  const Positions normals = (unit.array().colwise() / radii).matrix().colwise().normalized();
  EXPECT_LT((egg.normals - normals).cwiseAbs().maxCoeff(), 1e-10);

  const Scan ring = scanOf(Shape::Torus, 500);
  Positions core = ring.points;
  core.row(2).setZero();
  core = 0.36 * core.colwise().normalized();
  EXPECT_LT((norms(ring.points - core) - 0.14).abs().maxCoeff(), 1e-12);

  const Scan bowl = scanOf(Shape::Bowl, 500);
  EXPECT_LT((norms(bowl.points) - 0.5).abs().maxCoeff(), 1e-12);
  // The samples lie above the chords of the mesh's rim by less than its step squared.
  EXPECT_LT(bowl.points.row(2).maxCoeff(), 0.15 + 1e-3);
}

class EveryShape : public testing::TestWithParam<ShapeInfo> {};

INSTANTIATE_TEST_SUITE_P(ScanShapes, EveryShape, testing::ValuesIn(allShapes()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(EveryShape, IsCoveredEvenlyByPointsWithOutwardUnitNormals) {
  constexpr Eigen::Index n = 600;
  const Scan scan = scanOf(GetParam().shape, n);
  const TruthMesh mesh = referenceMesh(GetParam().shape, 1);
  const NeighborLists neighbors = test::bruteForceNeighbors(scan.points, 1);
  Eigen::ArrayXd spacing(n);
  for (Eigen::Index i = 0; i < n; ++i)
    spacing(i) =
        (scan.points.col(i) - scan.points.col(neighbors.indices[static_cast<std::size_t>(i)]))
            .norm();
  EXPECT_GT(spacing.minCoeff(), 0.7 * spacing.mean());
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); v += 7)
    EXPECT_LT((scan.points.colwise() - mesh.vertices.col(v)).colwise().norm().minCoeff(),
              1.4 * spacing.mean());
  // A point and the nearest vertex of the mesh have about the same normal.
  const Positions normals = normalsOf(mesh);
  EXPECT_LT((norms(scan.normals) - 1.0).abs().maxCoeff(), 1e-12);
  for (Eigen::Index i = 0; i < n; i += 13) {
    Eigen::Index nearest = 0;
    const double distance =
        (mesh.vertices.colwise() - scan.points.col(i)).colwise().norm().minCoeff(&nearest);
    EXPECT_LT(distance, 0.05);  // two steps of the coarsest lattice
    EXPECT_GT(scan.normals.col(i).dot(normals.col(nearest)), 0.5);
  }
}

TEST_P(EveryShape, ReferenceMeshHasTheSizeAndTheTopologyOfTheShape) {
  const Shape shape = GetParam().shape;
  const TruthMesh mesh = referenceMesh(shape, 1);
  const Vector3d low = mesh.vertices.rowwise().minCoeff();
  const Vector3d high = mesh.vertices.rowwise().maxCoeff();
  EXPECT_NEAR((high - low).maxCoeff(), 1.0, 0.2);
  EXPECT_LT((0.5 * (high + low)).norm(), 0.2);
  const MeshTopology topology =
      checkTopology(mesh.triangles, static_cast<std::size_t>(mesh.vertices.cols()));
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented);
  EXPECT_TRUE(topology.unused_vertices.empty());
  EXPECT_EQ(topology.components, shape == Shape::Pair ? 2u : 1u);
  const long openings = shape == Shape::Bowl    ? 1
                        : shape == Shape::Holed ? 4
                        : shape == Shape::Room  ? 2
                                                : 0;
  EXPECT_EQ(topology.closed, openings == 0);
  // V - E + F: 2 for each sphere, 2 less for each handle, 1 less for each opening.
  const long euler = shape == Shape::Torus         ? 0
                     : shape == Shape::DoubleTorus ? -2
                     : shape == Shape::Pair        ? 4
                                                   : 2 - openings;
  EXPECT_EQ(topology.euler_characteristic, euler);
  if (openings == 0) {
    EXPECT_GT(volumeOf(mesh.vertices, mesh.triangles), 0.0);
  }
}

/// Even where the shape is no sphere.
TEST_P(EveryShape, IsMeshedAsAClosedOutwardSphereThroughAllPoints) {
  constexpr Index n = 600;
  const Positions points = scanOf(GetParam().shape, n).points;
  const auto expect_sphere = [&](const char* name, const Options& options) {
    SCOPED_TRACE(name);
    const Surface result = reconstruct(points, options).surface();
    EXPECT_EQ(result.vertexCount(), static_cast<std::size_t>(n));
    EXPECT_TRUE(test::isSphereOverAll(result.triangles, n));
    EXPECT_GT(volumeOf(points, result.triangles), 0.0);
  };
  Options options;
  options.threads = 1;  // so few points take longer on more
  // The whole optimisation takes long where it is in vain.
  options.optimization = OptimizationMethod::Flips;
  expect_sphere("with adaptive weights", options);
  options.embedding.tolerance = 1e-8;
  options.embedding.weights = EdgeWeights::InverseLength;
  expect_sphere("converged, with inverse lengths", options);
  options.embedding = {};
  options.embedding.weights = EdgeWeights::Uniform;
  options.graph = GraphMethod::NearestNeighbors;
  options.embedding.method = EmbeddingMethod::Iterative;
  options.embedding.max_iterations = 100;
  options.triangulation = TriangulationMethod::Qhull;
  options.optimization = OptimizationMethod::None;
  expect_sphere("as in the paper", options);
}

TEST(ScanShapes, ReferenceMeshHasAboutTheTrianglesAskedForAndTheVolume) {
  // The number of cubes that a lattice cuts depends on where it lies.
  const TruthMesh mesh = referenceMesh(Shape::Dumbbell, 30000);
  EXPECT_NEAR(static_cast<double>(mesh.triangles.cols()), 30000.0, 1500.0);
  // A mesh of step h misses about h^2 / R^2 of a curved volume: 0.6 % for h = 1/40, R = 1/3.
  const std::map<Shape, std::array<double, 2>> volumes = {
      {Shape::Sphere, {4.0 / 3.0 * kPi * 0.125, 0.006}},
      {Shape::Ellipsoid, {4.0 / 3.0 * kPi * 0.5 * 0.32 * 0.22, 0.006}},
      {Shape::Torus, {2.0 * kPi * kPi * 0.36 * 0.14 * 0.14, 0.02}}};
  for (const auto& [shape, volume] : volumes) {
    const TruthMesh coarse = referenceMesh(shape, 1);
    EXPECT_NEAR(volumeOf(coarse.vertices, coarse.triangles), volume[0], volume[1] * volume[0]);
  }
}

TEST(ScanShapes, NoiseIsUniformAlongTheNormalRelativeToThe25NearestNeighbors) {
  constexpr std::size_t n = 1000;
  const double noise = 0.3;
  const Scan clean = scanOf(Shape::Snake, n);
  const Scan noisy = scanOf(Shape::Snake, n, noise);
  const Scan noisier = scanOf(Shape::Snake, n, 2.0 * noise);
  EXPECT_EQ(clean.normals, noisy.normals);
  const NeighborLists neighbors = test::bruteForceNeighbors(clean.points, 25);
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    double mean = 0.0;
    for (std::size_t k = 0; k < 25; ++k)
      mean += (clean.points.col(neighbors.indices[25 * i + k]) - clean.points.col(column)).norm();
    mean /= 25.0;
    const Vector3d normal = clean.normals.col(column);
    const Vector3d move = noisy.points.col(column) - clean.points.col(column);
    const double relative = move.dot(normal) / (noise * mean);
    EXPECT_LT(move.cross(normal).norm(), 1e-14);
    EXPECT_LE(std::abs(relative), 1.0 + 1e-12);
    const Vector3d double_move = noisier.points.col(column) - clean.points.col(column);
    EXPECT_LT((double_move - 2.0 * move).norm(), 1e-14);
    sum += relative;
    sum_of_squares += relative * relative;
  }
  // Of a uniform variable in [-1, 1]: mean 0, mean square 1/3 with a variance of 4/45; five
  // standard deviations for 1000 points.
  EXPECT_NEAR(sum / n, 0.0, 5.0 * std::sqrt(1.0 / 3.0 / n));
  EXPECT_NEAR(sum_of_squares / n, 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0 / n));
}

}  // namespace
}  // namespace spherical_param::tools
