// Reading by blocks, against PCL's readers and VTK's writers, on files of several blocks; and files
// that would have ended the program.

#include "common/cloud_reader.h"

#include "common/errors.h"
#include "common/file_formats.h"
#include "common/record_log.h"
#include "tool_runner.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <vtkBitArray.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataWriter.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataWriter.h>
#include <vtkStringArray.h>
#include <vtkStructuredGrid.h>
#include <vtkStructuredGridWriter.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridWriter.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string>
#include <type_traits>
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

/// A VTK file of text.
std::string vtkOf(const Cloud& cloud, const std::string& behind) {
  return "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET POLYDATA\nPOINTS " +
         std::to_string(cloud.size()) + " float\n" + textOf(cloud, "") + behind;
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
  const std::string vtk = vtkOf(cloud, "POINT_DATA 90000\n");
  expect_cut_refused("cut.vtk", vtk, vtk.size() - vtk.rfind("90000"), "broken or not complete");
  expect_cut_refused("cut.vtk", vtk, vtk.size() - vtk.rfind(' ', vtk.size() - 30),
                     "broken or not complete");
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
  ASSERT_EQ(pcl::io::savePCDFileBinaryCompressed(directory.file("packed.pcd"), cloud), 0);
  tool_test::writeFile(directory.file("a.xyz"), textOf(cloud, ""));
  tool_test::writeFile(directory.file("a.vtk"), vtkOf(cloud, ""));
  for (const char* name : {"a.ply", "a.pcd", "packed.pcd", "a.xyz", "a.vtk"}) {
    std::vector<double> shares;
    readCloud(directory.file(name), [&](double share) { shares.push_back(share); });
    ASSERT_GE(shares.size(), 2U) << name;
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end())) << name;
    EXPECT_LT(shares.front(), 0.8) << name;
    EXPECT_EQ(shares.back(), 1.0) << name;
  }
}

// --- VTK -------------------------------------------------------------------------------------

/// What a writer of VTK has to write, besides points and cells.
void addAttributes(vtkPointSet& set, const Cloud& cloud) {
  const auto count = static_cast<vtkIdType>(cloud.size());
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetName("Colors");
  colors->SetNumberOfComponents(4);
  vtkNew<vtkDoubleArray> normals;
  normals->SetName("n");
  normals->SetNumberOfComponents(3);
  vtkNew<vtkFloatArray> vectors;
  vectors->SetName("v");
  vectors->SetNumberOfComponents(3);
  vectors->SetComponentName(0, "first one");
  vtkNew<vtkFloatArray> tensors;
  tensors->SetName("t");
  tensors->SetNumberOfComponents(9);
  vtkNew<vtkFloatArray> textures;
  textures->SetName("u v");
  textures->SetNumberOfComponents(2);
  vtkNew<vtkIdTypeArray> ids;
  ids->SetName("ids");
  vtkNew<vtkTypeInt64Array> large;
  large->SetName("large");
  vtkNew<vtkBitArray> bits;
  bits->SetName("bits");
  vtkNew<vtkStringArray> names;
  names->SetName("names");
  for (const pcl::PointXYZRGBNormal& point : cloud) {
    colors->InsertNextTuple4(point.r, point.g, point.b, 77);
    normals->InsertNextTuple3(static_cast<double>(point.normal_x),
                              static_cast<double>(point.normal_y),
                              static_cast<double>(point.normal_z));
    vectors->InsertNextTuple3(1.0, 2.0, 3.0);
    tensors->InsertNextTuple9(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0);
    textures->InsertNextTuple2(0.5, 0.25);
    ids->InsertNextValue(ids->GetNumberOfValues());
    large->InsertNextValue(-1);
    bits->InsertNextValue(static_cast<int>(ids->GetNumberOfValues() % 2));
    names->InsertNextValue(std::string(static_cast<std::size_t>(point.r) * 2, 'n'));
  }
  ASSERT_EQ(ids->GetNumberOfValues(), count);
  vtkPointData& data = *set.GetPointData();
  data.SetScalars(colors);
  data.SetNormals(normals);
  data.SetVectors(vectors);
  data.SetTensors(tensors);
  data.SetTCoords(textures);
  data.SetPedigreeIds(ids);
  data.AddArray(large);
  data.AddArray(bits);
  data.AddArray(names);
  vtkNew<vtkDoubleArray> time;
  time->SetName("TimeValue");
  time->InsertNextValue(0.5);
  set.GetFieldData()->AddArray(time);
}

template <typename Set, typename Writer>
void writeVtk(const std::string& path, const Cloud& cloud, int point_type, bool binary,
              int version) {
  vtkNew<Set> set;
  vtkNew<vtkPoints> points;
  points->SetDataType(point_type);
  for (const pcl::PointXYZRGBNormal& point : cloud) {
    points->InsertNextPoint(static_cast<double>(point.x), static_cast<double>(point.y),
                            static_cast<double>(point.z));
  }
  set->SetPoints(points);
  const auto count = static_cast<vtkIdType>(cloud.size());
  if constexpr (std::is_same_v<Set, vtkStructuredGrid>) {
    set->SetDimensions(static_cast<int>(count), 1, 1);
  } else {
    vtkNew<vtkCellArray> cells;
    for (vtkIdType i = 2; i < count; ++i) {
      cells->InsertNextCell({i - 2, i - 1, i});
    }
    if constexpr (std::is_same_v<Set, vtkPolyData>) {
      set->SetPolys(cells);
    } else {
      set->SetCells(VTK_TRIANGLE, cells);
    }
    vtkNew<vtkFloatArray> heights;
    heights->SetName("heights");
    heights->SetNumberOfTuples(cells->GetNumberOfCells());
    heights->Fill(1.0);
    set->GetCellData()->SetScalars(heights);
  }
  addAttributes(*set, cloud);
  vtkNew<Writer> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(set);
  writer->SetFileVersion(version);
  binary ? writer->SetFileTypeToBinary() : writer->SetFileTypeToASCII();
  ASSERT_EQ(writer->Write(), 1);
}

/// Cut anywhere, it is refused, or nothing of its points is missing: sections that are lost as a
/// whole, and the ends of texts, are not missed.
void expectCutsRefused(const std::string& path, std::size_t points) {
  const std::string whole = tool_test::readFile(path);
  std::size_t refused = 0;
  constexpr std::size_t cuts = 20;
  for (std::size_t cut = 1; cut < cuts; ++cut) {
    tool_test::writeFile(path, whole.substr(0, whole.size() * cut / cuts));
    try {
      const PointData data = readCloud(path);
      EXPECT_EQ(data.points.size(), points);
      EXPECT_TRUE(data.normals.empty() || data.normals.size() == points);
      EXPECT_TRUE(data.colors.empty() || data.colors.size() == points);
    } catch (const Failure&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, cuts / 4);
}

TEST_F(CloudReader, ReadsTheFilesOfVtkWhateverElseTheyHave) {
  Cloud cloud = makeCloud();
  cloud.resize(1000);
  for (pcl::PointXYZRGBNormal& point : cloud) {
    // VTK's text has 6 digits.
    point.x = std::round(point.x * 64.0F) / 64.0F;
    point.y = std::round(point.y * 1e3F);
    point.z = std::round(point.z);
    point.normal_x = point.r % 2 == 0 ? 1.0F : 0.0F;
    point.normal_y = 0.25F;
  }
  const std::string path = directory.file("a.vtk");
  for (const int version : {42, 51}) {
    for (const bool binary : {false, true}) {
      for (const int type : {VTK_FLOAT, VTK_DOUBLE}) {
        using Write = void (*)(const std::string&, const Cloud&, int, bool, int);
        for (const Write write : {Write(writeVtk<vtkPolyData, vtkPolyDataWriter>),
                                  Write(writeVtk<vtkUnstructuredGrid, vtkUnstructuredGridWriter>),
                                  Write(writeVtk<vtkStructuredGrid, vtkStructuredGridWriter>)}) {
          write(path, cloud, type, binary, version);
          SCOPED_TRACE(tool_test::readFile(path).substr(0, 200));
          PointData data = readCloud(path);
          EXPECT_TRUE(data.has_alpha);
          for (Color& color : data.colors) {
            EXPECT_EQ(color[3], 77);
            color[3] = 255;
          }
          expectSame(data, cloud, true);
          expectCutsRefused(path, cloud.size());
        }
      }
    }
  }
}

TEST_F(CloudReader, VtkColoursOfArraysWithAName) {
  Cloud cloud = makeCloud();
  cloud.resize(2);
  const std::string path = directory.file("a.vtk");
  const auto colors_of = [&](const std::string& behind) {
    tool_test::writeFile(path, vtkOf(cloud, "POINT_DATA 2\n" + behind));
    return readCloud(path).colors;
  };
  const std::vector<Color> expected = {{1, 2, 3, 255}, {4, 5, 6, 255}};
  const std::string rgb = "RGB 3 2 unsigned_char\n1 2 3 4 5 6\n";
  EXPECT_EQ(colors_of("FIELD f 1\n" + rgb), expected);
  EXPECT_EQ(colors_of("FIELD f 2\nRGBA 4 2 unsigned_char\n9 9 9 9 9 9 9 9\n" + rgb), expected);
  EXPECT_EQ(colors_of("FIELD f 1\n" + rgb + "SCALARS s unsigned_char 3\nLOOKUP_TABLE default\n" +
                      "1 2 3\n4 5 6\n"),
            expected);
  EXPECT_TRUE(colors_of("FIELD f 1\nRGB 3 2 int\n1 2 3 4 5 6\n").empty());
  EXPECT_TRUE(colors_of("FIELD f 1\nRGB 2 2 unsigned_char\n1 2 3 4\n").empty());
  EXPECT_TRUE(colors_of("SCALARS s unsigned_char\nLOOKUP_TABLE default\n1\n2\n").empty());
}

// --- Files that would have ended the program -----------------------------------------------------

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

TEST_F(CloudReader, ColoursWithoutAllTheirChannelsAreNone) {
  tool_test::writeFile(directory.file("a.pcd"),
                       pcdOf("x y z red", "4 4 4 1", "F F F U", "1", "ascii\n1 2 3 4\n"));
  const PointData data = readCloud(directory.file("a.pcd"));
  EXPECT_EQ(data.points.size(), 1U);
  EXPECT_TRUE(data.colors.empty());
}

TEST_F(CloudReader, PackedPointsThatMakeNoSenseAreRefused) {
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

// PCL leaves these fields out of what it packs, so that the file's size is no bound of theirs.
TEST_F(CloudReader, PaddingOfPackedPointsTakesNoMemory) {
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

TEST_F(CloudReader, PointsOfVtkMayBeFarBehindTheBeginning) {
  const std::string path = directory.file("a.vtk");
  std::string before = "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET POLYDATA\nFIELD f 2\n"
                       "words 1 1 string\npoints 7 float\nmany 1 1000000 int\n";
  for (int i = 0; i < 1000000; ++i) {
    before += "0 ";
  }
  tool_test::writeFile(path, before + "\nPOINTS\n2 float 1 2 3\n4 5 6\n");
  EXPECT_EQ(readCloud(path).points, (std::vector<Point>{{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}}));
  tool_test::writeFile(path, before + "\nPOINTS 800000000 float 1 2 3\n");
  expectRefused(path, "shorter than its header says");
  tool_test::writeFile(path, before + "\nVERTICES 0 0\n");
  expectRefused(path, "it has no points");
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
  for (const std::string format : {"ascii", "binary_little_endian"}) {
    const std::string header = "ply\nformat " + format +
                               " 1.0\nelement vertex 1\nproperty float x\nproperty float "
                               "y\nproperty float z\nelement nothing 1073741824\nend_header\n";
    tool_test::writeFile(directory.file("a.ply"),
                         header + (format == "ascii" ? "0 0 0\n" : std::string(12, '\0')));
    EXPECT_EQ(readCloud(directory.file("a.ply")).points.size(), 1U);
  }
}

TEST_F(CloudReader, LengthsOfListsAreWholeNumbers) {
  tool_test::writeFile(
      directory.file("a.ply"),
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
      "y\nproperty float z\nelement face 1\nproperty list float int i\nend_header\n"
      "0 0 0\n1 0\n");
  expectRefused(directory.file("a.ply"), "unknown type 'float'");
}

// PCL's reader spreads such points over the grid; here they are just read.
TEST_F(CloudReader, PointsOfARangeGridAreReadInTheirOrder) {
  tool_test::writeFile(directory.file("a.ply"),
                       "ply\nformat ascii 1.0\nobj_info num_cols 1073741824\nobj_info num_rows "
                       "1073741824\nobj_info num_rows 1073741824\nelement vertex 2\nproperty float "
                       "x\nproperty float y\nproperty float z\nelement range_grid 3\nproperty list "
                       "uchar int vertex_indices\nend_header\n1 2 3\n4 5 6\n1 1\n0\n1 0\n");
  EXPECT_EQ(readCloud(directory.file("a.ply")).points,
            (std::vector<Point>{{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}}));
}

TEST_F(CloudReader, RecordsThatAreNestedDeeplyAreNotKept) {
  const std::string path = directory.file("a.jsonl");
  const std::string deep = std::string(1000000, '[') + std::string(1000000, ']');
  tool_test::writeFile(path, "{\"output\":" + deep + "}\n" + deep + "\n{\"output\":[[1]]}\n");
  const std::vector<Json> records = readRecords(path);
  ASSERT_EQ(records.size(), 2U);
  EXPECT_LT(records[0].dump().size(), 200U);  // the rest of it is as if it were not there
  EXPECT_EQ(records[1]["output"], Json::parse("[[1]]"));
}

/// An answer or a refusal, but nothing else.
void expectAnswer(const std::string& path) {
  try {
    const PointData data = readCloud(path);
    EXPECT_FALSE(data.points.empty());
    EXPECT_TRUE(data.normals.empty() || data.normals.size() == data.points.size());
    EXPECT_TRUE(data.colors.empty() || data.colors.size() == data.points.size());
  } catch (const ToolError& error) {
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST_F(CloudReader, EveryFileOfTheFuzzersHasAnAnswer) {
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
    expectAnswer(path);
  }
  EXPECT_GT(count, 30U);
}

}  // namespace
}  // namespace spherical_param::tools
