// pcl_spherical_param_remesh: meshes a point cloud anew, with regular triangles or as many points
// as one likes, and makes and reads geometry images and series of spherical harmonics.

#include "common/cloud_reconstruction.h"
#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/findings.h"
#include "common/geometry_image_file.h"
#include "common/json_report.h"
#include "common/mesh_distance.h"
#include "common/mesh_writer.h"
#include "common/names.h"
#include "common/numbers.h"
#include "common/output_file.h"
#include "common/output_options.h"
#include "common/point_data.h"
#include "common/product_input.h"
#include "common/reconstruction_report.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/version.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using spherical_param::GeometryImage;
using spherical_param::GridSphere;
using spherical_param::Index;
using spherical_param::Positions;
using spherical_param::ResampledMesh;
using spherical_param::SphereGrid;
using spherical_param::SphereLocation;
using spherical_param::SphereSurface;
using spherical_param::SphericalHarmonics;
using spherical_param::SurfaceFit;

const std::string tool_name = "pcl_spherical_param_remesh";

/// Where the points are.
enum class Sampling { Icosahedral, Octahedral, Even };

const Names<Sampling> sampling_names = {
    {"icosahedral", Sampling::Icosahedral},
    {"octahedral", Sampling::Octahedral},
    {"even", Sampling::Even},
};

const Names<SurfaceFit> fit_names = {
    {"linear", SurfaceFit::Linear},
    {"smooth", SurfaceFit::Smooth},
};

/// Of geometry images.
constexpr const char* image_extensions = " .tif .tiff";
constexpr int longest_side = 16385;
constexpr std::int64_t most_even_points = std::int64_t{1} << 24;
constexpr std::int64_t most_vertices = std::int64_t{1} << 28;

const std::vector<OptionInfo> own_options = {
    {"grid", "NAME", "icosahedral or octahedral: meshes; even: a cloud (icosahedral)"},
    {"points", "N", "number of points; for meshes the nearest possible (as the mesh of the cloud)"},
    {"side", "N", "pixels along the sides of a geometry image, odd (as -points says)"},
    {"fit", "NAME", "surface between the points of the cloud: linear or smooth (smooth)"},
    {"sphere", "FILE", "write the points on the sphere with the same triangles"},
    {"harmonics", "FILE", "write coefficients of spherical harmonics of the shape, as JSON"},
    {"series", "", "output the surface of that series"},
    {"degree", "L", "degree of the series, up to 512 (32)"},
};
const ProductDefaults product_defaults(HandlesOnSphere::Refused,
                                       spherical_param::mapOptionsForResampling());
const std::vector<OptionInfo> option_table =
    joined({own_options, productOptions(product_defaults), outputOptions()});

/// What each does, and the words after the tool's name.
const std::vector<std::pair<std::string, std::string>> example_table = {
    {"A mesh of even triangles on an icosahedral grid", "scan.ply even.ply -points 2562"},
    {"A geometry image", "scan.ply geometry.tif"},
    {"A mesh of that image", "geometry.tif mesh.ply"},
};

std::string helpText(bool with_experts) {
  return "Usage: " + tool_name +
         " input output [options]\n\n"
         "Meshes the points of an object without holes through it and resamples its surface.\n"
         "  input:  " +
         extensionsFor(FileUse::ReadCloud) +
         ", or a geometry image: .tif .tiff\n  output: a mesh: " +
         extensionsFor(FileUse::WriteMesh) +
         "\n          with -grid even a cloud: " + extensionsFor(FileUse::WriteCloud) +
         "\n          a geometry image: .tif .tiff"
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
  bool reads_image = false;  ///< a geometry image becomes a mesh; else the input is a cloud
  bool writes_image = false;
  FileFormat output_format = nullptr;         ///< unless it is an image
  Sampling sampling = Sampling::Icosahedral;  ///< octahedral for an image
  std::optional<std::size_t> points;          ///< none: as many as the mesh has vertices
  std::optional<int> side;                    ///< none: as the points say
  SurfaceFit fit = SurfaceFit::Smooth;
  std::string sphere;  ///< empty: not wanted
  FileFormat sphere_format = nullptr;
  std::string harmonics;  ///< empty: not wanted
  bool series = false;
  int degree = 32;
  ProductSettings product;
  OutputSettings report;

  bool makesCloud() const { return !reads_image && sampling == Sampling::Even; }
  /// Whether vertices are slid along the surface, so that triangles do not intersect.
  bool slides() const { return !reads_image && !series && sampling != Sampling::Even; }
  bool needsHarmonics() const { return series || !harmonics.empty(); }
  int threads() const { return product.map.threads; }
};

void refuse(const CommandLine& command_line, const std::string& option, const std::string& other,
            const std::string& wanted) {
  if (command_line.has(option)) {
    throw UsageError("option -" + option + " does nothing with " + other,
                     "leave -" + option + " out, or give " + wanted);
  }
}

/// Refuses options that would change nothing.
void checkCombination(const CommandLine& command_line, const Settings& settings) {
  if (settings.reads_image) {
    for (const OptionInfo& option : option_table) {
      const bool has_a_say = option.name == "sphere" || option.name == "json" ||
                             option.name == "ascii" || option.name == "offset" ||
                             option.name == "quiet" || option.name == "threads" ||
                             option.name == "strict";
      if (!has_a_say) {
        refuse(command_line, option.name, "a geometry image as input", "a cloud");
      }
    }
    return;
  }
  if (settings.writes_image) {
    const std::string image = "a geometry image as output";
    for (const char* option : {"grid", "sphere", "series", "offset", "ascii"}) {
      refuse(command_line, option, image, "a mesh as output");
    }
    if (command_line.has("points")) {
      refuse(command_line, "side", "-points", "-side alone");
    }
  } else {
    refuse(command_line, "side", "an output other than a geometry image", "one ending in .tif");
  }
  if (settings.sampling == Sampling::Even) {
    for (const char* option : {"sphere", "series"}) {
      refuse(command_line, option, "-grid even", "-grid icosahedral");
    }
  }
  if (!settings.needsHarmonics()) {
    refuse(command_line, "degree", "neither -harmonics nor -series", "-harmonics FILE");
  }
}

std::string nonempty(const CommandLine& command_line, const std::string& option) {
  std::string value = command_line.value(option, "");
  if (command_line.has(option) && value.empty()) {
    throw UsageError("option -" + option + ": the name of the file is empty", "give a file");
  }
  return value;
}

void parseFiles(const CommandLine& command_line, Settings& settings) {
  std::tie(settings.input, settings.output) = inputAndOutput(command_line, tool_name);
  settings.reads_image = isGeometryImageFile(settings.input);
  settings.writes_image = isGeometryImageFile(settings.output);
  if (!settings.reads_image) {
    requireFormat(settings.input, FileUse::ReadCloud, image_extensions);
  } else if (settings.writes_image) {
    throw UsageError("a geometry image can only be written as a mesh",
                     "give an output with one of " + extensionsFor(FileUse::WriteMesh));
  }
  if (!settings.writes_image) {
    settings.output_format = requireFormat(
        settings.output, settings.makesCloud() ? FileUse::WriteCloud : FileUse::WriteMesh,
        image_extensions);
  }
  settings.sphere = nonempty(command_line, "sphere");
  if (command_line.has("sphere")) {
    settings.sphere_format = requireFormat(settings.sphere, FileUse::WriteMesh);
  }
  settings.harmonics = nonempty(command_line, "harmonics");
}

Settings parseSettings(const CommandLine& command_line) {
  Settings settings;
  if (command_line.has("grid")) {
    settings.sampling = parseName("grid", command_line.value("grid", ""), sampling_names);
  }
  parseFiles(command_line, settings);
  if (command_line.has("points")) {
    const std::int64_t most = settings.makesCloud() ? most_even_points : most_vertices;
    settings.points = static_cast<std::size_t>(
        parseInteger("points", command_line.value("points", ""), {4, most}));
  }
  if (command_line.has("side")) {
    settings.side =
        static_cast<int>(parseInteger("side", command_line.value("side", ""), {3, longest_side}));
    if (*settings.side % 2 == 0) {
      throw UsageError("option -side: " + std::to_string(*settings.side) + " is even",
                       "give an odd number such as " + std::to_string(*settings.side + 1));
    }
  }
  if (command_line.has("fit")) {
    settings.fit = parseName("fit", command_line.value("fit", ""), fit_names);
  }
  settings.series = command_line.has("series");
  if (command_line.has("degree")) {
    settings.degree =
        static_cast<int>(parseInteger("degree", command_line.value("degree", ""), {0, 512}));
  }
  settings.report = parseOutputOptions(command_line);
  settings.product = parseProductOptions(command_line, product_defaults);
  checkCombination(command_line, settings);
  if (settings.writes_image) {
    settings.sampling = Sampling::Octahedral;
  }
  return settings;
}

/// The files that will be written, the standard output not among them.
std::vector<std::string> outputsOf(const Settings& settings) {
  std::vector<std::string> outputs = {settings.output};
  for (const std::string& file : {settings.sphere, settings.harmonics}) {
    if (!file.empty()) {
      outputs.push_back(file);
    }
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
  if (!settings.harmonics.empty()) {
    console.entry("harmonics", oneLine(settings.harmonics));
  }
  if (!settings.report.json.empty()) {
    console.entry("json", oneLine(settings.report.json));
  }
  if (settings.reads_image) {
    return;
  }
  if (!settings.writes_image) {
    console.entry("grid", nameOf(settings.sampling, sampling_names));
  }
  console.entry("fit", nameOf(settings.fit, fit_names));
  if (settings.needsHarmonics()) {
    console.entry("degree", std::to_string(settings.degree));
  }
  printProductOptions(settings.product, console);
}

Json optionsToJson(const Settings& settings) {
  const auto unless = [](bool idle, const Json& value) { return idle ? Json(nullptr) : value; };
  const bool from_image = settings.reads_image;
  Json json;
  json["grid"] =
      unless(from_image || settings.writes_image, nameOf(settings.sampling, sampling_names));
  json["points"] = settings.points ? Json(*settings.points) : Json(nullptr);
  json["side"] = settings.side ? Json(*settings.side) : Json(nullptr);
  json["fit"] = unless(from_image, nameOf(settings.fit, fit_names));
  json["sphere"] = unless(settings.sphere.empty(), settings.sphere);
  json["harmonics"] = unless(settings.harmonics.empty(), settings.harmonics);
  json["series"] = settings.series;
  json["degree"] = unless(!settings.needsHarmonics(), settings.degree);
  if (from_image) {
    json["strict"] = settings.product.reconstruction.strict;
    json["threads"] = settings.threads();
  } else {
    const Json product = productOptionsToJson(settings.product);
    for (const auto& [name, value] : product.items()) {
      json[name] = value;
    }
  }
  addToJson(settings.report, json);
  return json;
}

/// What is written, with its quality.
struct Output {
  ResampledMesh mesh;         ///< in single precision, as it is written; a cloud has no triangles
  std::vector<Color> colors;  ///< of its points, or none
  GeometryImage image;        ///< if one is read or written
  int frequency = 0;          ///< of the grid
  std::optional<SphericalHarmonics> harmonics;
  std::optional<spherical_param::UntanglingReport> untangling;
  std::size_t flipped_edges = 0;  ///< after it
  spherical_param::MeshTopology topology;
  spherical_param::MeshMeasures measures;
  std::vector<std::array<Index, 2>> self_intersections;
  std::optional<DistanceStatistics> distance;  ///< of the vertices of the cloud's mesh
  std::vector<spherical_param::StageTime> stages;
  Point offset{};  ///< of the coordinates that are written

  std::size_t pointCount() const { return static_cast<std::size_t>(mesh.points.cols()); }
  bool isCloud() const { return mesh.triangles.cols() == 0; }
};

/// The colours of places in a mesh, between those of the corners of the triangles.
std::vector<Color> interpolatedColors(const MappedCloud& mapped,
                                      const std::vector<SphereLocation>& locations) {
  std::vector<Color> colors;
  if (mapped.colors.empty()) {
    return colors;
  }
  colors.reserve(locations.size());
  for (const SphereLocation& location : locations) {
    Eigen::Vector4d sum = Eigen::Vector4d::Constant(0.5);  // to round to the nearest
    for (Eigen::Index corner = 0; corner < 3; ++corner) {
      const Index vertex = mapped.mesh.triangles(corner, location.triangle);
      const Color& color = mapped.colors[static_cast<std::size_t>(vertex)];
      for (std::size_t channel = 0; channel < 4; ++channel) {
        sum[static_cast<Eigen::Index>(channel)] += location.weights[corner] * color[channel];
      }
    }
    Color color{};
    for (std::size_t channel = 0; channel < 4; ++channel) {
      const double value = sum[static_cast<Eigen::Index>(channel)];
      color[channel] = static_cast<std::uint8_t>(std::min(std::max(value, 0.0), 255.0));
    }
    colors.push_back(color);
  }
  return colors;
}

GridSphere gridOf(const Settings& settings, std::size_t points, const SphereSurface& surface) {
  const SphereGrid kind =
      settings.sampling == Sampling::Icosahedral ? SphereGrid::Icosahedral : SphereGrid::Octahedral;
  int frequency = spherical_param::gridFrequency(kind, points, surface);
  if (settings.writes_image) {
    frequency = (settings.side ? *settings.side : std::min(2 * frequency + 1, longest_side)) / 2;
  }
  return spherical_param::makeGridSphere(kind, frequency);
}

/// Samples the surface as the user wants it.
void resample(const Settings& settings, const MappedCloud& mapped, const SphereSurface& surface,
              Output& output) {
  const std::size_t wanted =
      settings.points ? *settings.points : static_cast<std::size_t>(mapped.mesh.points.cols());
  if (settings.makesCloud()) {
    spherical_param::SurfacePoints points = spherical_param::sampleEvenly(
        surface, wanted, settings.product.reconstruction.options.seed);
    output.mesh.points = std::move(points.points);
    output.mesh.normals = std::move(points.normals);
    output.colors = interpolatedColors(mapped, points.locations);
  } else {
    const GridSphere grid = gridOf(settings, wanted, surface);
    output.frequency = grid.frequency;
    output.mesh = spherical_param::resampleSurface(surface, grid);
    if (settings.series) {
      output.mesh.points = spherical_param::evaluateSphericalHarmonics(
          *output.harmonics, output.mesh.directions, settings.threads());
      output.mesh.normals.resize(3, 0);
    }
  }
}

/// Looks at the mesh as it will be in the file.
void verify(const Settings& settings, const MappedCloud& mapped, Output& output, Console& console) {
  console.begin("verify");
  const ResampledMesh& mesh = output.mesh;
  if (!output.isCloud()) {
    output.topology =
        spherical_param::checkTopology(mesh.triangles, output.pointCount(), settings.threads());
    output.measures = spherical_param::measureMesh(mesh.points, mesh.triangles, settings.threads());
    spherical_param::Execution execution;
    execution.threads = settings.threads();
    execution.progress = [&console](const spherical_param::Progress& progress) {
      console.update(0.5 * progress.fraction);
      return true;
    };
    output.self_intersections =
        spherical_param::findSelfIntersections(mesh.points, mesh.triangles, execution);
    if (!settings.reads_image && output.topology.closed) {
      const SphereSurface surface(mesh.points, mesh.triangles, mesh.directions,
                                  {SurfaceFit::Linear, settings.threads()});
      output.distance = distanceFromMesh(mapped.mesh.points, mapped.map.sphere, surface);
    }
  }
  output.stages.push_back({"verify", console.end("")});
}

void makeFromCloud(const Settings& settings, MappedCloud& mapped, Output& output,
                   Console& console) {
  mapCloud(settings.input, settings.product, console, mapped);
  console.begin("surface");
  const SphereSurface surface(mapped.mesh.points, mapped.mesh.triangles, mapped.map.sphere,
                              {settings.fit, settings.threads(), mapped.map.caps});
  output.stages = mapped.cloud.stages;
  output.stages.push_back({"surface", console.end("")});
  if (settings.writes_image && surface.isOpen()) {
    throw Failure("cannot write " + inQuotes(settings.output) +
                      ": a geometry image has no openings, but the surface has some",
                  "give -surface closed, or the name of a mesh as output");
  }
  if (settings.needsHarmonics()) {
    console.begin("harmonics");
    output.harmonics =
        spherical_param::computeSphericalHarmonics(surface, settings.degree, settings.threads());
    output.stages.push_back({"harmonics", console.end("")});
  }
  console.begin("resample");
  resample(settings, mapped, surface, output);
  output.stages.push_back(
      {"resample", console.end(std::to_string(output.pointCount()) + " points")});
  if (settings.slides()) {
    console.begin("untangle");
    output.untangling = spherical_param::untangle(surface, output.mesh, settings.threads());
    // Flips may remove what sliding leaves; the edges of an image are given.
    if (output.untangling->after > 0 && !settings.writes_image) {
      output.flipped_edges =
          spherical_param::removeIntersections(output.mesh, settings.threads()).flips;
    }
    output.stages.push_back(
        {"untangle", console.end(std::to_string(output.untangling->moved) + " points slid")});
  }
  if (!output.isCloud() && !mapped.colors.empty()) {
    output.colors = interpolatedColors(mapped, surface.evaluate(output.mesh.directions).locations);
  }
  output.mesh.points = asWritten(output.mesh.points);
  if (settings.writes_image) {
    output.image = spherical_param::geometryImageOfMesh(output.mesh);
  }
}

void makeFromImage(const Settings& settings, Output& output, Console& console) {
  console.begin("read");
  output.image =
      readGeometryImage(settings.input, [&console](double fraction) { console.update(fraction); });
  const std::string size = std::to_string(output.image.side);
  output.stages.push_back({"read", console.end(size + " x " + size + " pixels")});
  output.frequency = (output.image.side - 1) / 2;
  console.begin("resample");
  output.mesh = spherical_param::meshOfGeometryImage(output.image);
  output.mesh.points = asWritten(output.mesh.points);
  output.stages.push_back(
      {"resample", console.end(std::to_string(output.pointCount()) + " points")});
}

std::vector<spherical_param::Finding> findingsOf(const Settings& settings,
                                                 const MappedCloud& mapped, const Output& output) {
  std::vector<spherical_param::Finding> findings;
  if (!settings.reads_image) {
    findings = findingsOf(mapped);
  }
  if (!output.self_intersections.empty()) {
    findings.push_back({"the output has self-intersections" +
                            std::string(settings.reads_image || settings.series
                                            ? ""
                                            : ": try more -points, or a smaller -area-weight"),
                        "", "", true});
  }
  return findings;
}

std::size_t intersectingTriangles(const Output& output) {
  return spherical_param::countTriangles(output.self_intersections);
}

/// Whether the output is sound, and what the mesh of the cloud leaves open, fills, cuts or joins.
std::string verdictOf(const Output& output, const MappedCloud& mapped) {
  if (output.isCloud()) {
    return "Points spread evenly over the surface.";
  }
  if (output.self_intersections.empty()) {
    const bool is_of_sound_mesh =
        !mapped.cloud.result.surfaces.empty() && mapped.cloud.surface().intersecting_triangles == 0;
    return is_of_sound_mesh ? mapped.cloud.surface().verdict : "A sound mesh.";
  }
  return "The mesh has faults: " + grouped(intersectingTriangles(output)) + " of " +
         counted(static_cast<std::size_t>(output.mesh.triangles.cols()), "triangle") +
         " intersect.";
}

/// The series, one line for each coefficient.
std::string harmonicsText(const Settings& settings, const SphericalHarmonics& harmonics) {
  const auto dump = [](const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  };
  std::string text = "{\n";
  const auto add = [&](const std::string& name, const Json& value) {
    text += "  \"" + name + "\": " + dump(value) + ",\n";
  };
  add("version", SPHERICAL_PARAM_VERSION);
  add("input", settings.input);
  add("degree", harmonics.degree);
  add("convention",
      "position(u) = sum over l = 0 ... degree, m = -l ... l of xyz Y_lm(u), u a unit vector. Real "
      "spherical harmonics, orthonormal on the unit sphere (the integral of Y_lm Y_lm is 1), "
      "without the phase (-1)^m; m > 0 with cos(m phi), m < 0 with sin(|m| phi); phi is the "
      "longitude, from x to y, and z = cos(theta)");
  add("rms_residual", harmonics.rms_residual);
  text += "  \"coefficients\": [\n";
  for (int l = 0; l <= harmonics.degree; ++l) {
    for (int m = -l; m <= l; ++m) {
      const Json line = {
          {"l", l},
          {"m", m},
          {"xyz", toJson(Eigen::Vector3d(harmonics.coefficients.col(l * l + l + m)))}};
      text += "    " + dump(line) + (m == l && l == harmonics.degree ? "\n" : ",\n");
    }
  }
  return text + "  ]\n}\n";
}

Json report(const Settings& settings, const MappedCloud& mapped, const Output& output) {
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = settings.input;
  json["output"] = settings.output;
  json["offset"] = output.offset;
  json["options"] = optionsToJson(settings);
  if (!settings.reads_image) {
    addMapToJson(mapped, json);
  }
  const bool is_cloud = output.isCloud();
  const auto unless = [](bool idle, const Json& value) { return idle ? Json(nullptr) : value; };
  json["grid"] = {{"kind", nameOf(settings.reads_image ? Sampling::Octahedral : settings.sampling,
                                  sampling_names)},
                  {"frequency", unless(is_cloud, output.frequency)},
                  {"side", unless(output.image.side == 0, output.image.side)}};
  json["points"] = output.pointCount();
  json["triangles"] = output.mesh.triangles.cols();
  json["closed"] = unless(is_cloud, output.topology.closed);
  json["manifold"] = unless(is_cloud, output.topology.manifold());
  json["oriented"] = unless(is_cloud, output.topology.oriented);
  json["components"] = unless(is_cloud, output.topology.components);
  json["genus"] = output.topology.genus ? Json(*output.topology.genus) : Json(nullptr);
  json["volume"] = unless(is_cloud, output.measures.volume);
  json["area"] = unless(is_cloud, output.measures.area);
  json["self_intersections"] = unless(is_cloud, output.self_intersections.size());
  json["untangling"] = nullptr;
  if (output.untangling) {
    json["untangling"] = {{"self_intersections_before", output.untangling->before},
                          {"rounds", output.untangling->rounds},
                          {"moved", output.untangling->moved},
                          {"flipped_edges", output.flipped_edges}};
  }
  json["distance"] = nullptr;
  if (output.distance) {
    json["distance"] = {{"mean", output.distance->mean},
                        {"rms", output.distance->rms},
                        {"max", output.distance->max}};
  }
  json["harmonics"] = nullptr;
  if (output.harmonics) {
    json["harmonics"] = {{"degree", output.harmonics->degree},
                         {"rms_residual", output.harmonics->rms_residual}};
  }
  json["stages"] = toJson(output.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
  json["findings"] = toJson(findingsOf(settings, mapped, output));
  return json;
}

void printVerdict(const Settings& settings, const MappedCloud& mapped, const Output& output,
                  Console& console) {
  if (!settings.reads_image) {
    printMap(mapped, console);
  }
  if (output.image.side > 0) {
    const std::string side = std::to_string(output.image.side);
    console.entry("geometry image", side + " x " + side + " pixels");
  }
  const bool is_nearest = settings.points && *settings.points != output.pointCount();
  console.entry("points", std::to_string(output.pointCount()) +
                              (is_nearest ? " (the nearest possible to " +
                                                std::to_string(*settings.points) + ")"
                                          : ""));
  if (output.harmonics) {
    console.entry("harmonics", "degree " + std::to_string(output.harmonics->degree) +
                                   ", residual " + formatted(output.harmonics->rms_residual, 4) +
                                   " (root mean square)");
  }
  if (!output.isCloud()) {
    console.entry("triangles", std::to_string(output.mesh.triangles.cols()));
    console.entry("closed", yesOrNo(output.topology.closed));
    console.entry("manifold", yesOrNo(output.topology.manifold()));
    console.entry("oriented", yesOrNo(output.topology.oriented));
    console.entry("genus",
                  output.topology.genus ? std::to_string(*output.topology.genus) : "undefined");
    const bool were_more =
        output.untangling && output.untangling->before > output.self_intersections.size();
    console.entry("self-intersections",
                  std::to_string(output.self_intersections.size()) +
                      (were_more ? " (" + std::to_string(output.untangling->before) + " before " +
                                       std::to_string(output.untangling->moved) +
                                       " points were slid along the surface)"
                                 : ""));
    console.entry("volume", formatted(output.measures.volume, 6));
    console.entry("area", formatted(output.measures.area, 6));
  }
  if (output.distance) {
    console.entry("distance", formatted(output.distance->mean, 4) + ", " +
                                  formatted(output.distance->rms, 4) + ", " +
                                  formatted(output.distance->max, 4) +
                                  " (mean, RMS, max; of the cloud's mesh, at its vertices)");
  }
  const CloudReconstruction& cloud = mapped.cloud;
  Summary summary;
  summary.read = settings.input;
  summary.verdict = verdictOf(output, mapped);
  summary.made = counted(output.pointCount(), "vertex", "vertices") + ", " +
                 counted(static_cast<std::size_t>(output.mesh.triangles.cols()), "triangle");
  summary.left_out = "nothing";
  if (!settings.reads_image) {
    summary.read += ", " + counted(cloud.data->points.size(), "point");
    summary.left_out = leftOut(cloud);
  }
  summary.written = outputsOf(settings);
  summary.written.front() +=
      notWritten(!output.colors.empty(), settings.output_format, output.offset);
  console.summary(summary);
}

PointData toVertices(const Output& output, const MappedCloud& mapped) {
  PointData vertices;
  vertices.points = toPoints(output.mesh.points);
  vertices.normals = toNormals(output.mesh.normals);
  vertices.colors = output.colors;
  vertices.has_alpha = mapped.cloud.data->has_alpha;
  return vertices;
}

/// Stores all files but the report, none of them under its name yet.
std::vector<std::unique_ptr<OutputFile>> store(const Settings& settings, const MappedCloud& mapped,
                                               Output& output, Console& console) {
  console.begin("write");
  const double fraction_of_file = settings.sphere.empty() ? 1.0 : 0.5;
  const auto update = [&](double fraction) { console.update(fraction_of_file * fraction); };
  std::vector<std::unique_ptr<OutputFile>> files;
  files.push_back(std::make_unique<OutputFile>(settings.output));
  if (settings.writes_image) {
    writeGeometryImage(*files.back(), output.image, update);
  } else {
    const PointData vertices = toVertices(output, mapped);
    MeshView mesh(vertices, output.mesh.triangles);
    output.offset = offsetOf(settings.report, settings.output_format, vertices);
    mesh.shiftBy(output.offset);
    writeMesh(*files.back(), mesh, settings.output_format, settings.report.encoding, update);
    if (!settings.sphere.empty()) {
      files.push_back(std::make_unique<OutputFile>(settings.sphere));
      MeshView sphere = mesh;
      sphere.leaveOutNormals();
      sphere.shiftBy({});
      sphere.moveTo(output.mesh.directions);
      writeMesh(*files.back(), sphere, settings.sphere_format, settings.report.encoding,
                [&](double fraction) { console.update(0.5 + 0.5 * fraction); });
    }
  }
  if (!settings.harmonics.empty()) {
    files.push_back(std::make_unique<OutputFile>(settings.harmonics));
    files.back()->write(harmonicsText(settings, *output.harmonics));
  }
  for (const auto& file : files) {
    file->finish();
  }
  output.stages.push_back({"write", console.end("")});
  return files;
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText)) {
    return;
  }
  const Settings settings = parseSettings(command_line);
  checkOutputs({settings.input}, outputsOf(settings));

  Console console(settings.report.detail());
  printParameters(settings, console);
  MappedCloud mapped;
  Output output;
  runLibrary("cannot remesh " + inQuotes(settings.input), kReportIt, [&] {
    if (settings.reads_image) {
      makeFromImage(settings, output, console);
    } else {
      makeFromCloud(settings, mapped, output, console);
    }
    verify(settings, mapped, output, console);
  });
  std::vector<std::unique_ptr<OutputFile>> files = store(settings, mapped, output, console);
  publish(
      settings.report, files, console, [&] { return report(settings, mapped, output); },
      [&] { printVerdict(settings, mapped, output, console); });
  Findings findings(settings.report.quiet, settings.product.reconstruction.strict, false);
  findings.add("", findingsOf(settings, mapped, output));
  findings.print();
  findings.requireSoundness(100 * intersectingTriangles(output) <=
                            static_cast<std::size_t>(output.mesh.triangles.cols()));
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
