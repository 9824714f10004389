#include "common/product_input.h"

#include "common/errors.h"
#include "common/text.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

namespace spherical_param::tools {
namespace {

Json toJson(const DistortionStatistics& statistics) {
  return {{"mean", statistics.mean}, {"p95", statistics.p95}, {"max", statistics.max}};
}

void addToJson(const MapDistortion& distortion, Json& json) {
  json["flipped_triangles"] = distortion.flipped_triangles;
  json["angle_distortion"] = toJson(distortion.angle);
  json["area_distortion"] = toJson(distortion.area);
  json["mean_angle_difference_degrees"] = distortion.mean_angle_difference;
  json["stretch_efficiency"] = distortion.stretch_efficiency;
}

std::vector<Color> vertexColors(const CloudReconstruction& cloud) {
  std::vector<Color> colors;
  if (cloud.data->colors.empty()) {
    return colors;
  }
  for (const Index point : cloud.surface().input_of_vertex) {
    colors.push_back(cloud.data->colors[static_cast<std::size_t>(point)]);
  }
  return colors;
}

/// Removes options that the tool would refuse from the advice.
void fitFindings(std::vector<Finding>& findings) {
  for (Finding& finding : findings) {
    if (finding.option == "parts") {
      finding.value = "largest";
    } else if (finding.option == "handles") {
      finding.option.clear();
      finding.value.clear();
    }
  }
}

}  // namespace

ProductSettings::ProductSettings(TopologyMode topology, SphereMapOptions of_map)
    : map(std::move(of_map)) {
  // The embedding turns the map, and the report has its distortion.
  reconstruction.options.details = true;
  reconstruction.options.topology = topology;
  if (topology == TopologyMode::Sphere) {
    reconstruction.options.handles = HandleMode::None;
  }
}

OptionTable productOptions(ProductSettings& settings) {
  SphereMapOptions& map = settings.map;
  return joined(
      {reconstructionOptions(settings.reconstruction),
       {usedIf([&map] { return map.sweeps > 0; },
               numberOption("area-weight", "map: weight of areas instead of angles",
                            map.area_weight, 0, 1)),
        numberOption("map-sweeps", "map: maximum number of sweeps a level", map.sweeps, 0, 1000)}});
}

void parseProductOptions(const CommandLine& command_line, ProductSettings& settings) {
  parseReconstructionOptions(command_line, settings.reconstruction);
  Options& options = settings.reconstruction.options;
  if (options.topology == TopologyMode::Scan && options.parts == PartsMode::AsTopology) {
    options.parts = PartsMode::Largest;
  }
  if (options.parts == PartsMode::Each) {
    throw UsageError("option -parts: this tool makes one surface",
                     "give -parts largest, or write each part to its own file first");
  }
  settings.map.threads = options.threads;
  if (settings.map.sweeps == 0) {
    command_line.refuse({"area-weight"}, "-map-sweeps 0", "more sweeps");
  }
}

void mapCloud(const std::string& path, const ProductSettings& settings, Console& console,
              MappedCloud& mapped) {
  reconstructCloud(path, settings.reconstruction, console, mapped.cloud);
  const Surface& surface = mapped.cloud.surface();
  requireMap(inQuotes(path), surface);
  fitFindings(mapped.cloud.result.findings);
  console.begin("map");
  SphereMapOptions options = settings.map;
  options.progress = console.progress();
  runLibrary("cannot map " + inQuotes(path) + " to the sphere", "try another -seed", [&] {
    mapped.map = computeSphereMap(surface.points, surface.triangles, surface.sphere, options);
  });
  mapped.colors = vertexColors(mapped.cloud);
  mapped.cloud.stages.push_back(console.end());
}

const Names<SurfaceFit> fit_names = {{"linear", SurfaceFit::Linear},
                                     {"smooth", SurfaceFit::Smooth}};

SphereSurface surfaceOf(const MappedCloud& mapped, SurfaceFit fit, int threads) {
  return {mapped.points(), mapped.triangles(), mapped.map.sphere, {fit, threads, mapped.map.caps}};
}

Eigen::Matrix4Xd colorsAt(const MappedCloud& mapped, const std::vector<SphereLocation>& places,
                          double start) {
  Eigen::Matrix4Xd colors(4, mapped.colors.empty() ? 0 : places.size());
  for (Eigen::Index i = 0; i < colors.cols(); ++i) {
    const SphereLocation& place = places[static_cast<std::size_t>(i)];
    colors.col(i).setConstant(start);
    for (Eigen::Index corner = 0; corner < 3; ++corner) {
      const Index vertex = mapped.triangles()(corner, place.triangle);
      const Color& color = mapped.colors[static_cast<std::size_t>(vertex)];
      colors.col(i) +=
          place.weights[corner] * Eigen::Vector4d(color[0], color[1], color[2], color[3]);
    }
  }
  return colors;
}

std::vector<Color> truncated(const Eigen::Matrix4Xd& colors) {
  std::vector<Color> bytes(static_cast<std::size_t>(colors.cols()));
  for (std::size_t i = 0; i < 4 * bytes.size(); ++i) {
    bytes[i / 4][i % 4] =
        static_cast<std::uint8_t>(std::clamp(colors(static_cast<Eigen::Index>(i)), 0.0, 255.0));
  }
  return bytes;
}

void addMapToJson(const MappedCloud& mapped, Json& json) {
  json["input_points"] = mapped.cloud.data->points.size();
  json["vertices"] = mapped.cloud.surface().input_of_vertex.size();
  json["mesh_triangles"] = mapped.triangles().cols();
  json["mesh_self_intersections"] = mapped.cloud.surface().self_intersections.size();
  addToJson(mapped.map.distortion, json);
  json["embedding_distortion"] = nullptr;
  if (mapped.cloud.surface().sphere.cols() > 0) {
    addToJson(mapped.map.before, json["embedding_distortion"]);
  }
}

void addToJson(const MeshTopology& topology, Json& json) {
  json["closed"] = topology.closed;
  json["manifold"] = topology.manifold();
  json["oriented"] = topology.oriented;
  json["components"] = topology.components;
  json["genus"] = topology.genus ? Json(*topology.genus) : Json(nullptr);
}

}  // namespace spherical_param::tools
