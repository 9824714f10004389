#include "scan_shapes.h"

#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::tools {

namespace {

using Eigen::Vector3d;
using Point = std::array<double, 3>;

constexpr std::size_t sample_count = 1000;

Scan scanOf(Shape shape, std::size_t points, double noise = 0.0, std::uint64_t seed = 1) {
  ScanOptions options;
  options.shape = shape;
  options.points = points;
  options.noise = noise;
  options.seed = seed;
  return generateScan(options);
}

// Scans and meshes that several tests look at are made once.
const Scan& commonScan(Shape shape) {
  static std::map<Shape, Scan> scans;
  const auto found = scans.find(shape);
  return found != scans.end() ? found->second
                              : scans.emplace(shape, scanOf(shape, sample_count)).first->second;
}

// The least number of triangles with which the shape is meshed correctly.
const TruthMesh& commonMesh(Shape shape) {
  static std::map<Shape, TruthMesh> meshes;
  const auto found = meshes.find(shape);
  return found != meshes.end() ? found->second
                               : meshes.emplace(shape, referenceMesh(shape, 1)).first->second;
}

// Plain arrays: the brute force searches below would be slow with unoptimised expressions.
std::vector<Point> toPoints(const Positions& positions, Eigen::Index stride = 1) {
  std::vector<Point> points;
  for (Eigen::Index i = 0; i < positions.cols(); i += stride)
    points.push_back({positions(0, i), positions(1, i), positions(2, i)});
  return points;
}

double squaredDistance(const Point& a, const Point& b) {
  const double x = a[0] - b[0];
  const double y = a[1] - b[1];
  const double z = a[2] - b[2];
  return x * x + y * y + z * z;
}

double distanceToNearest(const Point& p, const std::vector<Point>& others) {
  double least = std::numeric_limits<double>::max();
  for (const Point& q : others)
    if (&p != &q)
      least = std::min(least, squaredDistance(p, q));
  return std::sqrt(least);
}

double meanSpacing(const std::vector<Point>& points) {
  double sum = 0.0;
  for (const Point& p : points)
    sum += distanceToNearest(p, points);
  return sum / static_cast<double>(points.size());
}

double signedVolume(const TruthMesh& mesh) {
  double volume = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Vector3d a = mesh.vertices.col(mesh.triangles(0, t));
    const Vector3d b = mesh.vertices.col(mesh.triangles(1, t));
    const Vector3d c = mesh.vertices.col(mesh.triangles(2, t));
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

// How often each edge is traversed from its first to its second vertex.
std::map<std::pair<Index, Index>, int> directedEdges(const TruthMesh& mesh) {
  std::map<std::pair<Index, Index>, int> edges;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    for (Eigen::Index i = 0; i < 3; ++i)
      ++edges[{mesh.triangles(i, t), mesh.triangles((i + 1) % 3, t)}];
  return edges;
}

struct Topology {
  long euler = 0;
  std::size_t components = 0;
  std::size_t boundary_edges = 0;
  bool manifold_and_oriented = true;  // no directed edge twice
  bool uses_all_vertices = true;
};

Topology topologyOf(const TruthMesh& mesh) {
  const auto directed = directedEdges(mesh);
  Topology topology;
  std::vector<Index> parent(static_cast<std::size_t>(mesh.vertices.cols()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index i) {
    while (parent[static_cast<std::size_t>(i)] != i)
      i = parent[static_cast<std::size_t>(i)] =
          parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
    return i;
  };
  std::set<Index> used;
  long edges = 0;
  for (const auto& [edge, count] : directed) {
    const bool has_opposite = directed.count({edge.second, edge.first}) > 0;
    topology.manifold_and_oriented &= count == 1 && edge.first != edge.second;
    topology.boundary_edges += has_opposite ? 0 : 1;
    edges += !has_opposite || edge.first < edge.second ? 1 : 0;
    used.insert(edge.first);
    parent[static_cast<std::size_t>(root(edge.first))] = root(edge.second);
  }
  topology.uses_all_vertices = used.size() == parent.size();
  for (std::size_t i = 0; i < parent.size(); ++i)
    topology.components += parent[i] == static_cast<Index>(i) ? 1 : 0;
  topology.euler =
      static_cast<long>(mesh.vertices.cols()) - edges + static_cast<long>(mesh.triangles.cols());
  return topology;
}

std::size_t openingsOf(Shape shape) {
  return shape == Shape::Bowl ? 1u : shape == Shape::Holed ? 4u : shape == Shape::Room ? 2u : 0u;
}

// The vertices along each boundary.
std::vector<std::vector<Index>> boundaryLoops(const TruthMesh& mesh) {
  const auto directed = directedEdges(mesh);
  std::map<Index, Index> next;
  for (const auto& entry : directed)
    if (directed.count({entry.first.second, entry.first.first}) == 0) {
      EXPECT_TRUE(next.emplace(entry.first).second) << "boundaries touch";
    }
  std::vector<std::vector<Index>> loops;
  while (!next.empty()) {
    loops.emplace_back();
    for (auto at = next.begin(); at != next.end(); at = next.find(loops.back().back())) {
      loops.back().push_back(at->second);
      next.erase(at);
    }
  }
  return loops;
}

std::size_t distinctFloats(const Positions& points) {
  std::set<std::array<float, 3>> distinct;
  for (const Point& p : toPoints(points))
    distinct.insert({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  return distinct.size();
}

class EveryShape : public testing::TestWithParam<ShapeInfo> {};

INSTANTIATE_TEST_SUITE_P(ScanShapes, EveryShape, testing::ValuesIn(allShapes()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace

TEST(ScanShapes, ListsEveryShapeOnceAndFindsItByName) {
  std::set<std::string_view> names;
  std::set<Shape> shapes;
  std::size_t genus_zero = 0;
  for (const ShapeInfo& info : allShapes()) {
    names.insert(info.name);
    shapes.insert(info.shape);
    genus_zero += info.genus_zero ? 1 : 0;
    EXPECT_FALSE(info.description.empty());
    const auto found = findShape(info.name);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->shape, info.shape);
  }
  EXPECT_EQ(names.size(), 16u);
  EXPECT_EQ(shapes.size(), 16u);
  EXPECT_EQ(genus_zero, 10u);
  EXPECT_FALSE(findShape("Sphere").has_value());
  EXPECT_FALSE(findShape("").has_value());
}

TEST(ScanShapes, PresetsHaveTheSizesOfThePapersTable1) {
  ASSERT_EQ(allPresets().size(), 3u);
  ASSERT_TRUE(findPreset("tweety") && findPreset("max") && findPreset("igea"));
  EXPECT_EQ(findPreset("tweety")->points, 19818u);
  EXPECT_EQ(findPreset("max")->points, 52809u);
  EXPECT_EQ(findPreset("igea")->points, 134345u);
  EXPECT_EQ(findPreset("tweety")->shape, Shape::Bird);
  EXPECT_FALSE(findPreset("sphere").has_value());
}

TEST(ScanShapes, GivesExactlyTheNumberOfPointsAskedFor) {
  for (const Shape shape : {Shape::Sphere, Shape::Plate, Shape::Pair})
    for (const std::size_t n : {4u, 5u, 26u, 27u, 333u}) {
      const Scan scan = scanOf(shape, n, n % 2 == 0 ? 0.0 : 0.1);
      EXPECT_EQ(scan.points.cols(), static_cast<Eigen::Index>(n));
      EXPECT_EQ(scan.normals.cols(), static_cast<Eigen::Index>(n));
      EXPECT_TRUE(scan.points.allFinite());
      EXPECT_EQ(distinctFloats(scan.points), n);
    }
}

TEST(ScanShapes, RefusesOptionsOutOfRange) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(scanOf(Shape::Sphere, 0), InvalidInput);
  EXPECT_THROW(scanOf(Shape::Sphere, 3), InvalidInput);
  EXPECT_THROW(scanOf(Shape::Sphere, 100'000'001), InvalidInput);
  EXPECT_THROW(scanOf(Shape::Sphere, 10, -0.1), InvalidInput);
  EXPECT_THROW(scanOf(Shape::Sphere, 10, 100.1), InvalidInput);
  EXPECT_THROW(scanOf(Shape::Sphere, 10, infinity), InvalidInput);
  EXPECT_THROW(scanOf(Shape::Sphere, 10, std::nan("")), InvalidInput);
  EXPECT_THROW(scanOf(static_cast<Shape>(99), 10), InvalidInput);
  EXPECT_THROW(referenceMesh(Shape::Sphere, 0), InvalidInput);
  EXPECT_THROW(referenceMesh(Shape::Sphere, 20'000'001), InvalidInput);
}

TEST(ScanShapes, SameSeedSameScanOtherSeedOtherPoints) {
  const Scan first = scanOf(Shape::Dumbbell, 500, 0.1, 7);
  const Scan again = scanOf(Shape::Dumbbell, 500, 0.1, 7);
  const Scan other = scanOf(Shape::Dumbbell, 500, 0.1, 8);
  EXPECT_EQ(first.points, again.points);
  EXPECT_EQ(first.normals, again.normals);
  Positions both(3, 1000);
  both << first.points, other.points;
  EXPECT_EQ(distinctFloats(both), 1000u);
}

TEST(ScanShapes, PointsAndNormalsOfAnalyticShapesAreExact) {
  const Scan& ball = commonScan(Shape::Sphere);
  const Scan& egg = commonScan(Shape::Ellipsoid);
  const Scan& ring = commonScan(Shape::Torus);
  const Scan& bowl = commonScan(Shape::Bowl);
  const Vector3d radii(0.5, 0.32, 0.22);
  for (Eigen::Index i = 0; i < ball.points.cols(); ++i) {
    // Rounding: the projection stops at a value of 1e-13.
    EXPECT_NEAR(ball.points.col(i).norm(), 0.5, 1e-12);
    EXPECT_LT((ball.normals.col(i) - ball.points.col(i).normalized()).norm(), 1e-12);

    const Vector3d p = egg.points.col(i);
    EXPECT_NEAR(p.cwiseQuotient(radii).norm(), 1.0, 1e-11);
    const Vector3d normal = p.cwiseQuotient(radii.cwiseAbs2()).normalized();
    EXPECT_LT((egg.normals.col(i) - normal).norm(), 1e-10);

    const Vector3d q = ring.points.col(i);
    const Vector3d core = Vector3d(q.x(), q.y(), 0.0).normalized() * 0.36;
    EXPECT_NEAR((q - core).norm(), 0.14, 1e-12);

    EXPECT_NEAR(bowl.points.col(i).norm(), 0.5, 1e-12);
    // The samples lie above the chords of the mesh's rim by less than its step squared.
    EXPECT_LT(bowl.points(2, i), 0.15 + 1e-3);
  }
}

TEST_P(EveryShape, IsAboutOneUnitLong) {
  const Positions& points = commonMesh(GetParam().shape).vertices;
  const Vector3d low = points.rowwise().minCoeff();
  const Vector3d high = points.rowwise().maxCoeff();
  EXPECT_GT((high - low).maxCoeff(), 0.85);
  EXPECT_LT((high - low).maxCoeff(), 1.2);
  EXPECT_LT((0.5 * (high + low)).norm(), 0.2);
}

TEST_P(EveryShape, PointsKeepTheirDistance) {
  const std::vector<Point> points = toPoints(commonScan(GetParam().shape).points);
  const double mean = meanSpacing(points);
  for (const Point& p : points)
    EXPECT_GT(distanceToNearest(p, points), 0.7 * mean);
}

TEST_P(EveryShape, NoPartOfTheSurfaceIsLeftOut) {
  const std::vector<Point> points = toPoints(commonScan(GetParam().shape).points);
  const double mean = meanSpacing(points);
  for (const Point& p : toPoints(commonMesh(GetParam().shape).vertices, 7))
    EXPECT_LT(distanceToNearest(p, points), 1.4 * mean);
}

TEST_P(EveryShape, NormalsAreUnitAndPointOutward) {
  // A point and the nearest vertex of the mesh have about the same normal.
  const Scan& scan = commonScan(GetParam().shape);
  const TruthMesh& mesh = commonMesh(GetParam().shape);
  Positions mesh_normals = Positions::Zero(3, mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Vector3d a = mesh.vertices.col(mesh.triangles(0, t));
    const Vector3d b = mesh.vertices.col(mesh.triangles(1, t));
    const Vector3d c = mesh.vertices.col(mesh.triangles(2, t));
    for (Eigen::Index i = 0; i < 3; ++i)
      mesh_normals.col(mesh.triangles(i, t)) += (b - a).cross(c - a);
  }
  const std::vector<Point> vertices = toPoints(mesh.vertices);
  const std::vector<Point> points = toPoints(scan.points);
  for (std::size_t i = 0; i < points.size(); i += 13) {
    const auto nearest =
        std::min_element(vertices.begin(), vertices.end(), [&](const Point& a, const Point& b) {
          return squaredDistance(a, points[i]) < squaredDistance(b, points[i]);
        });
    // Two steps of the coarsest lattice.
    EXPECT_LT(squaredDistance(*nearest, points[i]), 0.05 * 0.05);
    const Vector3d normal = scan.normals.col(static_cast<Eigen::Index>(i));
    EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
    EXPECT_GT(normal.dot(mesh_normals.col(nearest - vertices.begin()).normalized()), 0.5);
  }
}

TEST_P(EveryShape, ReferenceMeshHasTheTopologyOfTheShape) {
  const Topology topology = topologyOf(commonMesh(GetParam().shape));
  const Shape shape = GetParam().shape;
  EXPECT_TRUE(topology.manifold_and_oriented);
  EXPECT_TRUE(topology.uses_all_vertices);
  EXPECT_EQ(topology.components, shape == Shape::Pair ? 2u : 1u);
  const std::size_t openings = openingsOf(shape);
  EXPECT_EQ(topology.boundary_edges > 0, openings > 0);
  EXPECT_EQ(boundaryLoops(commonMesh(shape)).size(), openings);
  // V - E + F: 2 for each sphere, 2 less for each handle, 1 less for each opening.
  const long euler = shape == Shape::Torus         ? 0
                     : shape == Shape::DoubleTorus ? -2
                     : shape == Shape::Pair        ? 4
                                                   : 2 - static_cast<long>(openings);
  EXPECT_EQ(topology.euler, euler);
  if (openings == 0) {
    EXPECT_GT(signedVolume(commonMesh(shape)), 0.0);
  }
}

TEST(ScanShapes, ReferenceMeshHasAboutTheTrianglesAskedFor) {
  const TruthMesh mesh = referenceMesh(Shape::Dumbbell, 30000);
  // The number of cubes that a lattice cuts depends on where it lies.
  EXPECT_NEAR(static_cast<double>(mesh.triangles.cols()), 30000.0, 1500.0);
  EXPECT_EQ(topologyOf(mesh).euler, 2);
}

TEST(ScanShapes, ReferenceMeshConvergesToTheVolume) {
  // A mesh of step h misses about h^2 / R^2 of a curved volume: 0.6 % for h = 1/40, R = 1/3.
  const double pi = 3.14159265358979323846;
  const auto volume = [](Shape shape) { return signedVolume(commonMesh(shape)); };
  const double ball = 4.0 / 3.0 * pi * 0.125;
  EXPECT_NEAR(volume(Shape::Sphere), ball, 0.006 * ball);
  const double egg = 4.0 / 3.0 * pi * 0.5 * 0.32 * 0.22;
  EXPECT_NEAR(volume(Shape::Ellipsoid), egg, 0.006 * egg);
  const double ring = 2.0 * pi * pi * 0.36 * 0.14 * 0.14;
  EXPECT_NEAR(volume(Shape::Torus), ring, 0.02 * ring);
}

TEST(ScanShapes, NoiseIsUniformAlongTheNormalRelativeToThe25NearestNeighbors) {
  const double noise = 0.3;
  const Scan clean = scanOf(Shape::Snake, sample_count);
  const Scan noisy = scanOf(Shape::Snake, sample_count, noise);
  const Scan noisier = scanOf(Shape::Snake, sample_count, 2.0 * noise);
  EXPECT_EQ(clean.normals, noisy.normals);
  const std::vector<Point> points = toPoints(clean.points);
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<double> distances;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i)
        distances.push_back(squaredDistance(points[i], points[j]));
    std::nth_element(distances.begin(), distances.begin() + 25, distances.end());
    double mean = 0.0;
    for (std::size_t k = 0; k < 25; ++k)
      mean += std::sqrt(distances[k]) / 25.0;

    const auto column = static_cast<Eigen::Index>(i);
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
  EXPECT_NEAR(sum / 1000.0, 0.0, 5.0 * std::sqrt(1.0 / 3.0 / 1000.0));
  EXPECT_NEAR(sum_of_squares / 1000.0, 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0 / 1000.0));
}

}  // namespace spherical_param::tools
