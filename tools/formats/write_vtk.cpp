#include "formats/formats.h"
#include "formats/mesh_parts.h"

namespace spherical_param::tools {
namespace {

template <typename Values>
void writeNumbers(RecordWriter& writer, const Values& values, bool binary) {
  if (binary) {
    writer.words(values, ByteOrder::Big);
    writer.endRecord();
  } else {
    writer.numbers(values);
    writer.endLine();
  }
}

/// Points that belong to no cell are not shown.
void writeVertexCells(RecordWriter& writer, std::size_t count, bool binary) {
  writer.line("VERTICES " + std::to_string(count) + " " + std::to_string(2 * count));
  for (std::size_t i = 0; i < count; ++i) {
    if (binary) {
      writer.word(std::uint32_t{1}, ByteOrder::Big);
      writer.word(static_cast<std::uint32_t>(i), ByteOrder::Big);
      writer.endRecord();
    } else {
      writer.line("1 " + std::to_string(i));
    }
  }
}

void writePolygons(RecordWriter& writer, const MeshView& mesh, bool binary) {
  const std::size_t count = mesh.triangleCount();
  writer.line("POLYGONS " + std::to_string(count) + " " + std::to_string(4 * count));
  for (std::size_t t = 0; t < count; ++t) {
    if (binary) {
      writer.word(std::uint32_t{3}, ByteOrder::Big);
      writer.words(mesh.triangle(t), ByteOrder::Big);
      writer.endRecord();
    } else {
      writeTextTriangle(writer, mesh.triangle(t));
    }
  }
}

void writeColors(RecordWriter& writer, const MeshView& mesh, bool binary) {
  writer.line("COLOR_SCALARS Colors " + std::to_string(channelCount(mesh)));
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

}  // namespace

/// Legacy format, version 3.0: every VTK can read it, and pcl_viewer with it.
void writeVtk(RecordWriter& writer, const MeshView& mesh, Encoding encoding) {
  writer.expect((mesh.hasNormals() ? 2 : 1) * mesh.vertexCount() + mesh.triangleCount());
  const bool binary = encoding == Encoding::Binary;
  writer.line("# vtk DataFile Version 3.0");
  writer.line(mesh.triangleCount() == 0 ? "point cloud" : "triangle mesh");
  writer.line(binary ? "BINARY" : "ASCII");
  writer.line("DATASET POLYDATA");
  writer.line("POINTS " + std::to_string(mesh.vertexCount()) +
              (writer.inDouble() ? " double" : " float"));
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writeNumbers(writer, mesh.point(i), binary);
  }
  if (mesh.triangleCount() == 0) {
    writeVertexCells(writer, mesh.vertexCount(), binary);
  } else {
    writePolygons(writer, mesh, binary);
  }
  if (mesh.hasColors() || mesh.hasNormals()) {
    writer.line("POINT_DATA " + std::to_string(mesh.vertexCount()));
  }
  if (mesh.hasColors()) {
    writeColors(writer, mesh, binary);
  }
  if (mesh.hasNormals()) {
    writer.line("NORMALS Normals float");
    for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
      writeNumbers(writer, mesh.normal(i), binary);
    }
  }
}

}  // namespace spherical_param::tools
