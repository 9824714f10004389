#include "formats/formats.h"

namespace spherical_param::tools {

void writeObj(RecordWriter& writer, const MeshView& mesh, Encoding /*text only*/) {
  writer.expect((mesh.hasNormals() ? 2 : 1) * mesh.vertexCount() + mesh.triangleCount());
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writer.text("v ");
    writer.put(mesh.point(i));
    if (mesh.hasColors()) {
      const Color& color = mesh.color(i);
      writer.put(Normal{static_cast<float>(color[0]) / 255.0F,
                        static_cast<float>(color[1]) / 255.0F,
                        static_cast<float>(color[2]) / 255.0F});
    }
    writer.endLine();
  }
  for (std::size_t i = 0; mesh.hasNormals() && i < mesh.vertexCount(); ++i) {
    writer.text("vn ");
    writer.put(mesh.normal(i));
    writer.endLine();
  }
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    writer.text("f ");
    for (const std::int32_t corner : triangle) {
      writer.put(std::int64_t{corner} + 1);
      if (mesh.hasNormals()) {
        writer.text("//");
        writer.number(std::int64_t{corner} + 1);
      }
    }
    writer.endLine();
  }
}

}  // namespace spherical_param::tools
