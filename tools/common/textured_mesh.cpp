#include "common/textured_mesh.h"

#include "common/errors.h"
#include "common/record_writer.h"
#include "spherical_param/mesh_measures.h"

#include <Eigen/Geometry>

#include <cstdint>

namespace spherical_param::tools {
PointData verticesOf(const TextureAtlas& atlas, const Positions& points,
                     const Triangles& triangles) {
  PointData vertices;
  vertices.points = toPoints(atCutVertices(atlas, points));
  for (const Point& direction :
       toPoints(atCutVertices(atlas, areaWeightedNormals(points, triangles)))) {
    // Programs expect unit vectors, also where triangles have no area.
    const Eigen::Vector3d normal = Eigen::Vector3d(direction.data()).stableNormalized();
    vertices.normals.push_back(normal.isZero(0.0) ? Normal{0.0F, 0.0F, 1.0F}
                                                  : toFloat({normal.x(), normal.y(), normal.z()}));
  }
  return vertices;
}

TriangleMesh repeatedOnCuts(const TextureAtlas& atlas, const PointData& vertices) {
  const auto count = static_cast<std::size_t>(atlas.coordinates.cols());
  TriangleMesh mesh;
  mesh.vertices.points.resize(count);
  mesh.vertices.normals.resize(count);
  mesh.vertices.scalars = {{"s", {}}, {"t", {}}};
  for (Eigen::Index i = 0; i < atlas.coordinates.cols(); ++i) {
    mesh.vertices.scalars[0].values.push_back(atlas.coordinates(0, i));
    mesh.vertices.scalars[1].values.push_back(atlas.coordinates(1, i));
  }
  for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
    const auto corners = atlas.coordinate_triangles.col(t);
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto vertex = static_cast<std::size_t>(atlas.triangles(k, t));
      mesh.vertices.points[static_cast<std::size_t>(corners[k])] = vertices.points[vertex];
      mesh.vertices.normals[static_cast<std::size_t>(corners[k])] = vertices.normals[vertex];
    }
  }
  return mesh;
}

void writeTexturedObj(OutputFile& file, const TextureAtlas& atlas, const PointData& vertices,
                      const std::string& material_name) {
  const FileProgress no_progress;
  RecordWriter writer(file, needsDouble(vertices), no_progress);
  writer.line("mtllib " + material_name);
  for (const Point& point : vertices.points) {
    writer.text("v ");
    writer.put(point);
    writer.endLine();
  }
  for (Eigen::Index i = 0; i < atlas.coordinates.cols(); ++i) {
    writer.text("vt ");
    writer.put(static_cast<float>(atlas.coordinates(0, i)));
    writer.put(static_cast<float>(atlas.coordinates(1, i)));
    writer.endLine();
  }
  for (const Normal& normal : vertices.normals) {
    writer.text("vn ");
    writer.put(normal);
    writer.endLine();
  }
  writer.line("usemtl textured");
  for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
    writer.text("f ");
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto vertex = std::int64_t{atlas.triangles(k, t)} + 1;
      writer.put(vertex);
      writer.text("/");
      writer.number(std::int64_t{atlas.coordinate_triangles(k, t)} + 1);
      writer.text("/");
      writer.number(vertex);
    }
    writer.endLine();
  }
  writer.finish();
}

void writeMaterial(OutputFile& file, const std::string& image_name) {
  file.write("newmtl textured\n"
             "Ka 1 1 1\n"
             "Kd 1 1 1\n"
             "Ks 0 0 0\n"
             "illum 1\n"
             "map_Kd " +
             image_name + "\n");
}

}  // namespace spherical_param::tools
