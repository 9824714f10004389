#include "formats/formats.h"
#include "formats/mesh_parts.h"

namespace spherical_param::tools {

/// Colours are 0 ... 255 with alpha, as most programs read them.
void writeOff(RecordWriter& writer, const MeshView& mesh, Encoding /*text only*/) {
  writer.expect(mesh.vertexCount() + mesh.triangleCount());
  writer.text(!mesh.hasColors() ? "" : "C");
  writer.text(!mesh.hasNormals() ? "" : "N");
  writer.line("OFF");
  writer.line(std::to_string(mesh.vertexCount()) + " " + std::to_string(mesh.triangleCount()) +
              " 0");
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
    writeTextTriangle(writer, mesh.triangle(t));
  }
}

}  // namespace spherical_param::tools
