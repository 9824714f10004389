// pcl_spherical_param_reconstruction: meshes the point cloud of a file.

#include "common/cloud_reconstruction.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/html_report.h"
#include "common/reconstruction_report.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param;
using namespace spherical_param::tools;

ToolText toolText() {
  return {"pcl_spherical_param_reconstruction",
          "input output",
          "Meshes a point cloud into surfaces with the parts, openings and handles that it shows,\n"
          "or into one closed surface through every point.\n"
          "  input:  " +
              extensionsFor(FileUse::ReadCloud) +
              "\n  output: " + extensionsFor(FileUse::WriteMesh) + "\n",
          {{"The surfaces of a scan", "scan.ply mesh.ply"},
           {"With its map to the sphere and a page to look at",
            "scan.ply mesh.ply -sphere sphere.ply -report report.html"},
           {"A mesh of a noisy scan, through its points", "scan.ply mesh.ply -consolidation none"},
           {"One closed surface through every point", "scan.ply mesh.ply -topology sphere"}}};
}

/// What the user asked for.
struct Settings {
  std::string input;
  std::string output;
  std::string sphere;   ///< empty: not wanted
  std::string page;     ///< empty: not wanted
  std::string command;  ///< repeats the run
  OutputSettings report;
  ReconstructionSettings reconstruction;
};

OptionTable optionsOf(Settings& settings) {
  OptionTable page = htmlReportOptions();
  page.front().value = [&settings] {
    return settings.page.empty() ? Json(nullptr) : Json(settings.page);
  };
  return joined({reconstructionOptions(settings.reconstruction),
                 {fileOption("sphere", "write the points on the sphere with the same triangles",
                             settings.sphere)},
                 page,
                 outputOptions(settings.report)});
}

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
  return name.substr(0, mark) + withZeros(part, 3) + name.substr(mark + number_mark.size());
}

/// The settings of a part, with the names of its files.
Settings settingsOf(Settings settings, std::size_t part) {
  for (std::string* name : {&settings.output, &settings.sphere, &settings.page}) {
    *name = numbered(*name, part);
  }
  return settings;
}

/// \throw UsageError for a pattern where there is only one file.
void checkNumbers(const Settings& settings) {
  const bool has_parts = withTopology(settings.reconstruction.options).parts == PartsMode::Each;
  if (isNumbered(settings.output) && !has_parts) {
    throw UsageError(inQuotes(settings.output) +
                         " is a pattern for several parts, but the output is one mesh",
                     "give -parts each, or a name without " + number_mark);
  }
  if (isNumbered(settings.report.json)) {
    throw UsageError(inQuotes(settings.report.json) + " is a pattern, but one report has all parts",
                     "give -json a name without " + number_mark);
  }
  for (const std::string& name : {settings.sphere, settings.page}) {
    if (isNumbered(name) && !isNumbered(settings.output)) {
      throw UsageError(inQuotes(name) + " is a pattern, but the output is one file",
                       "use " + number_mark + " in both names, or in none");
    }
  }
}

void parse(const CommandLine& command_line, Settings& settings) {
  const std::vector<std::string> files = filesOf(command_line, toolText());
  settings.input = files[0];
  settings.output = files[1];
  requireFormat(settings.input, FileUse::ReadCloud);
  requireFormat(settings.output, FileUse::WriteMesh);
  parseReconstructionOptions(command_line, settings.reconstruction);
  if (!settings.sphere.empty()) {
    requireFormat(settings.sphere, FileUse::WriteMesh);
    settings.reconstruction.options.details = true;
  }
  settings.page = parseHtmlReport(command_line);
  checkNumbers(settings);
  if (!settings.page.empty()) {
    keepForHtmlReport(settings.reconstruction);
    settings.command = repeatedCommand(toolText().name, command_line.words());
  }
}

/// The files that will be written, the standard output not among them.
std::vector<std::string> outputsOf(const Settings& settings) {
  return outputsOf(settings.report, {settings.output, settings.sphere, settings.page});
}

/// The members that reports on the cloud and on each of its parts share.
Json cloudReport(Settings settings, const CloudReconstruction& cloud) {
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = settings.input;
  json["output"] = settings.output;
  json["options"] = optionsToJson(optionsOf(settings));
  json["offset"] = cloud.offset;
  json["points"] = cloud.data->points.size();
  json["view"] = toJson(cloud.result.view);
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

/// The report on all parts, each with the members of the report on one surface.
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

/// The report on all that was made.
Json report(const Settings& settings, const CloudReconstruction& cloud) {
  const bool is_list =
      cloud.result.surfaces.size() > 1 || settings.reconstruction.options.parts == PartsMode::Each;
  return is_list ? reportOnParts(settings, cloud) : report(settings, cloud, cloud.surface());
}

/// The names of the files that are written, and what the mesh loses in them.
std::vector<std::string> writtenFiles(const Settings& settings, const CloudReconstruction& cloud) {
  const std::size_t surfaces = cloud.result.surfaces.size();
  std::vector<std::string> files;
  for (const std::string& name : outputsOf(settings)) {
    const bool is_largest = name == settings.sphere && surfaces > 1 && !cloud.result.view;
    files.push_back(isNumbered(name) && surfaces > 1
                        ? numbered(name, 0) + " to " + numbered(name, surfaces - 1)
                        : numbered(name, 0) + (is_largest ? " (the largest)" : ""));
  }
  files.front() += notWritten(!cloud.data->colors.empty(), settings.output, cloud.offset);
  return files;
}

/// Prints the tables of each surface. \return the summary of all
Summary summaryOf(const Settings& settings, const CloudReconstruction& cloud, Console& console) {
  const std::vector<Surface>& surfaces = cloud.result.surfaces;
  std::size_t vertices = 0;
  Eigen::Index triangles = 0;
  for (const Surface& surface : surfaces) {
    if (surfaces.size() > 1) {
      console.heading("\nsurface of " + counted(surface.inputs.size(), "point"));
    }
    printTables(surface, console);
    vertices += surface.vertexCount();
    triangles += surface.triangles.cols();
  }
  Summary summary = summaryOf(settings.input, cloud);
  summary.made = meshSize(vertices, triangles);
  summary.written = writtenFiles(settings, cloud);
  return summary;
}

void writeMeshFile(const Settings& settings, MeshView mesh, CloudReconstruction& cloud,
                   ToolRun& run) {
  mesh.shiftBy(cloud.offset);
  run.console.begin("write");
  run.write(settings.output, mesh, run.console.updates());
  cloud.stages.push_back(run.console.end());
}

/// Writes the page of a surface, of all if it is null.
void writePage(const Settings& settings, CloudReconstruction& cloud, const Surface* surface,
               ToolRun& run) {
  run.console.begin("report");
  OutputFile& file = run.open(settings.page);
  writeHtmlReport(file, {toolText().name, settings.command,
                         surface ? report(settings, cloud, *surface) : report(settings, cloud),
                         &cloud, surface});
  file.finish();
  cloud.stages.push_back(run.console.end());
}

/// Writes all surfaces to one file and page, or each to numbered ones. A file of the sphere without
/// a number holds the largest surface, or all surfaces of a view, which share one sphere.
void writeFiles(const Settings& settings, CloudReconstruction& cloud, ToolRun& run) {
  const std::vector<Surface>& surfaces = cloud.result.surfaces;
  const JoinedMesh mesh = joined(cloud.result);
  const bool is_numbered = isNumbered(settings.output);
  if (!is_numbered) {
    writeMeshFile(settings, meshOf(cloud, mesh), cloud, run);
  }
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Settings of_part = settingsOf(settings, i);
    if (is_numbered) {
      checkOutputs({settings.input}, outputsOf(of_part));
      writeMeshFile(of_part, meshOf(cloud, surfaces[i]), cloud, run);
    }
    if (!settings.sphere.empty() &&
        (isNumbered(settings.sphere) || (i == 0 && !cloud.result.view))) {
      run.write(of_part.sphere, sphereOf(cloud, surfaces[i].input_of_vertex, surfaces[i].triangles,
                                         surfaces[i].sphere));
    }
    if (isNumbered(settings.page)) {
      writePage(of_part, cloud, &surfaces[i], run);
    }
  }
  if (cloud.result.view && !settings.sphere.empty() && !isNumbered(settings.sphere)) {
    run.write(settings.sphere, sphereOf(cloud, mesh.input_of_vertex, mesh.triangles, mesh.sphere));
  }
  if (!settings.page.empty() && !isNumbered(settings.page)) {
    writePage(settings, cloud, nullptr, run);
  }
}

void run(const CommandLine& command_line, Settings& settings) {
  parse(command_line, settings);
  checkOutputs({settings.input}, outputsOf(settingsOf(settings, 0)));
  ToolRun run(settings.report, settings.reconstruction.strict, toolText().name,
              {{"input", settings.input}, {"output", settings.output}}, optionsOf(settings));
  CloudReconstruction cloud;
  reconstructCloud(settings.input, settings.reconstruction, run.console, cloud);
  cloud.offset = settings.report.offsetOf(settings.output, *cloud.data);
  if (!settings.sphere.empty()) {
    requireSpheres(settings.input, cloud, isNumbered(settings.sphere) || cloud.result.view);
  }
  writeFiles(settings, cloud, run);
  run.publish([&] { return report(settings, cloud); }, summaryOf(settings, cloud, run.console));
  for (const std::string& failure : cloud.result.failures) {
    run.addFailure(failure);
  }
  run.add("", cloud.result.findings);
  run.conclude(cloud.result.isUsable(), settings.page.empty() ? "-report report.html" : "");
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  return runTool(toolText(), argc, argv, optionsOf(settings),
                 [&](const CommandLine& command_line) { run(command_line, settings); });
}
