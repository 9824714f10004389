// pcl_spherical_param_morph, run as a user does: frames, pairs and report.

#include "tool_test.h"

#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sstream>
#include <string>
#include <vector>

namespace {

using nlohmann::json;
using spherical_param::Positions;
using tool_test::containsAll;
using tool_test::ellipsoid;
using tool_test::expectEntries;
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

  const Positions first = ellipsoid(300, {1.5, 1.1, 0.8});
  const Positions second = ellipsoid(220, {0.7, 2.0, 0.9});
};

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

  expectEntries(report, R"({"frames": 5, "closed": true, "manifold": true, "genus": 0,
                            "self_intersections": [0, 0, 0, 0, 0], "pairs": {"given": 0}})"_json);
  EXPECT_EQ(report["vertices"], frames[0].vertexCount());
  EXPECT_EQ(report["triangles"], frames[0].triangles.cols());
  EXPECT_EQ(report["files"][3], "m_003.ply");
  EXPECT_GT(report["alignment_error"], 0.0);
  EXPECT_EQ(report["rotation"].size(), 3U);
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
  expectEntries(report, {{"given", 4}, {"honoured", 3}});
  ASSERT_EQ(report["impossible"].size(), 1U);
  expectEntries(report["impossible"][0], {{"line", 4}, {"points", {10, 40}}});
  EXPECT_LT(report["worst_pair"], 1e-9);
  const Positions from = mesh("m_000.ply").points();
  const Positions to = mesh("m_001.ply").points();
  Eigen::Index near_ones = 0;
  (from.colwise() - first.col(150)).colwise().norm().minCoeff(&near_ones);
  EXPECT_EQ(to.col(near_ones), second.col(112));
}

TEST_F(MorphTool, ResampledFramesMatchInAreaAndHaveTheNamesOfThePattern) {
  const RunResult result = expectSuccess(
      MORPH_TOOL, {"a.ply", "b.ply", "m%02d.ply", "-frames", "3", "-connectivity", "resampled",
                   "-samples", "642", "-match", "-align", "none", "-verbose"});
  EXPECT_NE(result.output.find("align               none\n"), std::string::npos);
  std::vector<MeshFile> frames;
  for (const char* name : {"m00.ply", "m01.ply", "m02.ply"}) {
    frames.push_back(mesh(name));
    EXPECT_EQ(frames.back().vertexCount(), 642U);
    EXPECT_TRUE(frames.back().isSphere());
  }
  const auto area_of = [](const MeshFile& mesh) {
    return spherical_param::surfaceArea(mesh.points(), mesh.triangles);
  };
  EXPECT_NEAR(area_of(frames[2]), area_of(frames[0]), 0.05 * area_of(frames[0]));
}

}  // namespace
