// pcl_spherical_param_texture: meshes a point cloud and gives the mesh a texture with its colours.

#include "common/cloud_reconstruction.h"
#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/findings.h"
#include "common/json_report.h"
#include "common/names.h"
#include "common/numbers.h"
#include "common/output_file.h"
#include "common/output_options.h"
#include "common/product_input.h"
#include "common/reconstruction_report.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "common/textured_mesh.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/version.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using spherical_param::BakeOptions;
using spherical_param::SphereChart;
using spherical_param::Surface;
using spherical_param::TextureAtlas;
using spherical_param::TextureAtlasOptions;
using spherical_param::TextureImage;

const std::string tool_name = "pcl_spherical_param_texture";
const std::string extensions = ".glb .obj .ply";

const Names<SphereChart> chart_names = {
    {"equirectangular", SphereChart::Equirectangular},
    {"octahedral", SphereChart::Octahedral},
    {"cube", SphereChart::CubeMap},
};

enum class TextureFormat { Glb, Obj, Ply };

const Names<TextureFormat> format_names = {
    {".glb", TextureFormat::Glb},
    {".obj", TextureFormat::Obj},
    {".ply", TextureFormat::Ply},
};

/// Squares along a quarter of a great circle where a cloud has no colours.
constexpr int usual_cells = 8;

const std::vector<OptionInfo> own_options = {
    {"chart", "NAME", "equirectangular, octahedral or cube (octahedral)"},
    {"size", "N", "height of the image, 16 to 16384 pixels (1024)"},
    {"gutter", "N", "painted pixels around the triangles, up to 256 (8)"},
    {"checker", "N", "checkerboard of N squares a quarter circle instead of colours"},
    {"image", "FILE", "image beside .obj and .ply, .png (as the output)"},
};
const ProductDefaults product_defaults(HandlesOnSphere::Cut);
const std::vector<OptionInfo> option_table =
    joined({own_options, productOptions(product_defaults), outputOptions()});

/// What each does, and the words after the tool's name.
const std::vector<std::pair<std::string, std::string>> example_table = {
    {"A file with the colours of the scan in a texture", "scan.ply textured.glb"},
    {"A checkerboard, which shows the map", "scan.ply checker.glb -checker 16"},
};

std::string helpText(bool with_experts) {
  return "Usage: " + tool_name +
         " input output [options]\n\n"
         "Meshes the points of an object, and paints their colours into a texture.\n"
         "  input:  " +
         extensionsFor(FileUse::ReadCloud) +
         "\n  output: .glb, with the image in it; .obj, with .mtl and .png beside it; .ply, with "
         ".png\n"
         "\nOptions (-name value, --name value or --name=value; defaults in brackets):\n" +
         describeOptions(option_table, with_experts) + "\n" +
         describeExamples(tool_name, example_table) +
         "\nExit code: 0 done (also with warnings), 1 failed (with -strict also if the mesh is "
         "unfit),\n"
         "2 wrong usage, 3 written but not usable: more than 1 % of the triangles intersect.\n";
}

/// What the user asked for.
struct Settings {
  std::string input;
  std::string output;
  TextureFormat format = TextureFormat::Glb;
  std::string material;  ///< empty: not wanted
  std::string image;     ///< empty: it is in the output
  TextureAtlasOptions atlas;
  BakeOptions bake;
  std::optional<int> cells;  ///< none: the colours of the points, if there are any
  ProductSettings product;
  OutputSettings report;
};

/// The name by which a file is found from the place of another.
std::string seenFrom(const std::string& place, const std::string& file) {
  namespace fs = std::filesystem;
  const fs::path directory = fs::absolute(place).parent_path();
  return fs::absolute(file)
      .lexically_normal()
      .lexically_relative(directory.lexically_normal())
      .generic_string();
}

/// Names that would be read as something else where they are mentioned.
void checkName(const Settings& settings, const std::string& name) {
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  const bool is_obj = settings.format == TextureFormat::Obj;
  if (std::any_of(name.begin(), name.end(), [&](char c) {
        return is_control(static_cast<unsigned char>(c)) || (is_obj && c == ' ');
      })) {
    throw UsageError(inQuotes(name) + " cannot be mentioned in " + inQuotes(settings.output) +
                         ": it has a " + (is_obj ? "blank" : "control character") + " in it",
                     is_obj ? "give names without blanks, or write .glb"
                            : "give another name, or write .glb");
  }
}

void parseFiles(const CommandLine& command_line, Settings& settings) {
  std::tie(settings.input, settings.output) = inputAndOutput(command_line, tool_name);
  requireFormat(settings.input, FileUse::ReadCloud);
  const std::filesystem::path output = settings.output;
  const std::string extension = extensionOf(settings.output);
  const auto format =
      std::find_if(format_names.begin(), format_names.end(),
                   [&extension](const auto& entry) { return entry.first == extension; });
  if (format == format_names.end()) {
    throw UsageError(inQuotes(settings.output) + " has an extension without textures",
                     "use one of " + extensions);
  }
  settings.format = format->second;

  if (settings.format == TextureFormat::Glb) {
    if (command_line.has("image")) {
      throw UsageError("option -image does nothing with .glb, which contains the image",
                       "leave -image out, or write .obj or .ply");
    }
    return;
  }
  const auto beside = [&output](const char* other) {
    return std::filesystem::path(output).replace_extension(other).string();
  };
  settings.image = command_line.value("image", beside(".png"));
  if (extensionOf(settings.image) != ".png") {
    throw UsageError("option -image: " + inQuotes(settings.image) + " does not end in .png",
                     "give a name that does");
  }
  checkName(settings, seenFrom(settings.output, settings.image));
  if (settings.format == TextureFormat::Obj) {
    settings.material = beside(".mtl");
    checkName(settings, seenFrom(settings.output, settings.material));
  }
}

Settings parseSettings(const CommandLine& command_line) {
  Settings settings;
  parseFiles(command_line, settings);
  const auto integer = [&command_line](const char* option, int fallback,
                                       const IntegerRange& range) {
    return command_line.has(option)
               ? static_cast<int>(parseInteger(option, command_line.value(option, ""), range))
               : fallback;
  };
  if (command_line.has("chart")) {
    settings.atlas.chart = parseName("chart", command_line.value("chart", ""), chart_names);
  }
  settings.bake.height = integer("size", settings.bake.height, {16, 16384});
  settings.bake.gutter = integer("gutter", settings.bake.gutter, {0, 256});
  if (command_line.has("checker")) {
    settings.cells = integer("checker", usual_cells, {1, 4096});
  }
  settings.report = parseOutputOptions(command_line);
  settings.product = parseProductOptions(command_line, product_defaults);
  if (command_line.has("ascii") && settings.format != TextureFormat::Ply) {
    throw UsageError("option -ascii does nothing with " + nameOf(settings.format, format_names),
                     "leave -ascii out, or write .ply");
  }
  // The faces of a cube keep room for the gutter, unless they were hardly to be seen then.
  constexpr double largest_margin = 0.2;
  const double face = settings.bake.height / 2.0;
  settings.atlas.margin = std::min(settings.bake.gutter / face, largest_margin);
  settings.bake.threads = settings.product.map.threads;
  return settings;
}

/// The files that will be written, the standard output not among them.
std::vector<std::string> outputsOf(const Settings& settings) {
  std::vector<std::string> outputs = {settings.output};
  for (const std::string& file : {settings.material, settings.image}) {
    if (!file.empty()) {
      outputs.push_back(file);
    }
  }
  addReport(settings.report, outputs);
  return outputs;
}

void printParameters(const Settings& settings, Console& console) {
  console.heading(tool_name + " " + SPHERICAL_PARAM_VERSION);
  console.entry("input", oneLine(settings.input));
  console.entry("output", oneLine(settings.output));
  if (!settings.image.empty()) {
    console.entry("image", oneLine(settings.image));
  }
  if (!settings.report.json.empty()) {
    console.entry("json", oneLine(settings.report.json));
  }
  console.entry("chart", nameOf(settings.atlas.chart, chart_names));
  console.entry("size", std::to_string(settings.bake.height));
  console.entry("gutter", std::to_string(settings.bake.gutter));
  if (settings.cells) {
    console.entry("checker", std::to_string(*settings.cells));
  }
  printProductOptions(settings.product, console);
}

Json optionsToJson(const Settings& settings) {
  Json json;
  json["chart"] = nameOf(settings.atlas.chart, chart_names);
  json["size"] = settings.bake.height;
  json["gutter"] = settings.bake.gutter;
  json["checker"] = settings.cells ? Json(*settings.cells) : Json(nullptr);
  json["image"] = settings.image.empty() ? Json(nullptr) : Json(settings.image);
  const Json product = productOptionsToJson(settings.product);
  for (const auto& [name, value] : product.items()) {
    json[name] = value;
  }
  addToJson(settings.report, json);
  return json;
}

/// What is written, with how it came about.
struct Output {
  TextureAtlas atlas;
  TextureImage image;
  bool is_checkerboard = false;
  std::vector<spherical_param::StageTime> stages;

  /// Share of the pixels that are in a triangle (1) or in the gutter (2).
  double share(std::uint8_t kind) const {
    return static_cast<double>(std::count(image.covered.begin(), image.covered.end(), kind)) /
           static_cast<double>(image.covered.size());
  }
};

void make(const Settings& settings, MappedCloud& mapped, Output& output, Console& console) {
  mapCloud(settings.input, settings.product, console, mapped);
  mapped.cloud.offset = offsetOf(settings.report, formatOf(settings.output), *mapped.cloud.data);
  output.stages = mapped.cloud.stages;
  console.begin("atlas");
  output.atlas =
      spherical_param::makeTextureAtlas(mapped.mesh.triangles, mapped.map.sphere, settings.atlas);
  output.stages.push_back({"atlas", console.end("")});

  console.begin("image");
  output.is_checkerboard = settings.cells || mapped.colors.empty();
  if (output.is_checkerboard) {
    output.image = spherical_param::bakeCheckerboard(
        output.atlas, mapped.map.sphere, settings.cells.value_or(usual_cells), settings.bake);
  } else {
    Eigen::Matrix<double, 3, Eigen::Dynamic> colors(3, mapped.mesh.points.cols());
    for (Eigen::Index v = 0; v < colors.cols(); ++v) {
      const Color& color = mapped.colors[static_cast<std::size_t>(v)];
      colors.col(v) << color[0], color[1], color[2];
    }
    output.image = spherical_param::bakeColors(output.atlas, colors, settings.bake);
  }
  output.atlas = spherical_param::joinCuts(std::move(output.atlas), mapped.mesh);
  output.stages.push_back({"image", console.end(std::to_string(output.image.width) + " x " +
                                                std::to_string(output.image.height) + " pixels")});
}

std::vector<spherical_param::Finding> findingsOf(const Settings& settings,
                                                 const MappedCloud& mapped) {
  std::vector<spherical_param::Finding> findings = findingsOf(mapped);
  if (mapped.colors.empty() && !settings.cells) {
    findings.push_back({"the cloud has no colours: the texture is a checkerboard", "", "", false});
  }
  return findings;
}

/// Those that arise where the chart cuts triangles.
std::size_t cutVertices(const MappedCloud& mapped, const Output& output) {
  return output.atlas.vertices.size() - mapped.cloud.surface().input_of_vertex.size();
}

Json report(const Settings& settings, const MappedCloud& mapped, const Output& output) {
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = settings.input;
  json["output"] = settings.output;
  json["offset"] = mapped.cloud.offset;
  json["options"] = optionsToJson(settings);
  addMapToJson(mapped, json);
  json["chart"] = nameOf(settings.atlas.chart, chart_names);
  json["texture"] = output.is_checkerboard ? "checkerboard" : "colors";
  json["image"] = {{"width", output.image.width},
                   {"height", output.image.height},
                   {"covered_share", output.share(1)},
                   {"gutter_share", output.share(2)}};
  json["cut_handles"] = mapped.cloud.surface().genus();
  json["cut_vertices"] = cutVertices(mapped, output);
  json["texture_coordinates"] = output.atlas.coordinates.cols();
  json["triangles"] = output.atlas.triangles.cols();
  json["stages"] = toJson(output.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
  json["findings"] = toJson(findingsOf(settings, mapped));
  return json;
}

void printVerdict(const Settings& settings, const MappedCloud& mapped, const Output& output,
                  Console& console) {
  printMap(mapped, console);
  console.entry("texture", std::string(output.is_checkerboard ? "checkerboard" : "colours") + ", " +
                               std::to_string(output.image.width) + " x " +
                               std::to_string(output.image.height) + " pixels, " +
                               formatted(100.0 * output.share(1), 4) + " % in triangles");
  console.entry("cut handles", std::to_string(mapped.cloud.surface().genus()));
  console.entry("cut vertices", std::to_string(cutVertices(mapped, output)));
  console.entry("coordinates", std::to_string(output.atlas.coordinates.cols()));
  console.entry("triangles", std::to_string(output.atlas.triangles.cols()));
  const CloudReconstruction& cloud = mapped.cloud;
  std::vector<std::string> files = outputsOf(settings);
  files.front() += notWritten(false, formatOf(settings.output), cloud.offset);
  console.summary(
      {settings.input + ", " + counted(cloud.data->points.size(), "point"), cloud.surface().verdict,
       counted(output.atlas.vertices.size(), "vertex", "vertices") + ", " +
           counted(static_cast<std::size_t>(output.atlas.triangles.cols()), "triangle") + ", " +
           std::to_string(output.image.width) + " x " + std::to_string(output.image.height) +
           " pixels",
       leftOut(cloud), files});
}

/// Stores all files but the report, none of them under its name yet.
std::vector<std::unique_ptr<OutputFile>> store(const Settings& settings, const MappedCloud& mapped,
                                               Output& output, Console& console) {
  console.begin("write");
  const Surface& surface = mapped.cloud.surface();
  const spherical_param::Positions points =
      vertexPositions(mapped.cloud, surface).colwise() -
      Eigen::Map<const Eigen::Vector3d>(mapped.cloud.offset.data());
  const PointData vertices = verticesOf(output.atlas, points, surface.triangles);
  MeshTexture texture;
  texture.png = encodePng(output.image);
  texture.repeats_u = output.atlas.chart == SphereChart::Equirectangular;
  console.update(0.5);
  std::vector<std::unique_ptr<OutputFile>> files;
  const auto open = [&files](const std::string& path) -> OutputFile& {
    files.push_back(std::make_unique<OutputFile>(path));
    return *files.back();
  };
  // What another mentions gets its name before that does.
  if (!settings.image.empty()) {
    open(settings.image).write(texture.png);
    texture.image_name = seenFrom(settings.output, settings.image);
  }
  if (settings.format == TextureFormat::Obj) {
    writeMaterial(open(settings.material), seenFrom(settings.material, settings.image));
    writeTexturedObj(open(settings.output), output.atlas, vertices,
                     seenFrom(settings.output, settings.material));
  } else {
    const TriangleMesh mesh = repeatedOnCuts(output.atlas, vertices);
    MeshView view(mesh);
    view.cover(texture);
    writeMesh(open(settings.output), view, formatOf(settings.output), settings.report.encoding, {});
  }
  for (const auto& file : files) {
    file->finish();
  }
  output.stages.push_back({"write", console.end("")});
  return files;
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText)) {
    return;
  }
  const Settings settings = parseSettings(command_line);
  checkOutputs({settings.input}, outputsOf(settings));

  Console console(settings.report.detail());
  printParameters(settings, console);
  MappedCloud mapped;
  Output output;
  runLibrary("cannot texture " + inQuotes(settings.input), kReportIt,
             [&] { make(settings, mapped, output, console); });
  std::vector<std::unique_ptr<OutputFile>> files = store(settings, mapped, output, console);
  publish(
      settings.report, files, console, [&] { return report(settings, mapped, output); },
      [&] { printVerdict(settings, mapped, output, console); });
  Findings findings(settings.report.quiet, settings.product.reconstruction.strict, false);
  findings.add("", findingsOf(settings, mapped));
  findings.print();
  findings.requireSoundness(mapped.cloud.surface().isUsable());
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
