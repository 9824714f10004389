#include "formats/formats.h"

namespace spherical_param::tools {
namespace {

/// Points that belong to no cell are not shown: without triangles, each is one.
void writeCells(RecordWriter& writer, const MeshView& mesh) {
  const bool is_mesh = mesh.triangleCount() > 0;
  const std::size_t count = is_mesh ? mesh.triangleCount() : mesh.vertexCount();
  writer.line((is_mesh ? "POLYGONS " : "VERTICES ") + std::to_string(count) + " " +
              std::to_string((is_mesh ? 4 : 2) * count));
  for (std::size_t i = 0; i < count; ++i) {
    writer.put(std::int32_t{is_mesh ? 3 : 1});
    is_mesh ? writer.put(mesh.triangle(i)) : writer.put(static_cast<std::int32_t>(i));
    writer.end();
  }
}

void writeColors(RecordWriter& writer, const MeshView& mesh) {
  writer.line("COLOR_SCALARS Colors " + std::to_string(mesh.channelCount()));
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    for (std::size_t c = 0; c < mesh.channelCount(); ++c) {
      const std::uint8_t channel = mesh.color(i)[c];
      writer.isText() ? writer.put(static_cast<float>(channel) / 255.0F) : writer.put(channel);
    }
    writer.end();
  }
}

void writeScalar(RecordWriter& writer, const MeshView& mesh, const Scalar& scalar) {
  writer.line("SCALARS " + scalar.name + (scalar.is_double ? " double" : " float"));
  writer.line("LOOKUP_TABLE default");
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writer.put(mesh.scalar(scalar, i), scalar.is_double);
    writer.end();
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
  writer.useStyle(binary ? NumberStyle::BigEndian : NumberStyle::Text);
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writer.put(mesh.point(i));
    writer.end();
  }
  writeCells(writer, mesh);
  if (mesh.hasColors() || mesh.hasNormals() || !mesh.scalars().empty()) {
    writer.line("POINT_DATA " + std::to_string(mesh.vertexCount()));
  }
  if (mesh.hasColors()) {
    writeColors(writer, mesh);
  }
  if (mesh.hasNormals()) {
    writer.line("NORMALS Normals float");
    for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
      writer.put(mesh.normal(i));
      writer.end();
    }
  }
  for (const Scalar& scalar : mesh.scalars()) {
    writeScalar(writer, mesh, scalar);
  }
}

}  // namespace spherical_param::tools
