// pcl_spherical_param_morph, run as a user does: frames, pairs, report and what is refused.

#include "tool_runner.h"

#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

using nlohmann::json;
using pcl::PointXYZRGB;
using tool_test::readFile;
using tool_test::run;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::TemporaryDirectory;
using tool_test::writeFile;
using Cloud = pcl::PointCloud<PointXYZRGB>;

RunResult runTool(const TemporaryDirectory& directory, const std::vector<std::string>& arguments,
                  RunOptions options = {}) {
  options.directory = directory.path();
  return run(MORPH_TOOL, arguments, options);
}

/// Points of an ellipsoid on a spiral, of one colour.
Cloud ellipsoid(int count, const std::array<double, 3>& axes,
                const std::array<std::uint8_t, 3>& color) {
  Cloud cloud;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    PointXYZRGB point(static_cast<float>(axes[0] * radius * std::cos(angle)),
                      static_cast<float>(axes[1] * radius * std::sin(angle)),
                      static_cast<float>(axes[2] * z), color[0], color[1], color[2]);
    cloud.push_back(point);
  }
  return cloud;
}

const Cloud first_cloud = ellipsoid(300, {1.5, 1.1, 0.8}, {200, 10, 0});
const Cloud second_cloud = ellipsoid(220, {0.7, 2.0, 0.9}, {0, 10, 100});

/// A directory with both clouds, a.ply and b.ply.
class MorphTool : public testing::Test {
protected:
  void SetUp() override {
    pcl::io::savePLYFileBinary(directory.file("a.ply"), first_cloud);
    pcl::io::savePLYFileBinary(directory.file("b.ply"), second_cloud);
  }

  TemporaryDirectory directory;
};

struct Frame {
  Cloud cloud;
  spherical_param::Triangles triangles;

  bool isSphere() const {
    return spherical_param::checkTopology(triangles, cloud.size()).isSphere();
  }
  spherical_param::Positions points() const {
    spherical_param::Positions points(3, static_cast<Eigen::Index>(cloud.size()));
    for (std::size_t i = 0; i < cloud.size(); ++i)
      points.col(static_cast<Eigen::Index>(i)) = cloud[i].getVector3fMap().cast<double>();
    return points;
  }
};

Frame readFrame(const std::string& path) {
  pcl::PolygonMesh mesh;
  EXPECT_EQ(pcl::io::loadPLYFile(path, mesh), 0) << path;
  Frame frame;
  pcl::fromPCLPointCloud2(mesh.cloud, frame.cloud);
  frame.triangles.resize(3, static_cast<Eigen::Index>(mesh.polygons.size()));
  for (std::size_t t = 0; t < mesh.polygons.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner)
      frame.triangles(static_cast<Eigen::Index>(corner), static_cast<Eigen::Index>(t)) =
          static_cast<spherical_param::Index>(mesh.polygons[t].vertices.at(corner));
  return frame;
}

bool areSame(const PointXYZRGB& one, const PointXYZRGB& other) {
  return one.getVector3fMap() == other.getVector3fMap();
}

bool containsAll(const Frame& frame, const Cloud& points) {
  for (const PointXYZRGB& point : points) {
    bool is_there = false;
    for (const PointXYZRGB& vertex : frame.cloud)
      is_there = is_there || areSame(point, vertex);
    if (!is_there)
      return false;
  }
  return true;
}

int countPair(const Frame& from, const Frame& to, std::size_t first, std::size_t second) {
  int count = 0;
  for (std::size_t v = 0; v < from.cloud.size(); ++v)
    count +=
        areSame(from.cloud[v], first_cloud[first]) && areSame(to.cloud[v], second_cloud[second])
            ? 1
            : 0;
  return count;
}

TEST_F(MorphTool, FramesLeadFromOneObjectToTheOther) {
  const RunResult result = runTool(
      directory, {"a.ply", "b.ply", "m.ply", "-frames", "5", "-check", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  std::vector<Frame> frames;
  for (int i = 0; i < 5; ++i) {
    frames.push_back(readFrame(directory.file("m_00" + std::to_string(i) + ".ply")));
    EXPECT_TRUE(frames.back().isSphere());
    EXPECT_EQ(frames.back().triangles, frames[0].triangles);
  }
  EXPECT_EQ(directory.listing().size(), 8U);  // with both clouds and the report, nothing else
  EXPECT_TRUE(containsAll(frames.front(), first_cloud));
  EXPECT_TRUE(containsAll(frames.back(), second_cloud));
  EXPECT_LT((frames[1].points() - 0.75 * frames[0].points() - 0.25 * frames[4].points())
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
  // Colours go along, rounded.
  for (const PointXYZRGB& point : frames[2].cloud) {
    EXPECT_EQ(point.r, 100);
    EXPECT_EQ(point.g, 10);
    EXPECT_EQ(point.b, 50);
  }

  const json report = json::parse(readFile(directory.file("report.json")));
  EXPECT_EQ(report["frames"], 5);
  EXPECT_EQ(report["vertices"], frames[0].cloud.size());
  EXPECT_EQ(report["triangles"], frames[0].triangles.cols());
  EXPECT_EQ(report["closed"], true);
  EXPECT_EQ(report["manifold"], true);
  EXPECT_EQ(report["genus"], 0);
  EXPECT_EQ(report["self_intersections"], json({0, 0, 0, 0, 0}));
  EXPECT_EQ(report["files"][3], "m_003.ply");
  EXPECT_GT(report["alignment_error"], 0.0);
  Eigen::Matrix3d rotation;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      rotation(row, column) =
          report["rotation"][static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
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
  pairs << "# the top, then the bottom\n10 12\n\n  299, 219 # in numbers\n";
  // Near points, not at them.
  for (const PointXYZRGB& point : {first_cloud[150], second_cloud[112]})
    pairs << point.x + 0.01F << " " << point.y << " " << point.z - 0.01F << " ";
  pairs << "\n10 40";
  writeFile(directory.file("pairs.txt"), pairs.str());
  const RunResult result = runTool(
      directory, {"a.ply", "b.ply", "m.ply", "-frames", "2", "-pairs", "pairs.txt", "-json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report["pairs"]["given"], 4);
  EXPECT_EQ(report["pairs"]["honoured"], 3);
  ASSERT_EQ(report["pairs"]["impossible"].size(), 1U);
  EXPECT_EQ(report["pairs"]["impossible"][0]["line"], 6);
  EXPECT_EQ(report["pairs"]["impossible"][0]["points"], json({10, 40}));
  EXPECT_LT(report["pairs"]["worst_pair"], 1e-9);
  const Frame from = readFrame(directory.file("m_000.ply"));
  const Frame to = readFrame(directory.file("m_001.ply"));
  EXPECT_EQ(countPair(from, to, 10, 12), 1);
  EXPECT_EQ(countPair(from, to, 299, 219), 1);
  EXPECT_EQ(countPair(from, to, 150, 112), 1);
}

TEST_F(MorphTool, ResampledMatchedAndUnaligned) {
  const RunResult result =
      runTool(directory, {"a.ply", "b.ply", "m%02d.ply", "-frames", "3", "-connectivity",
                          "resampled", "-samples", "642", "-match", "-align", "none", "-quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.output, "");
  std::vector<Frame> frames;
  for (const char* name : {"m00.ply", "m01.ply", "m02.ply"}) {
    frames.push_back(readFrame(directory.file(name)));
    EXPECT_EQ(frames.back().cloud.size(), 642U);
    EXPECT_TRUE(frames.back().isSphere());
  }
  const double area = spherical_param::surfaceArea(frames[0].points(), frames[0].triangles);
  EXPECT_NEAR(spherical_param::surfaceArea(frames[2].points(), frames[2].triangles), area,
              0.05 * area);
}

TEST_F(MorphTool, SameBytesForAnyNumberOfThreads) {
  std::vector<std::map<std::string, std::string>> listings;
  writeFile(directory.file("pairs.txt"), "10 12\n299 200\n");
  for (const char* threads : {"1", "2", "3"}) {
    ASSERT_EQ(runTool(directory, {"a.ply", "b.ply", "m.ply", "-frames", "3", "-pairs", "pairs.txt",
                                  "-threads", threads})
                  .exit_code,
              0);
    listings.push_back(directory.listing());
  }
  EXPECT_EQ(listings[0].size(), 6U);
  EXPECT_TRUE(listings[1] == listings[0]);
  EXPECT_TRUE(listings[2] == listings[0]);
}

TEST_F(MorphTool, WrongUsageIsRefusedBeforeTheWork) {
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string message;  ///< a part of it
  };
  writeFile(directory.file("empty.txt"), "");
  const std::vector<Case> cases = {
      {{}, 2, "no two input files"},
      {{"a.ply", "b.ply"}, 2, "no output file"},
      {{"a.ply", "b.ply", "m.ply", "n.ply"}, 2, "one file too many"},
      {{"a.ply", "b.ply", "m.xyz"}, 2, "m.xyz"},
      {{"a.ply", "b.foo", "m.ply"}, 2, "b.foo"},
      {{"a.ply", "missing.ply", "m.ply"}, 1, "missing.ply"},
      {{"a.ply", "b.ply", "no/m.ply"}, 1, "no directory"},
      {{"a.ply", "b.ply", "m.ply", "-frames", "1"}, 2, "-frames"},
      {{"a.ply", "b.ply", "m.ply", "-align", "yes"}, 2, "none or rotation"},
      {{"a.ply", "b.ply", "m.ply", "-samples", "100"}, 2, "-connectivity resampled"},
      {{"a.ply", "b.ply", "m.ply", "-connectivity", "resampled", "-samples", "11"}, 2, "-samples"},
      {{"a.ply", "b.ply", "m.ply", "-pairs", ""}, 2, "-pairs"},
      {{"a.ply", "b.ply", "m_%s.ply"}, 2, "placeholder"},
      {{"a.ply", "b.ply", "m_%d_%d.ply"}, 2, "placeholder"},
      {{"a.ply", "b.ply", "m_%12d.ply"}, 2, "placeholder"},
      {{"a.ply", "b.ply", "m_%%.ply"}, 2, "placeholder"},
      {{"a.ply", "b.ply", "m.ply", "-json", "m_001.ply"}, 2, "would overwrite"},
      {{"a.ply", "m_001.ply", "m.ply"}, 2, "would overwrite"},
  };
  const auto before = directory.listing();
  for (const Case& wrong : cases) {
    const RunResult result = runTool(directory, wrong.arguments);
    const std::string last = wrong.arguments.empty() ? "nothing" : wrong.arguments.back();
    EXPECT_EQ(result.exit_code, wrong.exit_code) << last;
    EXPECT_EQ(result.errorLines().size(), 2U) << last << result.errors;
    EXPECT_NE(result.errors.find(wrong.message), std::string::npos) << last << result.errors;
    EXPECT_TRUE(directory.listing() == before) << last;
  }
}

TEST_F(MorphTool, WrongPairsAreToldWithTheirLine) {
  struct Case {
    std::string content;
    std::string message;
  };
  const std::vector<Case> cases = {
      {"1 2\n1\n", "line 2"},
      {"# nothing\n1 2 3\n", "line 2"},
      {"1 2 3 4 5 6 7", "line 1"},
      {"\n\n1 two", "line 3"},
      {"1.5 2", "line 1"},
      {"300 2", "no point '300' in a cloud of 300"},
      {"2 -1", "no point '-1' in a cloud of 220"},
      {"1 2 3 4 5 nan", "line 1"},
  };
  for (const Case& wrong : cases) {
    writeFile(directory.file("pairs.txt"), wrong.content);
    const auto before = directory.listing();
    const RunResult result =
        runTool(directory, {"a.ply", "b.ply", "m.ply", "-pairs", "pairs.txt", "-quiet"});
    EXPECT_EQ(result.exit_code, 1) << wrong.content;
    EXPECT_EQ(result.errorLines().size(), 2U) << result.errors;
    EXPECT_NE(result.errors.find(wrong.message), std::string::npos) << result.errors;
    EXPECT_TRUE(directory.listing() == before);
  }
}

TEST_F(MorphTool, AFullDiskLeavesNothingBehind) {
  // Frames that were there before stay as they were.
  writeFile(directory.file("m_000.ply"), "mine");
  const auto before = directory.listing();
  RunOptions options;
  options.file_size_limit = 20000;  // less than a frame
  const RunResult result = runTool(directory, {"a.ply", "b.ply", "m.ply", "-quiet"}, options);
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  EXPECT_TRUE(directory.listing() == before);
}

}  // namespace
