#include "scan_shapes.h"

#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/reconstruct.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace spherical_param::tools {
namespace {

using Eigen::Vector3d;
using test::kPi;
using test::volumeOf;

Scan scanOf(const std::string& shape, std::size_t points, double noise = 0.0,
            std::uint64_t seed = 1) {
  return generateScan({shape, points, noise, seed});
}

/// The length of each column.
Eigen::ArrayXd norms(const Positions& points) {
  return points.colwise().norm().transpose();
}

std::size_t distinctFloats(const Positions& points) {
  std::set<std::array<float, 3>> distinct;
  const Eigen::Matrix3Xf rounded = points.cast<float>();
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    distinct.insert({rounded(0, i), rounded(1, i), rounded(2, i)});
  return distinct.size();
}

TEST(ScanShapes, ScansHaveExactlyTheNumberOfPointsAskedForAllDifferent) {
  for (const char* shape : {"sphere", "plate", "pair"})
    for (const std::size_t n : {4u, 5u, 26u, 27u, 333u}) {
      const Scan scan = scanOf(shape, n, n % 2 == 0 ? 0.0 : 0.1);
      EXPECT_EQ(scan.normals.cols(), static_cast<Eigen::Index>(n));
      EXPECT_TRUE(scan.points.allFinite());
      EXPECT_EQ(distinctFloats(scan.points), n);
    }
}

TEST(ScanShapes, OptionsOutOfRangeAreRefused) {
  for (const std::size_t points : {0u, 3u, 100'000'001u})
    EXPECT_THROW(scanOf("sphere", points), InvalidInput) << points;
  for (const double noise : {-0.1, 100.1, std::nan("")})
    EXPECT_THROW(scanOf("sphere", 10, noise), InvalidInput) << noise;
  EXPECT_THROW(scanOf("Sphere", 10), InvalidInput);
  for (const std::size_t triangles : {0u, 20'000'001u})
    EXPECT_THROW(referenceMesh("sphere", triangles), InvalidInput) << triangles;
}

TEST(ScanShapes, TheSameSeedGivesTheSameScanAndAnotherOtherPoints) {
  const Scan first = scanOf("dumbbell", 500, 0.1, 7);
  const Scan again = scanOf("dumbbell", 500, 0.1, 7);
  EXPECT_EQ(first.points, again.points);
  EXPECT_EQ(first.normals, again.normals);
  const Scan other = scanOf("dumbbell", 500, 0.1, 8);
  EXPECT_EQ(distinctFloats(test::horizontally(first.points, other.points)), 1000u);
}

TEST(ScanShapes, PointsAndNormalsOfAnalyticShapesAreExact) {
  // Rounding: the projection stops at a value of 1e-13.
  const Scan egg = scanOf("ellipsoid", 500);
  const Eigen::Array3d radii(0.5, 0.32, 0.22);
  const Positions unit = egg.points.array().colwise() / radii;
  EXPECT_LT((norms(unit) - 1.0).abs().maxCoeff(), 1e-11);
  const Positions normals = (unit.array().colwise() / radii).matrix().colwise().normalized();
  EXPECT_LT((egg.normals - normals).cwiseAbs().maxCoeff(), 1e-10);

  const Scan ring = scanOf("torus", 500);
  Positions core = ring.points;
  core.row(2).setZero();
  core = 0.36 * core.colwise().normalized();
  EXPECT_LT((norms(ring.points - core) - 0.14).abs().maxCoeff(), 1e-12);

  const Scan bowl = scanOf("bowl", 500);
  EXPECT_LT((norms(bowl.points) - 0.5).abs().maxCoeff(), 1e-12);
  // The samples lie above the chords of the mesh's rim by less than its step squared.
  EXPECT_LT(bowl.points.row(2).maxCoeff(), 0.15 + 1e-3);
}

class EveryShape : public testing::TestWithParam<ShapeInfo> {};

INSTANTIATE_TEST_SUITE_P(ScanShapes, EveryShape, testing::ValuesIn(allShapes()),
                         [](const auto& test) { return test.param.name; });

TEST_P(EveryShape, IsCoveredEvenlyByPointsWithOutwardUnitNormals) {
  constexpr Eigen::Index n = 600;
  const Scan scan = scanOf(GetParam().name, n);
  const TruthMesh mesh = referenceMesh(GetParam().name, 1);
  const NeighborLists neighbors = test::bruteForceNeighbors(scan.points, 1);
  Eigen::ArrayXd spacing(n);
  for (Eigen::Index i = 0; i < n; ++i)
    spacing(i) =
        (scan.points.col(i) - scan.points.col(neighbors.indices[static_cast<std::size_t>(i)]))
            .norm();
  EXPECT_GT(spacing.minCoeff(), 0.7 * spacing.mean());
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); v += 7)
    EXPECT_LT(norms(scan.points.colwise() - mesh.vertices.col(v)).minCoeff(), 1.4 * spacing.mean());
  EXPECT_LT((norms(scan.normals) - 1.0).abs().maxCoeff(), 1e-12);
  // A point and the triangles at the nearest vertex of the mesh have about the same normal.
  Positions normals = Positions::Zero(3, mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Vector3d { return mesh.vertices.col(mesh.triangles(k, t)); };
    for (int k = 0; k < 3; ++k)
      normals.col(mesh.triangles(k, t)) += (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }
  for (Eigen::Index i = 0; i < n; i += 13) {
    Eigen::Index nearest = 0;
    const double distance = norms(mesh.vertices.colwise() - scan.points.col(i)).minCoeff(&nearest);
    EXPECT_LT(distance, 0.05);  // two steps of the coarsest lattice
    EXPECT_GT(scan.normals.col(i).dot(normals.col(nearest).normalized()), 0.5);
  }
}

TEST_P(EveryShape, ReferenceMeshHasTheSizeAndTheTopologyOfTheShape) {
  const std::string& shape = GetParam().name;
  const TruthMesh mesh = referenceMesh(shape, 1);
  const Vector3d low = mesh.vertices.rowwise().minCoeff();
  const Vector3d high = mesh.vertices.rowwise().maxCoeff();
  EXPECT_NEAR((high - low).maxCoeff(), 1.0, 0.2);
  EXPECT_LT((0.5 * (high + low)).norm(), 0.2);
  const MeshTopology topology =
      checkTopology(mesh.triangles, static_cast<std::size_t>(mesh.vertices.cols()));
  EXPECT_TRUE(topology.manifold() && topology.oriented && topology.unused_vertices.empty());
  EXPECT_EQ(topology.components, shape == "pair" ? 2u : 1u);
  const long openings = shape == "bowl" ? 1 : shape == "holed" ? 4 : 0;
  EXPECT_EQ(topology.closed, openings == 0);
  // V - E + F: 2 for each sphere, 2 less for each handle, 1 less for each opening.
  const long handles = shape == "torus" ? 1 : shape == "double_torus" ? 2 : 0;
  EXPECT_EQ(topology.euler_characteristic,
            2 * static_cast<long>(topology.components) - 2 * handles - openings);
}

/// Even where the shape is no sphere.
TEST_P(EveryShape, IsMeshedAsAClosedOutwardSphereThroughAllPoints) {
  constexpr Index n = 600;
  const Positions points = scanOf(GetParam().name, n).points;
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
  const TruthMesh mesh = referenceMesh("dumbbell", 30000);
  EXPECT_NEAR(static_cast<double>(mesh.triangles.cols()), 30000.0, 1500.0);
  // A mesh of step h misses about h^2 / R^2 of a curved volume: 0.6 % for h = 1/40, R = 1/3.
  for (const auto& [shape, volume, error] :
       {std::tuple{"ellipsoid", 4.0 / 3.0 * kPi * 0.5 * 0.32 * 0.22, 0.006},
        {"torus", 2.0 * kPi * kPi * 0.36 * 0.14 * 0.14, 0.02}}) {
    const TruthMesh coarse = referenceMesh(shape, 1);
    EXPECT_NEAR(volumeOf(coarse.vertices, coarse.triangles), volume, error * volume);
  }
}

TEST(ScanShapes, NoiseIsUniformAlongTheNormalRelativeToThe25NearestNeighbors) {
  constexpr std::size_t n = 1000;
  const double noise = 0.3;
  const Scan clean = scanOf("snake", n);
  const Scan noisy = scanOf("snake", n, noise);
  const Scan noisier = scanOf("snake", n, 2.0 * noise);
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
