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
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using spherical_param::PartsMode;

const std::string tool_name = "pcl_spherical_param_reconstruction";

const std::vector<OptionInfo> option_table =
    joined({reconstructionOptions(),
            {{"sphere", "FILE", "write the points on the sphere with the same triangles"}},
            htmlReportOptions(),
            outputOptions()});

/// What each does, and the words after the tool's name.
const std::vector<std::pair<std::string, std::string>> example_table = {
    {"A mesh through all points of a scan", "scan.ply mesh.ply"},
    {"With its map to the sphere and a page to look at",
     "scan.ply mesh.ply -sphere sphere.ply -report report.html"},
    {"Of a noisy scan with outliers", "scan.ply mesh.ply -outliers auto -consolidation auto"},
    {"Of the largest object in a depth image, with the openings left open",
     "scan.pcd mesh.ply -parts largest -surface open"},
};

std::string helpText(bool with_experts) {
  return "Usage: " + tool_name +
         " input output [options]\n\n"
         "Meshes the points of an object without holes through it into a closed surface,\n"
         "or one with the openings of the scan.\n"
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

/// The settings of a part, with the names of its files.
Settings settingsOf(Settings settings, std::size_t part) {
  for (std::string* name : {&settings.output, &settings.sphere, &settings.page}) {
    *name = numbered(*name, part);
  }
  return settings;
}

/// \throw UsageError for names without the numbers that they need, or with some that they do not.
void checkNumbers(const Settings& settings) {
  const bool makes_parts = settings.reconstruction.parts == PartsMode::Each;
  if (isNumbered(settings.output) && !makes_parts) {
    throw UsageError(inQuotes(settings.output) + " is for several parts, but one mesh is made",
                     "give -parts each, or a name without " + number_mark);
  }
  const bool has_numbers = isNumbered(settings.output);
  for (const std::string& name : {settings.sphere, settings.page}) {
    if (makes_parts && !name.empty() && !(isNumbered(name) && has_numbers)) {
      throw UsageError(inQuotes(name) + " can show one part alone",
                       "give names with " + number_mark + " to it and to the output");
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

Json report(const Settings& settings, const CloudReconstruction& cloud) {
  Json json = filesToJson(settings);
  json.update(cloudToJson(settings.reconstruction, cloud));
  json["parts"] = nullptr;
  if (cloud.parts) {
    json["parts"] = Json::array();
    for (const spherical_param::Part& part : cloud.parts->parts) {
      json["parts"].push_back(toJson(part));
    }
  }
  addMesh(settings.reconstruction, cloud, json);
  return json;
}

/// One sentence on the meshes of a cloud.
std::string verdictOf(const std::vector<CloudReconstruction>& meshes) {
  if (meshes.size() == 1) {
    return meshes.front().result.verdict;
  }
  const auto faulty = static_cast<std::size_t>(
      std::count_if(meshes.begin(), meshes.end(), [](const CloudReconstruction& mesh) {
        return spherical_param::hasFault(mesh.result.findings);
      }));
  return counted(meshes.size(), "mesh", "meshes") +
         (faulty == 0 ? ", all sound." : ", " + grouped(faulty) + " of them with faults.");
}

bool areUsable(const std::vector<CloudReconstruction>& parts) {
  return std::all_of(parts.begin(), parts.end(),
                     [](const CloudReconstruction& part) { return part.result.isUsable(); });
}

/// The report on all parts, each with what report() says of one mesh.
Json reportOnParts(const Settings& settings, const PartsReconstruction& reconstruction) {
  const CloudReconstruction& cloud = reconstruction.cloud;
  Json json = filesToJson(settings);
  json.update(cloudToJson(settings.reconstruction, cloud));
  json["verdict"] = verdictOf(reconstruction.parts);
  json["usable"] = areUsable(reconstruction.parts);
  json["parts"] = Json::array();
  for (std::size_t i = 0; i < reconstruction.parts.size(); ++i) {
    Json part = toJson(cloud.parts->parts[i]);
    part["output"] = numbered(settings.output, i);
    addMesh(settings.reconstruction, reconstruction.parts[i], part);
    json["parts"].push_back(std::move(part));
  }
  json["stages"] = toJson(cloud.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
  json["failures"] = reconstruction.failures;
  return json;
}

/// The names of the files that are written.
std::vector<std::string> writtenFiles(const Settings& settings, std::size_t meshes) {
  std::vector<std::string> files;
  for (const std::string& name : outputsOf(settings)) {
    files.push_back(isNumbered(name) && meshes > 1
                        ? numbered(name, 0) + " to " + numbered(name, meshes - 1)
                        : numbered(name, 0));
  }
  return files;
}

/// How far consolidation moved points; empty without.
std::string movedBy(const Settings& settings, const std::vector<CloudReconstruction>& meshes) {
  if (settings.reconstruction.options.consolidation == spherical_param::ConsolidationMode::None) {
    return {};
  }
  double points = 0.0;
  double noise = 0.0;
  double mean = 0.0;
  double most = 0.0;
  for (const CloudReconstruction& mesh : meshes) {
    const auto count = static_cast<double>(mesh.result.vertex_of_input.size());
    const spherical_param::ConsolidationReport& moved = mesh.result.consolidation;
    points += count;
    noise += count * moved.noise;
    mean += count * moved.mean_displacement;
    most = std::max(most, moved.max_displacement);
  }
  return "by " + formatted(mean / points, 3) + " in the mean, " + formatted(most, 3) +
         " at most; the noise is " + formatted(noise / points, 3);
}

/// Prints the six lines of a run. \param meshes of the cloud: one, or those of its parts.
void printSummary(const Settings& settings, const CloudReconstruction& cloud,
                  const std::vector<CloudReconstruction>& meshes, Console& console) {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t duplicates = 0;
  std::size_t merged = 0;
  for (const CloudReconstruction& mesh : meshes) {
    vertices += mesh.result.vertexCount();
    triangles += static_cast<std::size_t>(mesh.result.triangles.cols());
    duplicates += mesh.result.duplicates();
    merged += mesh.result.consolidation.merged;
  }
  console.summary({settings.input + ", " + counted(cloud.data->points.size(), "point"),
                   verdictOf(meshes),
                   counted(vertices, "vertex", "vertices") + ", " + counted(triangles, "triangle"),
                   leftOut(cloud, duplicates, merged), writtenFiles(settings, meshes.size()),
                   movedBy(settings, meshes)});
}

/// Writes the mesh, the sphere and the page of a cloud, or of a part of one.
void writeFiles(const Settings& settings, CloudReconstruction& cloud, Console& console,
                std::vector<std::unique_ptr<OutputFile>>& files) {
  console.begin("write");
  // The mesh, and the sphere if it is wanted, are halves of one stage.
  const double fraction_of_file = settings.sphere.empty() ? 1.0 : 0.5;
  files.push_back(std::make_unique<OutputFile>(settings.output));
  writeMesh(*files.back(), meshOf(cloud), settings.output_format, settings.report.encoding,
            [&](double fraction) { console.update(fraction_of_file * fraction); });
  files.back()->finish();
  if (!settings.sphere.empty()) {
    files.push_back(std::make_unique<OutputFile>(settings.sphere));
    writeMesh(*files.back(), sphereOf(cloud, cloud.result.sphere), settings.sphere_format,
              settings.report.encoding,
              [&](double fraction) { console.update(0.5 + 0.5 * fraction); });
    files.back()->finish();
  }
  cloud.stages.push_back({"write", console.end("")});
  if (!settings.page.empty()) {
    console.begin("report");
    files.push_back(std::make_unique<OutputFile>(settings.page));
    writeHtmlReport(*files.back(), reportPage(),
                    {tool_name, settings.command, report(settings, cloud), &cloud,
                     settings.reconstruction.options.threads});
    files.back()->finish();
    cloud.stages.push_back({"report", console.end("")});
  }
}

/// Writes the surfaces of all parts to one file.
void writeJoined(const Settings& settings, PartsReconstruction& reconstruction, Console& console,
                 std::vector<std::unique_ptr<OutputFile>>& files) {
  const JoinedMesh joined(reconstruction.parts);
  console.begin("write");
  files.push_back(std::make_unique<OutputFile>(settings.output));
  writeMesh(*files.back(), joined.view(), settings.output_format, settings.report.encoding,
            [&](double fraction) { console.update(fraction); });
  files.back()->finish();
  reconstruction.cloud.stages.push_back({"write", console.end("")});
}

/// Prints what was made of each part, then of all.
void printParts(const Settings& settings, const PartsReconstruction& reconstruction,
                Console& console) {
  for (std::size_t i = 0; i < reconstruction.parts.size(); ++i) {
    const CloudReconstruction& part = reconstruction.parts[i];
    console.heading("\npart " + std::to_string(i + 1) + ", " +
                    counted(part.meshed.size(), "point"));
    printTables(part, console);
    printMeasures(part.result, console);
  }
  printSummary(settings, reconstruction.cloud, reconstruction.parts, console);
}

Findings findingsFor(const Settings& settings) {
  return {settings.report.quiet, settings.reconstruction.strict, settings.page.empty()};
}

void runOnCloud(const Settings& settings, Console& console) {
  std::vector<CloudReconstruction> clouds(1);
  CloudReconstruction& cloud = clouds.front();
  reconstructCloud(settings.input, settings.reconstruction, console, cloud);
  std::vector<std::unique_ptr<OutputFile>> files;
  writeFiles(settings, cloud, console, files);
  publish(
      settings.report, files, console, [&] { return report(settings, cloud); },
      [&] {
        printTables(cloud, console);
        printMeasures(cloud.result, console);
        printSummary(settings, cloud, clouds, console);
      });
  Findings findings = findingsFor(settings);
  findings.add("", cloud.result.findings);
  findings.print();
  findings.requireSoundness(cloud.result.isUsable());
}

void runOnParts(const Settings& settings, Console& console) {
  PartsReconstruction reconstruction;
  reconstructParts(settings.input, settings.reconstruction, console, reconstruction);
  std::vector<CloudReconstruction>& parts = reconstruction.parts;
  std::vector<std::unique_ptr<OutputFile>> files;
  if (isNumbered(settings.output)) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Settings of_part = settingsOf(settings, i);
      checkOutputs({settings.input}, outputsOf(of_part));
      writeFiles(of_part, parts[i], console, files);
    }
  } else {
    writeJoined(settings, reconstruction, console, files);
  }
  publish(
      settings.report, files, console, [&] { return reportOnParts(settings, reconstruction); },
      [&] { printParts(settings, reconstruction, console); });
  Findings findings = findingsFor(settings);
  for (const std::string& failure : reconstruction.failures) {
    findings.add(failure);
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    findings.add("part " + std::to_string(i + 1), parts[i].result.findings);
  }
  findings.print();
  findings.requireSoundness(areUsable(parts));
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText)) {
    return;
  }
  const Settings settings = parseSettings(command_line);
  const bool makes_parts = settings.reconstruction.parts == PartsMode::Each;
  checkOutputs({settings.input}, outputsOf(makes_parts ? settingsOf(settings, 0) : settings));

  Console console(settings.report.detail());
  printParameters(settings, console);
  if (makes_parts) {
    runOnParts(settings, console);
  } else {
    runOnCloud(settings, console);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
