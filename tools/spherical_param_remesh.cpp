// pcl_spherical_param_remesh: meshes a point cloud anew, with regular triangles and any number of
// points, and makes series of spherical harmonics.

#include "common/errors.h"
#include "common/file_formats.h"
#include "common/mesh_distance.h"
#include "common/png_image.h"
#include "common/product_input.h"
#include "common/reconstruction_report.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/version.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param;
using namespace spherical_param::tools;

const Names<SphereGrid> grid_names = {
    {"icosahedral", SphereGrid::Icosahedral},
    {"octahedral", SphereGrid::Octahedral},
};

constexpr double most_vertices = 1 << 28;

ToolText toolText() {
  return {"pcl_spherical_param_remesh",
          "input output",
          "Meshes the points of an object without holes through it and resamples its surface.\n"
          "  input:  " +
              extensionsFor(FileUse::ReadCloud) +
              "\n  output: " + extensionsFor(FileUse::WriteMesh) + "\n",
          {{"A mesh of even triangles on an icosahedral grid", "scan.ply even.ply -points 2562"},
           {"A geometry image: a square of positions",
            "scan.ply mesh.ply -grid octahedral -image image.png"},
           {"The shape as spherical harmonics, and their surface",
            "scan.ply smooth.ply -series -degree 16 -harmonics shape.json"}}};
}

/// What the user asked for.
struct Settings {
  std::string input;
  std::string output;
  SphereGrid grid = SphereGrid::Icosahedral;
  std::optional<std::size_t> points;  ///< none: as many as the mesh has vertices
  SurfaceFit fit = SurfaceFit::Smooth;
  std::string sphere;     ///< empty: not wanted
  std::string image;      ///< empty: not wanted
  std::string harmonics;  ///< empty: not wanted
  bool series = false;
  int degree = 32;
  ProductSettings product{TopologyMode::Sphere, mapOptionsForResampling()};
  OutputSettings report;

  bool needsHarmonics() const { return series || !harmonics.empty(); }
  int threads() const { return product.map.threads; }
};

OptionTable optionsOf(Settings& settings) {
  return joined(
      {{choiceOption("grid", "of the points", settings.grid, grid_names),
        numberOption("points",
                     "number of points, the nearest possible; unset: as the mesh of the cloud",
                     settings.points, 4, most_vertices),
        choiceOption("fit", "surface between the points of the cloud", settings.fit, fit_names),
        fileOption("sphere", "write the points on the sphere with the same triangles",
                   settings.sphere),
        fileOption("image", "write the octahedral grid as geometry image, 16-bit .png",
                   settings.image),
        fileOption("harmonics", "write coefficients of spherical harmonics of the shape, as JSON",
                   settings.harmonics),
        flagOption("series", "output the surface of that series", settings.series),
        usedIf([&] { return settings.needsHarmonics(); },
               numberOption("degree", "degree of the series", settings.degree, 0, 512))},
       productOptions(settings.product),
       outputOptions(settings.report)});
}

void parse(const CommandLine& command_line, Settings& settings) {
  const std::vector<std::string> files = filesOf(command_line, toolText());
  settings.input = files[0];
  settings.output = files[1];
  requireFormat(settings.input, FileUse::ReadCloud);
  requireFormat(settings.output, FileUse::WriteMesh);
  if (!settings.sphere.empty()) {
    requireFormat(settings.sphere, FileUse::WriteMesh);
  }
  if (!settings.image.empty()) {
    requirePngName(settings.image);
  }
  if (settings.grid != SphereGrid::Octahedral) {
    command_line.refuse({"image"}, "-grid icosahedral", "-grid octahedral");
  }
  parseProductOptions(command_line, settings.product);
  if (!settings.needsHarmonics()) {
    command_line.refuse({"degree"}, "neither -harmonics nor -series", "-harmonics FILE");
  }
}

/// The files that will be written, the standard output not among them.
std::vector<std::string> outputsOf(const Settings& settings) {
  return outputsOf(settings.report,
                   {settings.output, settings.sphere, settings.image, settings.harmonics});
}

/// What is written, with its quality.
struct Output {
  ResampledMesh mesh;         ///< in single precision, as it is written
  std::vector<Color> colors;  ///< of its points, or none
  int frequency = 0;          ///< of the grid
  std::optional<GeometryImage> image;
  std::optional<SphericalHarmonics> harmonics;
  std::optional<UntanglingReport> untangling;
  MeshTopology topology;
  MeshMeasures measures;
  std::size_t self_intersections = 0;  ///< pairs of triangles
  std::size_t intersecting_triangles = 0;
  std::optional<DistanceStatistics> distance;  ///< of the vertices of the cloud's mesh
  std::vector<StageTime> stages;
  Point offset{};  ///< of the coordinates that are written

  std::size_t pointCount() const { return static_cast<std::size_t>(mesh.points.cols()); }
};

/// Samples the surface as the user wants it.
void resample(const Settings& settings, const MappedCloud& mapped, const SphereSurface& surface,
              Output& output) {
  const std::size_t wanted =
      settings.points ? *settings.points : static_cast<std::size_t>(mapped.points().cols());
  const GridSphere grid =
      makeGridSphere(settings.grid, gridFrequency(settings.grid, wanted, surface));
  output.frequency = grid.frequency;
  output.mesh = resampleSurface(surface, grid);
  if (settings.series) {
    output.mesh.points =
        evaluateSphericalHarmonics(*output.harmonics, output.mesh.directions, settings.threads());
    output.mesh.normals.resize(3, 0);
  }
}

/// Looks at the mesh as it will be in the file.
void verify(const Settings& settings, const MappedCloud& mapped, Output& output, Console& console) {
  console.begin("verify");
  const ResampledMesh& mesh = output.mesh;
  output.topology = checkTopology(mesh.triangles, output.pointCount(), settings.threads());
  output.measures = measureMesh(mesh.points, mesh.triangles, settings.threads());
  Execution execution;
  execution.threads = settings.threads();
  execution.progress = console.progress(0.5);
  const auto pairs = findSelfIntersections(mesh.points, mesh.triangles, execution);
  output.self_intersections = pairs.size();
  output.intersecting_triangles = countTriangles(pairs);
  if (output.topology.closed) {
    const SphereSurface surface(mesh.points, mesh.triangles, mesh.directions,
                                {SurfaceFit::Linear, settings.threads()});
    output.distance = distanceFromMesh(mapped.points(), mapped.map.sphere, surface);
  }
  output.stages.push_back(console.end());
}

void makeFromCloud(const Settings& settings, MappedCloud& mapped, Output& output,
                   Console& console) {
  mapCloud(settings.input, settings.product, console, mapped);
  console.begin("surface");
  const SphereSurface surface = surfaceOf(mapped, settings.fit, settings.threads());
  output.stages = mapped.cloud.stages;
  output.stages.push_back(console.end());
  if (!settings.image.empty() && surface.isOpen()) {
    throw Failure("cannot write " + inQuotes(settings.image) +
                      ": a geometry image has no openings, but the surface has some",
                  "give -surface closed, or leave out -image");
  }
  if (settings.needsHarmonics()) {
    console.begin("harmonics");
    output.harmonics = computeSphericalHarmonics(surface, settings.degree, settings.threads());
    output.stages.push_back(console.end());
  }
  console.begin("resample");
  resample(settings, mapped, surface, output);
  output.stages.push_back(console.end(std::to_string(output.pointCount()) + " points"));
  if (!settings.series) {
    console.begin("untangle");
    output.untangling = untangle(surface, output.mesh, settings.threads());
    output.stages.push_back(console.end(std::to_string(output.untangling->moved) + " points slid"));
  }
  if (!mapped.colors.empty()) {
    output.colors =
        truncated(colorsAt(mapped, surface.evaluate(output.mesh.directions).locations, 0.5));
  }
  output.mesh.points = asWritten(output.mesh.points);
  if (!settings.image.empty()) {
    output.image = geometryImageOfMesh(output.mesh);
  }
}

Json imageToJson(const GeometryImage& image) {
  const Eigen::AlignedBox3d box = boxOf(image);
  return {{"side", image.side}, {"low", toJson(box.min())}, {"high", toJson(box.max())}};
}

std::vector<Finding> findingsOf(const Settings& settings, const MappedCloud& mapped,
                                const Output& output) {
  std::vector<Finding> findings = mapped.cloud.result.findings;
  if (output.self_intersections > 0) {
    findings.push_back(
        {"the output has self-intersections" +
             std::string(settings.series ? "" : ": try more -points, or a smaller -area-weight"),
         "", "", true});
  }
  return findings;
}

/// Whether the output is sound, and what the mesh of the cloud leaves open, fills, cuts or joins.
std::string verdictOf(const Output& output, const MappedCloud& mapped) {
  if (output.self_intersections == 0) {
    return mapped.cloud.surface().intersecting_triangles == 0 ? mapped.cloud.surface().verdict
                                                              : "A sound mesh.";
  }
  return "The mesh has faults: " + grouped(output.intersecting_triangles) + " of " +
         counted(static_cast<std::size_t>(output.mesh.triangles.cols()), "triangle") +
         " intersect.";
}

Json harmonicsToJson(const Settings& settings, const SphericalHarmonics& harmonics) {
  Json json = {
      {"version", SPHERICAL_PARAM_VERSION},
      {"input", settings.input},
      {"degree", harmonics.degree},
      {"convention",
       "position(u) = sum over l = 0 ... degree, m = -l ... l of xyz Y_lm(u), u a unit vector. "
       "Real spherical harmonics, orthonormal on the unit sphere (the integral of Y_lm Y_lm is 1), "
       "without the phase (-1)^m; m > 0 with cos(m phi), m < 0 with sin(|m| phi); phi is the "
       "longitude, from x to y, and z = cos(theta)"},
      {"rms_residual", harmonics.rms_residual}};
  for (int l = 0; l <= harmonics.degree; ++l) {
    for (int m = -l; m <= l; ++m) {
      const Eigen::Vector3d xyz = harmonics.coefficients.col(l * l + l + m);
      json["coefficients"].push_back({{"l", l}, {"m", m}, {"xyz", toJson(xyz)}});
    }
  }
  return json;
}

Json report(Settings settings, const MappedCloud& mapped, const Output& output) {
  Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = settings.input;
  json["output"] = settings.output;
  json["offset"] = output.offset;
  json["options"] = optionsToJson(optionsOf(settings));
  addMapToJson(mapped, json);
  json["grid"] = {{"kind", nameOf(settings.grid, grid_names)}, {"frequency", output.frequency}};
  json["image"] = output.image ? imageToJson(*output.image) : Json();
  json["points"] = output.pointCount();
  json["triangles"] = output.mesh.triangles.cols();
  addToJson(output.topology, json);
  json["volume"] = output.measures.volume;
  json["area"] = output.measures.area;
  json["self_intersections"] = output.self_intersections;
  const auto& untangling = output.untangling;
  json["untangling"] = !untangling ? Json()
                                   : Json({{"self_intersections_before", untangling->before},
                                           {"rounds", untangling->rounds},
                                           {"moved", untangling->moved},
                                           {"flipped_edges", untangling->flips}});
  const auto& distance = output.distance;
  json["distance"] =
      !distance ? Json()
                : Json({{"mean", distance->mean}, {"rms", distance->rms}, {"max", distance->max}});
  const auto& harmonics = output.harmonics;
  json["harmonics"] =
      !harmonics ? Json()
                 : Json({{"degree", harmonics->degree}, {"rms_residual", harmonics->rms_residual}});
  json["stages"] = toJson(output.stages);
  json["peak_memory_bytes"] = peakMemoryToJson();
  json["findings"] = toJson(findingsOf(settings, mapped, output));
  return json;
}

Summary summaryOf(const Settings& settings, const MappedCloud& mapped, const Output& output) {
  Summary summary = summaryOf(settings.input, mapped.cloud);
  summary.verdict = verdictOf(output, mapped);
  summary.made = meshSize(output.pointCount(), output.mesh.triangles.cols());
  summary.written = outputsOf(settings);
  summary.written.front() += notWritten(!output.colors.empty(), settings.output, output.offset);
  return summary;
}

/// Stores all files but the report, none of them under its name yet.
void store(const Settings& settings, const MappedCloud& mapped, Output& output, ToolRun& run) {
  Console& console = run.console;
  console.begin("write");
  PointData vertices;
  vertices.points = toPoints(output.mesh.points);
  vertices.normals = toNormals(output.mesh.normals);
  vertices.colors = output.colors;
  vertices.has_alpha = mapped.cloud.data->has_alpha;
  MeshView mesh(vertices, output.mesh.triangles);
  output.offset = settings.report.offsetOf(settings.output, vertices);
  mesh.shiftBy(output.offset);
  run.write(settings.output, mesh, console.updates(0.0, settings.sphere.empty() ? 1.0 : 0.5));
  if (!settings.sphere.empty()) {
    MeshView sphere = mesh;
    sphere.leaveOutNormals();
    sphere.shiftBy({});
    sphere.moveTo(output.mesh.directions);
    run.write(settings.sphere, sphere, console.updates(0.5, 1.0));
  }
  if (output.image) {
    run.open(settings.image).write(encodePng(*output.image));
  }
  if (!settings.harmonics.empty()) {
    run.open(settings.harmonics).write(textOf(harmonicsToJson(settings, *output.harmonics)));
  }
  output.stages.push_back(console.end());
}

void run(const CommandLine& command_line, Settings& settings) {
  parse(command_line, settings);
  checkOutputs({settings.input}, outputsOf(settings));
  ToolRun run(settings.report, settings.product.reconstruction.strict, toolText().name,
              {{"input", settings.input}, {"output", settings.output}}, optionsOf(settings));
  MappedCloud mapped;
  Output output;
  runLibrary("cannot remesh " + inQuotes(settings.input), kReportIt, [&] {
    makeFromCloud(settings, mapped, output, run.console);
    verify(settings, mapped, output, run.console);
  });
  store(settings, mapped, output, run);
  Json json = report(settings, mapped, output);
  printFigures(json, run.console);
  run.publish([&] { return json; }, summaryOf(settings, mapped, output));
  run.add("", findingsOf(settings, mapped, output));
  run.conclude(100 * output.intersecting_triangles <=
               static_cast<std::size_t>(output.mesh.triangles.cols()));
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  return runTool(toolText(), argc, argv, optionsOf(settings),
                 [&](const CommandLine& command_line) { run(command_line, settings); });
}
