#include "formats/formats.h"

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
    writer.put(mesh.point(i));
    if (mesh.hasNormals()) {
      writer.put(mesh.normal(i));
    }
    for (std::size_t c = 0; mesh.hasColors() && c < 4; ++c) {
      writer.put(mesh.color(i)[c]);
    }
    writer.end();
  }
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    writer.put(std::uint8_t{3});
    writer.put(mesh.triangle(t));
    writer.end();
  }
}

}  // namespace spherical_param::tools
