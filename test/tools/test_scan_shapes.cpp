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

namespace spherical_param::tools {
namespace {

using Eigen::Vector3d;

std::size_t distinctFloats(const Positions& points) {
  std::set<std::array<float, 3>> distinct;
  const Eigen::Matrix3Xf rounded = points.cast<float>();
  for (const auto& p : rounded.colwise())
    distinct.insert({p.x(), p.y(), p.z()});
  return distinct.size();
}

Eigen::ArrayXd norms(const Positions& points) {
  return points.colwise().norm().transpose();
}

TEST(ScanShapes, ScansHaveExactlyTheNumberOfPointsAskedForAllDifferent) {
  for (const char* shape : {"sphere", "plate", "pair"})
    for (const std::size_t n : {4U, 5U, 26U, 27U, 333U}) {
      const Scan scan = generateScan({shape, n, n % 2 == 0 ? 0.0 : 0.1});
      EXPECT_EQ(scan.normals.cols(), static_cast<Eigen::Index>(n));
      EXPECT_TRUE(scan.points.allFinite());
      EXPECT_EQ(distinctFloats(scan.points), n);
    }
  for (const ScanOptions& options : {ScanOptions{"sphere", 3},
                                     {"sphere", kMaxScanPoints + 1},
                                     {"sphere", 9, -0.1},
                                     {"sphere", 9, std::nan("")},
                                     {"cube"}})
    EXPECT_THROW(generateScan(options), InvalidInput);
}

TEST(ScanShapes, TheSameSeedGivesTheSameScanAndAnotherOtherPoints) {
  const Scan first = generateScan({"dumbbell", 500, 0.1, 7});
  const Scan again = generateScan({"dumbbell", 500, 0.1, 7});
  EXPECT_EQ(first.points, again.points);
  EXPECT_EQ(first.normals, again.normals);
  const Scan other = generateScan({"dumbbell", 500, 0.1, 8});
  EXPECT_EQ(distinctFloats(test::horizontally(first.points, other.points)), 1000U);
}

TEST(ScanShapes, PointsAndNormalsOfAnalyticShapesAreExact) {
  const Scan egg = generateScan({"ellipsoid", 500});
  const Eigen::Array3d radii(0.5, 0.32, 0.22);
  const Positions unit = egg.points.array().colwise() / radii;
  EXPECT_LT((norms(unit) - 1.0).abs().maxCoeff(), 1e-11);  // the projection stops at 1e-13
  const Positions normals = (unit.array().colwise() / radii).matrix().colwise().normalized();
  EXPECT_LT((egg.normals - normals).cwiseAbs().maxCoeff(), 1e-8);  // central differences
}

class EveryShape : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(ScanShapes, EveryShape, testing::ValuesIn(allShapes()),
                         [](const auto& test) { return test.param.name; });

TEST_P(EveryShape, IsCoveredEvenlyByPointsWithOutwardUnitNormals) {
  const auto& [name, description, distance, opening] = GetParam();
  const Scan scan = generateScan({name, 600});
  const NeighborLists neighbors = test::bruteForceNeighbors(scan.points, 1);
  const Eigen::ArrayXd spacing = norms(scan.points - scan.points(Eigen::all, neighbors.indices));
  EXPECT_GT(spacing.minCoeff(), 0.7 * spacing.mean());
  const Positions vertices = referenceMesh(name, 128).vertices;
  for (Eigen::Index v = 0; v < vertices.cols(); v += 29)
    EXPECT_LT(norms(scan.points.colwise() - vertices.col(v)).minCoeff(), 1.4 * spacing.mean());
  EXPECT_LT((norms(scan.normals) - 1.0).abs().maxCoeff(), 1e-12);
  for (Eigen::Index i = 0; i < scan.points.cols(); ++i) {
    const Vector3d p = scan.points.col(i);
    EXPECT_LT(std::abs(distance(p)), 1e-12);
    EXPECT_GT(opening(p), -1e-4);
    // The distance grows along the normal, and does not change across it.
    const Vector3d normal = 1e-6 * scan.normals.col(i);
    EXPECT_GT(distance(p + normal), 1e-7);
    EXPECT_LT(std::abs(distance(p + normal.unitOrthogonal() * 1e-6)), 1e-8);
  }
}

TEST_P(EveryShape, ReferenceMeshHasTheSizeAndTheTopologyOfTheShape) {
  const std::string& shape = GetParam().name;
  const TruthMesh mesh = referenceMesh(shape);
  const Vector3d low = mesh.vertices.rowwise().minCoeff();
  const Vector3d high = mesh.vertices.rowwise().maxCoeff();
  EXPECT_NEAR((high - low).maxCoeff(), 1.0, 0.2);
  EXPECT_LT((0.5 * (high + low)).norm(), 0.2);
  const MeshTopology topology =
      checkTopology(mesh.triangles, static_cast<std::size_t>(mesh.vertices.cols()));
  EXPECT_TRUE(topology.manifold() && topology.oriented && topology.unused_vertices.empty());
  EXPECT_EQ(topology.components, shape == "pair" ? 2U : 1U);
  const long openings = shape == "bowl" ? 1 : shape == "holed" ? 4 : 0;
  EXPECT_EQ(topology.closed, openings == 0);
  // V - E + F: 2 for each sphere, 2 less for each handle, 1 less for each opening.
  const long handles = shape == "torus"          ? 1
                       : shape == "double_torus" ? 2
                       : shape == "chair"        ? 4
                                                 : 0;
  EXPECT_EQ(topology.euler_characteristic,
            2 * static_cast<long>(topology.components) - 2 * handles - openings);
}

TEST(ScanShapes, ReferenceMeshHasTheVolumeOfTheShape) {
  const auto volume = [](const char* shape) {
    const TruthMesh mesh = referenceMesh(shape);
    return test::volumeOf(mesh.vertices, mesh.triangles) / test::kPi;
  };
  // A mesh of step h misses about h^2 / R^2 of a curved volume: 0.1 % for h = 1/200, R = 0.14.
  EXPECT_NEAR(volume("ellipsoid") / (4.0 / 3.0 * 0.5 * 0.32 * 0.22), 1.0, 0.001);
  EXPECT_NEAR(volume("torus") / (2.0 * test::kPi * 0.36 * 0.14 * 0.14), 1.0, 0.001);
}

/// Even where the shape is no sphere.
TEST_P(EveryShape, IsMeshedAsAClosedOutwardSphereThroughAllPoints) {
  constexpr Index n = 600;
  const Positions points = generateScan({GetParam().name, n}).points;
  Options options;
  options.threads = 1;       // so few points take longer on more
  options.time_limit = 0.0;  // all of the optimisation takes long where it is in vain
  options.topology = TopologyMode::Sphere;
  Options converged = options;
  converged.embedding.tolerance = 1e-8;
  Options as_published = options;
  as_published.method = Method::Paper;
  as_published.paper.weights = EdgeWeights::Uniform;
  as_published.paper.max_iterations = 100;
  for (const Options& with : {options, converged, as_published}) {
    const Surface result = reconstruct(points, with).surface();
    EXPECT_EQ(result.vertexCount(), static_cast<std::size_t>(n));
    EXPECT_TRUE(test::isSphereOverAll(result.triangles, n));
    EXPECT_GT(test::volumeOf(points, result.triangles), 0.0);
  }
}

TEST(ScanShapes, NoiseIsUniformAlongTheNormalRelativeToThe25NearestNeighbors) {
  constexpr Eigen::Index n = 1000;
  const double noise = 0.3;
  const Scan clean = generateScan({"snake", n});
  const Scan noisy = generateScan({"snake", n, noise});
  const Positions moves = noisy.points - clean.points;
  EXPECT_EQ(clean.normals, noisy.normals);
  EXPECT_TRUE(
      generateScan({"snake", n, 2.0 * noise}).points.isApprox(clean.points + 2.0 * moves, 1e-14));
  const NeighborLists neighbors = test::bruteForceNeighbors(clean.points, 25);
  Eigen::ArrayXd relative(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    double mean = 0.0;
    for (Eigen::Index k = 25 * i; k < 25 * (i + 1); ++k)
      mean +=
          (clean.points.col(neighbors.indices[static_cast<std::size_t>(k)]) - clean.points.col(i))
              .norm() /
          25.0;
    relative[i] = moves.col(i).dot(clean.normals.col(i)) / (noise * mean);
    EXPECT_LT((moves.col(i) - relative[i] * noise * mean * clean.normals.col(i)).norm(), 1e-14);
  }
  EXPECT_LE(relative.abs().maxCoeff(), 1.0 + 1e-12);
  // Of a uniform variable in [-1, 1]: mean 0, mean square 1/3 with a variance of 4/45; five
  // standard deviations for 1000 points.
  EXPECT_NEAR(relative.mean(), 0.0, 5.0 * std::sqrt(1.0 / 3.0 / n));
  EXPECT_NEAR(relative.square().mean(), 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0 / n));
}

}  // namespace
}  // namespace spherical_param::tools
