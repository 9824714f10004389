#include "common/errors.h"
#include "common/json_report.h"
#include "formats/formats.h"
#include "spherical_param/version.h"

#include <Eigen/Geometry>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace spherical_param::tools {
namespace {

// Numbers of the specification of glTF 2.0: types, uses, filters and edges of images.
constexpr int gltf_short = 5123, gltf_int = 5125, gltf_float = 5126;
constexpr int gltf_vertices = 34962, gltf_indices = 34963;
constexpr int gltf_linear = 9729, gltf_linear_mipmap = 9987;
constexpr int gltf_clamp = 33071, gltf_repeat = 10497;

/// The description of a file, and of the parts of its buffer, each at a multiple of 4 bytes.
struct GlbDescription {
  Json json;
  std::size_t buffer_size = 0;

  std::size_t addView(std::size_t size) {
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer_size}, {"byteLength", size}});
    buffer_size += (size + 3) / 4 * 4;
    return json["bufferViews"].size() - 1;
  }
  /// A part with numbers. \param size bytes of an entry. \return their index
  std::size_t addNumbers(std::size_t count, std::size_t size, int component,
                         const std::string& type) {
    const std::size_t view = addView(count * size);
    json["bufferViews"][view]["target"] = component == gltf_int ? gltf_indices : gltf_vertices;
    json["accessors"].push_back({{"bufferView", view},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type},
                                 {"normalized", component == gltf_short}});
    return json["accessors"].size() - 1;
  }
};

Json attributesOf(const MeshView& mesh, GlbDescription& description) {
  const std::size_t count = mesh.vertexCount();
  Json attributes;
  attributes["POSITION"] = description.addNumbers(count, 12, gltf_float, "VEC3");
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < count; ++i) {
    box.extend(Eigen::Vector3f(toFloat(mesh.point(i)).data()));
  }
  Json& positions = description.json["accessors"].back();
  positions["min"] = {box.min().x(), box.min().y(), box.min().z()};
  positions["max"] = {box.max().x(), box.max().y(), box.max().z()};
  if (mesh.hasNormals()) {
    attributes["NORMAL"] = description.addNumbers(count, 12, gltf_float, "VEC3");
  }
  if (mesh.texture() != nullptr) {
    attributes["TEXCOORD_0"] = description.addNumbers(count, 8, gltf_float, "VEC2");
  } else if (mesh.hasColors()) {
    attributes["COLOR_0"] = description.addNumbers(count, 8, gltf_short, "VEC4");
  }
  return attributes;
}

/// Both sides of a triangle are shown, but of those with a texture: a mesh may be open.
Json materialOf(const MeshView& mesh, GlbDescription& description) {
  Json surface = {{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
  if (const MeshTexture* const texture = mesh.texture()) {
    Json& json = description.json;
    surface["baseColorTexture"] = {{"index", 0}};
    json["textures"] = {{{"sampler", 0}, {"source", 0}}};
    json["images"] = {
        {{"bufferView", description.addView(texture->png.size())}, {"mimeType", "image/png"}}};
    json["samplers"] = {{{"magFilter", gltf_linear},
                         {"minFilter", gltf_linear_mipmap},
                         {"wrapS", texture->repeats_u ? gltf_repeat : gltf_clamp},
                         {"wrapT", gltf_clamp}}};
  }
  return {{"pbrMetallicRoughness", surface}, {"doubleSided", mesh.texture() == nullptr}};
}

/// A channel of glTF: 16 bits, linear in the light, as those of images are not.
std::uint16_t linearChannel(std::uint8_t channel) {
  const double value = channel / 255.0;
  const double linear = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(65535.0 * linear));
}

void writeHead(RecordWriter& writer, GlbDescription& description) {
  std::string text = description.json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t size = 12 + 8 + text.size() + 8 + description.buffer_size;
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    throw Failure("the file would be larger than the 4 GB of binary glTF", "write .ply or .obj");
  }
  const auto chunk = [&writer](std::size_t length, std::string_view name) {
    writer.put(static_cast<std::uint32_t>(length));
    writer.text(name);
  };
  writer.useStyle(NumberStyle::LittleEndian);
  writer.text(std::string_view("glTF\2\0\0\0", 8));
  chunk(size, "");
  chunk(text.size(), "JSON");
  writer.text(text);
  chunk(description.buffer_size, std::string_view("BIN\0", 4));
}

}  // namespace

/// Binary glTF 2.0, in single precision, with the image of a texture in it.
void writeGlb(RecordWriter& writer, const MeshView& mesh, Encoding /*binary only*/) {
  const std::size_t count = mesh.vertexCount();
  writer.expect(3 * count + mesh.triangleCount());
  GlbDescription description;
  Json primitive = {{"attributes", attributesOf(mesh, description)}, {"material", 0}};
  primitive["indices"] = description.addNumbers(3 * mesh.triangleCount(), 4, gltf_int, "SCALAR");
  Json& json = description.json;
  json["materials"] = Json::array({materialOf(mesh, description)});
  json["asset"] = {{"version", "2.0"},
                   {"generator", std::string("pcl_spherical_param ") + SPHERICAL_PARAM_VERSION}};
  json.update(Json::parse(R"({"scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}]})"));
  json["meshes"] = {{{"primitives", Json::array({primitive})}}};
  json["buffers"] = {{{"byteLength", description.buffer_size}}};
  writeHead(writer, description);
  const auto each = [&writer](std::size_t records, const auto& write) {
    for (std::size_t i = 0; i < records; ++i) {
      write(i);
      writer.end();
    }
  };
  const bool has_texture = mesh.texture() != nullptr;
  each(count, [&](std::size_t i) { writer.put(toFloat(mesh.point(i))); });
  each(mesh.hasNormals() ? count : 0, [&](std::size_t i) { writer.put(mesh.normal(i)); });
  each(has_texture ? count : 0, [&](std::size_t i) {
    writer.put(static_cast<float>(mesh.scalars()[0].values[i]));
    writer.put(1.0F - static_cast<float>(mesh.scalars()[1].values[i]));  // v is down there
  });
  each(!has_texture && mesh.hasColors() ? count : 0, [&](std::size_t i) {
    const Color& color = mesh.color(i);
    for (std::size_t c = 0; c < 3; ++c) {
      writer.put(linearChannel(color[c]));
    }
    writer.put(static_cast<std::uint16_t>(257 * color[3]));
  });
  each(mesh.triangleCount(), [&](std::size_t t) { writer.put(mesh.triangle(t)); });
  if (has_texture) {
    writer.text(mesh.texture()->png);
    writer.text(std::string((4 - mesh.texture()->png.size() % 4) % 4, '\0'));
  }
}

}  // namespace spherical_param::tools
