// pcl_spherical_param_morph: changes the shape of one point cloud into that of another, as a
// sequence of meshes.

#include "common/errors.h"
#include "common/file_formats.h"
#include "common/point_pairs.h"
#include "common/product_input.h"
#include "common/reconstruction_report.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/version.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstddef>
#include <regex>
#include <string>
#include <vector>

namespace {

using namespace spherical_param;
using namespace spherical_param::tools;

const Names<bool> alignment_names = {{"none", false}, {"rotation", true}};
const Names<MorphConnectivity> connectivity_names = {
    {"all", MorphConnectivity::AllVertices},
    {"resampled", MorphConnectivity::Resampled},
};
ToolText toolText() {
  return {"pcl_spherical_param_morph",
          "first second output",
          "Meshes the points of two objects without holes through them and morphs the first into\n"
          "the second by their maps to the sphere. The output morph.ply or morph_%03d.ply writes\n"
          "morph_000.ply and so on. Options of the meshes and the map hold for both clouds.\n"
          "  inputs: " +
              extensionsFor(FileUse::ReadCloud) +
              "\n  output: " + extensionsFor(FileUse::WriteMesh) + "\n",
          {{"Twenty meshes from one scan to another", "scan.ply other.ply morph.ply"}}};
}

/// What the user asked for.
struct Settings {
  std::array<std::string, 2> inputs;
  std::string output;
  std::size_t frames = 20;
  std::vector<std::string> files;  ///< of the frames
  std::string pairs;               ///< empty: none
  MorphOptions morph;
  SurfaceFit fit = SurfaceFit::Linear;
  bool match = false;
  bool check = false;
  ProductSettings product{TopologyMode::Sphere};
  OutputSettings report;

  bool isResampled() const { return morph.connectivity == MorphConnectivity::Resampled; }
  int threads() const { return product.reconstruction.options.threads; }
};

OptionTable optionsOf(Settings& settings) {
  return joined(
      {{numberOption("frames", "number of meshes including both ends", settings.frames, 2, 10000),
        fileOption("pairs", "points that become one: two numbers from 0, or six coordinates a line",
                   settings.pairs),
        choiceOption("align", "of the spheres: none, or the best rotation of all",
                     settings.morph.align, alignment_names),
        choiceOption("connectivity", "the vertices of both meshes, or those of a geodesic sphere",
                     settings.morph.connectivity, connectivity_names),
        usedIf([&] { return settings.isResampled(); },
               numberOption("samples", "approximate number of vertices of resampled",
                            settings.morph.samples, 12, 1 << 24)),
        choiceOption("fit", "between vertices; resampled: smooth, unless it is given", settings.fit,
                     fit_names),
        flagOption("match", "move and scale the second object to the place and area of the first",
                   settings.match),
        flagOption("check", "count the self-intersections of all frames", settings.check)},
       productOptions(settings.product),
       outputOptions(settings.report)});
}

/// Names of numbered files. A placeholder in the pattern's file name, %d or %03d with any number of
/// digits up to 9, is replaced by the number of the frame; without one, it goes before the
/// extension: morph.ply gives morph_000.ply. Frames begin at 0.
///
/// \throw UsageError for a pattern with another or a second %.
std::vector<std::string> frameNames(const std::string& pattern, std::size_t frames) {
  static const std::regex placeholder("([^%]*)%(?:0([1-9]))?d([^%]*)");
  static const std::regex plain("([^%]*?)()((?:\\.[^%.]*)?)");
  const std::size_t begin = pattern.rfind('/') + 1;
  const std::string name = pattern.substr(begin);
  std::smatch parts;
  const bool has_placeholder = std::regex_match(name, parts, placeholder);
  if (!has_placeholder && !std::regex_match(name, parts, plain)) {
    throw UsageError("the output " + inQuotes(pattern) + " has a % that is not a frame number",
                     "give one placeholder, as in frame_%03d.ply, or none");
  }
  const std::size_t digits = !has_placeholder
                                 ? std::max<std::size_t>(3, std::to_string(frames - 1).size())
                             : parts[2].matched ? std::stoul(parts[2])
                                                : 1;
  std::vector<std::string> names;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    names.push_back(pattern.substr(0, begin) + parts[1].str() + (has_placeholder ? "" : "_") +
                    withZeros(frame, digits) + parts[3].str());
  }
  return names;
}

void parse(const CommandLine& command_line, Settings& settings) {
  const std::vector<std::string> files = filesOf(command_line, toolText());
  settings.inputs = {files[0], files[1]};
  settings.output = files[2];
  for (const std::string& input : settings.inputs) {
    requireFormat(input, FileUse::ReadCloud);
  }
  requireFormat(settings.output, FileUse::WriteMesh);
  settings.files = frameNames(settings.output, settings.frames);
  if (!settings.isResampled()) {
    command_line.refuse({"samples"}, "-connectivity all", "-connectivity resampled");
  } else if (!command_line.has("fit")) {
    settings.fit = SurfaceFit::Smooth;
  }
  parseProductOptions(command_line, settings.product);
}

void checkFiles(const Settings& settings) {
  std::vector<std::string> others(settings.inputs.begin(), settings.inputs.end());
  if (!settings.pairs.empty()) {
    others.push_back(settings.pairs);
  }
  const std::vector<std::string> report = outputsOf(settings.report, {});
  checkOutputs(others, report);
  others.insert(others.end(), report.begin(), report.end());
  // The frames have different names.
  for (const std::string& frame : settings.files) {
    checkOutputs(others, {frame});
  }
}

/// What is written, with its quality.
struct Morph {
  MorphResult result;
  std::vector<FilePair> pairs;
  std::vector<std::string> reasons;  ///< why pairs could not be honoured; empty: they are
  MeshTopology topology;
  std::vector<std::size_t> self_intersections;  ///< of each frame; empty: not counted
  /// Of both shapes, 4 x w, in 0 ... 255; empty unless both have colours.
  std::array<Eigen::Matrix4Xd, 2> colors;
  std::vector<StageTime> stages;
  Point offset{};  ///< of the coordinates that are written

  bool hasColors() const { return colors[0].cols() > 0 && colors[1].cols() > 0; }
  std::size_t vertexCount() const { return static_cast<std::size_t>(result.first.cols()); }
  std::ptrdiff_t honoured() const { return std::count(reasons.begin(), reasons.end(), ""); }
};

/// Moves and scales the second shape to the place and the area of the first.
void matchSecond(const std::array<MappedCloud, 2>& clouds, MorphResult& morph) {
  std::array<Eigen::Vector3d, 2> centers;
  std::array<double, 2> areas{};
  for (std::size_t side = 0; side < 2; ++side) {
    const Positions& points = clouds[side].points();
    const Triangles& triangles = clouds[side].triangles();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Eigen::Vector3d origin = points.col(triangles(0, 0));
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      const Eigen::Vector3d a = points.col(triangles(0, t));
      const Eigen::Vector3d b = points.col(triangles(1, t));
      const Eigen::Vector3d c = points.col(triangles(2, t));
      const double area = (b - a).cross(c - a).norm() / 2.0;
      areas[side] += area;
      for (const Eigen::Vector3d& corner : {a, b, c})
        sum += area / 3.0 * (corner - origin);
    }
    centers[side] = areas[side] > 0.0 ? Eigen::Vector3d(origin + sum / areas[side]) : origin;
  }
  const double scale = areas[1] > 0.0 ? std::sqrt(areas[0] / areas[1]) : 1.0;
  morph.second = (scale * (morph.second.colwise() - centers[1])).colwise() + centers[0];
}

/// Hands the pairs over to the library that are vertices. \return their places in the file
std::vector<std::size_t> addPairs(Morph& morph, MorphOptions& options) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < morph.pairs.size(); ++i) {
    const FilePair& pair = morph.pairs[i];
    morph.reasons.emplace_back();
    for (std::size_t side = 0; side < 2; ++side) {
      if (pair.vertices[side] < 0) {
        morph.reasons.back() = "point " + std::to_string(pair.points[side]) + " of the " +
                               (side == 0 ? "first" : "second") +
                               " cloud is not finite, or was left out as an outlier";
      }
    }
    if (morph.reasons.back().empty()) {
      options.pairs.push_back({pair.vertices[0], pair.vertices[1]});
      places.push_back(i);
    }
  }
  return places;
}

void makeMorph(const Settings& settings, const std::array<MappedCloud, 2>& clouds, Morph& morph,
               Console& console) {
  MorphOptions options = settings.morph;
  options.threads = settings.threads();
  options.progress = console.progress();
  const std::vector<std::size_t> places = addPairs(morph, options);
  console.begin("morph");
  morph.result = morphSurfaces(surfaceOf(clouds[0], settings.fit, settings.threads()),
                               surfaceOf(clouds[1], settings.fit, settings.threads()), options);
  for (const ImpossiblePair& pair : morph.result.impossible) {
    morph.reasons[places[pair.pair]] = pair.reason;
  }
  morph.colors = {colorsAt(clouds[0], morph.result.first_places, 0.0),
                  colorsAt(clouds[1], morph.result.second_places, 0.0)};
  if (settings.match) {
    matchSecond(clouds, morph.result);
  }
  morph.topology = checkTopology(morph.result.triangles, morph.vertexCount(), settings.threads());
  morph.stages.push_back(console.end(std::to_string(morph.vertexCount()) + " vertices"));
}

double timeOf(const Settings& settings, std::size_t frame) {
  return static_cast<double>(frame) / static_cast<double>(settings.frames - 1);
}

Positions positionsOf(const Settings& settings, const Morph& morph, std::size_t frame) {
  return inBetween(morph.result, timeOf(settings, frame));
}

void checkFrames(const Settings& settings, Morph& morph, Console& console) {
  console.begin("verify");
  std::size_t sum = 0;
  for (std::size_t frame = 0; frame < settings.frames; ++frame) {
    const Positions positions = asWritten(positionsOf(settings, morph, frame));
    morph.self_intersections.push_back(
        findSelfIntersections(positions, morph.result.triangles, Execution{settings.threads()})
            .size());
    sum += morph.self_intersections.back();
    console.update(timeOf(settings, frame));
  }
  morph.stages.push_back(console.end(counted(sum, "self-intersection")));
}

/// Stores all frames, none of them under its name yet.
void store(const Settings& settings, const std::array<MappedCloud, 2>& clouds, Morph& morph,
           ToolRun& run) {
  run.console.begin("write");
  morph.offset = settings.report.offsetOf(settings.output, *clouds[0].cloud.data);
  PointData vertices;
  vertices.has_alpha =
      morph.hasColors() && (clouds[0].cloud.data->has_alpha || clouds[1].cloud.data->has_alpha);
  for (std::size_t frame = 0; frame < settings.frames; ++frame) {
    const double t = timeOf(settings, frame);
    vertices.points = toPoints(positionsOf(settings, morph, frame));
    if (morph.hasColors()) {
      // To the nearest.
      vertices.colors =
          truncated((((1.0 - t) * morph.colors[0] + t * morph.colors[1]).array() + 0.5).matrix());
    }
    MeshView mesh(vertices, morph.result.triangles);
    mesh.shiftBy(morph.offset);
    run.write(settings.files[frame], mesh);
    run.console.update(t);
  }
  morph.stages.push_back(run.console.end(counted(settings.frames, "frame")));
}

Json report(Settings settings, const std::array<MappedCloud, 2>& clouds, const Morph& morph) {
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["inputs"] = settings.inputs;
  json["output"] = settings.output;
  json["offset"] = morph.offset;
  json["options"] = optionsToJson(optionsOf(settings));
  json["frames"] = settings.frames;
  json["files"] = settings.files;
  json["vertices"] = morph.vertexCount();
  json["triangles"] = morph.result.triangles.cols();
  addToJson(morph.topology, json);
  json["rotation"] = Json::array();
  for (Eigen::Index row = 0; row < 3; ++row) {
    json["rotation"].push_back(toJson(Eigen::Vector3d(morph.result.rotation.row(row))));
  }
  json["alignment_error"] = morph.result.alignment_error;
  Json impossible = Json::array();
  for (std::size_t i = 0; i < morph.pairs.size(); ++i) {
    if (!morph.reasons[i].empty()) {
      impossible.push_back({{"line", morph.pairs[i].line},
                            {"points", morph.pairs[i].points},
                            {"reason", morph.reasons[i]}});
    }
  }
  json["pairs"] = {{"given", morph.pairs.size()},
                   {"honoured", morph.honoured()},
                   {"worst_pair", morph.result.worst_pair},
                   {"impossible", impossible}};
  json["self_intersections"] = settings.check ? Json(morph.self_intersections) : Json(nullptr);
  for (std::size_t side = 0; side < 2; ++side) {
    Json& of_side = json[side == 0 ? "first" : "second"];
    addMapToJson(clouds[side], of_side);
    of_side["stages"] = toJson(clouds[side].cloud.stages);
    of_side["findings"] = toJson(clouds[side].cloud.result.findings);
  }
  json["stages"] = toJson(morph.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
  return json;
}

Summary summaryOf(const Settings& settings, const std::array<MappedCloud, 2>& clouds,
                  const Morph& morph) {
  Summary both;
  for (std::size_t side = 0; side < 2; ++side) {
    const std::string& input = settings.inputs[side];
    const CloudReconstruction& cloud = clouds[side].cloud;
    const std::string of = (side == 0 ? "" : "; ") + input + ": ";
    both.read += of + counted(cloud.data->points.size(), "point");
    both.verdict += (side == 0 ? "" : " ") + input + ": " + cloud.result.verdict;
    both.left_out += of + leftOut(cloud);
  }
  both.made = meshSize(morph.vertexCount(), morph.result.triangles.cols());
  both.written =
      outputsOf(settings.report, {settings.files.front() + " to " + settings.files.back()});
  both.written.front() += notWritten(morph.hasColors(), settings.output, morph.offset);
  return both;
}

void run(const CommandLine& command_line, Settings& settings) {
  parse(command_line, settings);
  checkFiles(settings);
  ToolRun run(settings.report, settings.product.reconstruction.strict, toolText().name,
              {{"first", settings.inputs[0]},
               {"second", settings.inputs[1]},
               {"output", settings.files.front() + " ... " + settings.files.back()}},
              optionsOf(settings));
  std::array<MappedCloud, 2> clouds;
  Morph morph;
  for (std::size_t side = 0; side < 2; ++side) {
    mapCloud(settings.inputs[side], settings.product, run.console, clouds[side]);
  }
  if (!settings.pairs.empty()) {
    morph.pairs = readPointPairs(settings.pairs, clouds[0].cloud, clouds[1].cloud);
  }
  runLibrary("cannot morph", kReportIt, [&] {
    makeMorph(settings, clouds, morph, run.console);
    if (settings.check) {
      checkFrames(settings, morph, run.console);
    }
  });
  store(settings, clouds, morph, run);
  Json json = report(settings, clouds, morph);
  printFigures(json, run.console);
  run.publish([&] { return json; }, summaryOf(settings, clouds, morph));
  for (std::size_t side = 0; side < 2; ++side) {
    run.add(settings.inputs[side], clouds[side].cloud.result.findings);
  }
  for (std::size_t i = 0; i < morph.pairs.size(); ++i) {
    if (!morph.reasons[i].empty()) {
      run.addFailure("the pair of line " + std::to_string(morph.pairs[i].line) +
                     " is impossible: " + morph.reasons[i]);
    }
  }
  run.conclude(clouds[0].cloud.surface().isUsable() && clouds[1].cloud.surface().isUsable());
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  return runTool(toolText(), argc, argv, optionsOf(settings),
                 [&](const CommandLine& command_line) { run(command_line, settings); });
}
