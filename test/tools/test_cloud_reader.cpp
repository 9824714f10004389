// Readers of clouds against those of PCL, on files of several blocks; and files that broke readers.

#include "common/cloud_reader.h"

#include "common/errors.h"
#include "common/file_formats.h"
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
#include <filesystem>
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
      ASSERT_EQ(data.normals[i], (Normal{point.normal_x, point.normal_y, point.normal_z})) << i;
      ASSERT_EQ(data.colors[i], (Color{point.r, point.g, point.b, 255})) << i;
    }
  }
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

/// A PLY file with elements before and after its points.
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

TEST_F(CloudReader, FindsThePointsAmongOtherElementsInAnyByteOrder) {
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
  text.precision(17);  // exact
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
    expectSame(readCloud(directory.file(name)), cloud, false);
  }
}

TEST_F(CloudReader, ProgressGrowsToOne) {
  const Cloud cloud = makeCloud();
  ASSERT_EQ(pcl::io::savePLYFileBinary(directory.file("a.ply"), cloud), 0);
  ASSERT_EQ(pcl::io::savePCDFileBinary(directory.file("a.pcd"), cloud), 0);
  ASSERT_EQ(pcl::io::savePCDFileBinaryCompressed(directory.file("packed.pcd"), cloud), 0);
  tool_test::writeFile(directory.file("a.xyz"), textOf(cloud, ""));
  for (const char* name : {"a.ply", "a.pcd", "packed.pcd", "a.xyz"}) {
    std::vector<double> shares;
    readCloud(directory.file(name), [&](double share) { shares.push_back(share); });
    ASSERT_GE(shares.size(), 2U) << name;
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end())) << name;
    EXPECT_LT(shares.front(), 0.8) << name;
    EXPECT_EQ(shares.back(), 1.0) << name;
  }
}

/// One point a field, so that other fields may be added.
std::string pcdOf(const std::string& fields, const std::string& sizes, const std::string& types,
                  const std::string& points, const std::string& data) {
  return "VERSION .7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types + "\nWIDTH " +
         points + "\nHEIGHT 1\nPOINTS " + points + "\nDATA " + data;
}

std::string packedPcd(const std::string& points, std::uint32_t size, const std::string& packed) {
  const auto packed_size = static_cast<std::uint32_t>(packed.size());
  return pcdOf("x y z", "4 4 4", "F F F", points, "binary_compressed\n") +
         bytesOf(&packed_size, 4, false) + bytesOf(&size, 4, false) + packed;
}

TEST_F(CloudReader, IncompleteColoursAreIgnored) {
  tool_test::writeFile(directory.file("a.pcd"),
                       pcdOf("x y z red", "4 4 4 1", "F F F U", "1", "ascii\n1 2 3 4\n"));
  const PointData data = readCloud(directory.file("a.pcd"));
  EXPECT_EQ(data.points.size(), 1U);
  EXPECT_TRUE(data.colors.empty());
}

TEST_F(CloudReader, ColoursOfPlyAreFoundByTheirNames) {
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                             "float y\nproperty float z\nproperty uchar alpha\n";
  tool_test::writeFile(directory.file("a.ply"),
                       header + "property uchar blue\nproperty uchar green\nproperty uchar red\n"
                                "end_header\n0 0 0 1 2 3 4\n");
  EXPECT_EQ(readCloud(directory.file("a.ply")).colors, (std::vector<Color>{{4, 3, 2, 1}}));
  tool_test::writeFile(directory.file("a.ply"), header + "end_header\n0 0 0 1\n");
  EXPECT_TRUE(readCloud(directory.file("a.ply")).colors.empty());
}

TEST_F(CloudReader, BrokenCompressedPointsAreRefused) {
  const std::string path = directory.file("a.pcd");
  const std::string zeros("\x00\x00\xe0\x02\x00", 5);  // one byte, then 11 times the same
  tool_test::writeFile(path, packedPcd("1", 12, zeros));
  EXPECT_EQ(readCloud(path).points, (std::vector<Point>{{0.0F, 0.0F, 0.0F}}));
  const std::vector<std::string> broken = {
      zeros.substr(0, 2),                             // too few
      zeros.substr(0, 4),                             // a reference that is cut
      zeros.substr(0, 3),                             // in its length
      zeros + std::string("\x00\x00", 2),             // too many
      std::string("\x00\x00\xe0\x03\x00", 5),         // one too many
      std::string("\x00\x00\xe0\x02\x01", 5),         // before the beginning
      std::string("\xff\xff\xff", 3),                 // long before it
      std::string("\x1f\x00\x00", 3),                 // fewer literals than said
      std::string("\x0c" + std::string(13, '\x01')),  // more literals than points
      "",
  };
  for (const std::string& packed : broken) {
    tool_test::writeFile(path, packedPcd("1", 12, packed));
    EXPECT_THROW(readCloud(path), Failure) << testing::PrintToString(packed);
  }
  // No memory is taken for what so few bytes cannot hold.
  tool_test::writeFile(path, packedPcd("300000000", 3600000000U, zeros));
  expectRefused(path, "too short for the points");
}

// PCL does not compress padding fields, so that the size of the file does not limit their counts.
TEST_F(CloudReader, PaddingOfCompressedPointsTakesNoMemory) {
  std::string fields = "x y z";
  std::string sizes = "4 4 4";
  std::string types = "F F F";
  std::string counts = "1 1 1";
  for (int i = 0; i < 16; ++i) {
    fields = "_ " + fields;
    sizes = "8 " + sizes;
    types = "U " + types;
    counts = "1073741824 " + counts;
  }
  const std::uint32_t size = 12;
  const std::string packed("\x00\x00\xe0\x02\x00", 5);
  const auto packed_size = static_cast<std::uint32_t>(packed.size());
  std::string file = pcdOf(fields, sizes, types, "1", "binary_compressed\n") +
                     bytesOf(&packed_size, 4, false) + bytesOf(&size, 4, false) + packed;
  file.insert(file.find("WIDTH"), "COUNT " + counts + "\n");
  tool_test::writeFile(directory.file("a.pcd"), file);
  EXPECT_EQ(readCloud(directory.file("a.pcd")).points, (std::vector<Point>{{0.0F, 0.0F, 0.0F}}));
}

TEST_F(CloudReader, NumbersBeyondTheRangeOfDoubleAreNotZero) {
  const std::string zeros(400, '0');
  tool_test::writeFile(directory.file("a.xyz"),
                       "1" + zeros + " -1" + zeros + ".5 0." + zeros + "1\n1e400 -1e+400 1e-400\n");
  const PointData data = readCloud(directory.file("a.xyz"));
  ASSERT_EQ(data.points.size(), 2U);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const Point& point : data.points) {
    EXPECT_EQ(point, (Point{infinity, -infinity, 0.0F}));
  }
}

TEST_F(CloudReader, ElementsWithoutPropertiesTakeNoTime) {
  tool_test::writeFile(
      directory.file("a.ply"),
      "ply\nformat ascii 1.0\nelement nothing 1073741824\nelement vertex "
      "1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n");
  EXPECT_EQ(readCloud(directory.file("a.ply")).points.size(), 1U);
}

TEST_F(CloudReader, ListLengthsOfRealTypeAreRefused) {
  tool_test::writeFile(
      directory.file("a.ply"),
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
      "y\nproperty float z\nelement face 1\nproperty list float int i\nend_header\n"
      "0 0 0\n1 0\n");
  expectRefused(directory.file("a.ply"), "unknown type 'float'");
}

void expectPointsOrRefusal(const std::string& path) {
  try {
    const PointData data = readCloud(path);
    EXPECT_FALSE(data.points.empty());
    EXPECT_TRUE(data.normals.empty() || data.normals.size() == data.points.size());
    EXPECT_TRUE(data.colors.empty() || data.colors.size() == data.points.size());
  } catch (const ToolError& error) {
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST_F(CloudReader, EveryFileOfTheFuzzersIsReadOrRefused) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(FUZZERS_CORPUS)) {
    const std::string kind = entry.path().parent_path().filename().string();
    if (!entry.is_regular_file() || !formatOf("a." + kind)) {
      continue;
    }
    ++count;
    const std::string path = directory.file("a." + kind);
    const std::string content = tool_test::readFile(entry.path().string());
    tool_test::writeFile(path, content);
    SCOPED_TRACE(entry.path());
    expectPointsOrRefusal(path);
  }
  EXPECT_GT(count, 30U);
}

}  // namespace
}  // namespace spherical_param::tools
