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
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;

const std::string tool_name = "pcl_spherical_param_scan";

const std::vector<OptionInfo> option_table = {
    {"points", "N",
     "number of points, 4 to " + std::to_string(kMaxScanPoints) + " (5000, or as the preset says)"},
    {"noise", "B", "noise along the normal, relative to the mean distance of neighbours (0)"},
    {"seed", "S", "seed of the random placement (1)"},
    {"normals", "", "write the normals of the surface, too"},
    {"truth", "FILE", "write a fine mesh of the surface"},
    {"list", "", "list the shapes and presets"},
};

/// What each does, and the words after the tool's name.
const std::vector<std::pair<std::string, std::string>> example_table = {
    {"A scan of a hand to try the other tools on", "hand scan.ply"},
    {"A noisy one of another size, and the surface that it comes from",
     "bird other.ply -points 3000 -noise 0.2 -truth truth.ply"},
};

std::string helpText(bool with_experts) {
  return "Usage: " + tool_name +
         " SHAPE output [options]\n\n"
         "Writes points that are spread evenly over a generated surface.\n"
         "  SHAPE:  a shape or preset, see -list\n  output: " +
         extensionsFor(FileUse::WriteCloud) +
         "\n\nOptions (-name value, --name value or --name=value; defaults in brackets):\n" +
         describeOptions(option_table, with_experts) + "\n" +
         describeExamples(tool_name, example_table) +
         "\nExit code: 0 done, 1 failed, 2 wrong usage.\n";
}

struct Preset {
  std::string name;   ///< of the paper's scan, lower case
  std::string shape;  ///< stands for it
  std::size_t points = 0;
};

/// Table 1 of the paper.
const std::vector<Preset> presets = {
    {"tweety", "bird", 19818}, {"max", "head", 52809}, {"igea", "head", 134345}};

std::string listText() {
  const auto line = [](const std::string& name, const std::string& text) {
    return "  " + name + std::string(14 - name.size(), ' ') + text + "\n";
  };
  std::string text = "Shapes:\n";
  for (const Shape& shape : allShapes())
    text += line(shape.name, shape.description);
  text += "Presets:\n";
  for (const Preset& preset : presets)
    text += line(preset.name, "the shape " + preset.shape + " in place of the paper's scan (" +
                                  std::to_string(preset.points) + " points)");
  return text;
}

/// Shape and output, in either order.
std::pair<std::string, std::string> shapeAndOutput(const std::vector<std::string>& words) {
  if (words.size() != 2)
    throw UsageError(words.empty()       ? "the shape is missing"
                     : words.size() == 1 ? "the shape or the output file is missing"
                                         : "one word too many: " + inQuotes(words[2]),
                     "run '" + tool_name + " SHAPE output [options]', -h shows the options");
  const bool output_first = formatOf(words[0]) && !formatOf(words[1]);
  return {words[output_first ? 1 : 0], words[output_first ? 0 : 1]};
}

ScanOptions parseScanOptions(const std::string& name, const CommandLine& command_line) {
  ScanOptions scan;
  scan.shape = lowerCase(name);
  for (const Preset& preset : presets)
    if (preset.name == scan.shape) {
      scan.shape = preset.shape;
      scan.points = preset.points;
      break;
    }
  if (std::none_of(allShapes().begin(), allShapes().end(),
                   [&](const Shape& shape) { return shape.name == scan.shape; }))
    throw UsageError("unknown shape " + inQuotes(name),
                     "run '" + tool_name + " -list' for the shapes");
  const std::string points = command_line.value("points", std::to_string(scan.points));
  scan.points = static_cast<std::size_t>(parseInteger("points", points, {4, kMaxScanPoints}));
  scan.noise = parseReal("noise", command_line.value("noise", "0"), {0.0, 100.0, true});
  scan.seed = parseUnsigned("seed", command_line.value("seed", "1"));
  return scan;
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText))
    return;
  if (command_line.has("list"))
    return printAll(listText());
  const auto [shape, output] = shapeAndOutput(command_line.others());
  const ScanOptions options = parseScanOptions(shape, command_line);
  std::vector<std::string> outputs = {output};
  std::vector<FileFormat> formats = {requireFormat(output, FileUse::WriteCloud)};
  if (command_line.has("truth")) {
    outputs.push_back(command_line.value("truth", ""));
    formats.push_back(requireFormat(outputs[1], FileUse::WriteMesh));
  }
  checkOutputs({}, outputs);

  std::vector<std::unique_ptr<OutputFile>> files;
  const auto write = [&](const PointData& data, const spherical_param::Triangles& triangles) {
    const FileFormat format = formats[files.size()];
    files.push_back(std::make_unique<OutputFile>(outputs[files.size()]));
    writeMesh(*files.back(), MeshView(data, triangles), format, Encoding::Binary);
    files.back()->finish();
  };
  const Scan scan = generateScan(options);
  PointData cloud;
  cloud.points = toPoints(scan.points);
  if (command_line.has("normals"))
    cloud.normals = toNormals(scan.normals);
  write(cloud, {});
  if (command_line.has("truth")) {
    const TruthMesh truth = referenceMesh(options.shape);
    PointData vertices;
    vertices.points = toPoints(truth.vertices);
    write(vertices, truth.triangles);
  }
  printAll(std::to_string(options.points) + " points written to " + oneLine(output) + "\n");
  for (const auto& file : files)
    file->commit();
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
