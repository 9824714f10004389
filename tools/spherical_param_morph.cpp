// pcl_spherical_param_morph: changes the shape of one point cloud into that of another, as a
// sequence of meshes.

#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/findings.h"
#include "common/json_report.h"
#include "common/mesh_writer.h"
#include "common/names.h"
#include "common/numbers.h"
#include "common/output_file.h"
#include "common/output_options.h"
#include "common/point_data.h"
#include "common/point_pairs.h"
#include "common/product_input.h"
#include "common/reconstruction_report.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/version.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using spherical_param::ImpossiblePair;
using spherical_param::Index;
using spherical_param::MorphConnectivity;
using spherical_param::MorphResult;
using spherical_param::Positions;
using spherical_param::SphereLocation;
using spherical_param::SphereSurface;
using spherical_param::SurfaceFit;

const std::string tool_name = "pcl_spherical_param_morph";

enum class Alignment { None, Rotation };

const Names<Alignment> alignment_names = {
    {"none", Alignment::None},
    {"rotation", Alignment::Rotation},
};
const Names<MorphConnectivity> connectivity_names = {
    {"all", MorphConnectivity::AllVertices},
    {"resampled", MorphConnectivity::Resampled},
};
const Names<SurfaceFit> fit_names = {
    {"linear", SurfaceFit::Linear},
    {"smooth", SurfaceFit::Smooth},
};

const std::vector<OptionInfo> own_options = {
    {"frames", "N", "number of meshes including both ends, 2 to 10000 (20)"},
    {"pairs", "FILE", "points that become one: two numbers from 0, or six coordinates a line"},
    {"align", "NAME", "of the spheres: none, or rotation: the best of all (rotation)"},
    {"connectivity", "NAME", "all: the vertices of both meshes, or resampled (all)"},
    {"samples", "N", "approximate number of vertices of resampled, 12 to 16777216 (40962)"},
    {"fit", "NAME", "between vertices: linear or smooth (linear; resampled: smooth)"},
    {"match", "", "move and scale the second object to the place and the area of the first"},
    {"check", "", "count the self-intersections of all frames"},
};
const ProductDefaults product_defaults(HandlesOnSphere::Refused);
const std::vector<OptionInfo> option_table =
    joined({own_options, productOptions(product_defaults), outputOptions()});

/// What each does, and the words after the tool's name.
const std::vector<std::pair<std::string, std::string>> example_table = {
    {"Twenty meshes from one scan to another", "scan.ply other.ply morph.ply"},
};

std::string helpText(bool with_experts) {
  return "Usage: " + tool_name +
         " first second output [options]\n\n"
         "Meshes the points of two objects without holes through them and morphs the first into\n"
         "the second by their maps to the sphere. The output morph.ply or morph_%03d.ply writes\n"
         "morph_000.ply and so on.\n"
         "  inputs: " +
         extensionsFor(FileUse::ReadCloud) + "\n  output: " + extensionsFor(FileUse::WriteMesh) +
         "\n\nOptions (-name value, --name value or --name=value; defaults in brackets; those of\n"
         "the meshes and the map hold for both clouds):\n" +
         describeOptions(option_table, with_experts) + "\n" +
         describeExamples(tool_name, example_table) +
         "\nExit code: 0 done (also with warnings), 1 failed (with -strict also if the mesh is "
         "unfit),\n"
         "2 wrong usage, 3 written but not usable: more than 1 % of the triangles intersect.\n";
}

/// What the user asked for.
struct Settings {
  std::array<std::string, 2> inputs;
  std::string output;
  std::vector<std::string> frames;  ///< their files
  FileFormat format = nullptr;
  std::string pairs;  ///< empty: none
  Alignment alignment = Alignment::Rotation;
  MorphConnectivity connectivity = MorphConnectivity::AllVertices;
  std::size_t samples = spherical_param::MorphOptions().samples;
  SurfaceFit fit = SurfaceFit::Linear;
  bool match = false;
  bool check = false;
  ProductSettings product;
  OutputSettings report;

  int threads() const { return product.reconstruction.options.threads; }
};

constexpr std::size_t fewest_digits = 3;

/// A number with zeros before it.
std::string padded(int number, std::size_t digits) {
  const std::string text = std::to_string(number);
  return std::string(digits - std::min(digits, text.size()), '0') + text;
}

[[noreturn]] void refusePattern(const std::string& pattern) {
  throw UsageError("the output " + inQuotes(pattern) + " has a % that is not a frame number",
                   "give one placeholder, as in frame_%03d.ply, or none");
}

/// Names of numbered files. A placeholder in the pattern's file name, %d or %03d with any number of
/// digits up to 9, is replaced by the number of the frame; without one, it goes before the
/// extension: morph.ply gives morph_000.ply. Frames begin at 0.
///
/// \throw UsageError for a pattern with another or a second %.
std::vector<std::string> frameNames(const std::string& pattern, int frames) {
  const std::size_t slash = pattern.rfind('/');
  const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
  const std::size_t percent = pattern.find('%', begin);
  std::string before;
  std::string after;
  std::size_t digits = std::max(fewest_digits, std::to_string(frames - 1).size());
  if (percent == std::string::npos) {
    const std::size_t dot = pattern.rfind('.');
    const std::size_t end = dot == std::string::npos || dot < begin ? pattern.size() : dot;
    before = pattern.substr(0, end) + "_";
    after = pattern.substr(end);
  } else {
    // The text between % and d is nothing, or a 0 and one digit from 1 to 9.
    const std::size_t d =
        percent + 1 < pattern.size() && pattern[percent + 1] == '0' ? percent + 3 : percent + 1;
    if (d >= pattern.size() || pattern[d] != 'd' ||
        pattern.find('%', percent + 1) != std::string::npos) {
      refusePattern(pattern);
    }
    digits = 1;
    if (d == percent + 3) {
      if (pattern[percent + 2] < '1' || pattern[percent + 2] > '9') {
        refusePattern(pattern);
      }
      digits = static_cast<std::size_t>(pattern[percent + 2] - '0');
    }
    before = pattern.substr(0, percent);
    after = pattern.substr(d + 1);
  }
  std::vector<std::string> names;
  names.reserve(static_cast<std::size_t>(frames));
  for (int frame = 0; frame < frames; ++frame) {
    names.push_back(before + padded(frame, digits) + after);
  }
  return names;
}

Settings parseSettings(const CommandLine& command_line) {
  const std::vector<std::string>& files = command_line.others();
  if (files.size() != 3) {
    throw UsageError(files.size() > 3    ? "one file too many: " + inQuotes(files[3])
                     : files.size() == 2 ? "the output file is missing"
                                         : "two input files are needed",
                     "run '" + tool_name + " first second output [options]', -h shows the options");
  }
  Settings settings;
  settings.inputs = {files[0], files[1]};
  settings.output = files[2];
  for (const std::string& input : settings.inputs) {
    requireFormat(input, FileUse::ReadCloud);
  }
  settings.format = requireFormat(settings.output, FileUse::WriteMesh);
  const auto frames = parseInteger("frames", command_line.value("frames", "20"), {2, 10000});
  settings.frames = frameNames(settings.output, static_cast<int>(frames));
  settings.pairs = command_line.value("pairs", "");
  if (command_line.has("pairs") && settings.pairs.empty()) {
    throw UsageError("option -pairs: the name of the file is empty", "give a file");
  }
  if (command_line.has("align")) {
    settings.alignment = parseName("align", command_line.value("align", ""), alignment_names);
  }
  if (command_line.has("connectivity")) {
    settings.connectivity =
        parseName("connectivity", command_line.value("connectivity", ""), connectivity_names);
  }
  const bool is_resampled = settings.connectivity == MorphConnectivity::Resampled;
  if (command_line.has("samples")) {
    if (!is_resampled) {
      throw UsageError("option -samples does nothing with -connectivity all",
                       "leave -samples out, or give -connectivity resampled");
    }
    settings.samples = static_cast<std::size_t>(
        parseInteger("samples", command_line.value("samples", ""), {12, std::int64_t{1} << 24U}));
  }
  settings.fit = is_resampled ? SurfaceFit::Smooth : SurfaceFit::Linear;
  if (command_line.has("fit")) {
    settings.fit = parseName("fit", command_line.value("fit", ""), fit_names);
  }
  settings.match = command_line.has("match");
  settings.check = command_line.has("check");
  settings.report = parseOutputOptions(command_line);
  settings.product = parseProductOptions(command_line, product_defaults);
  return settings;
}

void checkFiles(const Settings& settings) {
  std::vector<std::string> others(settings.inputs.begin(), settings.inputs.end());
  if (!settings.pairs.empty()) {
    others.push_back(settings.pairs);
  }
  std::vector<std::string> report;
  addReport(settings.report, report);
  checkOutputs(others, report);
  others.insert(others.end(), report.begin(), report.end());
  // The frames have different names.
  for (const std::string& frame : settings.frames) {
    checkOutputs(others, {frame});
  }
}

void printParameters(const Settings& settings, Console& console) {
  console.heading(tool_name + " " + SPHERICAL_PARAM_VERSION);
  console.entry("first", oneLine(settings.inputs[0]));
  console.entry("second", oneLine(settings.inputs[1]));
  console.entry("output",
                oneLine(settings.frames.front()) + " ... " + oneLine(settings.frames.back()));
  if (!settings.pairs.empty()) {
    console.entry("pairs", oneLine(settings.pairs));
  }
  if (!settings.report.json.empty()) {
    console.entry("json", oneLine(settings.report.json));
  }
  console.entry("align", nameOf(settings.alignment, alignment_names));
  console.entry("connectivity", nameOf(settings.connectivity, connectivity_names));
  if (settings.connectivity == MorphConnectivity::Resampled) {
    console.entry("samples", std::to_string(settings.samples));
  }
  console.entry("fit", nameOf(settings.fit, fit_names));
  console.entry("match", yesOrNo(settings.match));
  printProductOptions(settings.product, console);
}

/// A pair of the file that could not be honoured.
struct LostPair {
  FilePair pair;
  std::string reason;
};

/// What is written, with its quality.
struct Morph {
  MorphResult result;
  std::vector<FilePair> pairs;
  std::vector<LostPair> lost;
  spherical_param::MeshTopology topology;
  std::vector<std::size_t> self_intersections;  ///< of each frame; empty: not counted
  /// Of both shapes, 4 x w, in 0 ... 255; empty unless both have colours.
  std::array<Eigen::Matrix<double, 4, Eigen::Dynamic>, 2> colors;
  std::vector<spherical_param::StageTime> stages;
  Point offset{};  ///< of the coordinates that are written

  bool hasColors() const { return colors[0].cols() > 0; }
};

Eigen::Matrix<double, 4, Eigen::Dynamic> colorsAt(const MappedCloud& mapped,
                                                  const std::vector<SphereLocation>& places) {
  Eigen::Matrix<double, 4, Eigen::Dynamic> colors(4, static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (Eigen::Index corner = 0; corner < 3; ++corner) {
      const Index vertex = mapped.mesh.triangles(corner, places[i].triangle);
      const Color& color = mapped.colors[static_cast<std::size_t>(vertex)];
      sum += places[i].weights[corner] * Eigen::Vector4d(color[0], color[1], color[2], color[3]);
    }
    colors.col(static_cast<Eigen::Index>(i)) = sum;
  }
  return colors;
}

/// Moves and scales the second shape to the place and the area of the first.
void matchSecond(const std::array<MappedCloud, 2>& clouds, MorphResult& morph) {
  std::array<Eigen::Vector3d, 2> centers;
  std::array<double, 2> areas{};
  for (std::size_t side = 0; side < 2; ++side) {
    const Positions& points = clouds[side].mesh.points;
    const spherical_param::Triangles& triangles = clouds[side].mesh.triangles;
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

void makeMorph(const Settings& settings, const std::array<MappedCloud, 2>& clouds, Morph& morph,
               Console& console) {
  spherical_param::MorphOptions options;
  options.align = settings.alignment == Alignment::Rotation;
  options.connectivity = settings.connectivity;
  options.samples = settings.samples;
  options.threads = settings.threads();
  options.progress = [&console](const spherical_param::Progress& progress) {
    console.update(progress.fraction);
    return true;
  };
  std::vector<std::size_t> numbers;  // of the pairs, among those of the file
  for (std::size_t i = 0; i < morph.pairs.size(); ++i) {
    const FilePair& pair = morph.pairs[i];
    if (pair.vertices[0] >= 0 && pair.vertices[1] >= 0) {
      options.pairs.push_back({pair.vertices[0], pair.vertices[1]});
      numbers.push_back(i);
    }
  }
  console.begin("morph");
  const SphereSurface first(clouds[0].mesh.points, clouds[0].mesh.triangles, clouds[0].map.sphere,
                            {settings.fit, settings.threads(), clouds[0].map.caps});
  const SphereSurface second(clouds[1].mesh.points, clouds[1].mesh.triangles, clouds[1].map.sphere,
                             {settings.fit, settings.threads(), clouds[1].map.caps});
  morph.result = spherical_param::morphSurfaces(first, second, options);
  std::vector<std::string> reasons(morph.pairs.size());
  for (std::size_t i = 0; i < morph.pairs.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      if (morph.pairs[i].vertices[side] < 0) {
        reasons[i] = "point " + std::to_string(morph.pairs[i].points[side]) + " of the " +
                     (side == 0 ? "first" : "second") +
                     " cloud is not finite, or was left out as an outlier";
      }
    }
  }
  for (const ImpossiblePair& pair : morph.result.impossible) {
    reasons[numbers[pair.pair]] = pair.reason;
  }
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    if (!reasons[i].empty()) {
      morph.lost.push_back({morph.pairs[i], reasons[i]});
    }
  }
  if (!clouds[0].colors.empty() && !clouds[1].colors.empty()) {
    morph.colors = {colorsAt(clouds[0], morph.result.first_places),
                    colorsAt(clouds[1], morph.result.second_places)};
  }
  if (settings.match) {
    matchSecond(clouds, morph.result);
  }
  morph.topology = spherical_param::checkTopology(
      morph.result.triangles, static_cast<std::size_t>(morph.result.first.cols()),
      settings.threads());
  morph.stages.push_back(
      {"morph", console.end(std::to_string(morph.result.first.cols()) + " vertices")});
}

double timeOf(const Settings& settings, std::size_t frame) {
  return static_cast<double>(frame) / static_cast<double>(settings.frames.size() - 1);
}

Positions positionsOf(const Settings& settings, const Morph& morph, std::size_t frame) {
  return spherical_param::inBetween(morph.result, timeOf(settings, frame));
}

void checkFrames(const Settings& settings, Morph& morph, Console& console) {
  console.begin("verify");
  std::size_t sum = 0;
  for (std::size_t frame = 0; frame < settings.frames.size(); ++frame) {
    spherical_param::Execution execution;
    execution.threads = settings.threads();
    const Positions positions = asWritten(positionsOf(settings, morph, frame));
    morph.self_intersections.push_back(
        spherical_param::findSelfIntersections(positions, morph.result.triangles, execution)
            .size());
    sum += morph.self_intersections.back();
    console.update(timeOf(settings, frame));
  }
  morph.stages.push_back({"verify", console.end(counted(sum, "self-intersection"))});
}

/// Stores all frames, none of them under its name yet.
void store(const Settings& settings, const std::array<MappedCloud, 2>& clouds, Morph& morph,
           std::vector<std::unique_ptr<OutputFile>>& files, Console& console) {
  console.begin("write");
  morph.offset = offsetOf(settings.report, settings.format, *clouds[0].cloud.data);
  PointData vertices;
  const auto count = static_cast<std::size_t>(morph.result.first.cols());
  if (morph.hasColors()) {
    vertices.colors.resize(count);
    vertices.has_alpha = clouds[0].cloud.data->has_alpha || clouds[1].cloud.data->has_alpha;
  }
  for (std::size_t frame = 0; frame < settings.frames.size(); ++frame) {
    const double t = timeOf(settings, frame);
    vertices.points = toPoints(positionsOf(settings, morph, frame));
    for (std::size_t i = 0; i < count; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      if (morph.hasColors()) {
        const Eigen::Vector4d color =
            (1.0 - t) * morph.colors[0].col(column) + t * morph.colors[1].col(column);
        for (std::size_t channel = 0; channel < 4; ++channel) {
          // To the nearest.
          const double value = color[static_cast<Eigen::Index>(channel)] + 0.5;
          vertices.colors[i][channel] =
              static_cast<std::uint8_t>(std::min(std::max(value, 0.0), 255.0));
        }
      }
    }
    files.push_back(std::make_unique<OutputFile>(settings.frames[frame]));
    MeshView mesh(vertices, morph.result.triangles);
    mesh.shiftBy(morph.offset);
    writeMesh(*files.back(), mesh, settings.format, settings.report.encoding);
    files.back()->finish();
    console.update(t);
  }
  morph.stages.push_back({"write", console.end(counted(settings.frames.size(), "frame"))});
}

Json optionsToJson(const Settings& settings) {
  Json json;
  json["frames"] = settings.frames.size();
  json["pairs"] = settings.pairs.empty() ? Json(nullptr) : Json(settings.pairs);
  json["align"] = nameOf(settings.alignment, alignment_names);
  json["connectivity"] = nameOf(settings.connectivity, connectivity_names);
  json["samples"] = settings.connectivity == MorphConnectivity::Resampled ? Json(settings.samples)
                                                                          : Json(nullptr);
  json["fit"] = nameOf(settings.fit, fit_names);
  json["match"] = settings.match;
  json["check"] = settings.check;
  const Json product = productOptionsToJson(settings.product);
  for (const auto& [name, value] : product.items()) {
    json[name] = value;
  }
  addToJson(settings.report, json);
  return json;
}

Json report(const Settings& settings, const std::array<MappedCloud, 2>& clouds,
            const Morph& morph) {
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["inputs"] = {settings.inputs[0], settings.inputs[1]};
  json["output"] = settings.output;
  json["offset"] = morph.offset;
  json["options"] = optionsToJson(settings);
  json["frames"] = settings.frames.size();
  json["files"] = settings.frames;
  json["vertices"] = morph.result.first.cols();
  json["triangles"] = morph.result.triangles.cols();
  json["closed"] = morph.topology.closed;
  json["manifold"] = morph.topology.manifold();
  json["oriented"] = morph.topology.oriented;
  json["components"] = morph.topology.components;
  json["genus"] = morph.topology.genus ? Json(*morph.topology.genus) : Json(nullptr);
  json["rotation"] = Json::array();
  for (Eigen::Index row = 0; row < 3; ++row) {
    json["rotation"].push_back(toJson(Eigen::Vector3d(morph.result.rotation.row(row))));
  }
  json["alignment_error"] = morph.result.alignment_error;
  Json impossible = Json::array();
  for (const LostPair& lost : morph.lost) {
    impossible.push_back({{"line", lost.pair.line},
                          {"points", {lost.pair.points[0], lost.pair.points[1]}},
                          {"reason", lost.reason}});
  }
  json["pairs"] = {{"given", morph.pairs.size()},
                   {"honoured", morph.pairs.size() - morph.lost.size()},
                   {"worst_pair", morph.result.worst_pair},
                   {"impossible", impossible}};
  json["self_intersections"] = settings.check ? Json(morph.self_intersections) : Json(nullptr);
  for (std::size_t side = 0; side < 2; ++side) {
    Json& of_side = json[side == 0 ? "first" : "second"];
    addMapToJson(clouds[side], of_side);
    of_side["stages"] = toJson(clouds[side].cloud.stages);
    of_side["findings"] = toJson(clouds[side].cloud.surface().findings);
  }
  json["stages"] = toJson(morph.stages);
  json["peak_memory"] = peakMemoryToJson();
  return json;
}

void printVerdict(const Settings& settings, const std::array<MappedCloud, 2>& clouds,
                  const Morph& morph, Console& console) {
  for (const MappedCloud& mapped : clouds) {
    printMap(mapped, console);
  }
  console.entry("alignment error", formatted(morph.result.alignment_error, 4));
  console.entry("morph", std::to_string(morph.result.first.cols()) + " vertices, " +
                             std::to_string(morph.result.triangles.cols()) + " triangles");
  console.entry("closed manifold", yesOrNo(morph.topology.isSphere()));
  if (!morph.pairs.empty()) {
    console.entry("pairs", std::to_string(morph.pairs.size() - morph.lost.size()) + " of " +
                               std::to_string(morph.pairs.size()) + " honoured");
  }
  Summary summary;
  for (std::size_t side = 0; side < 2; ++side) {
    const CloudReconstruction& cloud = clouds[side].cloud;
    const std::string of = (side == 0 ? "" : "; ") + settings.inputs[side] + ": ";
    summary.read += of + counted(cloud.data->points.size(), "point");
    summary.verdict +=
        (side == 0 ? "" : " ") + settings.inputs[side] + ": " + cloud.surface().verdict;
    summary.left_out += of + leftOut(cloud);
  }
  summary.made =
      counted(static_cast<std::size_t>(morph.result.first.cols()), "vertex", "vertices") + ", " +
      counted(static_cast<std::size_t>(morph.result.triangles.cols()), "triangle");
  summary.written = {settings.frames.front() +
                     (settings.frames.size() > 1 ? " to " + settings.frames.back() : "")};
  summary.written.front() += notWritten(morph.hasColors(), settings.format, morph.offset);
  addReport(settings.report, summary.written);
  console.summary(summary);
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText)) {
    return;
  }
  const Settings settings = parseSettings(command_line);
  checkFiles(settings);

  Console console(settings.report.detail());
  printParameters(settings, console);

  std::array<MappedCloud, 2> clouds;
  Morph morph;
  for (std::size_t side = 0; side < 2; ++side) {
    mapCloud(settings.inputs[side], settings.product, console, clouds[side]);
  }
  if (!settings.pairs.empty()) {
    morph.pairs = readPointPairs(settings.pairs, clouds[0].cloud, clouds[1].cloud);
  }
  runLibrary("cannot morph", kReportIt, [&] {
    makeMorph(settings, clouds, morph, console);
    if (settings.check) {
      checkFrames(settings, morph, console);
    }
  });
  std::vector<std::unique_ptr<OutputFile>> files;
  store(settings, clouds, morph, files, console);
  publish(
      settings.report, files, console, [&] { return report(settings, clouds, morph); },
      [&] { printVerdict(settings, clouds, morph, console); });
  Findings findings(settings.report.quiet, settings.product.reconstruction.strict, false);
  bool is_usable = true;
  for (std::size_t side = 0; side < 2; ++side) {
    findings.add(settings.inputs[side], findingsOf(clouds[side]));
    is_usable = is_usable && clouds[side].cloud.surface().isUsable();
  }
  for (const LostPair& lost : morph.lost) {
    findings.add("the pair of line " + std::to_string(lost.pair.line) +
                 " is impossible: " + lost.reason);
  }
  findings.print();
  findings.requireSoundness(is_usable);
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
