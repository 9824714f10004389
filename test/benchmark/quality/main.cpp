// benchmark_mesh_quality MESH [-truth FILE] [-cloud FILE] [-sphere FILE] [-samples N]
//
// Measures a mesh and prints one JSON object. All files are PLY files.
//   -truth   the true mesh: distances, normals and edges are compared
//   -cloud   the points that were meshed; default: the vertices of the truth
//   -sphere  the same triangles on the unit sphere: the distortion of the map is measured
//   -samples of each mesh for distances and normals; default: 200000

#include "mesh_quality.h"

#include "spherical_param/self_intersection.h"

#include <nlohmann/json.hpp>

#include <exception>
#include <iostream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

namespace {

using namespace spherical_param::benchmark;
using Json = nlohmann::ordered_json;

template <typename T>
Json orNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json measure(const std::string& path, std::map<std::string, std::string> options) {
  const Mesh mesh = readPly(path);
  if (mesh.triangles.size() == 0)
    throw std::runtime_error("'" + path + "' has no triangles");
  Json json;
  json["vertices"] = mesh.points.cols();
  json["triangles"] = mesh.triangles.cols();
  json["sphere"] = isClosedManifoldGenus0(mesh);
  json["intersections"] =
      spherical_param::findSelfIntersections(mesh.points, mesh.triangles).size();
  const TriangleShapes shapes = measureTriangleShapes(mesh);
  json["min_angle"] = shapes.min_angle_mean;
  json["needles"] = shapes.below_10_percent;

  std::optional<Mesh> truth;
  if (options.count("-truth") > 0)
    truth = readPly(options["-truth"]);
  if (options.count("-cloud") > 0 || truth) {
    const spherical_param::Positions cloud =
        options.count("-cloud") > 0 ? readPly(options["-cloud"]).points : truth->points;
    json["points"] = cloud.cols();
    json["used"] = pointsUsedPercent(mesh, cloud);
    if (truth)
      json["edges"] = orNull(edgesReproducedPercent(mesh, *truth, cloud));
  }
  if (truth) {
    const int samples = options.count("-samples") > 0 ? std::stoi(options["-samples"]) : 200000;
    const std::optional<Distances> found = measureDistances(mesh, *truth, samples);
    json["rms"] = found ? Json(found->rms) : Json();
    json["hausdorff"] = found ? Json(found->hausdorff) : Json();
    json["normals"] = found ? Json(found->normal_deviation) : Json();
  }
  if (options.count("-sphere") > 0) {
    const Mesh sphere = readPly(options["-sphere"]);
    if (sphere.triangles.cols() != mesh.triangles.cols() || sphere.triangles != mesh.triangles)
      throw std::runtime_error("'" + options["-sphere"] + "' has other triangles than the mesh");
    const MapDistortion map = measureMapDistortion(mesh, sphere.points);
    json["angle"] = map.angle_mean;
    json["angle_95"] = map.angle_p95;
    json["area"] = map.area_rms_log2;
    json["inverted"] = 100.0 * static_cast<double>(map.inverted_triangles) /
                       static_cast<double>(mesh.triangles.cols());
    json["collapsed"] = map.collapsed_triangles;
  }
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2 || argc % 2 != 0)
      throw std::runtime_error("the command line is wrong");
    std::map<std::string, std::string> options;
    for (int i = 2; i < argc; i += 2)
      options[argv[i]] = argv[i + 1];
    std::cout << measure(argv[1], options).dump(2) << '\n';
  } catch (const std::exception& error) {
    std::cerr << "benchmark_mesh_quality: " << error.what() << "\n"
              << "run it as MESH [-truth FILE] [-cloud FILE] [-sphere FILE] [-samples N]\n";
    return 1;
  }
  return 0;
}
