#include "common/textured_mesh.h"

#include "common/errors.h"
#include "common/json_report.h"
#include "common/record_writer.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/version.h"

#include <Eigen/Geometry>

#include <png.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace spherical_param::tools {
namespace {

FloatTriple toTriple(const Eigen::Vector3d& value) {
  return {static_cast<float>(value.x()), static_cast<float>(value.y()),
          static_cast<float>(value.z())};
}

std::array<Index, 3> toArray(const Eigen::Matrix<Index, 3, 1>& triangle) {
  return {triangle[0], triangle[1], triangle[2]};
}

/// The parts of a binary glTF file, each of which begins at a multiple of 4 bytes.
class GlbBuffer {
public:
  explicit GlbBuffer(Json& json) : json_(json) {
    json_["accessors"] = Json::array();
    json_["bufferViews"] = Json::array();
  }

  /// \param target what it is for, 0: no data of vertices. \return the view's index.
  std::size_t addView(std::size_t size, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", size_}, {"byteLength", size}};
    if (target != 0) {
      view["target"] = target;
    }
    json_["bufferViews"].push_back(view);
    size_ += (size + 3) / 4 * 4;
    return json_["bufferViews"].size() - 1;
  }
  /// \return the accessor's index.
  std::size_t addAccessor(std::size_t view, int component, const std::string& type,
                          std::size_t count, const Json& lowest, const Json& highest) {
    Json accessor = {
        {"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
    if (!lowest.is_null()) {
      accessor["min"] = lowest;
      accessor["max"] = highest;
    }
    json_["accessors"].push_back(accessor);
    return json_["accessors"].size() - 1;
  }
  std::size_t size() const { return size_; }

private:
  Json& json_;
  std::size_t size_ = 0;
};

/// Numbers of the specification of glTF 2.0.
namespace gltf {
constexpr int kFloat = 5126;
constexpr int kUnsigned = 5125;
constexpr int kVertexData = 34962;
constexpr int kIndexData = 34963;
constexpr int kLinear = 9729;
constexpr int kLinearMipmap = 9987;
constexpr int kClamp = 33071;
constexpr int kRepeat = 10497;
}  // namespace gltf

/// Where the parts of a mesh are in the buffer of a file.
struct GlbViews {
  std::size_t positions;
  std::size_t normals;
  std::size_t coordinates;
  std::size_t indices;
  std::size_t image;
};

/// The geometry in the JSON part: one primitive with its attributes.
Json glbPrimitive(const TexturedMesh& mesh, const GlbViews& views, GlbBuffer& buffer) {
  FloatTriple lowest = mesh.points.front();
  FloatTriple highest = mesh.points.front();
  for (const FloatTriple& point : mesh.points) {
    for (std::size_t d = 0; d < 3; ++d) {
      lowest[d] = std::min(lowest[d], point[d]);
      highest[d] = std::max(highest[d], point[d]);
    }
  }
  const std::size_t count = mesh.coordinates.size();
  Json attributes;
  attributes["POSITION"] =
      buffer.addAccessor(views.positions, gltf::kFloat, "VEC3", count, lowest, highest);
  attributes["NORMAL"] =
      buffer.addAccessor(views.normals, gltf::kFloat, "VEC3", count, nullptr, nullptr);
  attributes["TEXCOORD_0"] =
      buffer.addAccessor(views.coordinates, gltf::kFloat, "VEC2", count, nullptr, nullptr);
  const std::size_t corners = buffer.addAccessor(views.indices, gltf::kUnsigned, "SCALAR",
                                                 3 * mesh.triangles.size(), nullptr, nullptr);
  return {{"attributes", attributes}, {"indices", corners}, {"material", 0}};
}

/// The JSON part of a file, of a length that is a multiple of 4, and the size of the buffer.
std::pair<std::string, std::size_t> glbDescription(const TexturedMesh& mesh,
                                                   std::size_t image_size) {
  Json json;
  json["asset"] = {{"version", "2.0"},
                   {"generator", std::string("pcl_spherical_param ") + SPHERICAL_PARAM_VERSION}};
  json["scene"] = 0;
  json["scenes"] = {{{"nodes", {0}}}};
  json["nodes"] = {{{"mesh", 0}}};
  GlbBuffer buffer(json);
  const std::size_t count = mesh.coordinates.size();
  const std::size_t positions = buffer.addView(12 * count, gltf::kVertexData);
  const std::size_t normals = buffer.addView(12 * count, gltf::kVertexData);
  const std::size_t coordinates = buffer.addView(8 * count, gltf::kVertexData);
  const std::size_t indices = buffer.addView(12 * mesh.triangles.size(), gltf::kIndexData);
  const std::size_t image = buffer.addView(image_size, 0);
  const Json primitive =
      glbPrimitive(mesh, {positions, normals, coordinates, indices, image}, buffer);
  json["meshes"] = {{{"primitives", {primitive}}}};
  json["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}},
       {"doubleSided", false}}};
  json["textures"] = {{{"sampler", 0}, {"source", 0}}};
  json["images"] = {{{"bufferView", image}, {"mimeType", "image/png"}}};
  json["samplers"] = {{{"magFilter", gltf::kLinear},
                       {"minFilter", gltf::kLinearMipmap},
                       {"wrapS", mesh.repeats_u ? gltf::kRepeat : gltf::kClamp},
                       {"wrapT", gltf::kClamp}}};
  json["buffers"] = {{{"byteLength", buffer.size()}}};
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  return {text, buffer.size()};
}

}  // namespace

TexturedMesh makeTexturedMesh(const TextureAtlas& atlas, const Positions& points,
                              const Triangles& triangles) {
  TexturedMesh mesh;
  const Eigen::MatrixXd at_vertices = atCutVertices(atlas, points);
  const Eigen::MatrixXd normals = atCutVertices(atlas, areaWeightedNormals(points, triangles));
  mesh.points.reserve(atlas.vertices.size());
  mesh.normals.reserve(atlas.vertices.size());
  for (Eigen::Index v = 0; v < at_vertices.cols(); ++v) {
    mesh.points.push_back(toTriple(at_vertices.col(v)));
    // Programs expect unit vectors, also where triangles have no area.
    const Eigen::Vector3d normal = normals.col(v).stableNormalized();
    mesh.normals.push_back(toTriple(normal.isZero(0.0) ? Eigen::Vector3d::UnitZ() : normal));
  }
  mesh.coordinates.reserve(static_cast<std::size_t>(atlas.coordinates.cols()));
  for (Eigen::Index i = 0; i < atlas.coordinates.cols(); ++i) {
    mesh.coordinates.push_back(
        {static_cast<float>(atlas.coordinates(0, i)), static_cast<float>(atlas.coordinates(1, i))});
  }
  mesh.vertex_of_coordinate.resize(mesh.coordinates.size());
  mesh.triangles.reserve(static_cast<std::size_t>(atlas.triangles.cols()));
  mesh.coordinate_triangles.reserve(static_cast<std::size_t>(atlas.triangles.cols()));
  for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
    mesh.triangles.push_back(toArray(atlas.triangles.col(t)));
    mesh.coordinate_triangles.push_back(toArray(atlas.coordinate_triangles.col(t)));
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.vertex_of_coordinate[static_cast<std::size_t>(mesh.coordinate_triangles.back()[k])] =
          mesh.triangles.back()[k];
    }
  }
  mesh.repeats_u = atlas.chart == SphereChart::Equirectangular;
  return mesh;
}

std::string encodePng(const TextureImage& image) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  constexpr int converted = 0;   // the pixels are of 8 bits
  constexpr int row_stride = 0;  // rows follow each other
  std::string png(PNG_IMAGE_PNG_SIZE_MAX(header), '\0');
  png_alloc_size_t size = png.size();
  if (png_image_write_to_memory(&header, png.data(), &size, converted, image.pixels.data(),
                                row_stride, nullptr) == 0) {
    throw Failure("the image cannot be encoded as PNG", "give -size a smaller number");
  }
  png.resize(size);
  return png;
}

void writeGlb(OutputFile& file, const TexturedMesh& mesh, const std::string& png) {
  const auto [text, buffer_size] = glbDescription(mesh, png.size());
  const std::size_t size = 12 + 8 + text.size() + 8 + buffer_size;
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    throw Failure("the file would be larger than the 4 GB of binary glTF",
                  "write .ply or .obj, or give -size a smaller number");
  }
  const FileProgress no_progress;
  RecordWriter writer(file, false, no_progress);
  const auto word = [&writer](std::size_t value) {
    writer.word(static_cast<std::uint32_t>(value), ByteOrder::Little);
  };
  writer.text("glTF");
  word(2);
  word(size);
  word(text.size());
  writer.text("JSON");
  writer.text(text);
  word(buffer_size);
  writer.text(std::string_view("BIN\0", 4));
  for (const Index vertex : mesh.vertex_of_coordinate) {
    writer.words(mesh.points[static_cast<std::size_t>(vertex)], ByteOrder::Little);
    writer.endRecord();
  }
  for (const Index vertex : mesh.vertex_of_coordinate) {
    writer.words(mesh.normals[static_cast<std::size_t>(vertex)], ByteOrder::Little);
    writer.endRecord();
  }
  for (const auto& [u, v] : mesh.coordinates) {
    writer.word(u, ByteOrder::Little);
    writer.word(1.0F - v, ByteOrder::Little);  // v is down there
    writer.endRecord();
  }
  for (const std::array<Index, 3>& triangle : mesh.coordinate_triangles) {
    writer.words(triangle, ByteOrder::Little);
    writer.endRecord();
  }
  writer.finish();
  file.write(png);
  file.write(std::string((4 - png.size() % 4) % 4, '\0'));
}

void writeTexturedPly(OutputFile& file, const TexturedMesh& mesh, const std::string& image_name,
                      Encoding encoding) {
  const bool is_binary = encoding == Encoding::Binary;
  const FileProgress no_progress;
  RecordWriter writer(file, false, no_progress);
  writer.line("ply");
  writer.line(is_binary ? "format binary_little_endian 1.0" : "format ascii 1.0");
  writer.line("comment TextureFile " + image_name);
  writer.line("element vertex " + std::to_string(mesh.coordinates.size()));
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "s", "t"}) {
    writer.line(std::string("property float ") + name);
  }
  writer.line("element face " + std::to_string(mesh.triangles.size()));
  writer.line("property list uchar int vertex_indices");
  writer.line("end_header");
  for (std::size_t i = 0; i < mesh.coordinates.size(); ++i) {
    const auto vertex = static_cast<std::size_t>(mesh.vertex_of_coordinate[i]);
    if (is_binary) {
      writer.words(mesh.points[vertex], ByteOrder::Little);
      writer.words(mesh.normals[vertex], ByteOrder::Little);
      writer.word(mesh.coordinates[i][0], ByteOrder::Little);
      writer.word(mesh.coordinates[i][1], ByteOrder::Little);
      writer.endRecord();
      continue;
    }
    writer.numbers(mesh.points[vertex]);
    writer.text(" ");
    writer.numbers(mesh.normals[vertex]);
    for (const float coordinate : mesh.coordinates[i]) {
      writer.text(" ");
      writer.number(coordinate);
    }
    writer.endLine();
  }
  for (const std::array<Index, 3>& triangle : mesh.coordinate_triangles) {
    if (is_binary) {
      writer.byte(3);
      writer.words(triangle, ByteOrder::Little);
      writer.endRecord();
      continue;
    }
    writer.text("3");
    for (const Index corner : triangle) {
      writer.text(" ");
      writer.number(std::int64_t{corner});
    }
    writer.endLine();
  }
  writer.finish();
}

void writeTexturedObj(OutputFile& file, const TexturedMesh& mesh,
                      const std::string& material_name) {
  const FileProgress no_progress;
  RecordWriter writer(file, false, no_progress);
  writer.line("mtllib " + material_name);
  for (const FloatTriple& point : mesh.points) {
    writer.text("v ");
    writer.numbers(point);
    writer.endLine();
  }
  for (const auto& [u, v] : mesh.coordinates) {
    writer.text("vt ");
    writer.number(u);
    writer.text(" ");
    writer.number(v);
    writer.endLine();
  }
  for (const FloatTriple& normal : mesh.normals) {
    writer.text("vn ");
    writer.numbers(normal);
    writer.endLine();
  }
  writer.line("usemtl textured");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    writer.text("f");
    for (std::size_t k = 0; k < 3; ++k) {
      const auto vertex = std::int64_t{mesh.triangles[t][k]} + 1;
      writer.text(" ");
      writer.number(vertex);
      writer.text("/");
      writer.number(std::int64_t{mesh.coordinate_triangles[t][k]} + 1);
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
