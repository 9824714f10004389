#include "formats/formats.h"
#include "formats/mesh_parts.h"

namespace spherical_param::tools {
namespace {

std::size_t writtenChannels(const MeshView& mesh) {
  return mesh.hasColors() ? channelCount(mesh) : 0;
}

void writePlyHeader(RecordWriter& writer, const MeshView& mesh, Encoding encoding) {
  writer.line("ply");
  writer.line(encoding == Encoding::Binary ? "format binary_little_endian 1.0"
                                           : "format ascii 1.0");
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
  for (std::size_t c = 0; c < writtenChannels(mesh); ++c) {
    writer.line(std::string("property uchar ") + channels[c]);
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

void writeBinaryVertex(RecordWriter& writer, const MeshView& mesh, std::size_t i) {
  writer.words(mesh.point(i), ByteOrder::Little);
  if (mesh.hasNormals()) {
    writer.words(mesh.normal(i), ByteOrder::Little);
  }
  for (std::size_t c = 0; c < writtenChannels(mesh); ++c) {
    writer.byte(mesh.color(i)[c]);
  }
  if (mesh.hasAdded()) {
    writer.byte(mesh.added(i));
  }
  writer.endRecord();
}

void writeTextVertex(RecordWriter& writer, const MeshView& mesh, std::size_t i) {
  writer.numbers(mesh.point(i));
  if (mesh.hasNormals()) {
    writer.text(" ");
    writer.numbers(mesh.normal(i));
  }
  for (std::size_t c = 0; c < writtenChannels(mesh); ++c) {
    writer.text(" ");
    writer.number(std::int64_t{mesh.color(i)[c]});
  }
  if (mesh.hasAdded()) {
    writer.text(mesh.added(i) != 0 ? " 1" : " 0");
  }
  writer.endLine();
}

}  // namespace

void writePly(RecordWriter& writer, const MeshView& mesh, Encoding encoding) {
  writer.expect(mesh.vertexCount() + mesh.triangleCount());
  writePlyHeader(writer, mesh, encoding);
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    if (encoding == Encoding::Binary) {
      writeBinaryVertex(writer, mesh, i);
    } else {
      writeTextVertex(writer, mesh, i);
    }
  }
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    if (encoding == Encoding::Binary) {
      writer.byte(3);
      writer.words(mesh.triangle(t), ByteOrder::Little);
      writer.endRecord();
    } else {
      writeTextTriangle(writer, mesh.triangle(t));
    }
  }
}

}  // namespace spherical_param::tools
