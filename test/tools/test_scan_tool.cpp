// Generated scans, and pcl_spherical_param_scan run as a user does.

#include "helpers.h"
#include "scan_shapes.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "tool_test.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

using Eigen::Vector3d;
using tool_test::RunResult;
using Words = std::vector<std::string>;

Positions rounded(const Positions& points) {
  return points.cast<float>().cast<double>();
}

Eigen::ArrayXd norms(const Positions& points) {
  return points.colwise().norm().transpose();
}

TEST(ScanShapes, HaveTheNumberOfPointsAskedForAllDifferentTheSameForTheSameSeed) {
  for (const char* shape : {"sphere", "plate", "pair"})
    for (const std::size_t n : {4U, 27U, 333U}) {
      const Scan scan = generateScan({shape, n, 0.1, 7});
      EXPECT_EQ(generateScan({shape, n, 0.1, 7}).points, scan.points);
      const Scan other = generateScan({shape, n, 0.1, 8});
      std::set<std::array<double, 3>> distinct;
      const Positions both = rounded(test::horizontally(scan.points, other.points));
      for (const auto& p : both.colwise())
        distinct.insert({p.x(), p.y(), p.z()});
      EXPECT_EQ(distinct.size(), 2 * n);
    }
  for (const ScanOptions& options : {ScanOptions{"sphere", 3},
                                     {"sphere", kMaxScanPoints + 1},
                                     {"sphere", 9, std::nan("")},
                                     {"cube"}})
    EXPECT_THROW(generateScan(options), InvalidInput);
}

TEST(ScanShapes, PointsAndNormalsOfAnalyticShapesAreExact) {
  const Scan egg = generateScan({"ellipsoid", 500});
  const Eigen::Array3d radii(0.5, 0.32, 0.22);
  const Positions unit = egg.points.array().colwise() / radii;
  EXPECT_LT((norms(unit) - 1.0).abs().maxCoeff(), 1e-11);  // the projection stops at 1e-13
  const Positions normals = (unit.array().colwise() / radii).matrix().colwise().normalized();
  EXPECT_LT((egg.normals - normals).cwiseAbs().maxCoeff(), 1e-8);  // central differences
}

TEST(ScanShapes, NoiseIsUniformAlongTheNormalRelativeToThe25NearestNeighbors) {
  constexpr Eigen::Index n = 1000;
  const Scan clean = generateScan({"snake", n});
  const Positions moves = generateScan({"snake", n, 0.3}).points - clean.points;
  const NeighborLists neighbors = test::bruteForceNeighbors(clean.points, 25);
  Eigen::ArrayXd relative(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Positions around =
        clean.points(Eigen::all, test::rowOf(neighbors, static_cast<Index>(i)));
    const double width = 0.3 * norms(around.colwise() - clean.points.col(i)).mean();
    relative[i] = moves.col(i).dot(clean.normals.col(i)) / width;
    EXPECT_LT((moves.col(i) - relative[i] * width * clean.normals.col(i)).norm(), 1e-14);
  }
  EXPECT_LE(relative.abs().maxCoeff(), 1.0 + 1e-12);
  // Of a uniform variable in [-1, 1]: mean 0, mean square 1/3 with a variance of 4/45; five
  // standard deviations for 1000 points.
  EXPECT_NEAR(relative.mean(), 0.0, 5.0 * std::sqrt(1.0 / 3.0 / n));
  EXPECT_NEAR(relative.square().mean(), 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0 / n));
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

TEST_P(EveryShape, HasATrueMeshOfItsSizeAndTopology) {
  const std::string& shape = GetParam().name;
  const TruthMesh mesh = referenceMesh(shape);
  const Eigen::AlignedBox3d box(mesh.vertices.rowwise().minCoeff(),
                                mesh.vertices.rowwise().maxCoeff());
  EXPECT_NEAR(box.sizes().maxCoeff(), 1.0, 0.2);
  EXPECT_LT(box.center().norm(), 0.2);
  EXPECT_GT(test::volumeOf(mesh.vertices, mesh.triangles), 0.0);
  const MeshTopology topology =
      checkTopology(mesh.triangles, static_cast<std::size_t>(mesh.vertices.cols()));
  EXPECT_TRUE(topology.manifold() && topology.oriented && topology.unused_vertices.empty());
  // V - E + F: 2 for each sphere, 2 less for each handle, 1 less for each opening.
  const std::map<std::string, long> others = {{"pair", 4}, {"torus", 0},  {"double_torus", -2},
                                              {"bowl", 1}, {"chair", -6}, {"holed", -2}};
  EXPECT_EQ(topology.euler_characteristic, others.count(shape) > 0 ? others.at(shape) : 2);
  EXPECT_EQ(topology.components, shape == "pair" ? 2U : 1U);
  EXPECT_EQ(topology.closed, shape != "bowl" && shape != "holed");
}

class ScanTool : public tool_test::ToolTest {
protected:
  RunResult scan(const Words& words) const { return run(SCAN_TOOL, words); }
};

TEST_F(ScanTool, WritesTheScanItsNormalsAndTheTruthOnRequestInEveryFormat) {
  Words words = {"out.ply", "ELLIPSOID", "-points=100", "-noise", "0.25", "--seed", "7"};
  ASSERT_EQ(scan(tool_test::with(words, {"-truth", "truth.ply"})).exit_code, 0);
  EXPECT_EQ(mesh("out.ply").points(), rounded(generateScan({"ellipsoid", 100, 0.25, 7}).points));
  EXPECT_EQ(mesh("out.ply").properties.count("nx"), 0U);
  EXPECT_EQ(mesh("truth.ply").points(), rounded(referenceMesh("ellipsoid").vertices));
  words.emplace_back("-normals");
  for (const std::string extension : {"pcd", "ply", "obj", "xyz", "txt"}) {
    words[0] = "out." + extension;
    ASSERT_EQ(scan(words).exit_code, 0) << extension;
    ASSERT_EQ(run(RECONSTRUCTION_TOOL, {words[0], extension + ".off"}).exit_code, 0) << extension;
    // Nothing of points and normals is lost on the way, hence all meshes are the same.
    EXPECT_EQ(content(extension + ".off").rfind("NOFF\n100 196 0\n", 0), 0U) << extension;
    EXPECT_EQ(content(extension + ".off"), content("pcd.off")) << extension;
  }
}

TEST_F(ScanTool, ListHelpAndVersionSucceed) {
  const std::string list = scan({"-list"}).output;
  Words expected = {"19818", "52809", "134345"};  // the sizes of Table 1 of the paper
  for (const Shape& shape : allShapes())
    expected.push_back("\n  " + shape.name);
  for (const std::string& text : expected)
    EXPECT_NE(list.find(text), std::string::npos) << text;
  for (const char* option : {"-h", "-version"})
    EXPECT_NE(scan({option}).output.find("pcl_spherical_param_scan"), std::string::npos);
}

}  // namespace
}  // namespace spherical_param::tools
