// pcl_spherical_param_scan: writes generated scans, so that nothing needs to be downloaded.

#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/mesh_writer.h"
#include "common/point_data.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "scan_shapes.h"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;

ToolText toolText() {
  return {"pcl_spherical_param_scan",
          "SHAPE output",
          "Writes points that are spread evenly over a generated surface, or a depth image.\n"
          "  SHAPE:  a shape or scene, see -list\n  output: " +
              extensionsFor(FileUse::WriteCloud) + "\n",
          {{"A scan of a hand to try the other tools on", "hand scan.ply"},
           {"A noisy one of another size, and the surface that it comes from",
            "bird other.ply -points 3000 -noise 0.2 -truth truth.ply"},
           {"What a depth camera sees of a desk", "desk depth.ply"}},
          "0 done, 1 failed, 2 wrong usage."};
}

/// Options besides the shape.
struct Settings {
  ScanOptions scan;
  std::string truth;
  bool normals = false;
  bool list = false;
};

OptionTable optionsOf(Settings& settings) {
  return {numberOption("points", "number of points; of a depth image 76800 by default",
                       settings.scan.points, 4, kMaxScanPoints),
          numberOption("noise",
                       "noise along the normal or the ray, relative to the distance of neighbours",
                       settings.scan.noise, 0, 100),
          numberOption("seed", "seed of the random placement", settings.scan.seed, 0, 1e15),
          flagOption("normals", "write the normals of the surface, too", settings.normals),
          fileOption("truth", "write a fine mesh of the surface", settings.truth),
          flagOption("list", "list the shapes", settings.list)};
}

/// Of the depth image, unless the command line says it: 320 x 240.
constexpr std::size_t kDepthPoints = 76800;

std::string listText() {
  const auto line = [](const std::string& name, const std::string& text) {
    return "  " + name + std::string(14 - name.size(), ' ') + text + "\n";
  };
  std::string text = "Shapes:\n";
  for (const Shape& shape : allShapes())
    text += line(shape.name, shape.description);
  return text + "Scene:\n" + line(deskScene().name, deskScene().description);
}

/// Shape and output, in either order.
std::pair<std::string, std::string> shapeAndOutput(const std::vector<std::string>& words) {
  if (words.size() != 2)
    throw UsageError(words.empty()       ? "the shape is missing"
                     : words.size() == 1 ? "the shape or the output file is missing"
                                         : "one word too many: " + inQuotes(words[2]),
                     "run '" + toolText().name + " SHAPE output [options]', -h shows the options");
  const bool output_first = formatOf(words[0]) && !formatOf(words[1]);
  return {words[output_first ? 1 : 0], words[output_first ? 0 : 1]};
}

void parse(const std::string& name, const CommandLine& command_line, Settings& settings) {
  ScanOptions& scan = settings.scan;
  scan.shape = lowerCase(name);
  if (scan.shape == deskScene().name)
    scan.points = kDepthPoints;
  else if (std::none_of(allShapes().begin(), allShapes().end(),
                        [&](const Shape& shape) { return shape.name == scan.shape; }))
    throw UsageError("unknown shape " + inQuotes(name),
                     "run '" + toolText().name + " -list' for the shapes");
  command_line.apply(optionsOf(settings));
  if (scan.shape == deskScene().name && !settings.truth.empty())
    throw UsageError("there is no true mesh of a scene", "leave -truth out");
}

void run(const CommandLine& command_line, Settings& settings) {
  if (command_line.has("list"))
    return printAll(listText());
  const auto [shape, output] = shapeAndOutput(command_line.others());
  parse(shape, command_line, settings);
  std::vector<std::string> outputs = {output};
  std::vector<FileFormat> formats = {requireFormat(output, FileUse::WriteCloud)};
  if (!settings.truth.empty()) {
    outputs.push_back(settings.truth);
    formats.push_back(requireFormat(settings.truth, FileUse::WriteMesh));
  }
  checkOutputs({}, outputs);

  std::deque<OutputFile> files;
  const auto write = [&](const PointData& data, const spherical_param::Triangles& triangles) {
    const FileFormat format = formats[files.size()];
    OutputFile& file = files.emplace_back(outputs[files.size()]);
    writeMesh(file, MeshView(data, triangles), format, Encoding::Binary);
    file.finish();
  };
  const Scan scan = generateScan(settings.scan);
  PointData cloud;
  cloud.points = toPoints(scan.points);
  if (settings.normals)
    cloud.normals = toNormals(scan.normals);
  write(cloud, {});
  if (!settings.truth.empty()) {
    const TruthMesh truth = referenceMesh(settings.scan.shape);
    PointData vertices;
    vertices.points = toPoints(truth.vertices);
    write(vertices, truth.triangles);
  }
  printAll(std::to_string(settings.scan.points) + " points written to " + oneLine(output) + "\n");
  for (OutputFile& file : files)
    file.commit();
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  return runTool(toolText(), argc, argv, optionsOf(settings),
                 [&](const CommandLine& command_line) { run(command_line, settings); });
}
