// Reading by blocks, against PCL's readers, on files of several blocks.

#include "common/cloud_reader.h"

#include "common/errors.h"
#include "tool_runner.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

using tool_test::TemporaryDirectory;
using Cloud = pcl::PointCloud<pcl::PointXYZRGBNormal>;

/// More than two blocks in any format.
constexpr int point_count = 90000;

Cloud makeCloud() {
  Cloud cloud;
  for (int i = 0; i < point_count; ++i) {
    pcl::PointXYZRGBNormal point;
    point.x = static_cast<float>(std::sin(i));
    point.y = static_cast<float>(std::cos(0.7 * i)) * 1e-3F;
    point.z = static_cast<float>(i) * 0.37F;
    point.normal_x = static_cast<float>(std::cos(i));
    point.normal_y = static_cast<float>(std::sin(i));
    point.normal_z = 0.0F;
    point.r = static_cast<std::uint8_t>(i % 256);
    point.g = static_cast<std::uint8_t>(i / 7 % 256);
    point.b = static_cast<std::uint8_t>(i / 11 % 256);
    cloud.push_back(point);
  }
  return cloud;
}

void expectSame(const PointData& data, const Cloud& cloud, bool has_more) {
  ASSERT_EQ(data.points.size(), cloud.size());
  ASSERT_EQ(data.normals.size(), has_more ? cloud.size() : 0U);
  ASSERT_EQ(data.colors.size(), has_more ? cloud.size() : 0U);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const pcl::PointXYZRGBNormal& point = cloud[i];
    ASSERT_EQ(data.points[i], (Point{point.x, point.y, point.z})) << i;
    if (has_more) {
      ASSERT_EQ(data.normals[i], (Point{point.normal_x, point.normal_y, point.normal_z})) << i;
      ASSERT_EQ(data.colors[i], (Color{point.r, point.g, point.b, 255})) << i;
    }
  }
  EXPECT_EQ(data.rounding, 0.0);
}

template <typename Reader>
Cloud readWithPcl(const std::string& path) {
  pcl::PCLPointCloud2 blob;
  EXPECT_EQ(Reader().read(path, blob), 0);
  Cloud cloud;
  pcl::fromPCLPointCloud2(blob, cloud);
  return cloud;
}

class CloudReader : public testing::Test {
protected:
  CloudReader() { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }

  TemporaryDirectory directory;
};

TEST_F(CloudReader, ReadsThePcdFilesOfPclAsPclDoes) {
  const Cloud cloud = makeCloud();
  const std::string path = directory.file("a.pcd");
  ASSERT_EQ(pcl::io::savePCDFileBinary(path, cloud), 0);
  expectSame(readCloud(path), readWithPcl<pcl::PCDReader>(path), true);
  expectSame(readCloud(path), cloud, true);
  ASSERT_EQ(pcl::io::savePCDFileBinaryCompressed(path, cloud), 0);
  expectSame(readCloud(path), cloud, true);
  ASSERT_EQ(pcl::io::savePCDFileASCII(path, cloud), 0);
  expectSame(readCloud(path), readWithPcl<pcl::PCDReader>(path), true);
}

TEST_F(CloudReader, ReadsThePlyFilesOfPclAsPclDoes) {
  const Cloud cloud = makeCloud();
  const std::string path = directory.file("a.ply");
  ASSERT_EQ(pcl::io::savePLYFileBinary(path, cloud), 0);
  expectSame(readCloud(path), readWithPcl<pcl::PLYReader>(path), true);
  expectSame(readCloud(path), cloud, true);
  ASSERT_EQ(pcl::io::savePLYFileASCII(path, cloud), 0);
  expectSame(readCloud(path), readWithPcl<pcl::PLYReader>(path), true);
}

std::string bytesOf(const void* value, std::size_t size, bool big_endian) {
  std::string bytes(size, '\0');
  std::memcpy(bytes.data(), value, size);
  if (big_endian) {
    std::reverse(bytes.begin(), bytes.end());
  }
  return bytes;
}

/// A PLY file with things before and behind its points.
std::string plyOf(const Cloud& cloud, const std::string& format) {
  const bool text = format == "ascii";
  const bool big_endian = format == "binary_big_endian";
  std::string file =
      "ply\nformat " + format +
      " 1.0\nelement camera 2\nproperty double angle\nproperty list uchar short ids\n"
      "element vertex " +
      std::to_string(cloud.size()) +
      "\nproperty float x\nproperty uchar quality\nproperty float y\nproperty float "
      "z\nelement face 50000\nproperty list uchar int vertex_indices\n"
      "property uchar flag\nend_header\n";
  const auto add = [&](auto value) {
    std::ostringstream number;
    number.precision(9);
    number << +value << " ";
    file += text ? number.str() : bytesOf(&value, sizeof value, big_endian);
  };
  const auto end_line = [&] { file += text ? "\n" : ""; };
  for (int i = 0; i < 2; ++i) {
    add(0.5);
    add(std::uint8_t{3});
    for (int k = 0; k < 3; ++k) {
      add(static_cast<std::int16_t>(k));
    }
    end_line();
  }
  for (const pcl::PointXYZRGBNormal& point : cloud) {
    add(point.x);
    add(std::uint8_t{7});
    add(point.y);
    add(point.z);
    end_line();
  }
  for (std::int32_t t = 0; t < 50000; ++t) {
    add(static_cast<std::uint8_t>(3));
    for (std::int32_t k = 0; k < 3; ++k) {
      add(t + k);
    }
    add(std::uint8_t{1});
    end_line();
  }
  return file;
}

TEST_F(CloudReader, FindsThePointsBetweenOtherElementsInAnyByteOrder) {
  const Cloud cloud = makeCloud();
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    SCOPED_TRACE(format);
    const std::string path = directory.file("a.ply");
    tool_test::writeFile(path, plyOf(cloud, format));
    expectSame(readCloud(path), readWithPcl<pcl::PLYReader>(path), false);
  }
}

std::string textOf(const Cloud& cloud, const std::string& before) {
  std::ostringstream text;
  text.precision(9);
  for (const pcl::PointXYZRGBNormal& point : cloud) {
    text << before << point.x << " " << point.y << " " << point.z << "\n";
  }
  return text.str();
}

void expectRefused(const std::string& path, const std::string& cause) {
  try {
    readCloud(path);
    ADD_FAILURE() << path << " was read";
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find(cause), std::string::npos) << failure.what();
    EXPECT_EQ(failure.remedy(), "check that the file is complete and what its extension says");
  }
}

// Files of several blocks that end, or go wrong, far behind their headers.
TEST_F(CloudReader, LargeFilesThatAreCutAreRefused) {
  const Cloud cloud = makeCloud();
  const auto expect_cut_refused = [&](const std::string& name, const std::string& content,
                                      std::size_t missing, const std::string& cause) {
    SCOPED_TRACE(name + " without " + std::to_string(missing));
    ASSERT_GT(content.size(), std::size_t{1} << 20U);
    tool_test::writeFile(directory.file(name), content.substr(0, content.size() - missing));
    expectRefused(directory.file(name), cause);
  };
  for (const char* format : {"binary_little_endian", "binary_big_endian", "ascii"}) {
    const std::string ply = plyOf(cloud, format);
    // Within the faces, whose length no header tells, and within the points.
    expect_cut_refused("cut.ply", ply, 5, "broken or not complete");
    expect_cut_refused("cut.ply", ply, 200000, "broken or not complete");
    expect_cut_refused("cut.ply", ply, ply.size() - 400000, "shorter than its header says");
  }
  ASSERT_EQ(pcl::io::savePCDFileBinary(directory.file("a.pcd"), cloud), 0);
  expect_cut_refused("cut.pcd", tool_test::readFile(directory.file("a.pcd")), 1,
                     "shorter than its header says");
  ASSERT_EQ(pcl::io::savePCDFileBinaryCompressed(directory.file("a.pcd"), cloud), 0);
  expect_cut_refused("cut.pcd", tool_test::readFile(directory.file("a.pcd")), 1,
                     "shorter than its header says");
  ASSERT_EQ(pcl::io::savePCDFileASCII(directory.file("a.pcd"), cloud), 0);
  const std::string text_pcd = tool_test::readFile(directory.file("a.pcd"));
  expect_cut_refused("cut.pcd", text_pcd,
                     text_pcd.size() - text_pcd.rfind('\n', text_pcd.size() - 2),
                     "fewer points than its header says");
  expect_cut_refused("cut.pcd", text_pcd, text_pcd.size() - text_pcd.rfind(' ') + 1,
                     "line " + std::to_string(point_count + 11) + " has no 8 numbers");
  const std::string xyz = textOf(cloud, "");
  expect_cut_refused("cut.xyz", xyz, xyz.size() - xyz.rfind(' '),
                     "line " + std::to_string(point_count) + " does not begin");
  const std::string obj = textOf(cloud, "v ");
  expect_cut_refused("cut.obj", obj, obj.size() - obj.rfind(' '),
                     "line " + std::to_string(point_count) + " has no three numbers");
}

TEST_F(CloudReader, TextHasTheSamePointsAsBytes) {
  const Cloud cloud = makeCloud();
  for (const auto& [name, before] :
       {std::pair<std::string, std::string>{"a.xyz", ""}, {"a.obj", "v "}}) {
    tool_test::writeFile(directory.file(name), textOf(cloud, before));
    PointData data = readCloud(directory.file(name));
    EXPECT_LT(data.rounding, 1e-2);  // text may have more digits than single precision
    data.rounding = 0.0;
    expectSame(data, cloud, false);
  }
}

TEST_F(CloudReader, TellsHowFarItIs) {
  const Cloud cloud = makeCloud();
  ASSERT_EQ(pcl::io::savePLYFileBinary(directory.file("a.ply"), cloud), 0);
  ASSERT_EQ(pcl::io::savePCDFileBinary(directory.file("a.pcd"), cloud), 0);
  tool_test::writeFile(directory.file("a.xyz"), textOf(cloud, ""));
  for (const char* name : {"a.ply", "a.pcd", "a.xyz"}) {
    std::vector<double> shares;
    readCloud(directory.file(name), [&](double share) { shares.push_back(share); });
    ASSERT_GE(shares.size(), 2U) << name;
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end())) << name;
    EXPECT_LT(shares.front(), 0.8) << name;
    EXPECT_EQ(shares.back(), 1.0) << name;
  }
}

}  // namespace
}  // namespace spherical_param::tools
