#include "formats/formats.h"

namespace spherical_param::tools {
namespace {

void writePlyHeader(RecordWriter& writer, const MeshView& mesh, Encoding encoding) {
  writer.line("ply");
  writer.line(encoding == Encoding::Binary ? "format binary_little_endian 1.0"
                                           : "format ascii 1.0");
  if (mesh.texture() != nullptr) {
    writer.line("comment TextureFile " + mesh.texture()->image_name);  // for MeshLab
  }
  writer.line("element vertex " + std::to_string(mesh.vertexCount()));
  for (const char* name : {"x", "y", "z"}) {
    writer.line((writer.inDouble() ? "property double " : "property float ") + std::string(name));
  }
  if (mesh.hasNormals()) {
    for (const char* name : {"nx", "ny", "nz"}) {
      writer.line(std::string("property float ") + name);
    }
  }
  constexpr std::array channels = {"red", "green", "blue", "alpha"};
  for (std::size_t c = 0; c < mesh.channelCount(); ++c) {
    writer.line(std::string("property uchar ") + channels[c]);
  }
  for (const Scalar& scalar : mesh.scalars()) {
    writer.line((scalar.is_double ? "property double " : "property float ") + scalar.name);
  }
  if (mesh.hasAdded()) {
    writer.line("property uchar added");
  }
  if (mesh.triangleCount() > 0) {
    writer.line("element face " + std::to_string(mesh.triangleCount()));
    writer.line("property list uchar int vertex_indices");
  }
  writer.line("end_header");
}

void writeVertex(RecordWriter& writer, const MeshView& mesh, std::size_t i) {
  writer.put(mesh.point(i));
  if (mesh.hasNormals()) {
    writer.put(mesh.normal(i));
  }
  for (std::size_t c = 0; c < mesh.channelCount(); ++c) {
    writer.put(mesh.color(i)[c]);
  }
  for (const Scalar& scalar : mesh.scalars()) {
    writer.put(mesh.scalar(scalar, i), scalar.is_double);
  }
  if (mesh.hasAdded()) {
    writer.put(mesh.added(i));
  }
  writer.end();
}

}  // namespace

void writePly(RecordWriter& writer, const MeshView& mesh, Encoding encoding) {
  writer.expect(mesh.vertexCount() + mesh.triangleCount());
  writePlyHeader(writer, mesh, encoding);
  writer.useStyle(encoding == Encoding::Binary ? NumberStyle::LittleEndian : NumberStyle::Text);
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writeVertex(writer, mesh, i);
  }
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    writer.put(std::uint8_t{3});
    writer.put(mesh.triangle(t));
    writer.end();
  }
}

}  // namespace spherical_param::tools
