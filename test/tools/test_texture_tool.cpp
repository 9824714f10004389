// pcl_spherical_param_texture, run as a user does: files, report and refusals.

#include "tool_runner.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using nlohmann::json;
using tool_test::readFile;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::TemporaryDirectory;
using tool_test::writeFile;

using Point = std::array<float, 3>;
using Color = std::array<int, 3>;

/// What a file has in it. v is up.
struct Mesh {
  std::vector<Point> points;
  std::vector<Point> normals;
  std::vector<std::array<float, 2>> coordinates;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 3>> coordinate_triangles;
};

struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< the lowest row first

  Color at(const std::array<float, 2>& place) const {
    const auto index = [](float value, int count) {
      return std::clamp(static_cast<int>(value * static_cast<float>(count)), 0, count - 1);
    };
    const int i = 3 * (index(place[1], height) * width + index(place[0], width));
    return {pixels[static_cast<std::size_t>(i)], pixels[static_cast<std::size_t>(i) + 1],
            pixels[static_cast<std::size_t>(i) + 2]};
  }
};

Image decode(const std::string& png) {
  vtkNew<vtkPNGReader> reader;
  reader->SetMemoryBuffer(png.data());
  reader->SetMemoryBufferLength(static_cast<vtkIdType>(png.size()));
  reader->Update();
  Image image;
  image.width = reader->GetOutput()->GetDimensions()[0];
  image.height = reader->GetOutput()->GetDimensions()[1];
  EXPECT_EQ(reader->GetOutput()->GetNumberOfScalarComponents(), 3);
  const auto* const first =
      static_cast<const std::uint8_t*>(reader->GetOutput()->GetScalarPointer());
  image.pixels.assign(first, first + 3 * image.width * image.height);
  return image;
}

/// Colours that change slowly over an object of about this size.
Color colorOf(const Point& point) {
  Color color{};
  for (std::size_t d = 0; d < 3; ++d)
    color[d] = static_cast<int>(std::lround(127.0 + 110.0 * static_cast<double>(point[d])));
  return color;
}

/// An ellipsoid with a bump, 700 points.
std::vector<Point> cloud() {
  std::vector<Point> points;
  constexpr int count = 700;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    const double bump = 1.0 + 0.3 * std::exp(-8.0 * (1.0 - z) * (1.0 - z));
    points.push_back({static_cast<float>(0.9 * radius * std::cos(angle)),
                      static_cast<float>(0.6 * radius * std::sin(angle)),
                      static_cast<float>(0.7 * bump * z)});
  }
  return points;
}

void writeCloud(const std::string& path, bool has_colors) {
  std::ostringstream text;
  text.precision(9);
  const std::vector<Point> points = cloud();
  text << "ply\nformat ascii 1.0\nelement vertex " << points.size()
       << "\nproperty float x\nproperty float y\nproperty float z\n";
  if (has_colors)
    text << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  text << "end_header\n";
  for (const Point& point : points) {
    text << point[0] << " " << point[1] << " " << point[2];
    if (has_colors)
      for (const int channel : colorOf(point))
        text << " " << channel;
    text << "\n";
  }
  writeFile(path, text.str());
}

template <typename Value>
Value valueAt(const std::string& bytes, std::size_t offset) {
  Value value{};
  if (offset + sizeof value > bytes.size()) {
    ADD_FAILURE() << "byte " << offset << " is behind the end";
    return value;
  }
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Takes a binary glTF file apart, with all that the specification asks of one like it.
Mesh parseGlb(const std::string& bytes, json& document, std::string& png) {
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(valueAt<std::uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(valueAt<std::uint32_t>(bytes, 8), bytes.size());
  const std::size_t json_size = valueAt<std::uint32_t>(bytes, 12);
  EXPECT_EQ(json_size % 4, 0U);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  document = json::parse(bytes.substr(20, json_size));
  const std::size_t binary = 20 + json_size;
  EXPECT_EQ(valueAt<std::uint32_t>(bytes, binary), bytes.size() - binary - 8);
  EXPECT_EQ(bytes.substr(binary + 4, 4), std::string("BIN\0", 4));
  const std::string buffer = bytes.substr(binary + 8);
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
  const auto offset_of = [&](const json& accessor, std::size_t size) {
    const json& view = document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    EXPECT_EQ(view["byteLength"], size * accessor["count"].get<std::size_t>());
    return view["byteOffset"].get<std::size_t>();
  };
  const json& node = document["nodes"][document["scenes"][0]["nodes"][0].get<std::size_t>()];
  const json& primitive = document["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0];
  const auto accessor_of = [&](const json& index) {
    return document["accessors"][index.get<std::size_t>()];
  };
  Mesh mesh;
  const json positions = accessor_of(primitive["attributes"]["POSITION"]);
  const json normals = accessor_of(primitive["attributes"]["NORMAL"]);
  const json coordinates = accessor_of(primitive["attributes"]["TEXCOORD_0"]);
  const json indices = accessor_of(primitive["indices"]);
  EXPECT_EQ(positions["type"], "VEC3");
  EXPECT_EQ(normals["type"], "VEC3");
  EXPECT_EQ(coordinates["type"], "VEC2");
  EXPECT_EQ(indices["type"], "SCALAR");
  for (const json& accessor : {positions, normals, coordinates})
    EXPECT_EQ(accessor["componentType"], 5126);
  EXPECT_EQ(indices["componentType"], 5125);
  EXPECT_EQ(positions["count"], normals["count"]);
  EXPECT_EQ(positions["count"], coordinates["count"]);
  Point lowest{1e9F, 1e9F, 1e9F};
  Point highest{-1e9F, -1e9F, -1e9F};
  for (std::size_t i = 0; i < positions["count"].get<std::size_t>(); ++i) {
    mesh.points.push_back(valueAt<Point>(buffer, offset_of(positions, 12) + 12 * i));
    mesh.normals.push_back(valueAt<Point>(buffer, offset_of(normals, 12) + 12 * i));
    auto place = valueAt<std::array<float, 2>>(buffer, offset_of(coordinates, 8) + 8 * i);
    place[1] = 1.0F - place[1];
    mesh.coordinates.push_back(place);
    for (std::size_t d = 0; d < 3; ++d) {
      lowest[d] = std::min(lowest[d], mesh.points.back()[d]);
      highest[d] = std::max(highest[d], mesh.points.back()[d]);
    }
  }
  EXPECT_EQ(positions["min"].get<Point>(), lowest);
  EXPECT_EQ(positions["max"].get<Point>(), highest);
  EXPECT_EQ(indices["count"].get<std::size_t>() % 3, 0U);
  for (std::size_t t = 0; t < indices["count"].get<std::size_t>() / 3; ++t)
    mesh.triangles.push_back(valueAt<std::array<int, 3>>(buffer, offset_of(indices, 4) + 12 * t));
  mesh.coordinate_triangles = mesh.triangles;

  const json& material = document["materials"][primitive["material"].get<std::size_t>()];
  EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 0.0);
  EXPECT_EQ(material["pbrMetallicRoughness"]["roughnessFactor"], 1.0);
  EXPECT_EQ(material["doubleSided"], false);
  const json& texture =
      document["textures"]
              [material["pbrMetallicRoughness"]["baseColorTexture"]["index"].get<std::size_t>()];
  EXPECT_EQ(texture["sampler"], 0);
  const json& image = document["images"][texture["source"].get<std::size_t>()];
  EXPECT_EQ(image["mimeType"], "image/png");
  const json& view = document["bufferViews"][image["bufferView"].get<std::size_t>()];
  png = buffer.substr(view["byteOffset"].get<std::size_t>(), view["byteLength"].get<std::size_t>());
  return mesh;
}

Mesh parseObj(const std::string& text, std::string& material) {
  Mesh mesh;
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v" || kind == "vn") {
      Point point{};
      words >> point[0] >> point[1] >> point[2];
      (kind == "v" ? mesh.points : mesh.normals).push_back(point);
    } else if (kind == "vt") {
      std::array<float, 2> place{};
      words >> place[0] >> place[1];
      mesh.coordinates.push_back(place);
    } else if (kind == "mtllib") {
      words >> material;
    } else if (kind == "f") {
      std::array<int, 3> triangle{};
      std::array<int, 3> places{};
      for (std::size_t k = 0; k < 3; ++k) {
        int normal = 0;
        char slash = ' ';
        words >> triangle[k] >> slash >> places[k] >> slash >> normal;
        EXPECT_EQ(normal, triangle[k]);
        --triangle[k];
        --places[k];
      }
      mesh.triangles.push_back(triangle);
      mesh.coordinate_triangles.push_back(places);
    } else {
      EXPECT_EQ(kind, "usemtl");
    }
    EXPECT_FALSE(words.fail()) << line;
  }
  return mesh;
}

Mesh parsePly(const std::string& bytes, std::string& image) {
  std::istringstream text(bytes);
  std::string line;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  bool is_binary = false;
  std::vector<std::string> properties;
  while (std::getline(text, line) && line != "end_header") {
    std::istringstream words(line);
    std::string first;
    std::string second;
    words >> first >> second;
    if (first == "format")
      is_binary = second == "binary_little_endian";
    else if (first == "comment" && second == "TextureFile")
      words >> image;
    else if (first == "element")
      words >> (second == "vertex" ? vertices : faces);
    else if (first == "property" && second == "float")
      words >> properties.emplace_back();
  }
  EXPECT_EQ(properties, (std::vector<std::string>{"x", "y", "z", "nx", "ny", "nz", "s", "t"}));
  Mesh mesh;
  auto at = static_cast<std::size_t>(text.tellg());
  for (std::size_t i = 0; i < vertices; ++i) {
    std::array<float, 8> values{};
    if (is_binary) {
      values = valueAt<std::array<float, 8>>(bytes, at);
      at += sizeof values;
    } else {
      for (float& value : values)
        text >> value;
    }
    mesh.points.push_back({values[0], values[1], values[2]});
    mesh.normals.push_back({values[3], values[4], values[5]});
    mesh.coordinates.push_back({values[6], values[7]});
  }
  for (std::size_t t = 0; t < faces; ++t) {
    std::array<int, 3> triangle{};
    int corners = 0;
    if (is_binary) {
      corners = bytes[at];
      triangle = valueAt<std::array<int, 3>>(bytes, at + 1);
      at += 13;
    } else {
      text >> corners >> triangle[0] >> triangle[1] >> triangle[2];
    }
    EXPECT_EQ(corners, 3);
    mesh.triangles.push_back(triangle);
  }
  EXPECT_TRUE(is_binary ? at == bytes.size() : !text.fail());
  mesh.coordinate_triangles = mesh.triangles;
  return mesh;
}

/// Whether a mesh is closed and of genus 0 once vertices at one place are one.
void expectClosedSphere(const Mesh& mesh) {
  std::map<Point, int> welded;
  std::vector<int> vertex;
  for (const Point& point : mesh.points)
    vertex.push_back(welded.try_emplace(point, static_cast<int>(welded.size())).first->second);
  std::map<std::pair<int, int>, int> edges;
  long long triangles = 0;
  for (const std::array<int, 3>& corners : mesh.triangles) {
    std::array<int, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_GE(corners[k], 0);
      ASSERT_LT(corners[k], static_cast<int>(mesh.points.size()));
      t[k] = vertex[static_cast<std::size_t>(corners[k])];
    }
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      continue;  // too thin for single precision
    ++triangles;
    for (std::size_t k = 0; k < 3; ++k)
      ++edges[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_EQ(edges.count({edge.second, edge.first}), 1U);
  }
  EXPECT_EQ(static_cast<long long>(welded.size()) - static_cast<long long>(edges.size()) / 2 +
                triangles,
            2);
}

void expectTextured(const Mesh& mesh, const Image& image, bool cube = false) {
  expectClosedSphere(mesh);
  ASSERT_EQ(mesh.triangles.size(), mesh.coordinate_triangles.size());
  ASSERT_EQ(mesh.points.size(), mesh.normals.size());
  for (const Point& normal : mesh.normals)
    EXPECT_NEAR(std::hypot(normal[0], normal[1], normal[2]), 1.0F, 1e-5F);
  for (const auto& [u, v] : mesh.coordinates) {
    EXPECT_TRUE(u >= 0.0F && u <= 1.0F && v >= 0.0F && v <= 1.0F);
  }
  // All points of the cloud are there, and the image has their colours.
  const std::vector<Point> input = cloud();
  const std::set<Point> all(mesh.points.begin(), mesh.points.end());
  for (const Point& point : input)
    EXPECT_EQ(all.count(point), 1U);
  int worst = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Color wanted = colorOf(mesh.points[static_cast<std::size_t>(mesh.triangles[t][k])]);
      const auto& place =
          mesh.coordinates[static_cast<std::size_t>(mesh.coordinate_triangles[t][k])];
      const Color painted = image.at(place);
      for (std::size_t c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(wanted[c] - painted[c]));
    }
  // Half of a pixel of 512 is up to 0.01 of the object on its side in the image.
  EXPECT_LE(worst, cube ? 8 : 6);
}

class TextureTool : public testing::Test {
protected:
  TextureTool() {
    writeCloud(directory_.file("in.ply"), true);
    writeCloud(directory_.file("plain.ply"), false);
  }

  RunResult run(const std::vector<std::string>& arguments) const {
    RunOptions options;
    options.directory = directory_.path();
    return tool_test::run(TEXTURE_TOOL, arguments, options);
  }
  std::string file(const std::string& name) const { return directory_.file(name); }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& [name, content] : directory_.listing())
      all.insert(name);
    return all;
  }

  TemporaryDirectory directory_;
};

class TextureCharts : public TextureTool, public testing::WithParamInterface<std::string> {};

INSTANTIATE_TEST_SUITE_P(, TextureCharts, testing::Values("equirectangular", "octahedral", "cube"),
                         [](const auto& parameter) { return parameter.param; });

TEST_P(TextureCharts, AllFormatsHoldTheClosedMeshAndTheColorsOfThePoints) {
  const std::string& chart = GetParam();
  const bool is_cube = chart == "cube";
  const std::vector<std::string> options = {"-chart", chart, "-size", "512", "-quiet"};
  const auto with = [&options](std::vector<std::string> files) {
    files.insert(files.end(), options.begin(), options.end());
    return files;
  };
  ASSERT_EQ(run(with({"in.ply", "out.glb"})).exit_code, 0);
  json document;
  std::string png;
  const Mesh glb = parseGlb(readFile(file("out.glb")), document, png);
  const Image image = decode(png);
  EXPECT_EQ(image.height, 512);
  EXPECT_EQ(image.width, is_cube ? 768 : chart == "octahedral" ? 512 : 1024);
  expectTextured(glb, image, is_cube);
  EXPECT_EQ(document["samplers"][0]["wrapS"], chart == "equirectangular" ? 10497 : 33071);
  EXPECT_EQ(document["samplers"][0]["wrapT"], 33071);

  ASSERT_EQ(run(with({"in.ply", "out.obj"})).exit_code, 0);
  std::string material;
  const Mesh obj = parseObj(readFile(file("out.obj")), material);
  EXPECT_EQ(material, "out.mtl");
  EXPECT_NE(readFile(file("out.mtl")).find("\nmap_Kd out.png\n"), std::string::npos);
  EXPECT_EQ(readFile(file("out.png")), png);
  expectTextured(obj, image, is_cube);
  // Without welding: each vertex is there once.
  EXPECT_EQ(obj.triangles.size(), glb.triangles.size());
  EXPECT_EQ(obj.coordinates.size(), glb.points.size());
  EXPECT_LT(obj.points.size(), glb.points.size());

  for (const bool is_ascii : {false, true}) {
    std::vector<std::string> arguments = with({"in.ply", "mesh.ply", "-image", "other.png"});
    if (is_ascii)
      arguments.emplace_back("-ascii");
    ASSERT_EQ(run(arguments).exit_code, 0);
    std::string name;
    const Mesh ply = parsePly(readFile(file("mesh.ply")), name);
    EXPECT_EQ(name, "other.png");
    EXPECT_EQ(readFile(file("other.png")), png);
    expectTextured(ply, image, is_cube);
    EXPECT_EQ(ply.points, glb.points);
    EXPECT_EQ(ply.coordinates.size(), glb.coordinates.size());
  }
  EXPECT_EQ(names(), (std::set<std::string>{"in.ply", "mesh.ply", "other.png", "out.glb", "out.mtl",
                                            "out.obj", "out.png", "plain.ply"}));
}

TEST_P(TextureCharts, SameBytesForAnyNumberOfThreads) {
  std::set<std::string> contents;
  for (const char* threads : {"1", "2", "3"}) {
    ASSERT_EQ(run({"in.ply", "out.glb", "-chart", GetParam(), "-threads", threads, "-size", "200",
                   "-quiet"})
                  .exit_code,
              0);
    contents.insert(readFile(file("out.glb")));
  }
  EXPECT_EQ(contents.size(), 1U);
}

TEST_F(TextureTool, ReportTellsOfTheMapAndTheTexture) {
  ASSERT_EQ(run({"in.ply", "out.obj", "-json", "out.json", "-size", "100", "-chart", "cube",
                 "-gutter", "3", "-quiet"})
                .exit_code,
            0);
  const json report = json::parse(readFile(file("out.json")));
  EXPECT_EQ(report["flipped_triangles"], 0);
  for (const char* kind : {"angle_distortion", "area_distortion"}) {
    EXPECT_GE(report[kind]["mean"], 1.0);
    EXPECT_GE(report[kind]["p95"], 1.0);
    EXPECT_GE(report[kind]["max"], report[kind]["p95"]);
  }
  EXPECT_EQ(report["chart"], "cube");
  EXPECT_EQ(report["texture"], "colors");
  EXPECT_EQ(report["image"]["width"], 150);
  EXPECT_EQ(report["image"]["height"], 100);
  // 3 of 50 pixels at both sides of each face.
  EXPECT_NEAR(report["image"]["covered_share"].get<double>(), 0.88 * 0.88, 0.03);
  EXPECT_GT(report["image"]["gutter_share"], 0.15);
  EXPECT_EQ(report["vertices"], 700);
  EXPECT_EQ(report["mesh_triangles"], 1396);
  std::string material;
  const Mesh mesh = parseObj(readFile(file("out.obj")), material);
  EXPECT_EQ(report["triangles"], mesh.triangles.size());
  EXPECT_EQ(report["cut_vertices"], mesh.points.size() - 700);
  EXPECT_EQ(report["texture_coordinates"], mesh.coordinates.size());
  EXPECT_EQ(report["options"]["gutter"], 3);
  EXPECT_EQ(report["options"]["checker"], nullptr);
  EXPECT_EQ(report["options"]["image"], "out.png");
  EXPECT_TRUE(report["warnings"].empty());
  std::set<std::string> stages;
  for (const json& stage : report["stages"])
    stages.insert(stage["name"].get<std::string>());
  for (const char* stage : {"read", "map", "atlas", "image", "write"})
    EXPECT_EQ(stages.count(stage), 1U) << stage;
  EXPECT_GT(report["peak_memory_bytes"], 0);
}

TEST_F(TextureTool, WithoutColorsThereIsACheckerboardAndAWarning) {
  const RunResult plain = run({"plain.ply", "plain.glb", "-size", "64", "-json", "plain.json"});
  ASSERT_EQ(plain.exit_code, 0);
  EXPECT_NE(plain.output.find("no colours"), std::string::npos);
  const json report = json::parse(readFile(file("plain.json")));
  EXPECT_EQ(report["texture"], "checkerboard");
  ASSERT_EQ(report["warnings"].size(), 1U);
  EXPECT_NE(report["warnings"][0].get<std::string>().find("no colours"), std::string::npos);
  // Asked for, it is the same, and needs no warning.
  const RunResult asked =
      run({"plain.ply", "asked.glb", "-size", "64", "-checker", "8", "-json", "asked.json"});
  ASSERT_EQ(asked.exit_code, 0);
  EXPECT_EQ(readFile(file("asked.glb")), readFile(file("plain.glb")));
  EXPECT_TRUE(json::parse(readFile(file("asked.json")))["warnings"].empty());
  ASSERT_EQ(run({"in.ply", "colors.glb", "-size", "64", "-checker", "8", "-quiet"}).exit_code, 0);
  EXPECT_EQ(readFile(file("colors.glb")), readFile(file("plain.glb")));
}

TEST_F(TextureTool, FilesMentionEachOtherByPathsFromWhereTheyAre) {
  writeFile(file("folder.txt"), "");
  const std::string folder = file("folder");
  ASSERT_EQ(std::system(("mkdir '" + folder + "'").c_str()), 0);
  ASSERT_EQ(run({"in.ply", "folder/a.obj", "-size", "16", "-image", "b.png", "-quiet"}).exit_code,
            0);
  std::string material;
  parseObj(readFile(folder + "/a.obj"), material);
  EXPECT_EQ(material, "a.mtl");
  EXPECT_NE(readFile(folder + "/a.mtl").find("map_Kd ../b.png\n"), std::string::npos);
  // Blanks are no matter where the name is the rest of a line, or there is no name.
  EXPECT_EQ(run({"in.ply", "a b.ply", "-size", "16", "-quiet"}).exit_code, 0);
  EXPECT_NE(readFile(file("a b.ply")).find("comment TextureFile a b.png\n"), std::string::npos);
  EXPECT_EQ(run({"in.ply", "a b.glb", "-size", "16", "-quiet"}).exit_code, 0);
}

TEST_F(TextureTool, RefusesWhatItCannotDo) {
  const std::set<std::string> before = names();
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"in.ply"},
      {"in.ply", "out.glb", "more.glb"},
      {"in.ply", "out.stl"},
      {"in.glb", "out.glb"},
      {"in.ply", "in.ply"},
      {"in.ply", "out.glb", "-chart", "mercator"},
      {"in.ply", "out.glb", "-size", "15"},
      {"in.ply", "out.glb", "-gutter", "257"},
      {"in.ply", "out.glb", "-checker", "0"},
      {"in.ply", "out.glb", "-image", "out.png"},
      {"in.ply", "out.glb", "-ascii"},
      {"in.ply", "out.obj", "-image", "out.jpg"},
      {"in.ply", "out.obj", "-image", "a b.png"},
      {"in.ply", "a b.obj"},
      {"in.ply", "out.ply", "-image", "a\nb.png"},
      {"in.ply", "out.ply", "-json", "out.png"},
  };
  for (const std::vector<std::string>& arguments : wrong) {
    const RunResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << (arguments.empty() ? "" : arguments.back());
    EXPECT_EQ(result.errorLines().size(), 2U);
  }
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"missing.ply", "out.glb"},
                                             {"in.ply", "nowhere/out.glb"},
                                             {"in.ply", "out.ply", "-image", "nowhere/out.png"}}) {
    const RunResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << arguments.back();
    EXPECT_EQ(result.errorLines().size(), 2U);
  }
  EXPECT_EQ(names(), before);
}

TEST_F(TextureTool, AFullDiskLeavesNothingBehind) {
  const auto before = directory_.listing();
  for (const char* output : {"out.glb", "out.obj", "out.ply"}) {
    RunOptions options;
    options.directory = directory_.path();
    options.file_size_limit = 20000;
    const RunResult result = tool_test::run(TEXTURE_TOOL, {"in.ply", output, "-quiet"}, options);
    EXPECT_EQ(result.exit_code, 1) << output;
    EXPECT_EQ(directory_.listing(), before);
  }
}

TEST_F(TextureTool, HelpAndVersionSucceed) {
  const RunResult help = run({"-h"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* option : {"-chart", "-size", "-gutter", "-checker", "-image", "-json", "-graph"})
    EXPECT_NE(help.output.find(option), std::string::npos) << option;
  EXPECT_EQ(run({"-version"}).exit_code, 0);
}

}  // namespace
