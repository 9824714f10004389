// pcl_spherical_param_morph, run as a user does: frames, pairs and report.

#include "tool_test.h"

#include "helpers.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

namespace {

using nlohmann::json;
using spherical_param::Positions;
using tool_test::ellipsoid;
using tool_test::MeshFile;
using tool_test::RunResult;

Eigen::Array3Xd repeated(const Eigen::Vector3d& color, Eigen::Index n) {
  return color.replicate(1, n).array();
}

/// Two clouds, each of one colour, in a.ply and b.ply.
class MorphTool : public tool_test::ToolTest {
protected:
  void SetUp() override {
    write("a.ply", tool_test::plyOf(first, {}, repeated({200.0, 10.0, 0.0}, 300).matrix()));
    write("b.ply", tool_test::plyOf(second, {}, repeated({0.0, 10.0, 100.0}, 220).matrix()));
  }
  RunResult tool(const std::vector<std::string>& arguments) const {
    return run(MORPH_TOOL, arguments);
  }

  const Positions first = ellipsoid(300, {1.5, 1.1, 0.8});
  const Positions second = ellipsoid(220, {0.7, 2.0, 0.9});
};

std::tuple<double, double, double> key(const Eigen::Vector3d& point) {
  return {point.x(), point.y(), point.z()};
}

bool containsAll(const Positions& vertices, const Positions& points) {
  std::set<std::tuple<double, double, double>> all;
  for (Eigen::Index i = 0; i < vertices.cols(); ++i)
    all.insert(key(vertices.col(i)));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (all.count(key(points.col(i))) == 0)
      return false;
  return true;
}

double areaOf(const MeshFile& mesh) {
  const Positions points = mesh.points();
  double area = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Eigen::Vector3d { return points.col(mesh.triangles(k, t)); };
    area += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  return area;
}

TEST_F(MorphTool, FramesLeadFromOneObjectToTheOther) {
  const json report = reportOf(MORPH_TOOL, {"a.ply", "b.ply", "m.ply", "-frames", "5", "-check"});
  std::vector<MeshFile> frames;
  for (int i = 0; i < 5; ++i) {
    frames.push_back(mesh("m_00" + std::to_string(i) + ".ply"));
    EXPECT_TRUE(frames.back().isSphere());
    EXPECT_EQ(frames.back().triangles, frames[0].triangles);
  }
  EXPECT_EQ(directory.listing().size(), 7U);  // with both clouds, nothing else
  EXPECT_TRUE(containsAll(frames.front().points(), first));
  EXPECT_TRUE(containsAll(frames.back().points(), second));
  EXPECT_LT((frames[1].points() - 0.75 * frames[0].points() - 0.25 * frames[4].points())
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
  // Colours go along, rounded.
  EXPECT_EQ(frames[2].colors(), repeated({100.0, 10.0, 50.0}, frames[2].points().cols()).matrix());

  EXPECT_EQ(report["frames"], 5);
  EXPECT_EQ(report["vertices"], frames[0].vertexCount());
  EXPECT_EQ(report["triangles"], frames[0].triangles.cols());
  EXPECT_EQ(report["closed"], true);
  EXPECT_EQ(report["manifold"], true);
  EXPECT_EQ(report["genus"], 0);
  EXPECT_EQ(report["self_intersections"], json({0, 0, 0, 0, 0}));
  EXPECT_EQ(report["files"][3], "m_003.ply");
  EXPECT_GT(report["alignment_error"], 0.0);
  Eigen::Matrix3d rotation;
  for (std::size_t i = 0; i < 9; ++i)
    rotation(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) =
        report["rotation"][i / 3][i % 3];
  EXPECT_TRUE((rotation * rotation.transpose()).isIdentity(1e-12));
  for (const char* side : {"first", "second"}) {
    EXPECT_EQ(report[side]["flipped_triangles"], 0);
    for (const char* kind : {"angle_distortion", "area_distortion"})
      for (const char* value : {"mean", "p95", "max"})
        EXPECT_GE(report[side][kind][value], 1.0);
  }
  EXPECT_EQ(report["pairs"]["given"], 0);
}

TEST_F(MorphTool, PairsAreHonouredOrSaidToBeImpossible) {
  std::ostringstream pairs;
  pairs << "10 12\n299 219\n";
  // Near points, not at them.
  const Eigen::Vector3d near(0.01, 0.0, -0.01);
  pairs << (first.col(150) + near).transpose() << " " << (second.col(112) + near).transpose()
        << "\n10 40";
  write("pairs.txt", pairs.str());
  const json report = reportOf(
      MORPH_TOOL, {"a.ply", "b.ply", "m.ply", "-frames", "2", "-pairs", "pairs.txt"})["pairs"];
  EXPECT_EQ(report["given"], 4);
  EXPECT_EQ(report["honoured"], 3);
  ASSERT_EQ(report["impossible"].size(), 1U);
  EXPECT_EQ(report["impossible"][0]["line"], 4);
  EXPECT_EQ(report["impossible"][0]["points"], json({10, 40}));
  EXPECT_LT(report["worst_pair"], 1e-9);
  const Positions from = mesh("m_000.ply").points();
  const Positions to = mesh("m_001.ply").points();
  for (const auto& [a, b] : {std::pair(10, 12), std::pair(299, 219), std::pair(150, 112)}) {
    int count = 0;
    for (Eigen::Index v = 0; v < from.cols(); ++v)
      count += from.col(v) == first.col(a) && to.col(v) == second.col(b) ? 1 : 0;
    EXPECT_EQ(count, 1) << a;
  }
}

TEST_F(MorphTool, ResampledFramesMatchInAreaAndHaveTheNamesOfThePattern) {
  const RunResult result =
      tool({"a.ply", "b.ply", "m%02d.ply", "-frames", "3", "-connectivity", "resampled", "-samples",
            "642", "-match", "-align", "none", "-verbose"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("align               none\n"), std::string::npos);
  std::vector<MeshFile> frames;
  for (const char* name : {"m00.ply", "m01.ply", "m02.ply"}) {
    frames.push_back(mesh(name));
    EXPECT_EQ(frames.back().vertexCount(), 642U);
    EXPECT_TRUE(frames.back().isSphere());
  }
  EXPECT_NEAR(areaOf(frames[2]), areaOf(frames[0]), 0.05 * areaOf(frames[0]));
}

}  // namespace
