#include "formats/formats.h"
#include "formats/mesh_parts.h"

namespace spherical_param::tools {

void writeXyz(RecordWriter& writer, const MeshView& mesh, Encoding /*text only*/) {
  writer.expect(mesh.vertexCount());
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

}  // namespace spherical_param::tools
