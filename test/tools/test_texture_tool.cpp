// pcl_spherical_param_texture, run as a user does: its formats, taken apart without the tools.

#include "handle_shapes.h"
#include "helpers.h"
#include "spherical_param/mesh_topology.h"
#include "tool_test.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

namespace {

using nlohmann::json;
using spherical_param::Index;
using spherical_param::Positions;
using spherical_param::Triangles;
using tool_test::expectEntries;
using Words = std::vector<std::string>;

/// What a file has in it. v is up.
struct TexturedFile {
  Positions points;
  Positions normals;
  Eigen::Matrix2Xd coordinates;
  Triangles triangles;
  Triangles coordinate_triangles;
};

struct Image {
  Index width = 0;
  Index height = 0;
  std::vector<std::uint8_t> pixels;  ///< the highest row first

  Eigen::Vector3d at(const Eigen::Vector2d& place) const {
    const auto index = [](double value, Index count) {
      return std::clamp(static_cast<Index>(value * count), 0, count - 1);
    };
    const auto i = static_cast<std::size_t>(
        3 * ((height - 1 - index(place.y(), height)) * width + index(place.x(), width)));
    return {static_cast<double>(pixels[i]), static_cast<double>(pixels[i + 1]),
            static_cast<double>(pixels[i + 2])};
  }
};

Image decode(const std::string& png) {
  png_image reader{};
  reader.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&reader, png.data(), png.size()), 0);
  EXPECT_EQ(reader.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
  Image image{static_cast<Index>(reader.width), static_cast<Index>(reader.height), {}};
  image.pixels.resize(PNG_IMAGE_SIZE(reader));
  EXPECT_NE(png_image_finish_read(&reader, nullptr, image.pixels.data(), 0, nullptr), 0);
  return image;
}

/// Colours that change slowly over an object of about this size.
Positions colorsOf(const Positions& points) {
  return (127.0 + 110.0 * points.array()).round();
}

/// An ellipsoid with a bump.
Positions cloud() {
  Positions points = tool_test::ellipsoid(700, {0.9, 0.6, 0.7});
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double height = 1.0 - points(2, i) / 0.7;
    points(2, i) *= 1.0 + 0.3 * std::exp(-8.0 * height * height);
  }
  return points.cast<float>().cast<double>();
}

template <typename Scalar>
using Columns = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

/// The parts of a binary glTF file, with what the specification asks of one like it.
struct Glb {
  json document;
  std::string buffer;

  explicit Glb(const std::string& bytes) {
    const auto integer = [&bytes](std::size_t offset) {
      std::uint32_t value = 0;
      std::memcpy(&value, bytes.data() + offset, sizeof value);
      return std::size_t{value};
    };
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(integer(4), 2U);
    EXPECT_EQ(integer(8), bytes.size());
    EXPECT_EQ(integer(12) % 4, 0U);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    document = json::parse(bytes.substr(20, integer(12)));
    const std::size_t binary = 20 + integer(12);
    EXPECT_EQ(integer(binary), bytes.size() - binary - 8);
    EXPECT_EQ(bytes.substr(binary + 4, 4), std::string("BIN\0", 4));
    buffer = bytes.substr(binary + 8);
    EXPECT_EQ(buffer.size() % 4, 0U);
    EXPECT_EQ(document["asset"]["version"], "2.0");
    EXPECT_EQ(document["buffers"][0]["byteLength"], buffer.size());
    std::size_t end = 0;
    for (const json& view : document["bufferViews"]) {
      EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0U);
      EXPECT_GE(view["byteOffset"].get<std::size_t>(), end);
      end = view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>();
      EXPECT_LE(end, buffer.size());
    }
  }

  const json& at(const char* list, const json& index) const {
    return document[list][index.get<std::size_t>()];
  }
  std::string viewOf(const json& index) const {
    const json& view = at("bufferViews", index);
    return buffer.substr(view["byteOffset"], view["byteLength"]);
  }
  template <typename Scalar>
  Columns<Scalar> columns(const json& index, const char* type, int component_type,
                          Eigen::Index rows) const {
    const json& accessor = at("accessors", index);
    EXPECT_EQ(accessor["type"], type);
    EXPECT_EQ(accessor["componentType"], component_type);
    const std::string bytes = viewOf(accessor["bufferView"]);
    const std::size_t count = accessor["count"];
    const std::size_t scalars =
        std::string(type) == "SCALAR" ? count : count * static_cast<std::size_t>(rows);
    EXPECT_EQ(bytes.size(), sizeof(Scalar) * scalars);
    Columns<Scalar> values(rows, static_cast<Eigen::Index>(scalars) / rows);
    std::memcpy(values.data(), bytes.data(), bytes.size());
    if (accessor.contains("min"))
      for (Eigen::Index row = 0; row < rows; ++row) {
        const auto r = static_cast<std::size_t>(row);
        EXPECT_EQ(accessor["min"][r].get<Scalar>(), values.row(row).minCoeff());
        EXPECT_EQ(accessor["max"][r].get<Scalar>(), values.row(row).maxCoeff());
      }
    return values;
  }
};

TexturedFile parseGlb(const Glb& glb, std::string& png) {
  const json& node = glb.at("nodes", glb.document["scenes"][0]["nodes"][0]);
  const json& primitive = glb.at("meshes", node["mesh"])["primitives"][0];
  const json& attributes = primitive["attributes"];
  constexpr int real = 5126;
  constexpr int integer = 5125;
  EXPECT_TRUE(glb.at("accessors", attributes["POSITION"]).contains("max"));
  TexturedFile mesh;
  mesh.points = glb.columns<float>(attributes["POSITION"], "VEC3", real, 3).cast<double>();
  mesh.normals = glb.columns<float>(attributes["NORMAL"], "VEC3", real, 3).cast<double>();
  mesh.coordinates = glb.columns<float>(attributes["TEXCOORD_0"], "VEC2", real, 2).cast<double>();
  mesh.coordinates.row(1) = 1.0 - mesh.coordinates.row(1).array();
  mesh.triangles = glb.columns<Index>(primitive["indices"], "SCALAR", integer, 3);
  mesh.coordinate_triangles = mesh.triangles;
  const json& material = glb.at("materials", primitive["material"]);
  EXPECT_EQ(material["doubleSided"], false);
  const json& roughness = material["pbrMetallicRoughness"];
  EXPECT_EQ(roughness["metallicFactor"], 0.0);
  EXPECT_EQ(roughness["roughnessFactor"], 1.0);
  const json& texture = glb.at("textures", roughness["baseColorTexture"]["index"]);
  EXPECT_EQ(texture["sampler"], 0);
  const json& image = glb.at("images", texture["source"]);
  EXPECT_EQ(image["mimeType"], "image/png");
  png = glb.viewOf(image["bufferView"]);
  return mesh;
}

TexturedFile parseObj(const std::string& text, std::string& material) {
  std::map<std::string, std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "mtllib")
      words >> material;
    else if (kind == "f")
      for (int k = 0; k < 3; ++k) {
        int vertex = 0, place = 0, normal = 0;
        char slash = ' ';
        words >> vertex >> slash >> place >> slash >> normal;
        EXPECT_EQ(normal, vertex);
        rows["f"].push_back(vertex - 1);
        rows["ft"].push_back(place - 1);
      }
    else
      for (double value = 0.0; words >> value;)
        rows[kind].push_back(value);
  }
  const auto columns = [&rows](const char* kind, Eigen::Index size) {
    const std::vector<double>& values = rows[kind];
    return Eigen::Map<const Eigen::MatrixXd>(values.data(), size,
                                             static_cast<Eigen::Index>(values.size()) / size);
  };
  return {columns("v", 3).cast<float>().cast<double>(), columns("vn", 3), columns("vt", 2),
          columns("f", 3).cast<Index>(), columns("ft", 3).cast<Index>()};
}

TexturedFile parsePly(const tool_test::MeshFile& file) {
  return {file.points(), file.normals(), file.columns("s", "t", "t").topRows(2), file.triangles,
          file.triangles};
}

/// Whether a mesh is a closed sphere once vertices at one place are one.
bool isSphereWhenWelded(const TexturedFile& mesh) {
  std::map<std::array<double, 3>, Index> welded;
  std::vector<Index> kept;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    std::array<Index, 3> corners{};
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d place = mesh.points.col(mesh.triangles(k, t));
      corners[static_cast<std::size_t>(k)] =
          welded.insert({{place.x(), place.y(), place.z()}, static_cast<Index>(welded.size())})
              .first->second;
    }
    // Some are too thin for single precision.
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
      kept.insert(kept.end(), corners.begin(), corners.end());
  }
  const Triangles triangles =
      Eigen::Map<const Triangles>(kept.data(), 3, static_cast<Eigen::Index>(kept.size()) / 3);
  return spherical_param::test::isSphereOverAll(triangles, static_cast<Index>(welded.size()));
}

/// The largest error of a colour where the image has a corner of a triangle.
double worstColor(const TexturedFile& mesh, const Image& image) {
  const Positions colors = colorsOf(mesh.points);
  double worst = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector2d place = mesh.coordinates.col(mesh.coordinate_triangles(t));
    const Eigen::Vector3d off = image.at(place) - colors.col(mesh.triangles(t));
    worst = std::max(worst, off.cwiseAbs().maxCoeff());
  }
  return worst;
}

void expectTextured(const TexturedFile& mesh, const Image& image, double largest_error) {
  EXPECT_TRUE(isSphereWhenWelded(mesh));
  ASSERT_EQ(mesh.triangles.cols(), mesh.coordinate_triangles.cols());
  ASSERT_EQ(mesh.points.cols(), mesh.normals.cols());
  EXPECT_LT((mesh.normals.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-5);
  EXPECT_GE(mesh.coordinates.minCoeff(), 0.0);
  EXPECT_LE(mesh.coordinates.maxCoeff(), 1.0);
  // All points of the cloud are there, and the image has their colours.
  EXPECT_TRUE(tool_test::containsAll(mesh.points, cloud()));
  EXPECT_LE(worstColor(mesh, image), largest_error);
}

class TextureTool : public tool_test::ToolTest {
protected:
  void SetUp() override {
    write("in.ply", tool_test::plyOf(cloud(), {}, colorsOf(cloud())));
    write("plain.ply", tool_test::plyOf(cloud()));
  }
  void make(const Words& arguments) const { expectSuccess(TEXTURE_TOOL, arguments); }
};

TEST_F(TextureTool, AllFormatsHoldTheClosedMeshAndTheColoursOfThePoints) {
  for (const auto& [chart, width] : {std::tuple("equirectangular", 1024),
                                     std::tuple("octahedral", 512), std::tuple("cube", 768)}) {
    SCOPED_TRACE(chart);
    const auto make_chart = [this, name = std::string(chart)](const Words& words) {
      make(tool_test::with(words, {"-chart", name, "-size", "512", "-quiet"}));
    };
    // Half of a pixel of 512 is up to 0.01 of the object on its side in the image.
    const double largest_error = width == 768 ? 8.0 : 6.0;
    const bool wraps = width == 1024;
    make_chart({"in.ply", "out.glb"});
    std::string png;
    const Glb parts(content("out.glb"));
    const TexturedFile glb = parseGlb(parts, png);
    const Image image = decode(png);
    EXPECT_EQ(image.height, 512);
    EXPECT_EQ(image.width, width);
    expectTextured(glb, image, largest_error);
    EXPECT_EQ(parts.document["samplers"][0]["wrapS"], wraps ? 10497 : 33071);
    EXPECT_EQ(parts.document["samplers"][0]["wrapT"], 33071);

    make_chart({"in.ply", "out.obj"});
    std::string material;
    const TexturedFile obj = parseObj(content("out.obj"), material);
    EXPECT_EQ(material, "out.mtl");
    EXPECT_NE(content("out.mtl").find("\nmap_Kd out.png\n"), std::string::npos);
    EXPECT_TRUE(content("out.png") == png);
    expectTextured(obj, image, largest_error);
    // Without welding: each vertex is there once.
    EXPECT_EQ(obj.triangles.cols(), glb.triangles.cols());
    EXPECT_EQ(obj.coordinates.cols(), glb.points.cols());
    EXPECT_LT(obj.points.cols(), glb.points.cols());

    // Vertices, coordinates and triangles are those of .glb, whatever the chart.
    if (width != 768)
      continue;
    make_chart({"in.ply", "mesh.ply", "-image", "other.png"});
    EXPECT_EQ(mesh("mesh.ply").comment, "comment TextureFile other.png");
    EXPECT_TRUE(content("other.png") == png);
    const TexturedFile ply = parsePly(mesh("mesh.ply"));
    expectTextured(ply, image, largest_error);
    EXPECT_EQ(ply.points, glb.points);
    make_chart({"in.ply", "mesh.ply", "-image", "other.png", "-ascii"});
    EXPECT_NE(content("mesh.ply").find("format ascii"), std::string::npos);
  }
  EXPECT_EQ(directory.listing().size(), 8U);  // two clouds, glb, obj, mtl, ply and two images
}

TEST_F(TextureTool, ReportTellsOfTheMapAndTheTexture) {
  const json report = reportOf(
      TEXTURE_TOOL, {"in.ply", "out.obj", "-size", "100", "-chart", "cube", "-gutter", "3"});
  std::string material;
  const TexturedFile mesh = parseObj(content("out.obj"), material);
  expectEntries(report, R"({
      "chart": "cube", "texture": "colors", "image": {"width": 150, "height": 100},
      "vertices": 700, "mesh_triangles": 1396, "findings": [],
      "options": {"gutter": 3, "checker": null, "image": "out.png"}})"_json);
  EXPECT_EQ(report["triangles"], mesh.triangles.cols());
  EXPECT_EQ(report["cut_vertices"], mesh.points.cols() - 700);
  EXPECT_EQ(report["texture_coordinates"], mesh.coordinates.cols());
  // 3 of 50 pixels at both sides of each face.
  EXPECT_NEAR(report["image"]["covered_share"], 0.88 * 0.88, 0.03);
  EXPECT_GT(report["image"]["gutter_share"], 0.15);
}

TEST_F(TextureTool, WithoutColoursThereIsACheckerboardAndThatIsSaid) {
  const json plain = reportOf(TEXTURE_TOOL, {"plain.ply", "plain.glb", "-size", "64"});
  EXPECT_EQ(plain["texture"], "checkerboard");
  ASSERT_EQ(plain["findings"].size(), 1U);
  EXPECT_NE(plain["findings"][0]["text"].get<std::string>().find("no colours"), std::string::npos);
  // Asked for, it is the same, and needs no warning.
  for (const char* input : {"plain.ply", "in.ply"}) {
    const json asked = reportOf(TEXTURE_TOOL, {input, "asked.glb", "-size", "64", "-checker", "8"});
    EXPECT_TRUE(content("asked.glb") == content("plain.glb")) << input;
    EXPECT_TRUE(asked["findings"].empty());
  }
}

TEST_F(TextureTool, ASurfaceWithHandlesIsCutInTheImageAlone) {
  const Positions points =
      spherical_param::test::torusCloud(40, 20, 0.7, 0.3).cast<float>().cast<double>();
  write("torus.ply", tool_test::plyOf(points, {}, colorsOf(points)));
  const json report = reportOf(TEXTURE_TOOL, {"torus.ply", "out.obj", "-size", "512"});
  expectEntries(report, R"({"vertices": 800, "mesh_triangles": 1600, "cut_handles": 1,
      "texture": "colors", "embedding_distortion": null, "findings": []})"_json);
  std::string material;
  const TexturedFile mesh = parseObj(content("out.obj"), material);
  const auto topology =
      spherical_param::checkTopology(mesh.triangles, static_cast<std::size_t>(mesh.points.cols()));
  EXPECT_TRUE(topology.isSurface() && topology.closed);
  EXPECT_EQ(topology.genus, 1);
  EXPECT_EQ(mesh.points.leftCols(800), points);
  EXPECT_LE(worstColor(mesh, decode(content("out.png"))), 10.0);
}

TEST_F(TextureTool, FilesMentionEachOtherByPathsFromWhereTheyAre) {
  ASSERT_TRUE(std::filesystem::create_directory(directory.file("folder")));
  make({"in.ply", "folder/a.obj", "-size", "16", "-image", "b.png", "-quiet"});
  std::string material;
  parseObj(content("folder/a.obj"), material);
  EXPECT_EQ(material, "a.mtl");
  EXPECT_NE(content("folder/a.mtl").find("map_Kd ../b.png\n"), std::string::npos);
  // Blanks are no matter where the name is the rest of a line, or there is no name.
  make({"in.ply", "a b.ply", "-size", "16", "-quiet"});
  EXPECT_EQ(mesh("a b.ply").comment, "comment TextureFile a b.png");
  make({"in.ply", "a b.glb", "-size", "16", "-quiet"});
}

}  // namespace
