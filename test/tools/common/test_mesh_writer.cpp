// Meshes and clouds of all formats, read back by PCL, VTK or our own reader.

#include "common/mesh_writer.h"

#include "common/cloud_reader.h"
#include "common/file_formats.h"
#include "common/output_file.h"
#include "temporary_directory.h"

#include <pcl/PolygonMesh.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <vtkCellArray.h>
#include <vtkCompositeDataIterator.h>
#include <vtkDataArray.h>
#include <vtkGLTFReader.h>
#include <vtkIdList.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

using tool_test::readFile;
using tool_test::TemporaryDirectory;

/// To 22 bits. Not by a cast to float and back, which GCC 12 leaves out.
double rounded(double value) {
  return std::ldexp(std::round(std::ldexp(value, 22)), -22);
}

/// Points with coordinates that need all digits of a float, or of a double where x and y are
/// shifted.
TriangleMesh makeMesh(std::size_t n, double shift = 0.0) {
  TriangleMesh mesh;
  PointData& vertices = mesh.vertices;
  for (std::size_t i = 0; i < n; ++i) {
    const auto t = static_cast<double>(i);
    vertices.points.push_back({shift + rounded(std::sin(t) / 3.0),
                               shift + rounded(std::cos(0.7 * t) / 7.0), rounded(1e-5 * t)});
    vertices.normals.push_back(toFloat({std::cos(t), 0.0, std::sin(t)}));
    vertices.colors.push_back({static_cast<std::uint8_t>(i % 256),
                               static_cast<std::uint8_t>(7 * i % 256),
                               static_cast<std::uint8_t>(255 - i % 256), 255});
  }
  for (std::int32_t i = 0; i + 2 < static_cast<std::int32_t>(n); ++i)
    mesh.triangles.push_back({i + 2, i, i + 1});
  return mesh;
}

void writeTo(const std::string& path, const TriangleMesh& mesh, Encoding encoding,
             const FileProgress& progress = {}) {
  OutputFile file(path);
  writeMesh(file, mesh, formatOf(path), encoding, progress);
  file.commit();
}

/// The first values as numbers of another type.
template <typename Number, typename Values>
std::array<Number, 3> threeOf(const Values& values) {
  return {static_cast<Number>(values[0]), static_cast<Number>(values[1]),
          static_cast<Number>(values[2])};
}

TriangleMesh readWithPcl(const std::string& path) {
  pcl::PolygonMesh file;
  const bool is_pcd = formatOf(path) == formatOf("a.pcd");
  EXPECT_EQ(is_pcd ? pcl::PCDReader().read(path, file.cloud) : pcl::PLYReader().read(path, file),
            0);
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud;
  pcl::fromPCLPointCloud2(file.cloud, cloud);
  TriangleMesh mesh;
  for (const auto& point : cloud) {
    mesh.vertices.points.push_back(threeOf<double>(point.data));
    mesh.vertices.normals.push_back({point.normal_x, point.normal_y, point.normal_z});
    mesh.vertices.colors.push_back({point.r, point.g, point.b, 255});
  }
  for (const pcl::Vertices& polygon : file.polygons) {
    EXPECT_EQ(polygon.vertices.size(), 3U);
    mesh.triangles.push_back(threeOf<std::int32_t>(polygon.vertices));
  }
  return mesh;
}

TriangleMesh meshOf(vtkPolyData& data) {
  TriangleMesh mesh;
  auto* const normals = data.GetPointData()->GetNormals();
  auto* const colors = vtkUnsignedCharArray::SafeDownCast(data.GetPointData()->GetScalars());
  for (vtkIdType i = 0; i < data.GetNumberOfPoints(); ++i) {
    mesh.vertices.points.push_back(threeOf<double>(data.GetPoint(i)));
    if (normals != nullptr)
      mesh.vertices.normals.push_back(threeOf<float>(normals->GetTuple3(i)));
    if (colors != nullptr)
      mesh.vertices.colors.push_back({colors->GetTypedComponent(i, 0),
                                      colors->GetTypedComponent(i, 1),
                                      colors->GetTypedComponent(i, 2), 255});
  }
  vtkNew<vtkIdList> cell;
  for (vtkIdType i = 0; i < data.GetPolys()->GetNumberOfCells(); ++i) {
    data.GetPolys()->GetCellAtId(i, cell);
    EXPECT_EQ(cell->GetNumberOfIds(), 3);
    mesh.triangles.push_back(threeOf<std::int32_t>(cell->GetPointer(0)));
  }
  return mesh;
}

template <typename Reader>
TriangleMesh readWithVtk(const std::string& path) {
  vtkNew<Reader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return meshOf(*reader->GetOutput());
}

/// Its colours have 16 bits, and are linear in the light.
TriangleMesh readGlb(const std::string& path) {
  vtkNew<vtkGLTFReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  const auto parts = vtk::TakeSmartPointer(reader->GetOutput()->NewIterator());
  auto& data = *vtkPolyData::SafeDownCast(parts->GetCurrentDataObject());
  TriangleMesh mesh = meshOf(data);
  vtkDataArray& colors = *data.GetPointData()->GetArray("COLOR_0");
  mesh.vertices.colors.resize(mesh.vertices.points.size());
  for (std::size_t i = 0; i < mesh.vertices.points.size(); ++i)
    for (int c = 0; c < 4; ++c) {
      const double most = colors.GetRange(3)[1];
      const double linear = colors.GetComponent(static_cast<vtkIdType>(i), c) / most;
      const double value = c == 3 || linear <= 0.0031308
                               ? linear * (c == 3 ? 1.0 : 12.92)
                               : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
      mesh.vertices.colors[i][static_cast<std::size_t>(c)] =
          static_cast<std::uint8_t>(std::lround(255.0 * value));
    }
  return mesh;
}

/// The places of the corners of all triangles.
std::vector<Point> cornersOf(const TriangleMesh& mesh) {
  std::vector<Point> corners;
  for (const auto& triangle : mesh.triangles)
    for (const std::int32_t corner : triangle)
      corners.push_back(mesh.vertices.points[static_cast<std::size_t>(corner)]);
  return corners;
}

class MeshWriter : public testing::Test {
protected:
  // PCL warns of each file that it has no curvature.
  MeshWriter() { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }

  const TemporaryDirectory directory;
};

TEST_F(MeshWriter, OtherReadersFindThePointsNormalsColoursAndTriangles) {
  const TriangleMesh mesh = makeMesh(300);
  const std::map<std::string, TriangleMesh (*)(const std::string&)> readers = {
      {"out.PLY", readWithPcl},
      {"out.pcd", readWithPcl},
      {"out.obj", readWithVtk<vtkOBJReader>},
      {"out.stl", readWithVtk<vtkSTLReader>},
      {"out.vtk", readWithVtk<vtkPolyDataReader>},
      {"out.glb", readGlb}};
  for (const bool is_text : {false, true})
    for (const auto& [name, read_mesh] : readers) {
      if (is_text && (name == "out.pcd" || name == "out.glb"))
        continue;  // they have no text
      SCOPED_TRACE(name + (is_text ? " as text" : ""));
      const std::string path = directory.file(name);
      writeTo(path, mesh, is_text ? Encoding::Ascii : Encoding::Binary);
      const bool has_zeros = readFile(path).find('\0') != std::string::npos;
      EXPECT_EQ(has_zeros, !is_text && name != "out.obj");
      const TriangleMesh read = read_mesh(path);
      if (name == "out.stl") {  // has no vertices
        EXPECT_EQ(cornersOf(read), cornersOf(mesh));
        continue;
      }
      EXPECT_EQ(read.vertices.points, mesh.vertices.points);
      if (name != "out.pcd") {
        EXPECT_EQ(read.triangles, mesh.triangles);
      }
      EXPECT_EQ(read.vertices.colors.empty(), name == "out.obj");  // not VTK
      EXPECT_TRUE(read.vertices.colors.empty() || read.vertices.colors == mesh.vertices.colors);
      ASSERT_EQ(read.vertices.normals.size(), 300U);
      for (std::size_t i = 0; i < 300; ++i)  // VTK normalises those of glTF again
        for (std::size_t d = 0; d < 3; ++d)
          ASSERT_NEAR(read.vertices.normals[i][d], mesh.vertices.normals[i][d],
                      name == "out.glb" ? 1e-6 : 0.0);
    }
}

/// More than a block, with alpha where the format has it, near the origin and far from it.
TEST_F(MeshWriter, OurReadersFindWhatIsInLargeClouds) {
  for (const double shift : {0.0, 5e5})
    for (const bool has_alpha : {false, true}) {
      TriangleMesh mesh = makeMesh(60000, shift);
      mesh.triangles.clear();
      mesh.vertices.has_alpha = has_alpha;
      for (Color& color : mesh.vertices.colors)
        color[3] = has_alpha ? color[0] : std::uint8_t{255};
      for (const char* name : {"a.pcd", "a.ply", "a.obj", "a.xyz", "a.txt", "a.off"}) {
        if (has_alpha && formatOf(name) != formatOf("a.pcd") && formatOf(name) != formatOf("a.ply"))
          continue;
        SCOPED_TRACE(std::string(name) + " at " + std::to_string(shift));
        std::vector<double> written;
        std::vector<double> done;
        writeTo(directory.file(name), mesh, Encoding::Binary,
                [&](double fraction) { written.push_back(fraction); });
        const PointData read =
            readCloud(directory.file(name), [&](double fraction) { done.push_back(fraction); });
        for (const std::vector<double>& fractions : {written, done}) {
          ASSERT_FALSE(fractions.empty());
          EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
          EXPECT_GT(fractions.front(), 0.0);
          EXPECT_LE(fractions.back(), 1.0);
        }
        EXPECT_LT(done.front(), 0.9);
        EXPECT_EQ(done.back(), 1.0);
        // Text in single precision has no more digits than that needs.
        if (shift == 0.0) {
          EXPECT_EQ(positionsOf(read).cast<float>(), positionsOf(mesh.vertices).cast<float>());
        } else {
          EXPECT_EQ(read.points, mesh.vertices.points);
        }
        EXPECT_TRUE(read.normals == mesh.vertices.normals);
        EXPECT_TRUE(read.colors == mesh.vertices.colors);
        EXPECT_EQ(read.has_alpha, has_alpha);
      }
    }
}

TEST_F(MeshWriter, ScalarsAreInPlyAndVtk) {
  TriangleMesh mesh = makeMesh(50);
  mesh.vertices.scalars = {{"intensity", std::vector<double>(50, 0.25)},
                           {"time", std::vector<double>(50, 1700000000.25), true}};
  for (const Encoding encoding : {Encoding::Binary, Encoding::Ascii}) {
    writeTo(directory.file("a.ply"), mesh, encoding);
    const std::vector<Scalar> read = readCloud(directory.file("a.ply")).scalars;
    writeTo(directory.file("a.vtk"), mesh, encoding);
    vtkNew<vtkPolyDataReader> reader;
    reader->SetFileName(directory.file("a.vtk").c_str());
    reader->ReadAllScalarsOn();
    reader->ReadAllColorScalarsOn();
    reader->Update();
    ASSERT_EQ(read.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      const Scalar& scalar = mesh.vertices.scalars[i];
      EXPECT_EQ(read[i].name, scalar.name);
      EXPECT_EQ(read[i].values, scalar.values);
      vtkDataArray* const array =
          reader->GetOutput()->GetPointData()->GetArray(scalar.name.c_str());
      ASSERT_NE(array, nullptr) << scalar.name;
      EXPECT_EQ(array->GetTuple1(49), scalar.values[49]);
    }
  }
}

}  // namespace
}  // namespace spherical_param::tools
