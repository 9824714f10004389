#include "common/mesh_writer.h"

#include "common/errors.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

namespace spherical_param::tools {
namespace {

enum class ByteOrder { Little, Big };

/// Puts numbers and text together and hands them to the file in larger pieces.
class Writer {
public:
  explicit Writer(OutputFile& file) : file_(file) {}

  void text(std::string_view part) { line_ += part; }
  /// 9 digits tell every two floats apart.
  void number(float value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                   std::chars_format::general, 9);
    line_.append(digits.data(), end.ptr);
  }
  void number(std::int64_t value) { line_ += std::to_string(value); }
  void numbers(const Point& values) {
    number(values[0]);
    text(" ");
    number(values[1]);
    text(" ");
    number(values[2]);
  }

  void byte(std::uint8_t value) { line_ += static_cast<char>(value); }
  void word(std::uint32_t value, ByteOrder order) {
    for (unsigned i = 0; i < 4; ++i) {
      const unsigned shift = order == ByteOrder::Little ? 8 * i : 24 - 8 * i;
      byte(static_cast<std::uint8_t>(value >> shift));
    }
  }
  void word(float value, ByteOrder order) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    word(bits, order);
  }
  void words(const Point& values, ByteOrder order) {
    for (const float value : values) {
      word(value, order);
    }
  }

  /// Ends a line or record.
  void send() {
    file_.write(line_);
    line_.clear();
  }
  void endLine() {
    line_ += '\n';
    send();
  }
  void line(std::string_view whole) {
    text(whole);
    endLine();
  }

private:
  OutputFile& file_;
  std::string line_;
};

std::string count(std::size_t number) {
  return std::to_string(number);
}

void writeCorners(Writer& writer, const std::array<std::int32_t, 3>& triangle) {
  for (const std::int32_t corner : triangle) {
    writer.text(" ");
    writer.number(std::int64_t{corner});
  }
}

std::size_t channelCount(const PointData& data) {
  return data.has_alpha ? 4 : 3;
}

void writePly(Writer& writer, const TriangleMesh& mesh, Encoding encoding) {
  const PointData& data = mesh.vertices;
  writer.line("ply");
  writer.line(encoding == Encoding::Binary ? "format binary_little_endian 1.0"
                                           : "format ascii 1.0");
  writer.line("element vertex " + count(data.points.size()));
  for (const char* name : {"x", "y", "z"}) {
    writer.line(std::string("property float ") + name);
  }
  if (!data.normals.empty()) {
    for (const char* name : {"nx", "ny", "nz"}) {
      writer.line(std::string("property float ") + name);
    }
  }
  if (!data.colors.empty()) {
    for (const char* name : {"red", "green", "blue"}) {
      writer.line(std::string("property uchar ") + name);
    }
    if (data.has_alpha) {
      writer.line("property uchar alpha");
    }
  }
  if (!mesh.triangles.empty()) {
    writer.line("element face " + count(mesh.triangles.size()));
    writer.line("property list uchar int vertex_indices");
  }
  writer.line("end_header");

  for (std::size_t i = 0; i < data.points.size(); ++i) {
    if (encoding == Encoding::Binary) {
      writer.words(data.points[i], ByteOrder::Little);
      if (!data.normals.empty()) {
        writer.words(data.normals[i], ByteOrder::Little);
      }
      for (std::size_t c = 0; c < (data.colors.empty() ? 0 : channelCount(data)); ++c) {
        writer.byte(data.colors[i][c]);
      }
      writer.send();
    } else {
      writer.numbers(data.points[i]);
      if (!data.normals.empty()) {
        writer.text(" ");
        writer.numbers(data.normals[i]);
      }
      for (std::size_t c = 0; c < (data.colors.empty() ? 0 : channelCount(data)); ++c) {
        writer.text(" ");
        writer.number(std::int64_t{data.colors[i][c]});
      }
      writer.endLine();
    }
  }
  for (const auto& triangle : mesh.triangles) {
    if (encoding == Encoding::Binary) {
      writer.byte(3);
      for (const std::int32_t corner : triangle) {
        writer.word(static_cast<std::uint32_t>(corner), ByteOrder::Little);
      }
      writer.send();
    } else {
      writer.text("3");
      writeCorners(writer, triangle);
      writer.endLine();
    }
  }
}

void writeObj(Writer& writer, const TriangleMesh& mesh) {
  const PointData& data = mesh.vertices;
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    writer.text("v ");
    writer.numbers(data.points[i]);
    if (!data.colors.empty()) {
      const Color& color = data.colors[i];
      writer.text(" ");
      writer.numbers({static_cast<float>(color[0]) / 255.0F, static_cast<float>(color[1]) / 255.0F,
                      static_cast<float>(color[2]) / 255.0F});
    }
    writer.endLine();
  }
  for (const Point& normal : data.normals) {
    writer.text("vn ");
    writer.numbers(normal);
    writer.endLine();
  }
  for (const auto& triangle : mesh.triangles) {
    writer.text("f");
    for (const std::int32_t corner : triangle) {
      const std::string number = std::to_string(corner + 1);
      writer.text(" " + number + (data.normals.empty() ? "" : "//" + number));
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

void writeStl(Writer& writer, const TriangleMesh& mesh, Encoding encoding) {
  const std::vector<Point>& points = mesh.vertices.points;
  if (encoding == Encoding::Binary) {
    // 80 bytes of free text, which must not begin with "solid", as files in text do.
    std::string header = "binary STL";
    header.resize(80, ' ');
    writer.text(header);
    writer.word(static_cast<std::uint32_t>(mesh.triangles.size()), ByteOrder::Little);
    writer.send();
  } else {
    writer.line("solid mesh");
  }
  for (const auto& triangle : mesh.triangles) {
    const std::array<Point, 3> corners = {points[static_cast<std::size_t>(triangle[0])],
                                          points[static_cast<std::size_t>(triangle[1])],
                                          points[static_cast<std::size_t>(triangle[2])]};
    const Point normal = facetNormal(corners[0], corners[1], corners[2]);
    if (encoding == Encoding::Binary) {
      writer.words(normal, ByteOrder::Little);
      for (const Point& corner : corners) {
        writer.words(corner, ByteOrder::Little);
      }
      writer.byte(0);
      writer.byte(0);
      writer.send();
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
void writeVtk(Writer& writer, const TriangleMesh& mesh, Encoding encoding) {
  const PointData& data = mesh.vertices;
  const bool binary = encoding == Encoding::Binary;
  const auto write_point = [&](const Point& point) {
    if (binary) {
      writer.words(point, ByteOrder::Big);
      writer.send();
    } else {
      writer.numbers(point);
      writer.endLine();
    }
  };

  writer.line("# vtk DataFile Version 3.0");
  writer.line(mesh.triangles.empty() ? "point cloud" : "triangle mesh");
  writer.line(binary ? "BINARY" : "ASCII");
  writer.line("DATASET POLYDATA");
  writer.line("POINTS " + count(data.points.size()) + " float");
  for (const Point& point : data.points) {
    write_point(point);
  }
  if (mesh.triangles.empty()) {
    // Points that belong to no cell are not shown.
    writer.line("VERTICES " + count(data.points.size()) + " " + count(2 * data.points.size()));
    for (std::size_t i = 0; i < data.points.size(); ++i) {
      if (binary) {
        writer.word(std::uint32_t{1}, ByteOrder::Big);
        writer.word(static_cast<std::uint32_t>(i), ByteOrder::Big);
        writer.send();
      } else {
        writer.line("1 " + count(i));
      }
    }
  } else {
    writer.line("POLYGONS " + count(mesh.triangles.size()) + " " +
                count(4 * mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles) {
      if (binary) {
        writer.word(std::uint32_t{3}, ByteOrder::Big);
        for (const std::int32_t corner : triangle) {
          writer.word(static_cast<std::uint32_t>(corner), ByteOrder::Big);
        }
        writer.send();
      } else {
        writer.text("3");
        writeCorners(writer, triangle);
        writer.endLine();
      }
    }
  }
  if (data.colors.empty() && data.normals.empty()) {
    return;
  }
  writer.line("POINT_DATA " + count(data.points.size()));
  if (!data.colors.empty()) {
    writer.line("COLOR_SCALARS Colors " + count(channelCount(data)));
    for (const Color& color : data.colors) {
      for (std::size_t c = 0; c < channelCount(data); ++c) {
        if (binary) {
          writer.byte(color[c]);
        } else {
          writer.text(c == 0 ? "" : " ");
          writer.number(static_cast<float>(color[c]) / 255.0F);
        }
      }
      if (binary) {
        writer.send();
      } else {
        writer.endLine();
      }
    }
  }
  if (!data.normals.empty()) {
    writer.line("NORMALS Normals float");
    for (const Point& normal : data.normals) {
      write_point(normal);
    }
  }
}

/// Colours are 0 ... 255 with alpha, as most programs read them.
void writeOff(Writer& writer, const TriangleMesh& mesh) {
  const PointData& data = mesh.vertices;
  writer.text(data.colors.empty() ? "" : "C");
  writer.text(data.normals.empty() ? "" : "N");
  writer.line("OFF");
  writer.line(count(data.points.size()) + " " + count(mesh.triangles.size()) + " 0");
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    writer.numbers(data.points[i]);
    if (!data.normals.empty()) {
      writer.text(" ");
      writer.numbers(data.normals[i]);
    }
    if (!data.colors.empty()) {
      for (const std::uint8_t channel : data.colors[i]) {
        writer.text(" ");
        writer.number(std::int64_t{channel});
      }
    }
    writer.endLine();
  }
  for (const auto& triangle : mesh.triangles) {
    writer.text("3");
    writeCorners(writer, triangle);
    writer.endLine();
  }
}

void writeXyz(Writer& writer, const PointData& data) {
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    writer.numbers(data.points[i]);
    if (!data.colors.empty()) {
      for (std::size_t c = 0; c < 3; ++c) {
        writer.text(" ");
        writer.number(std::int64_t{data.colors[i][c]});
      }
    }
    if (!data.normals.empty()) {
      writer.text(" ");
      writer.numbers(data.normals[i]);
    }
    writer.endLine();
  }
}

/// The header is PCL's. It writes the body to named files only, hence the packing in here.
void writePcd(Writer& writer, const PointData& data) {
  pcl::PCLPointCloud2 cloud;
  cloud.width = static_cast<std::uint32_t>(data.points.size());
  cloud.height = 1;
  const auto add_field = [&cloud](const char* name, std::uint8_t type) {
    pcl::PCLPointField field;
    field.name = name;
    field.offset = cloud.point_step;
    field.datatype = type;
    field.count = 1;
    cloud.fields.push_back(field);
    cloud.point_step += 4;
  };
  for (const char* name : {"x", "y", "z"}) {
    add_field(name, pcl::PCLPointField::FLOAT32);
  }
  if (!data.normals.empty()) {
    for (const char* name : {"normal_x", "normal_y", "normal_z"}) {
      add_field(name, pcl::PCLPointField::FLOAT32);
    }
  }
  if (!data.colors.empty()) {
    add_field(data.has_alpha ? "rgba" : "rgb",
              data.has_alpha ? pcl::PCLPointField::UINT32 : pcl::PCLPointField::FLOAT32);
  }
  cloud.row_step = cloud.point_step * cloud.width;
  writer.text(pcl::PCDWriter().generateHeaderBinary(cloud, Eigen::Vector4f::Zero(),
                                                    Eigen::Quaternionf::Identity()));
  writer.line("DATA binary");
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    writer.words(data.points[i], ByteOrder::Little);
    if (!data.normals.empty()) {
      writer.words(data.normals[i], ByteOrder::Little);
    }
    if (!data.colors.empty()) {
      std::uint32_t packed = 0;
      for (const std::size_t channel : {3U, 0U, 1U, 2U}) {
        const bool kept = channel != 3 || data.has_alpha;
        packed = packed << 8U | (kept ? data.colors[i][channel] : 0U);
      }
      writer.word(packed, ByteOrder::Little);
    }
    writer.send();
  }
}

}  // namespace

void writeMesh(OutputFile& file, const TriangleMesh& mesh, FileFormat format, Encoding encoding) {
  Writer writer(file);
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
    writeXyz(writer, mesh.vertices);
    break;
  case FileFormat::Pcd:
    writePcd(writer, mesh.vertices);
    break;
  }
}

}  // namespace spherical_param::tools
