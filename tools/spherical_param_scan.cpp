// pcl_spherical_param_scan: writes generated scans, so that nothing needs to be downloaded.

#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/mesh_writer.h"
#include "common/point_data.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "scan_scenes.h"
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
          "Writes points that are spread evenly over a generated surface, or what a sensor sees\n"
          "of a scene.\n"
          "  SHAPE:  a shape or scene, see -list\n  output: " +
              extensionsFor(FileUse::WriteCloud) + "\n",
          {{"A scan of a hand to try the other tools on", "hand scan.ply"},
           {"A noisy one of another size, and the surface that it comes from",
            "bird other.ply -points 3000 -noise 0.2 -truth truth.ply"},
           {"What a depth camera sees of a desk, as an organized cloud", "desk depth.pcd"},
           {"What eight depth cameras around an animal see", "animal turn.ply -views 8 -noise 1"}},
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
  return {
      numberOption("points", "number of points; of a scene, about: see -list for the default",
                   settings.scan.points, 4, kMaxScanPoints),
      numberOption("noise",
                   "noise along the normal, relative to the distance of neighbours; of a scene, "
                   "relative to that of its sensor (1 by default)",
                   settings.scan.noise, 0, 100),
      numberOption("seed", "seed of the random placement and noise", settings.scan.seed, 0, 1e15),
      numberOption(
          "views",
          "what this number of depth cameras around the shape see, merged; the noise, "
          "relative to the distance of neighbouring rays, is along them, and half as much is "
          "the error of registration",
          settings.scan.views, 0, 100),
      numberOption("slices", "contours in this number of planes, as of a tomograph",
                   settings.scan.slices, 0, 1000),
      flagOption("normals", "write the normals of the surface, too", settings.normals),
      fileOption("truth", "write a fine mesh of the surface; of a scene, of what is seen",
                 settings.truth),
      flagOption("list", "list the shapes and scenes", settings.list)};
}

std::string listText() {
  const auto line = [](const std::string& name, const std::string& text) {
    return "  " + name + std::string(14 - name.size(), ' ') + text + "\n";
  };
  std::string text = "Shapes:\n";
  for (const Shape& shape : allShapes())
    text += line(shape.name, shape.description);
  text += "Scenes:\n";
  for (const Scene& scene : allScenes())
    text += line(scene.name, scene.description + ", " + std::to_string(scene.points) + " points");
  return text;
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

/// \return the scene; null: it is a shape.
const Scene* parse(const std::string& name, const CommandLine& command_line, Settings& settings) {
  ScanOptions& scan = settings.scan;
  scan.shape = lowerCase(name);
  const auto is_it = [&](const auto& one) { return one.name == scan.shape; };
  const auto found = std::find_if(allScenes().begin(), allScenes().end(), is_it);
  const Scene* const scene = found != allScenes().end() ? &*found : nullptr;
  if (scene != nullptr) {
    scan.points = scene->points;
    scan.noise = 1.0;
  } else if (std::none_of(allShapes().begin(), allShapes().end(), is_it)) {
    throw UsageError("unknown shape " + inQuotes(name),
                     "run '" + toolText().name + " -list' for the shapes");
  }
  command_line.apply(optionsOf(settings));
  if (scene != nullptr && (scan.views > 0 || scan.slices > 0))
    throw UsageError(inQuotes(scan.shape) + " is a scene, which one sensor sees",
                     "leave -views and -slices out, or take a shape");
  if (scan.views > 0 && findShape(scan.shape).opening)
    throw UsageError(inQuotes(scan.shape) + " has openings, which -views does not cut",
                     "leave -views out, or take a closed shape");
  if (scan.slices > 0)
    for (const char* const other : {"views", "noise", "points", "seed"})
      if (command_line.has(other))
        throw UsageError(std::string("-") + other + " has no effect on slices", "leave it out");
  return scene;
}

/// A cloud to write: as an image where the format has one, else what is seen alone.
PointData cloudOf(const Scan& scan, bool has_normals, const std::string& path) {
  PointData cloud;
  cloud.points = toPoints(scan.points);
  if (has_normals)
    cloud.normals = toNormals(scan.normals);
  if (extensionOf(path) == ".pcd") {
    cloud.rows = scan.rows;
    return cloud;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.position(i).allFinite()) {
      cloud.points[kept] = cloud.points[i];
      if (has_normals)
        cloud.normals[kept] = cloud.normals[i];
      ++kept;
    }
  cloud.points.resize(kept);
  cloud.normals.resize(has_normals ? kept : 0);
  return cloud;
}

void run(const CommandLine& command_line, Settings& settings) {
  if (command_line.has("list"))
    return printAll(listText());
  const auto [shape, output] = shapeAndOutput(command_line.others());
  const Scene* const scene = parse(shape, command_line, settings);
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
  const ScanOptions& options = settings.scan;
  const bool has_truth = !settings.truth.empty();
  TruthMesh truth;
  const Scan scan = scene != nullptr     ? scene->scan(options, has_truth ? &truth : nullptr)
                    : options.views > 0  ? scanFromViews(options)
                    : options.slices > 0 ? sliceShape(options)
                                         : generateScan(options);
  const PointData cloud = cloudOf(scan, settings.normals, output);
  write(cloud, {});
  if (has_truth) {
    if (scene == nullptr)
      truth = referenceMesh(options.shape);
    PointData vertices;
    vertices.points = toPoints(truth.vertices);
    write(vertices, truth.triangles);
  }
  printAll(std::to_string(cloud.points.size()) + " points written to " + oneLine(output) + "\n");
  for (OutputFile& file : files)
    file.commit();
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  return runTool(toolText(), argc, argv, optionsOf(settings),
                 [&](const CommandLine& command_line) { run(command_line, settings); });
}
