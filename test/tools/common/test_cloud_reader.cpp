// Readers of clouds against those of PCL, on files of several blocks; and files that broke readers.

#include "common/cloud_reader.h"

#include "common/errors.h"
#include "common/file_formats.h"
#include "temporary_directory.h"

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
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

using tool_test::readFile;
using tool_test::TemporaryDirectory;
using tool_test::writeFile;
using Cloud = pcl::PointCloud<pcl::PointXYZRGBNormal>;

/// More than a block in any format.
constexpr int point_count = 50000;

Cloud makeCloud(int count) {
  Cloud cloud;
  for (int i = 0; i < count; ++i)
    cloud.emplace_back(static_cast<float>(std::sin(i)),
                       static_cast<float>(std::cos(0.7 * i)) * 1e-3F, static_cast<float>(i) * 0.37F,
                       static_cast<std::uint8_t>(i % 256), static_cast<std::uint8_t>(i / 7 % 256),
                       static_cast<std::uint8_t>(i / 11 % 256), static_cast<float>(std::cos(i)),
                       static_cast<float>(std::sin(i)), 0.0F);
  return cloud;
}

const Cloud& largeCloud() {
  static const Cloud cloud = makeCloud(point_count);
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

  PointData read(const std::string& name, const std::string& content) const {
    writeFile(directory.file(name), content);
    return readCloud(directory.file(name));
  }

  void expectRefused(const std::string& name, const std::string& content,
                     const std::string& cause) const {
    SCOPED_TRACE(name + ": " + cause);
    try {
      read(name, content);
      ADD_FAILURE() << "it was read";
    } catch (const Failure& failure) {
      EXPECT_NE(std::string(failure.what()).find(cause), std::string::npos) << failure.what();
      EXPECT_FALSE(failure.remedy().empty());
    }
  }

  TemporaryDirectory directory;
};

TEST_F(CloudReader, ReadsTheFilesOfPclAsPclDoes) {
  const Cloud& cloud = largeCloud();
  const std::string pcd = directory.file("a.pcd");
  const std::string ply = directory.file("a.ply");
  ASSERT_EQ(pcl::io::savePCDFileBinary(pcd, cloud), 0);
  expectSame(readCloud(pcd), cloud, true);
  ASSERT_EQ(pcl::io::savePCDFileBinaryCompressed(pcd, cloud), 0);
  expectSame(readCloud(pcd), cloud, true);
  ASSERT_EQ(pcl::io::savePLYFileBinary(ply, cloud), 0);
  expectSame(readCloud(ply), cloud, true);
  // PCL does not write all digits.
  const Cloud small = makeCloud(500);
  ASSERT_EQ(pcl::io::savePCDFileASCII(pcd, small), 0);
  expectSame(readCloud(pcd), readWithPcl<pcl::PCDReader>(pcd), true);
  ASSERT_EQ(pcl::io::savePLYFileASCII(ply, small), 0);
  expectSame(readCloud(ply), readWithPcl<pcl::PLYReader>(ply), true);
}

std::string bytesOf(const void* value, std::size_t size, bool big_endian) {
  std::string bytes(size, '\0');
  std::memcpy(bytes.data(), value, size);
  if (big_endian)
    std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

/// A PLY file with elements before and after its points, of which the faces use all but the last.
std::string plyOf(const Cloud& cloud, const std::string& format) {
  const auto faces = static_cast<std::int32_t>(cloud.size()) - 3;
  const bool text = format == "ascii";
  const bool big_endian = format == "binary_big_endian";
  std::string file =
      "ply\nformat " + format +
      " 1.0\nelement camera 2\nproperty double angle\nproperty list uchar short ids\n"
      "element vertex " +
      std::to_string(cloud.size()) +
      "\nproperty float x\nproperty list uchar short views\nproperty uchar quality\nproperty float "
      "y\nproperty int64 time\nproperty float z\nelement face " +
      std::to_string(faces) +
      "\nproperty list uchar int vertex_indices\nproperty uchar flag\nend_header\n";
  const auto add = [&](auto value) {
    std::ostringstream number;
    number.precision(9);
    number << +value << " ";
    file += text ? number.str() : bytesOf(&value, sizeof value, big_endian);
  };
  const auto add_line = [&](auto... values) {
    (add(values), ...);
    file += text ? "\n" : "";
  };
  using Small = std::int16_t;
  using Byte = std::uint8_t;
  for (int i = 0; i < 2; ++i)
    add_line(0.5, Byte{3}, Small{0}, Small{1}, Small{2});
  for (const pcl::PointXYZRGBNormal& point : cloud)
    add_line(point.x, Byte{1}, Small{-3}, Byte{7}, point.y, std::int64_t{-12345678901}, point.z);
  for (std::int32_t t = 0; t < faces; ++t)
    add_line(Byte{3}, t, t + 1, t + 2, Byte{1});
  return file;
}

std::string plyOf(const std::string& format, const std::string& count, const std::string& data,
                  const std::string& further = "") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\n" + further + "end_header\n" +
         data;
}

TEST_F(CloudReader, FindsThePointsAmongOtherElementsInAnyByteOrder) {
  const Cloud& cloud = largeCloud();
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    SCOPED_TRACE(format);
    const PointData data = read("a.ply", plyOf(cloud, format));
    expectSame(data, cloud, false);
    ASSERT_EQ(data.scalars.size(), 2U);
    EXPECT_EQ(data.scalars[0].name, "quality");
    EXPECT_EQ(data.scalars[1].values.back(), -12345678901.0);
  }
}

TEST_F(CloudReader, CoordinatesAreOfAnyNumericType) {
  const std::string bytes("\1\1\5\0\0\0\0\0\0\0\xff", 11);
  const std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty short "
                          "x\nproperty uint64 y\nproperty char z\nend_header\n";
  const std::string pcd = "FIELDS x y z\nSIZE 2 8 1\nTYPE I U I\nWIDTH 1\nDATA binary\n";
  for (const PointData& data : {read("a.ply", ply + bytes), read("a.pcd", pcd + bytes)})
    EXPECT_EQ(data.points, (std::vector<Point>{{257.0, 5.0, -1.0}}));
}

TEST_F(CloudReader, PointsInNoFaceAreNotedUnlessTheFacesMakeNoSense) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    SCOPED_TRACE(format);
    const std::string file = plyOf(makeCloud(50), format);
    EXPECT_EQ(read("a.ply", file).unused, (std::vector<Index>{49}));
    EXPECT_TRUE(read("a.ply", file.substr(0, file.size() - 20)).unused.empty());
  }
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_index\n";
  for (const auto& [corner, unused] :
       std::map<std::string, std::vector<Index>>{{"2", {3, 4}}, {"7", {}}, {"-2", {}}, {"x", {}}})
    EXPECT_EQ(read("a.ply", plyOf("ascii", "5", points + "3 0 1 " + corner + "\n", face)).unused,
              unused)
        << corner;
}

TEST_F(CloudReader, TheViewpointOfPcdIsTheOriginOnlyWithRowsOrIfItIsApart) {
  const auto viewpoint_of = [&](const std::string& header, double x) {
    return read("a.pcd", "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n" + header +
                             "POINTS 2\nDATA ascii\n-1 -1 -1\n" + std::to_string(x) + " 1 1\n")
        .viewpoint;
  };
  EXPECT_EQ(viewpoint_of("WIDTH 2\nHEIGHT 1\nVIEWPOINT 1 2 -3 1 0 0 0\n", 1.0),
            (Point{1.0, 2.0, -3.0}));
  EXPECT_EQ(viewpoint_of("WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n", -0.5), Point{});
  EXPECT_EQ(viewpoint_of("WIDTH 1\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\n", 1.0), Point{});
  EXPECT_EQ(viewpoint_of("WIDTH 2\nHEIGHT 1\n", 1.0), std::nullopt);
}

TEST_F(CloudReader, TheRowsOfPcdAreKept) {
  const auto rows_of = [&](const std::string& size) {
    return read("a.pcd", "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n" + size +
                             "POINTS 2\nDATA ascii\n0 0 0\nnan nan nan\n")
        .rows;
  };
  EXPECT_EQ(rows_of("WIDTH 1\nHEIGHT 2\n"), 2U);
  EXPECT_EQ(rows_of("WIDTH 2\n"), 1U);
}

/// One value a field.
std::string pcdOf(const std::string& fields, const std::string& sizes, const std::string& types,
                  const std::string& points, const std::string& data) {
  return "VERSION .7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types + "\nWIDTH " +
         points + "\nHEIGHT 1\nPOINTS " + points + "\nDATA " + data;
}

std::string xyzPcd(const std::string& points, const std::string& data) {
  return pcdOf("x y z", "4 4 4", "F F F", points, data);
}

std::string packedPcd(const std::string& points, std::uint32_t size, const std::string& packed) {
  const auto packed_size = static_cast<std::uint32_t>(packed.size());
  return xyzPcd(points, "binary_compressed\n" + bytesOf(&packed_size, 4, false) +
                            bytesOf(&size, 4, false) + packed);
}

TEST_F(CloudReader, WhatIsNoCloudIsRefusedWithItsCause) {
  struct Case {
    const char* name;
    std::string content;
    const char* cause;
  };
  const std::string bytes24(24, '\1');
  const std::string points = "1 2 3\n4 5 6\n7 8 9\n1 0 1\n";
  const std::string grid = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  const std::vector<Case> cases = {
      {"a.ply", "", "is empty"},
      {"a.pcd", std::string(5000, '\0'), "unknown entry"},
      {"a.pcd", xyzPcd("1000000000", "binary\n" + bytes24), "shorter than its header"},
      {"a.pcd", xyzPcd("1000000000", "binary_compressed\n" + bytes24), "shorter than its header"},
      {"a.pcd", xyzPcd("99999999999999999999", "binary\n" + bytes24), "number of columns"},
      {"a.pcd", xyzPcd("0", "ascii\n"), "no points"},
      {"a.pcd", "VERSION 0.7\nFIELDS x y z\n", "no PCD header"},
      {"a.txt", std::string("\xff\xfe") + "1", "UTF-16"},
      {"a.off", "OFF BINARY\n1 0 0\n", "does not begin as"},
      {"a.agr", grid + "1 x\n3 4", "no number, but 'x'"},
      {"a.pcd", xyzPcd("4", "zip\n1 2 3\n"), "stored as 'zip'"},
      {"a.pcd", xyzPcd("5", "ascii\n1.00 2.00 3.00\n4.000 5.000 6.000\n"), "fewer points"},
      {"a.pcd", xyzPcd("4", "ascii\n1 2 3\n4 5\n6 7 8\n9 10 11\n"), "line 10 "},
      {"a.ply", points, "does not begin as a PLY"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 4\n", "no end"},
      {"a.ply", plyOf("hexadecimal", "4", points), "neither ascii"},
      {"a.ply", plyOf("ascii", "1", "1 2 3 nan 5\n", "property list uchar int a\n"),
       "it is broken"},
      {"a.ply", plyOf("binary_big_endian", "4", points, "property string a\n"),
       "unknown type, of 'a'"},
      {"a.ply", plyOf("binary_little_endian", "1000000000", bytes24), "shorter than its header"},
      {"a.ply", plyOf("ascii", "99999999999999999999", points), "number of elements"},
      {"a.ply", plyOf("ascii", "0", ""), "no points"},
      {"a.ply", plyOf("ascii", "5", points), "shorter than its header"},
      {"a.ply", plyOf("ascii", "4", "a b c\nd e f\ng h i\nj k l\n"), "line 8 "},
      {"a.ply", plyOf("ascii", "4", points, "element face 1\nproperty list float int i\n"),
       "unknown type 'float'"},
      {"a.obj", "v 1 2 3\nv 1 2\n", "line 2"},
      {"a.obj", "o nothing\nf 1 2 3\n", "no points"},
      {"a.xyz", "hello world and more\n", "line 1"},
      {"a.csv", "1,0,2,0,3,0\n4,5,5,0,6,0\n", "commas separate columns, or they are decimal"},
      {"a.csv", "1,0,2,0,3,0\n4,2,5,0,6\n", "line 2 has 5 columns instead of 6"},
      {"a.xyz", "1 2 3\n4 5 6 7\n", "line 2 has 4 columns instead of 3"},
      {"a.xyz", "1 2 3\n4 x 6\n", "line 2 has no number in column 2, but 'x'"},
      {"a.xyz", "7 1 2 3\n8 4 5 6\n9 7 8 9\n10 1 1 1\n", "first column counts the lines"},
      {"a.obj", std::string("\xfe\xff") + "v 1 2 3\n", "UTF-16"},
      {"a.xyz", "1 2 3\r4 5 6\r", "do not end in LF"},
      {"a.pts", "10\n20\n0 0 0\n1 2 3\n", "as PTX files do"},
      {"a.pts", "3\n0 0 0\n1 2 3\n", "fewer points than its first line"},
      {"a.pcd", xyzPcd("1", "ascii\n1,5 2,5\n"), "no number for 'x'"},
      {"a.txt", "# nothing\n# here\n", "no points"},
      {"a.pcd", "FIELDS x y z\nDATA ascii\n1 2 3\n", "neither WIDTH nor POINTS"},
      {"a.csv", "lat,lon,altitude\n48,8,300\n", "latitude and longitude are degrees"},
      {"a.txt", "point" + std::string(60000, 'x') + "\n1 2 3\n", "line 1"},
      {"a.node", "2 2 1 0\n1 5 6 7\n2 8 9 7\n", "two dimensions"},
      {"a.node", "3 3 0 0\n1 5 6 7\n2 8 9 7\n", "fewer points than its first line"},
      {"a.node", "1 3 0 0\n1 5 6 7\n2 8 9 7\n", "more points than its first line"},
      {"a.off", "4OFF\n1 0 0\n1 2 3 1\n", "does not begin as"},
      {"a.off", "OFF\n1000000000 0 0\n1 2 3\n", "shorter than its header"},
      {"a.stl", std::string(80, ' ') + "\xff\xff\xff\xff", "shorter than its header"},
      {"a.stl", "solid\nvertex 1 2\n", "line 2 has no three numbers"},
      {"a.stl", "solid\nvertex 1 2 3\nvertex 2 3 4\n", "not complete"},
      {"a.off", "OFF 4 2 0\n1 2 3 4 5 6\n7 8 9 1 2 4\n3 0 1 2\n3 1 2 3\n", "fewer lines"},
      {"a.csv", "x,y,width,height\n1,2,3,4\n", "nor names x, y and z"},
      {"a.agr", "ncols 2\nnrows 1\nxllcorner 8\nyllcorner 48\ncellsize 1e-3\n1 400", "degrees"},
      {"a.agr", grid + "cellsize -1\n1 2\n3 4", "no size"},
      {"a.agr", grid + "1 2\n3", "fewer elevations"},
      {"a.agr", grid + "1 2\n3 4 5", "line 7 has more elevations"},
      {"a.agr", grid + "-9999 -9999 -9999 nan", "no points"},
      {"a.agr", grid + "nrows 99999\n1 2\n3 4", "shorter than its header"},
      {"a.agr", "ncols 2\nnrows 2\n1 2\n3 4", "no cellsize"},
  };
  for (const Case& test : cases)
    expectRefused(test.name, test.content, test.cause);
}

TEST_F(CloudReader, BrokenCompressedPointsAreRefused) {
  const std::string zeros("\x00\x00\xe0\x02\x00", 5);  // one byte, then 11 times the same
  EXPECT_EQ(read("a.pcd", packedPcd("1", 12, zeros)).points, (std::vector<Point>{{0.0, 0.0, 0.0}}));
  const std::vector<std::string> broken = {
      zeros.substr(0, 4),                             // a reference that is cut
      zeros + std::string("\x00\x00", 2),             // too many
      std::string("\x00\x00\xe0\x02\x01", 5),         // before the beginning
      std::string("\xff\xff\xff", 3),                 // long before it
      std::string("\x1f\x00\x00", 3),                 // fewer literals than said
      std::string("\x0c" + std::string(13, '\x01')),  // more literals than points
      "",
  };
  for (const std::string& packed : broken)
    EXPECT_THROW(read("a.pcd", packedPcd("1", 12, packed)), Failure)
        << testing::PrintToString(packed);
  // No memory is taken for what so few bytes cannot hold.
  expectRefused("a.pcd", packedPcd("300000000", 3600000000U, zeros), "too short for the points");
}

TEST_F(CloudReader, EveryFileOfTheFuzzersIsReadOrRefused) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(FUZZERS_CORPUS)) {
    const std::string kind = entry.path().parent_path().filename().string();
    if (!entry.is_regular_file() || !formatOf("a." + kind))
      continue;
    ++count;
    SCOPED_TRACE(entry.path());
    try {
      const PointData data = read("a." + kind, readFile(entry.path().string()));
      EXPECT_FALSE(data.points.empty());
      EXPECT_TRUE(data.normals.empty() || data.normals.size() == data.points.size());
      EXPECT_TRUE(data.colors.empty() || data.colors.size() == data.points.size());
    } catch (const ToolError& error) {
      EXPECT_FALSE(error.remedy().empty());
    }
  }
  EXPECT_GT(count, 20U);
}

}  // namespace
}  // namespace spherical_param::tools
