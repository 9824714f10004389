// pcl_spherical_param_scan: writes generated scans, so that nothing needs to be downloaded.

#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/mesh_writer.h"
#include "common/numbers.h"
#include "common/output_options.h"
#include "common/point_data.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "scan_shapes.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;

const std::string tool_name = "pcl_spherical_param_scan";

/// About as many triangles as the largest scan of the paper gives.
constexpr std::size_t truth_triangles = 200000;

const std::vector<OptionInfo> option_table = {
    {"points", "N", "number of points, 4 and up (5000, or as the preset says)"},
    {"noise", "B", "noise along the normal, relative to the mean distance of neighbours (0)"},
    {"seed", "S", "seed of the random placement (1)"},
    {"normals", "", "write the normals of the surface, too"},
    {"truth", "FILE", "write a fine mesh of the surface"},
    {"list", "", "list the shapes and presets"},
};

/// What each does, and the words after the tool's name.
const std::vector<std::pair<std::string, std::string>> example_table = {
    {"A scan of a hand to try the other tools on", "hand scan.ply"},
    {"A noisy scan of another size, and its true surface",
     "bird other.ply -points 3000 -noise 0.2 -truth truth.ply"},
};

std::string helpText(bool with_experts) {
  return "Usage: " + tool_name +
         " SHAPE output [options]\n\n"
         "Writes points spread evenly over a generated surface.\n"
         "  SHAPE:  a shape or preset, see -list\n  output: " +
         extensionsFor(FileUse::WriteCloud) +
         "\n\nOptions (-name value, --name value or --name=value; defaults in brackets):\n" +
         describeOptions(option_table, with_experts) + "\n" +
         describeExamples(tool_name, example_table) +
         "\nExit code: 0 done, 1 failed, 2 wrong usage.\n";
}

std::string listText() {
  const auto line = [](std::string_view name, const std::string& text) {
    constexpr std::size_t name_width = 14;
    return "  " + std::string(name) + std::string(name_width - name.size(), ' ') + text + "\n";
  };
  std::string text = "Shapes:\n";
  for (const ShapeInfo& shape : allShapes()) {
    text += line(shape.name, std::string(shape.description));
  }
  text += "Presets:\n";
  for (const ScanPreset& preset : allPresets()) {
    text += line(preset.name, std::string(preset.description) + " (" +
                                  std::to_string(preset.points) + " points)");
  }
  return text;
}

/// What the user asked for.
struct Settings {
  std::string output;
  FileFormat output_format = nullptr;
  std::string truth;  ///< empty: not wanted
  FileFormat truth_format = nullptr;
  bool normals = false;
  ScanOptions scan;
};

/// Sets shape and number of points from a name. \throw UsageError for an unknown one.
void applyShape(const std::string& name, ScanOptions& scan) {
  const std::string lower = lowerCase(name);
  if (const std::optional<ShapeInfo> shape = findShape(lower)) {
    scan.shape = shape->shape;
  } else if (const std::optional<ScanPreset> preset = findPreset(lower)) {
    scan.shape = preset->shape;
    scan.points = preset->points;
  } else {
    throw UsageError("unknown shape " + inQuotes(name),
                     "run '" + tool_name + " -list' for the shapes");
  }
}

Settings parseSettings(const CommandLine& command_line) {
  std::vector<std::string> words = command_line.others();
  if (words.size() != 2) {
    throw UsageError(words.empty()       ? "the shape is missing"
                     : words.size() == 1 ? "the output file or the shape is missing"
                                         : "one word too many: " + inQuotes(words[2]),
                     "run '" + tool_name + " SHAPE output [options]', -h shows the options");
  }
  if (formatOf(words[0]) && !formatOf(words[1])) {
    std::swap(words[0], words[1]);
  }

  Settings settings;
  applyShape(words[0], settings.scan);
  settings.output = words[1];
  settings.output_format = requireFormat(settings.output, FileUse::WriteCloud);
  settings.truth = command_line.value("truth", "");
  if (command_line.has("truth")) {
    settings.truth_format = requireFormat(settings.truth, FileUse::WriteMesh);
  }
  settings.normals = command_line.has("normals");
  if (command_line.has("points")) {
    settings.scan.points = static_cast<std::size_t>(
        parseInteger("points", command_line.value("points", ""), {4, 100000000}));
  }
  if (command_line.has("noise")) {
    settings.scan.noise = parseReal("noise", command_line.value("noise", ""), {0.0, 1000.0, true});
  }
  if (command_line.has("seed")) {
    settings.scan.seed = parseUnsigned("seed", command_line.value("seed", ""));
  }
  return settings;
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText)) {
    return;
  }
  if (command_line.has("list")) {
    printAll(listText());
    return;
  }
  const Settings settings = parseSettings(command_line);
  std::vector<std::string> outputs = {settings.output};
  if (!settings.truth.empty()) {
    outputs.push_back(settings.truth);
  }
  checkOutputs({}, outputs);

  const Scan scan = generateScan(settings.scan);
  PointData cloud;
  cloud.points = toPoints(scan.points);
  if (settings.normals) {
    cloud.normals = toNormals(scan.normals);
  }
  std::vector<std::unique_ptr<OutputFile>> files;
  files.push_back(std::make_unique<OutputFile>(settings.output));
  writeMesh(*files.back(), MeshView(cloud, spherical_param::Triangles()), settings.output_format,
            Encoding::Binary);
  if (!settings.truth.empty()) {
    const TruthMesh truth = referenceMesh(settings.scan.shape, truth_triangles);
    PointData vertices;
    vertices.points = toPoints(truth.vertices);
    files.push_back(std::make_unique<OutputFile>(settings.truth));
    writeMesh(*files.back(), MeshView(vertices, truth.triangles), settings.truth_format,
              Encoding::Binary);
  }
  for (const auto& file : files) {
    file->finish();
  }
  printAll(std::to_string(cloud.points.size()) + " points written to " + oneLine(settings.output) +
           "\n");
  for (const auto& file : files) {
    file->commit();
  }
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
