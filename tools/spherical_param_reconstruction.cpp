// pcl_spherical_param_reconstruction: meshes the point cloud of a file.

#include "common/cloud_reconstruction.h"
#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/findings.h"
#include "common/html_report.h"
#include "common/json_report.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"
#include "common/output_options.h"
#include "common/reconstruction_options.h"
#include "common/reconstruction_report.h"
#include "common/report_page.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using spherical_param::PartsMode;
using spherical_param::Surface;

const std::string tool_name = "pcl_spherical_param_reconstruction";

const std::vector<OptionInfo> option_table =
    joined({reconstructionOptions(),
            {{"sphere", "FILE", "write the points on the sphere with the same triangles"}},
            htmlReportOptions(),
            outputOptions()});

/// What each does, and the words after the tool's name.
const std::vector<std::pair<std::string, std::string>> example_table = {
    {"The surfaces of a scan", "scan.ply mesh.ply"},
    {"With its map to the sphere and a page to look at",
     "scan.ply mesh.ply -sphere sphere.ply -report report.html"},
    {"A mesh of a noisy scan", "scan.ply mesh.ply -consolidation auto"},
    {"One closed surface through every point", "scan.ply mesh.ply -topology sphere"},
};

std::string helpText(bool with_experts) {
  return "Usage: " + tool_name +
         " input output [options]\n\n"
         "Meshes a point cloud into surfaces with the parts, openings and handles that it shows,\n"
         "or into one closed surface through every point.\n"
         "  input:  " +
         extensionsFor(FileUse::ReadCloud) + "\n  output: " + extensionsFor(FileUse::WriteMesh) +
         "\n\nOptions (-name value, --name value or --name=value; defaults in brackets):\n" +
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
  FileFormat output_format = nullptr;
  std::string sphere;  ///< empty: not wanted
  FileFormat sphere_format = nullptr;
  std::string page;     ///< empty: not wanted
  std::string command;  ///< that does the same again
  OutputSettings report;
  ReconstructionSettings reconstruction;
};

/// In names of files, the number of the part.
const std::string number_mark = "%03d";

bool isNumbered(const std::string& name) {
  return name.find(number_mark) != std::string::npos;
}

/// The name of a file of a part; one without a mark is that of all parts.
std::string numbered(const std::string& name, std::size_t part) {
  const std::size_t mark = name.find(number_mark);
  if (mark == std::string::npos) {
    return name;
  }
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), "%03zu", part);
  return name.substr(0, mark) + number.data() + name.substr(mark + number_mark.size());
}

bool mayMakeParts(const Settings& settings) {
  return withTopology(settings.reconstruction.options).parts == PartsMode::Each;
}

/// The settings of a part, with the names of its files.
Settings settingsOf(Settings settings, std::size_t part) {
  for (std::string* name : {&settings.output, &settings.sphere, &settings.page}) {
    *name = numbered(*name, part);
  }
  return settings;
}

/// \throw UsageError for names without the numbers that they need, or with some that they do not.
void checkNumbers(const Settings& settings) {
  if (isNumbered(settings.output) && !mayMakeParts(settings)) {
    throw UsageError(inQuotes(settings.output) +
                         " is a pattern for several parts, but the output is one mesh",
                     "give -parts each, or a name without " + number_mark);
  }
  for (const std::string& name : {settings.sphere, settings.page}) {
    if (isNumbered(name) && !isNumbered(settings.output)) {
      throw UsageError(inQuotes(name) + " is a pattern, but the output is one file",
                       "use " + number_mark + " in both names, or in none");
    }
  }
}

Settings parseSettings(const CommandLine& command_line) {
  Settings settings;
  std::tie(settings.input, settings.output) = inputAndOutput(command_line, tool_name);
  requireFormat(settings.input, FileUse::ReadCloud);
  settings.output_format = requireFormat(settings.output, FileUse::WriteMesh);
  settings.sphere = command_line.value("sphere", "");
  if (command_line.has("sphere")) {
    settings.sphere_format = requireFormat(settings.sphere, FileUse::WriteMesh);
  }
  settings.report = parseOutputOptions(command_line);
  settings.reconstruction = parseReconstructionOptions(command_line);
  settings.page = parseHtmlReport(command_line);
  checkNumbers(settings);
  if (!settings.page.empty()) {
    keepForHtmlReport(settings.reconstruction);
    settings.command = repeatedCommand(tool_name, command_line, option_table,
                                       {settings.input, settings.output}, settings.reconstruction);
  }
  return settings;
}

/// The files that will be written, the standard output not among them.
std::vector<std::string> outputsOf(const Settings& settings) {
  std::vector<std::string> outputs = {settings.output};
  if (!settings.sphere.empty()) {
    outputs.push_back(settings.sphere);
  }
  if (!settings.page.empty()) {
    outputs.push_back(settings.page);
  }
  addReport(settings.report, outputs);
  return outputs;
}

void printParameters(const Settings& settings, Console& console) {
  console.heading(tool_name + " " + SPHERICAL_PARAM_VERSION);
  console.entry("input", oneLine(settings.input));
  console.entry("output", oneLine(settings.output));
  if (!settings.sphere.empty()) {
    console.entry("sphere", oneLine(settings.sphere));
  }
  if (!settings.page.empty()) {
    console.entry("report", oneLine(settings.page));
  }
  if (!settings.report.json.empty()) {
    console.entry("json", oneLine(settings.report.json));
  }
  printReconstructionOptions(settings.reconstruction, console);
}

Json optionsToJson(const Settings& settings) {
  Json json = reconstructionOptionsToJson(settings.reconstruction);
  json["sphere"] = settings.sphere.empty() ? Json(nullptr) : Json(settings.sphere);
  json["report"] = settings.page.empty() ? Json(nullptr) : Json(settings.page);
  addToJson(settings.report, json);
  return json;
}

/// The first members of a report.
Json filesToJson(const Settings& settings) {
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = settings.input;
  json["output"] = settings.output;
  json["options"] = optionsToJson(settings);
  return json;
}

/// The members that are the same for the whole cloud and for each of its parts.
Json cloudReport(const Settings& settings, const CloudReconstruction& cloud) {
  Json json = filesToJson(settings);
  json["offset"] = cloud.offset;
  json["points"] = cloud.data->points.size();
  json["left_out"] = toJson(cloud.result.left_out);
  json["stages"] = toJson(cloud.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
  return json;
}

/// The report on one surface.
Json report(const Settings& settings, const CloudReconstruction& cloud, const Surface& surface) {
  Json json = cloudReport(settings, cloud);
  json.update(toJson(surface));
  json["failures"] = cloud.result.failures;
  return json;
}

/// The report on all parts, each with what is said of one surface.
Json reportOnParts(const Settings& settings, const CloudReconstruction& cloud) {
  Json json = cloudReport(settings, cloud);
  json["verdict"] = cloud.result.verdict;
  json["usable"] = cloud.result.isUsable();
  json["findings"] = toJson(cloud.result.findings);
  json["failures"] = cloud.result.failures;
  json["parts"] = Json::array();
  for (const Surface& surface : cloud.result.surfaces) {
    Json part;
    part["points"] = surface.inputs.size();
    part["output"] = numbered(settings.output, json["parts"].size());
    part.update(toJson(surface));
    json["parts"].push_back(std::move(part));
  }
  return json;
}

/// The names of the files that are written, and what is not in them.
std::vector<std::string> writtenFiles(const Settings& settings, const CloudReconstruction& cloud) {
  const std::size_t surfaces = cloud.result.surfaces.size();
  std::vector<std::string> files;
  for (const std::string& name : outputsOf(settings)) {
    const bool is_view = name != settings.output && name != settings.report.json;
    files.push_back(isNumbered(name) && surfaces > 1
                        ? numbered(name, 0) + " to " + numbered(name, surfaces - 1)
                        : numbered(name, 0) + (is_view && surfaces > 1 ? " (the largest)" : ""));
  }
  files.front() += notWritten(!cloud.data->colors.empty(), settings.output_format, cloud.offset);
  return files;
}

/// How far consolidation moved points; empty without.
std::string movedBy(const Settings& settings, const std::vector<Surface>& surfaces) {
  if (settings.reconstruction.options.consolidation == spherical_param::ConsolidationMode::None) {
    return {};
  }
  double points = 0.0;
  double noise = 0.0;
  double mean = 0.0;
  double most = 0.0;
  for (const Surface& surface : surfaces) {
    const auto count = static_cast<double>(surface.inputs.size());
    const spherical_param::ConsolidationReport& moved = surface.consolidation;
    points += count;
    noise += count * moved.noise;
    mean += count * moved.mean_displacement;
    most = std::max(most, moved.max_displacement);
  }
  return "by " + formatted(mean / points, 3) + " on average, at most " + formatted(most, 3) +
         "; the noise is " + formatted(noise / points, 3);
}

/// Prints what was made of each surface, then the six lines of a run.
void printSummary(const Settings& settings, const CloudReconstruction& cloud, Console& console) {
  const std::vector<Surface>& surfaces = cloud.result.surfaces;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const Surface& surface : surfaces) {
    if (surfaces.size() > 1) {
      console.heading("\nsurface of " + counted(surface.inputs.size(), "point"));
    }
    printTables(surface, console);
    vertices += surface.vertexCount();
    triangles += static_cast<std::size_t>(surface.triangles.cols());
  }
  console.summary({settings.input + ", " + counted(cloud.data->points.size(), "point"),
                   cloud.result.verdict,
                   counted(vertices, "vertex", "vertices") + ", " + counted(triangles, "triangle"),
                   leftOut(cloud), writtenFiles(settings, cloud), movedBy(settings, surfaces)});
}

using Files = std::vector<std::unique_ptr<OutputFile>>;

void writeMeshFile(const Settings& settings, MeshView mesh, CloudReconstruction& cloud,
                   Console& console, Files& files) {
  mesh.shiftBy(cloud.offset);
  console.begin("write");
  files.push_back(std::make_unique<OutputFile>(settings.output));
  writeMesh(*files.back(), mesh, settings.output_format, settings.report.encoding,
            [&](double fraction) { console.update(fraction); });
  files.back()->finish();
  cloud.stages.push_back({"write", console.end("")});
}

/// Writes the sphere and the page of a surface, where they are wanted.
void writeViews(const Settings& settings, CloudReconstruction& cloud, const Surface& surface,
                Console& console, Files& files) {
  if (!settings.sphere.empty()) {
    files.push_back(std::make_unique<OutputFile>(settings.sphere));
    writeMesh(*files.back(), sphereOf(cloud, surface, surface.sphere), settings.sphere_format,
              settings.report.encoding, {});
    files.back()->finish();
  }
  if (!settings.page.empty()) {
    console.begin("report");
    files.push_back(std::make_unique<OutputFile>(settings.page));
    writeHtmlReport(*files.back(), reportPage(),
                    {tool_name, settings.command, report(settings, cloud, surface), &cloud,
                     &surface, settings.reconstruction.options.threads});
    files.back()->finish();
    cloud.stages.push_back({"report", console.end("")});
  }
}

/// Several surfaces go to one file, with the views of the largest, or to numbered files.
void writeFiles(const Settings& settings, CloudReconstruction& cloud, Console& console,
                Files& files) {
  const std::vector<Surface>& surfaces = cloud.result.surfaces;
  if (!isNumbered(settings.output)) {
    writeMeshFile(settings, JoinedMesh(cloud).view(), cloud, console, files);
    writeViews(settings, cloud, surfaces.front(), console, files);
    return;
  }
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Settings of_part = settingsOf(settings, i);
    checkOutputs({settings.input}, outputsOf(of_part));
    writeMeshFile(of_part, meshOf(cloud, surfaces[i]), cloud, console, files);
    // Those without a number are of the largest.
    Settings of_views = of_part;
    if (i > 0 && !isNumbered(settings.sphere)) {
      of_views.sphere.clear();
    }
    if (i > 0 && !isNumbered(settings.page)) {
      of_views.page.clear();
    }
    writeViews(of_views, cloud, surfaces[i], console, files);
  }
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText)) {
    return;
  }
  const Settings settings = parseSettings(command_line);
  checkOutputs({settings.input}, outputsOf(settingsOf(settings, 0)));

  Console console(settings.report.detail());
  printParameters(settings, console);
  CloudReconstruction cloud;
  reconstructCloud(settings.input, settings.reconstruction, console, cloud);
  cloud.offset = offsetOf(settings.report, settings.output_format, *cloud.data);
  if (!settings.sphere.empty()) {
    requireSpheres(settings.input, cloud, isNumbered(settings.sphere));
  }
  Files files;
  writeFiles(settings, cloud, console, files);
  publish(
      settings.report, files, console,
      [&] {
        const bool is_list = cloud.result.surfaces.size() > 1 ||
                             settings.reconstruction.options.parts == PartsMode::Each;
        return is_list ? reportOnParts(settings, cloud) : report(settings, cloud, cloud.surface());
      },
      [&] { printSummary(settings, cloud, console); });
  Findings findings(settings.report.quiet, settings.reconstruction.strict, settings.page.empty());
  for (const std::string& failure : cloud.result.failures) {
    findings.add(failure);
  }
  findings.add("", cloud.result.findings);
  findings.print();
  findings.requireSoundness(cloud.result.isUsable());
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
