#include "formats/formats.h"

#include <Eigen/Geometry>

#include <cmath>

namespace spherical_param::tools {
namespace {

/// The normal of a triangle; zero without area, as STL readers expect.
Normal facetNormal(const std::array<Point, 3>& corners) {
  const auto corner = [&](std::size_t k) {
    return Eigen::Map<const Eigen::Vector3d>(corners[k].data());
  };
  const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
  const double length = std::hypot(normal.x(), normal.y(), normal.z());
  if (!(length > 0.0)) {
    return {0.0F, 0.0F, 0.0F};
  }
  return toFloat({normal.x() / length, normal.y() / length, normal.z() / length});
}

void writeTextFacet(RecordWriter& writer, const std::array<Point, 3>& corners) {
  writer.text("facet normal ");
  writer.put(facetNormal(corners));
  writer.endLine();
  writer.line("outer loop");
  for (const Point& corner : corners) {
    writer.text("vertex ");
    writer.put(corner);
    writer.endLine();
  }
  writer.line("endloop");
  writer.line("endfacet");
}

}  // namespace

/// Binary files have single precision only.
void writeStl(RecordWriter& writer, const MeshView& mesh, Encoding encoding) {
  const bool binary = encoding == Encoding::Binary;
  writer.expect((binary ? 1 : 7) * mesh.triangleCount());
  if (binary) {
    // 80 bytes of free text, which must not begin with "solid", as files in text do.
    std::string header = "binary STL";
    header.resize(80, ' ');
    writer.text(header);
    writer.useStyle(NumberStyle::LittleEndian);
    writer.put(static_cast<std::uint32_t>(mesh.triangleCount()));
    writer.end();
  } else {
    writer.line("solid mesh");
  }
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    const std::array<Point, 3> corners = {mesh.point(static_cast<std::size_t>(triangle[0])),
                                          mesh.point(static_cast<std::size_t>(triangle[1])),
                                          mesh.point(static_cast<std::size_t>(triangle[2]))};
    if (!binary) {
      writeTextFacet(writer, corners);
      continue;
    }
    writer.put(facetNormal(corners));
    for (const Point& corner : corners) {
      writer.put(toFloat(corner));
    }
    writer.put(std::uint16_t{0});
    writer.end();
  }
  if (!binary) {
    writer.line("endsolid mesh");
  }
}

}  // namespace spherical_param::tools
