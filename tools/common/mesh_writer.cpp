#include "common/mesh_writer.h"

#include "common/errors.h"
#include "common/record_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace spherical_param::tools {
namespace {

std::string count(std::size_t number) {
  return std::to_string(number);
}

void writeCorners(RecordWriter& writer, const Triangle& triangle) {
  for (const std::int32_t corner : triangle) {
    writer.text(" ");
    writer.number(std::int64_t{corner});
  }
}

std::size_t channelCount(const MeshView& mesh) {
  return mesh.hasAlpha() ? 4 : 3;
}

void writePly(RecordWriter& writer, const MeshView& mesh, Encoding encoding) {
  writer.line("ply");
  writer.line(encoding == Encoding::Binary ? "format binary_little_endian 1.0"
                                           : "format ascii 1.0");
  writer.line("element vertex " + count(mesh.vertexCount()));
  for (const char* name : {"x", "y", "z"}) {
    writer.line(std::string("property float ") + name);
  }
  if (mesh.hasNormals()) {
    for (const char* name : {"nx", "ny", "nz"}) {
      writer.line(std::string("property float ") + name);
    }
  }
  if (mesh.hasColors()) {
    for (const char* name : {"red", "green", "blue"}) {
      writer.line(std::string("property uchar ") + name);
    }
    if (mesh.hasAlpha()) {
      writer.line("property uchar alpha");
    }
  }
  if (mesh.triangleCount() > 0) {
    writer.line("element face " + count(mesh.triangleCount()));
    writer.line("property list uchar int vertex_indices");
  }
  writer.line("end_header");

  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    if (encoding == Encoding::Binary) {
      writer.words(mesh.point(i), ByteOrder::Little);
      if (mesh.hasNormals()) {
        writer.words(mesh.normal(i), ByteOrder::Little);
      }
      for (std::size_t c = 0; c < (!mesh.hasColors() ? 0 : channelCount(mesh)); ++c) {
        writer.byte(mesh.color(i)[c]);
      }
      writer.endRecord();
    } else {
      writer.numbers(mesh.point(i));
      if (mesh.hasNormals()) {
        writer.text(" ");
        writer.numbers(mesh.normal(i));
      }
      for (std::size_t c = 0; c < (!mesh.hasColors() ? 0 : channelCount(mesh)); ++c) {
        writer.text(" ");
        writer.number(std::int64_t{mesh.color(i)[c]});
      }
      writer.endLine();
    }
  }
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    if (encoding == Encoding::Binary) {
      writer.byte(3);
      writer.words(triangle, ByteOrder::Little);
      writer.endRecord();
    } else {
      writer.text("3");
      writeCorners(writer, triangle);
      writer.endLine();
    }
  }
}

void writeObj(RecordWriter& writer, const MeshView& mesh) {
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writer.text("v ");
    writer.numbers(mesh.point(i));
    if (mesh.hasColors()) {
      const Color& color = mesh.color(i);
      writer.text(" ");
      writer.numbers({static_cast<float>(color[0]) / 255.0F, static_cast<float>(color[1]) / 255.0F,
                      static_cast<float>(color[2]) / 255.0F});
    }
    writer.endLine();
  }
  for (std::size_t i = 0; mesh.hasNormals() && i < mesh.vertexCount(); ++i) {
    writer.text("vn ");
    writer.numbers(mesh.normal(i));
    writer.endLine();
  }
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    writer.text("f");
    for (const std::int32_t corner : triangle) {
      writer.text(" ");
      writer.number(std::int64_t{corner} + 1);
      if (mesh.hasNormals()) {
        writer.text("//");
        writer.number(std::int64_t{corner} + 1);
      }
    }
    writer.endLine();
  }
}

Point facetNormal(const Point& a, const Point& b, const Point& c) {
  std::array<double, 3> ab{};
  std::array<double, 3> ac{};
  for (std::size_t d = 0; d < 3; ++d) {
    ab[d] = static_cast<double>(b[d]) - static_cast<double>(a[d]);
    ac[d] = static_cast<double>(c[d]) - static_cast<double>(a[d]);
  }
  const std::array<double, 3> cross = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                                       ab[0] * ac[1] - ab[1] * ac[0]};
  const double length = std::hypot(cross[0], cross[1], cross[2]);
  if (!(length > 0.0)) {
    return {0.0F, 0.0F, 0.0F};  // what STL readers expect of a triangle without area
  }
  return {static_cast<float>(cross[0] / length), static_cast<float>(cross[1] / length),
          static_cast<float>(cross[2] / length)};
}

void writeStl(RecordWriter& writer, const MeshView& mesh, Encoding encoding) {
  if (encoding == Encoding::Binary) {
    // 80 bytes of free text, which must not begin with "solid", as files in text do.
    std::string header = "binary STL";
    header.resize(80, ' ');
    writer.text(header);
    writer.word(static_cast<std::uint32_t>(mesh.triangleCount()), ByteOrder::Little);
    writer.endRecord();
  } else {
    writer.line("solid mesh");
  }
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    const std::array<Point, 3> corners = {mesh.point(static_cast<std::size_t>(triangle[0])),
                                          mesh.point(static_cast<std::size_t>(triangle[1])),
                                          mesh.point(static_cast<std::size_t>(triangle[2]))};
    const Point normal = facetNormal(corners[0], corners[1], corners[2]);
    if (encoding == Encoding::Binary) {
      writer.words(normal, ByteOrder::Little);
      for (const Point& corner : corners) {
        writer.words(corner, ByteOrder::Little);
      }
      writer.byte(0);
      writer.byte(0);
      writer.endRecord();
    } else {
      writer.text("facet normal ");
      writer.numbers(normal);
      writer.endLine();
      writer.line("outer loop");
      for (const Point& corner : corners) {
        writer.text("vertex ");
        writer.numbers(corner);
        writer.endLine();
      }
      writer.line("endloop");
      writer.line("endfacet");
    }
  }
  if (encoding == Encoding::Ascii) {
    writer.line("endsolid mesh");
  }
}

/// Legacy format, version 3.0: every VTK can read that, and pcl_viewer with it.
void writeVtk(RecordWriter& writer, const MeshView& mesh, Encoding encoding) {
  const bool binary = encoding == Encoding::Binary;
  const auto write_point = [&](const Point& point) {
    if (binary) {
      writer.words(point, ByteOrder::Big);
      writer.endRecord();
    } else {
      writer.numbers(point);
      writer.endLine();
    }
  };

  writer.line("# vtk DataFile Version 3.0");
  writer.line(mesh.triangleCount() == 0 ? "point cloud" : "triangle mesh");
  writer.line(binary ? "BINARY" : "ASCII");
  writer.line("DATASET POLYDATA");
  writer.line("POINTS " + count(mesh.vertexCount()) + " float");
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    write_point(mesh.point(i));
  }
  if (mesh.triangleCount() == 0) {
    // Points that belong to no cell are not shown.
    writer.line("VERTICES " + count(mesh.vertexCount()) + " " + count(2 * mesh.vertexCount()));
    for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
      if (binary) {
        writer.word(std::uint32_t{1}, ByteOrder::Big);
        writer.word(static_cast<std::uint32_t>(i), ByteOrder::Big);
        writer.endRecord();
      } else {
        writer.line("1 " + count(i));
      }
    }
  } else {
    writer.line("POLYGONS " + count(mesh.triangleCount()) + " " + count(4 * mesh.triangleCount()));
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
      const Triangle triangle = mesh.triangle(t);
      if (binary) {
        writer.word(std::uint32_t{3}, ByteOrder::Big);
        writer.words(triangle, ByteOrder::Big);
        writer.endRecord();
      } else {
        writer.text("3");
        writeCorners(writer, triangle);
        writer.endLine();
      }
    }
  }
  if (!mesh.hasColors() && !mesh.hasNormals()) {
    return;
  }
  writer.line("POINT_DATA " + count(mesh.vertexCount()));
  if (mesh.hasColors()) {
    writer.line("COLOR_SCALARS Colors " + count(channelCount(mesh)));
    for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
      const Color color = mesh.color(i);
      for (std::size_t c = 0; c < channelCount(mesh); ++c) {
        if (binary) {
          writer.byte(color[c]);
        } else {
          writer.text(c == 0 ? "" : " ");
          writer.number(static_cast<float>(color[c]) / 255.0F);
        }
      }
      if (binary) {
        writer.endRecord();
      } else {
        writer.endLine();
      }
    }
  }
  if (mesh.hasNormals()) {
    writer.line("NORMALS Normals float");
    for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
      write_point(mesh.normal(i));
    }
  }
}

/// Colours are 0 ... 255 with alpha, as most programs read them.
void writeOff(RecordWriter& writer, const MeshView& mesh) {
  writer.text(!mesh.hasColors() ? "" : "C");
  writer.text(!mesh.hasNormals() ? "" : "N");
  writer.line("OFF");
  writer.line(count(mesh.vertexCount()) + " " + count(mesh.triangleCount()) + " 0");
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writer.numbers(mesh.point(i));
    if (mesh.hasNormals()) {
      writer.text(" ");
      writer.numbers(mesh.normal(i));
    }
    if (mesh.hasColors()) {
      for (const std::uint8_t channel : mesh.color(i)) {
        writer.text(" ");
        writer.number(std::int64_t{channel});
      }
    }
    writer.endLine();
  }
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    writer.text("3");
    writeCorners(writer, triangle);
    writer.endLine();
  }
}

void writeXyz(RecordWriter& writer, const MeshView& mesh) {
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writer.numbers(mesh.point(i));
    if (mesh.hasColors()) {
      for (std::size_t c = 0; c < 3; ++c) {
        writer.text(" ");
        writer.number(std::int64_t{mesh.color(i)[c]});
      }
    }
    if (mesh.hasNormals()) {
      writer.text(" ");
      writer.numbers(mesh.normal(i));
    }
    writer.endLine();
  }
}

/// The header has the lines of PCL's own, in their order.
void writePcd(RecordWriter& writer, const MeshView& mesh) {
  std::string fields = "x y z";
  std::string types = "F F F";
  std::size_t numbers = 3;
  if (mesh.hasNormals()) {
    fields += " normal_x normal_y normal_z";
    types += " F F F";
    numbers += 3;
  }
  if (mesh.hasColors()) {
    fields += mesh.hasAlpha() ? " rgba" : " rgb";
    types += mesh.hasAlpha() ? " U" : " F";
    ++numbers;
  }
  std::string sizes;
  std::string counts;
  for (std::size_t i = 0; i < numbers; ++i) {
    sizes += " 4";
    counts += " 1";
  }
  writer.line("# .PCD v0.7 - Point Cloud Data file format");
  writer.line("VERSION 0.7");
  writer.line("FIELDS " + fields);
  writer.line("SIZE" + sizes);
  writer.line("TYPE " + types);
  writer.line("COUNT" + counts);
  writer.line("WIDTH " + count(mesh.vertexCount()));
  writer.line("HEIGHT 1");
  writer.line("VIEWPOINT 0 0 0 1 0 0 0");
  writer.line("POINTS " + count(mesh.vertexCount()));
  writer.line("DATA binary");
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writer.words(mesh.point(i), ByteOrder::Little);
    if (mesh.hasNormals()) {
      writer.words(mesh.normal(i), ByteOrder::Little);
    }
    if (mesh.hasColors()) {
      std::uint32_t packed = 0;
      for (const std::size_t channel : {3U, 0U, 1U, 2U}) {
        const bool kept = channel != 3 || mesh.hasAlpha();
        packed = packed << 8U | (kept ? mesh.color(i)[channel] : 0U);
      }
      writer.word(packed, ByteOrder::Little);
    }
    writer.endRecord();
  }
}

}  // namespace

void writeMesh(OutputFile& file, const MeshView& mesh, FileFormat format, Encoding encoding,
               const FileProgress& progress) {
  const bool stl = format == FileFormat::Stl;
  const std::size_t of_vertex = stl ? 0
                                : format == FileFormat::Obj || format == FileFormat::Vtk
                                    ? 1 + (mesh.hasNormals() ? 1 : 0)
                                    : 1;
  const std::size_t of_triangle = stl && encoding == Encoding::Ascii ? 7 : 1;
  RecordWriter writer(file, of_vertex * mesh.vertexCount() + of_triangle * mesh.triangleCount(),
                      progress);
  switch (format) {
  case FileFormat::Ply:
    writePly(writer, mesh, encoding);
    break;
  case FileFormat::Obj:
    writeObj(writer, mesh);
    break;
  case FileFormat::Stl:
    writeStl(writer, mesh, encoding);
    break;
  case FileFormat::Vtk:
    writeVtk(writer, mesh, encoding);
    break;
  case FileFormat::Off:
    writeOff(writer, mesh);
    break;
  case FileFormat::Xyz:
    writeXyz(writer, mesh);
    break;
  case FileFormat::Pcd:
    writePcd(writer, mesh);
    break;
  }
  writer.finish();
}

}  // namespace spherical_param::tools
