#include "formats/formats.h"

namespace spherical_param::tools {
namespace {

void writePcdHeader(RecordWriter& writer, const MeshView& mesh) {
  std::string fields = "x y z";
  std::string sizes = writer.inDouble() ? " 8 8 8" : " 4 4 4";
  std::string types = "F F F";
  std::string counts = " 1 1 1";
  if (mesh.hasNormals()) {
    fields += " normal_x normal_y normal_z";
    sizes += " 4 4 4";
    types += " F F F";
    counts += " 1 1 1";
  }
  if (mesh.hasColors()) {
    fields += mesh.hasAlpha() ? " rgba" : " rgb";
    sizes += " 4";
    types += mesh.hasAlpha() ? " U" : " F";
    counts += " 1";
  }
  const std::string points = std::to_string(mesh.vertexCount());
  const std::string columns = std::to_string(mesh.vertexCount() / mesh.rows());
  writer.line("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields +
              "\nSIZE" + sizes + "\nTYPE " + types + "\nCOUNT" + counts + "\nWIDTH " + columns +
              "\nHEIGHT " + std::to_string(mesh.rows()) + "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
              points + "\nDATA binary");
}

}  // namespace

/// The header has the lines of PCL's own, in their order.
void writePcd(RecordWriter& writer, const MeshView& mesh, Encoding /*binary only*/) {
  writer.expect(mesh.vertexCount());
  writePcdHeader(writer, mesh);
  writer.useStyle(NumberStyle::LittleEndian);
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    writer.put(mesh.point(i));
    if (mesh.hasNormals()) {
      writer.put(mesh.normal(i));
    }
    if (mesh.hasColors()) {
      const Color& color = mesh.color(i);
      const std::uint32_t alpha = mesh.hasAlpha() ? color[3] : 0U;
      writer.put(alpha << 24U | std::uint32_t{color[0]} << 16U | std::uint32_t{color[1]} << 8U |
                 std::uint32_t{color[2]});
    }
    writer.end();
  }
}

}  // namespace spherical_param::tools
