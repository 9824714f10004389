// benchmark_mesh_quality: measures a mesh, alone and against the truth, and tells it in JSON.

#include "common/cloud_reader.h"
#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/numbers.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "mesh_file.h"
#include "mesh_quality.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace spherical_param::benchmark;
using namespace spherical_param::tools;
using Json = nlohmann::ordered_json;
using spherical_param::Positions;

const std::string tool_name = "benchmark_mesh_quality";

const std::vector<OptionInfo> option_table = {
    {"truth", "FILE", "the true mesh: distances, normals, volume and edges are compared"},
    {"cloud", "FILE", "the points that were meshed (the vertices of the truth)"},
    {"sphere", "FILE", "the same triangles on the unit sphere: distortion of the map"},
    {"samples", "N", "samples on each mesh for distances and normals (200000)"},
    {"seed", "S", "seed of the samples (1)"},
};

std::string helpText() {
  return "Usage: " + tool_name +
         " MESH [options]\n\n"
         "Measures a mesh and prints one JSON object. Meshes are PLY files.\n\n"
         "Options (-name value, --name value or --name=value; defaults in brackets):\n" +
         describeOptions(option_table) + "\nExit code: 0 done, 1 failed, 2 wrong usage.\n";
}

struct Settings {
  std::string mesh;
  std::string truth;   ///< empty: there is none
  std::string cloud;   ///< the same
  std::string sphere;  ///< the same
  DistanceOptions distances;
};

Settings parseSettings(const CommandLine& command_line) {
  const std::vector<std::string>& words = command_line.others();
  if (words.size() != 1)
    throw UsageError(words.empty() ? "there is no mesh"
                                   : "there is one word too many: " + inQuotes(words[1]),
                     "run '" + tool_name + " MESH [options]', -h shows the options");
  Settings settings;
  settings.mesh = words[0];
  settings.truth = command_line.value("truth", "");
  settings.cloud = command_line.value("cloud", "");
  settings.sphere = command_line.value("sphere", "");
  for (const char* option : {"samples", "seed"})
    if (command_line.has(option) && settings.truth.empty())
      throw UsageError(std::string("-") + option + " is about the comparison with a truth",
                       "give -truth FILE, or leave it out");
  if (command_line.has("samples"))
    settings.distances.samples =
        parseInteger("samples", command_line.value("samples", ""), {1, 100000000});
  if (command_line.has("seed"))
    settings.distances.seed = parseUnsigned("seed", command_line.value("seed", ""));
  return settings;
}

Positions readPoints(const std::string& path) {
  const PointData data = readCloud(path);
  Positions points(3, static_cast<Eigen::Index>(data.points.size()));
  for (std::size_t i = 0; i < data.points.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::Vector3f>(data.points[i].data()).cast<double>();
  return points;
}

/// Reads the map of a mesh to the unit sphere. \throw Failure if it is no such map.
Positions readSphere(const std::string& path, const Mesh& mesh) {
  Mesh sphere = readMesh(path);
  const std::string remedy = "give the sphere that was written with the mesh";
  if (sphere.points.cols() != mesh.points.cols() ||
      sphere.triangles.cols() != mesh.triangles.cols() || sphere.triangles != mesh.triangles)
    throw Failure(inQuotes(path) + " has not the vertices and triangles of the mesh", remedy);
  // Far more than rounding, far less than any other surface.
  constexpr double tolerance = 1e-3;
  if (((sphere.points.colwise().norm().array() - 1.0).abs() > tolerance).any())
    throw Failure(inQuotes(path) + " has a vertex that is not on the unit sphere", remedy);
  return sphere.points;
}

double percent(double share) {
  return 100.0 * share;
}

double percentOf(Count part, Count whole) {
  return whole == 0 ? 0.0 : percent(static_cast<double>(part) / static_cast<double>(whole));
}

void addConnectivity(Json& json, const Mesh& mesh) {
  const Connectivity found = measureConnectivity(mesh);
  json["vertices"] = found.vertices;
  json["unreferenced_vertices"] = found.unreferenced_vertices;
  json["repeated_vertices"] = countRepeatedVertices(mesh);
  json["triangles"] = found.triangles;
  json["degenerate_triangles"] = found.degenerate_triangles;
  json["edges"] = found.edges;
  json["boundary_edges"] = found.boundary_edges;
  json["boundary_loops"] = found.boundary_loops;
  json["nonmanifold_edges"] = found.nonmanifold_edges;
  json["nonmanifold_vertices"] = found.nonmanifold_vertices;
  json["components"] = found.components;
  json["euler_characteristic"] = found.euler_characteristic;
  json["closed"] = found.closed;
  json["edge_manifold"] = found.edgeManifold();
  json["vertex_manifold"] = found.vertexManifold();
  json["oriented"] = found.oriented;
  json["orientable"] = found.orientable;
  json["genus"] = found.genus ? Json(*found.genus) : Json();
  json["closed_manifold_genus0"] = found.closedManifoldGenus0();
}

void addShape(Json& json, const Mesh& mesh) {
  const double volume = signedVolume(mesh, boundsOf(mesh).center());
  json["outward"] = volume > 0.0;
  json["volume"] = volume;
  json["area"] = surfaceArea(mesh);
  const TriangleShapes shapes = measureTriangleShapes(mesh);
  json["min_angle_mean_degrees"] = shapes.min_angle_mean;
  json["min_angle_p05_degrees"] = shapes.min_angle_p05;
  json["min_angle_below_10_percent"] = percent(shapes.share_below_10);
  json["min_angle_below_1_percent"] = percent(shapes.share_below_1);
  json["zero_area_triangles"] = shapes.zero_area_triangles;
  const SelfIntersectionCount intersections = countSelfIntersections(mesh);
  json["self_intersecting_pairs"] = intersections.pairs;
  json["self_intersecting_triangles"] = intersections.triangles;
}

void addCloud(Json& json, const Mesh& mesh, const Positions& cloud) {
  const CloudCoverage coverage = measureCloudCoverage(mesh, cloud);
  json["cloud_points"] = coverage.points;
  json["points_used"] = coverage.points_used;
  json["points_used_percent"] = percentOf(coverage.points_used, coverage.points);
  json["extra_vertices"] = coverage.extra_vertices;
}

void addTruth(Json& json, const Mesh& mesh, const Mesh& truth, const Positions& cloud,
              const DistanceOptions& options) {
  const double diagonal = boundsOf(truth).diagonal();
  json["truth_diagonal"] = diagonal;
  const std::optional<Distances> found = measureDistances(mesh, truth, options);
  const auto put = [&](const char* key, double value) { json[key] = found ? Json(value) : Json(); };
  const Distances distances = found.value_or(Distances{});
  const double scale = percent(1.0 / diagonal);
  put("hausdorff_percent", scale * distances.bothHausdorff());
  put("hausdorff_mesh_to_truth_percent", scale * distances.hausdorff.mesh_to_truth);
  put("hausdorff_truth_to_mesh_percent", scale * distances.hausdorff.truth_to_mesh);
  put("rms_percent", scale * distances.both_rms);
  put("rms_mesh_to_truth_percent", scale * distances.rms.mesh_to_truth);
  put("rms_truth_to_mesh_percent", scale * distances.rms.truth_to_mesh);
  put("mean_distance_percent", scale * distances.both_mean);
  put("normal_deviation_degrees", distances.normal_deviation);
  put("normal_deviation_above_30_percent", percent(distances.normal_deviation_over_30));
  json["samples"] = options.samples;
  json["seed"] = options.seed;
  // About one point, so that two open meshes can be compared, too. JSON shows what is not finite,
  // for a truth without volume, as null.
  const Eigen::Vector3d apex = boundsOf(truth).center();
  json["volume_ratio"] = std::abs(signedVolume(mesh, apex) / signedVolume(truth, apex));
  json["area_ratio"] = surfaceArea(mesh) / surfaceArea(truth);
  const bool comparable = isOverCloud(truth, cloud);
  const EdgeAgreement edges = comparable ? compareEdges(mesh, truth) : EdgeAgreement{};
  json["edges_reproduced_percent"] = comparable ? Json(percent(edges.reproduced)) : Json();
  json["edge_precision_percent"] = comparable ? Json(percent(edges.precision)) : Json();
}

void addMap(Json& json, const Mesh& mesh, const Positions& sphere) {
  const MapDistortion map = measureMapDistortion(mesh, sphere);
  json["map_angle_distortion_mean"] = map.angle_mean;
  json["map_angle_distortion_median"] = map.angle_median;
  json["map_angle_distortion_p95"] = map.angle_p95;
  json["map_area_distortion_rms_log2"] = map.area_rms_log2;
  json["map_area_distortion_p05_log2"] = map.area_p05_log2;
  json["map_area_distortion_p95_log2"] = map.area_p95_log2;
  json["map_inverted_triangles"] = map.inverted_triangles;
  json["map_inverted_percent"] = percentOf(map.inverted_triangles, mesh.triangles.cols());
  json["map_collapsed_triangles"] = map.collapsed_triangles;
  json["map_collapsed_percent"] = percentOf(map.collapsed_triangles, mesh.triangles.cols());
}

void run(const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, tool_name, helpText()))
    return;
  const Settings settings = parseSettings(command_line);
  const Mesh mesh = readMesh(settings.mesh);
  std::optional<Mesh> truth;
  if (!settings.truth.empty())
    truth = readMesh(settings.truth);
  std::optional<Positions> cloud;
  if (!settings.cloud.empty())
    cloud = readPoints(settings.cloud);
  else if (truth)
    cloud = truth->points;

  Json json;
  addConnectivity(json, mesh);
  addShape(json, mesh);
  if (cloud)
    addCloud(json, mesh, *cloud);
  if (truth)
    addTruth(json, mesh, *truth, *cloud, settings.distances);
  if (!settings.sphere.empty())
    addMap(json, mesh, readSphere(settings.sphere, mesh));
  printAll(json.dump(2) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(tool_name, argc, argv, run);
}
