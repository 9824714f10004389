#include "formats/formats.h"

namespace spherical_param::tools {

void writeXyz(RecordWriter& writer, const MeshView& mesh, Encoding /*text only*/) {
  writer.expect(mesh.vertexCount());
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writer.put(mesh.point(i));
    for (std::size_t c = 0; mesh.hasColors() && c < 3; ++c) {
      writer.put(mesh.color(i)[c]);
    }
    if (mesh.hasNormals()) {
      writer.put(mesh.normal(i));
    }
    writer.end();
  }
}

}  // namespace spherical_param::tools
