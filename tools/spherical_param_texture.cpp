// pcl_spherical_param_texture: meshes a point cloud and gives the mesh a texture with its colours.

#include "common/errors.h"
#include "common/file_formats.h"
#include "common/png_image.h"
#include "common/product_input.h"
#include "common/reconstruction_report.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "common/textured_mesh.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/version.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace spherical_param;
using namespace spherical_param::tools;

const Names<SphereChart> chart_names = {
    {"equirectangular", SphereChart::Equirectangular},
    {"octahedral", SphereChart::Octahedral},
    {"cube", SphereChart::CubeMap},
};

/// Squares along a quarter of a great circle if a cloud has no colours.
constexpr int usual_cells = 8;

ToolText toolText() {
  return {"pcl_spherical_param_texture",
          "input output",
          "Meshes the points of an object without holes through it, and paints their colours\n"
          "into a texture.\n"
          "  input:  " +
              extensionsFor(FileUse::ReadCloud) +
              "\n  output: .glb, with the image in it; .obj, with .mtl and .png beside it; .ply, "
              "with .png\n",
          {{"A file with the colours of the scan in a texture", "scan.ply textured.glb"},
           {"A checkerboard, which shows the map", "scan.ply checker.glb -checker 16"}}};
}

/// What the user asked for.
struct Settings {
  std::string input;
  std::string output;
  std::string material;  ///< empty: not wanted
  std::string image;     ///< empty: it is in the output
  TextureAtlasOptions atlas;
  BakeOptions bake;
  std::optional<int> cells;  ///< none: the colours of the points, if there are any
  ProductSettings product{TopologyMode::Scan};
  OutputSettings report;

  std::string extension() const { return extensionOf(output); }
};

OptionTable optionsOf(Settings& settings) {
  return joined(
      {{choiceOption("chart", "of the sphere in the image", settings.atlas.chart, chart_names),
        numberOption("size", "height of the image in pixels", settings.bake.height, 16, 16384),
        numberOption("gutter", "painted pixels around the triangles", settings.bake.gutter, 0, 256),
        numberOption("checker",
                     "checkerboard of that many squares a quarter circle; unset: colours",
                     settings.cells, 1, 4096),
        fileOption("image", "image beside .obj and .ply, .png (as the output)", settings.image)},
       productOptions(settings.product),
       outputOptions(settings.report)});
}

/// The name by which a file is found from the place of another.
std::string seenFrom(const std::string& place, const std::string& file) {
  namespace fs = std::filesystem;
  const fs::path directory = fs::absolute(place).parent_path();
  return fs::absolute(file)
      .lexically_normal()
      .lexically_relative(directory.lexically_normal())
      .generic_string();
}

/// Refuses a name that would be misread where the output mentions it.
void checkName(const Settings& settings, const std::string& name) {
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  const bool is_obj = settings.extension() == ".obj";
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
  const std::vector<std::string> files = filesOf(command_line, toolText());
  settings.input = files[0];
  settings.output = files[1];
  requireFormat(settings.input, FileUse::ReadCloud);
  if (settings.extension() == ".glb") {
    command_line.refuse({"image"}, ".glb, which contains the image", "an output .obj or .ply");
    command_line.refuse({"ascii"}, ".glb", "an output .ply");
    return;
  }
  if (settings.extension() != ".obj" && settings.extension() != ".ply") {
    throw UsageError(inQuotes(settings.output) + " has an extension without textures",
                     "use one of .glb .obj .ply");
  }
  const auto beside = [&settings](const char* other) {
    return std::filesystem::path(settings.output).replace_extension(other).string();
  };
  if (settings.image.empty()) {
    settings.image = beside(".png");
  } else {
    requirePngName(settings.image);
  }
  checkName(settings, seenFrom(settings.output, settings.image));
  if (settings.extension() == ".obj") {
    command_line.refuse({"ascii"}, ".obj", "an output .ply");
    settings.material = beside(".mtl");
    checkName(settings, seenFrom(settings.output, settings.material));
  }
}

void parse(const CommandLine& command_line, Settings& settings) {
  parseFiles(command_line, settings);
  parseProductOptions(command_line, settings.product);
  // The faces of a cube keep room for the gutter, but not more than this fraction of a side.
  constexpr double largest_margin = 0.2;
  const double face = settings.bake.height / 2.0;
  settings.atlas.margin = std::min(settings.bake.gutter / face, largest_margin);
  settings.bake.threads = settings.product.map.threads;
}

/// The files that will be written, the standard output not among them.
std::vector<std::string> outputsOf(const Settings& settings) {
  return outputsOf(settings.report, {settings.output, settings.material, settings.image});
}

/// What is written, with how it came about.
struct Output {
  TextureAtlas atlas;
  TextureImage image;
  bool is_checkerboard = false;
  std::vector<StageTime> stages;

  std::string pixels() const {
    return std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels";
  }
  /// Fraction of the pixels that are in a triangle (1) or in the gutter (2).
  double fraction(std::uint8_t kind) const {
    return static_cast<double>(std::count(image.covered.begin(), image.covered.end(), kind)) /
           static_cast<double>(image.covered.size());
  }
};

void make(const Settings& settings, MappedCloud& mapped, Output& output, Console& console) {
  mapCloud(settings.input, settings.product, console, mapped);
  mapped.cloud.offset = settings.report.offsetOf(settings.output, *mapped.cloud.data);
  output.stages = mapped.cloud.stages;
  console.begin("atlas");
  output.atlas = makeTextureAtlas(mapped.triangles(), mapped.map.sphere, settings.atlas);
  output.stages.push_back(console.end());

  console.begin("image");
  output.is_checkerboard = settings.cells || mapped.colors.empty();
  if (output.is_checkerboard) {
    output.image = bakeCheckerboard(output.atlas, mapped.map.sphere,
                                    settings.cells.value_or(usual_cells), settings.bake);
  } else {
    Eigen::Matrix<double, 3, Eigen::Dynamic> colors(3, mapped.points().cols());
    for (Eigen::Index v = 0; v < colors.cols(); ++v) {
      const Color& color = mapped.colors[static_cast<std::size_t>(v)];
      colors.col(v) << color[0], color[1], color[2];
    }
    output.image = bakeColors(output.atlas, colors, settings.bake);
  }
  output.stages.push_back(console.end(output.pixels()));
}

std::vector<Finding> findingsOf(const Settings& settings, const MappedCloud& mapped) {
  std::vector<Finding> findings = mapped.cloud.result.findings;
  if (mapped.colors.empty() && !settings.cells) {
    findings.push_back({"the cloud has no colours: the texture is a checkerboard", "", "", false});
  }
  return findings;
}

/// Number of vertices that arise where the chart cuts triangles.
std::size_t cutVertices(const MappedCloud& mapped, const Output& output) {
  return output.atlas.vertices.size() - mapped.cloud.surface().input_of_vertex.size();
}

Json report(Settings settings, const MappedCloud& mapped, const Output& output) {
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = settings.input;
  json["output"] = settings.output;
  json["offset"] = mapped.cloud.offset;
  json["options"] = optionsToJson(optionsOf(settings));
  addMapToJson(mapped, json);
  json["chart"] = nameOf(settings.atlas.chart, chart_names);
  json["texture"] = output.is_checkerboard ? "checkerboard" : "colors";
  json["image"] = {{"width", output.image.width},
                   {"height", output.image.height},
                   {"covered_fraction", output.fraction(1)},
                   {"gutter_fraction", output.fraction(2)}};
  json["cut_vertices"] = cutVertices(mapped, output);
  json["texture_coordinates"] = output.atlas.coordinates.cols();
  json["triangles"] = output.atlas.triangles.cols();
  json["stages"] = toJson(output.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
  json["findings"] = toJson(findingsOf(settings, mapped));
  return json;
}

Summary summaryOf(const Settings& settings, const MappedCloud& mapped, const Output& output) {
  Summary summary = summaryOf(settings.input, mapped.cloud);
  summary.made = meshSize(output.atlas.vertices.size(), output.atlas.triangles.cols()) + ", " +
                 output.pixels();
  summary.written = outputsOf(settings);
  summary.written.front() += notWritten(false, settings.output, mapped.cloud.offset);
  return summary;
}

/// Stores all files but the report, none of them under its name yet.
void store(const Settings& settings, const MappedCloud& mapped, Output& output, ToolRun& run) {
  run.console.begin("write");
  const auto& surface = mapped.cloud.surface();
  const Positions points =
      surface.points.colwise() - Eigen::Map<const Eigen::Vector3d>(mapped.cloud.offset.data());
  const PointData vertices = verticesOf(output.atlas, points, surface.triangles);
  MeshTexture texture;
  texture.png = encodePng(output.image);
  texture.repeats_u = output.atlas.chart == SphereChart::Equirectangular;
  run.console.update(0.5);
  // A file that another one mentions gets its name first.
  if (!settings.image.empty()) {
    run.open(settings.image).write(texture.png);
    texture.image_name = seenFrom(settings.output, settings.image);
  }
  if (!settings.material.empty()) {
    writeMaterial(run.open(settings.material), seenFrom(settings.material, settings.image));
    writeTexturedObj(run.open(settings.output), output.atlas, vertices,
                     seenFrom(settings.output, settings.material));
  } else {
    const TriangleMesh mesh = repeatedOnCuts(output.atlas, vertices);
    MeshView view(mesh);
    view.cover(texture);
    run.write(settings.output, view);
  }
  output.stages.push_back(run.console.end());
}

void run(const CommandLine& command_line, Settings& settings) {
  parse(command_line, settings);
  checkOutputs({settings.input}, outputsOf(settings));
  ToolRun run(settings.report, settings.product.reconstruction.strict, toolText().name,
              {{"input", settings.input}, {"output", settings.output}}, optionsOf(settings));
  MappedCloud mapped;
  Output output;
  runLibrary("cannot texture " + inQuotes(settings.input), kReportIt,
             [&] { make(settings, mapped, output, run.console); });
  store(settings, mapped, output, run);
  Json json = report(settings, mapped, output);
  printFigures(json, run.console);
  run.publish([&] { return json; }, summaryOf(settings, mapped, output));
  run.add("", findingsOf(settings, mapped));
  run.conclude(mapped.cloud.surface().isUsable());
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  return runTool(toolText(), argc, argv, optionsOf(settings),
                 [&](const CommandLine& command_line) { run(command_line, settings); });
}
