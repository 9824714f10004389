#include "common/product_input.h"

#include "common/errors.h"
#include "common/numbers.h"
#include "common/text.h"

#include <cstddef>
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

/// \param before of the embedding, if there is one.
std::string listed(const DistortionStatistics& statistics, const DistortionStatistics* before) {
  const auto three = [](const DistortionStatistics& values) {
    return formatted(values.mean, 4) + ", " + formatted(values.p95, 4) + ", " +
           formatted(values.max, 4);
  };
  return three(statistics) + " (mean, 95 %, max" +
         (before != nullptr ? "; embedding: " + three(*before) : "") + ")";
}

/// \param vertex_of of each vertex of the cut mesh.
std::vector<Color> vertexColors(const CloudReconstruction& cloud,
                                const std::vector<Index>& vertex_of) {
  std::vector<Color> colors;
  if (cloud.data->colors.empty()) {
    return colors;
  }
  colors.reserve(vertex_of.size());
  for (const Index v : vertex_of) {
    const Index point = cloud.surface().input_of_vertex[static_cast<std::size_t>(v)];
    colors.push_back(cloud.data->colors[static_cast<std::size_t>(point)]);
  }
  return colors;
}

}  // namespace

ProductDefaults::ProductDefaults(HandlesOnSphere on_sphere, SphereMapOptions of_map)
    : handles(on_sphere), map(std::move(of_map)) {
  if (handles == HandlesOnSphere::Refused) {
    reconstruction.topology = TopologyMode::Sphere;
  }
}

std::vector<OptionInfo> productOptions(const ProductDefaults& defaults) {
  std::vector<OptionInfo> options = reconstructionOptions(defaults.reconstruction);
  options.push_back(
      {"area-weight", "X",
       "map: weight of areas, 0 (angles) to 1 (" + formatted(defaults.map.area_weight, 3) + ")"});
  options.push_back({"map-sweeps", "N",
                     "map: maximum number of sweeps a level, up to 1000 (" +
                         std::to_string(defaults.map.sweeps) + ")"});
  return options;
}

ProductSettings parseProductOptions(const CommandLine& command_line,
                                    const ProductDefaults& defaults) {
  ProductSettings settings;
  settings.map = defaults.map;
  settings.handles = defaults.handles;
  settings.reconstruction = parseReconstructionOptions(command_line, defaults.reconstruction);
  Options& options = settings.reconstruction.options;
  if (options.topology == TopologyMode::Scan && options.parts == PartsMode::AsTopology) {
    options.parts = PartsMode::Largest;
  }
  if (defaults.handles == HandlesOnSphere::Refused && options.handles == HandleMode::AsTopology) {
    options.handles = HandleMode::None;
  }
  if (options.parts == PartsMode::Each) {
    throw UsageError("option -parts: this tool makes one surface",
                     "give -parts largest, or write each part to its own file first");
  }
  settings.map.threads = options.threads;
  if (command_line.has("area-weight")) {
    settings.map.area_weight =
        parseReal("area-weight", command_line.value("area-weight", ""), {0.0, 1.0, true});
  }
  if (command_line.has("map-sweeps")) {
    settings.map.sweeps = static_cast<int>(
        parseInteger("map-sweeps", command_line.value("map-sweeps", ""), {0, 1000}));
  }
  if (settings.map.sweeps == 0 && command_line.has("area-weight")) {
    throw UsageError("option -area-weight does nothing with -map-sweeps 0",
                     "leave -area-weight out, or give -map-sweeps " +
                         std::to_string(defaults.map.sweeps));
  }
  return settings;
}

void printProductOptions(const ProductSettings& settings, Console& console) {
  printReconstructionOptions(settings.reconstruction, console);
  if (settings.map.sweeps > 0) {
    console.entry("area weight", formatted(settings.map.area_weight, 6));
  }
  console.entry("map sweeps", "up to " + std::to_string(settings.map.sweeps));
}

Json productOptionsToJson(const ProductSettings& settings) {
  Json json = reconstructionOptionsToJson(settings.reconstruction);
  json["area_weight"] = settings.map.sweeps == 0 ? Json(nullptr) : Json(settings.map.area_weight);
  json["map_sweeps"] = settings.map.sweeps;
  return json;
}

void mapCloud(const std::string& path, const ProductSettings& settings, Console& console,
              MappedCloud& mapped) {
  reconstructCloud(path, settings.reconstruction, console, mapped.cloud);
  if (settings.handles == HandlesOnSphere::Refused) {
    requireSpheres(path, mapped.cloud, true);
  }
  const Surface& surface = mapped.cloud.surface();
  console.begin("map");
  SphereMapOptions options = settings.map;
  options.progress = [&console](const Progress& progress) {
    console.update(progress.fraction);
    return true;
  };
  runLibrary("cannot map " + inQuotes(path) + " to the sphere", "try another -seed", [&] {
    mapped.mesh = cutHandles(vertexPositions(mapped.cloud, surface), surface.triangles);
    mapped.map =
        computeSphereMap(mapped.mesh.points, mapped.mesh.triangles, surface.sphere, options);
  });
  mapped.colors = vertexColors(mapped.cloud, mapped.mesh.vertex_of);
  mapped.cloud.stages.push_back({"map", console.end("")});
}

std::vector<Finding> findingsOf(const MappedCloud& mapped) {
  std::vector<Finding> findings = mapped.cloud.result.findings;
  for (Finding& finding : findings) {
    if (finding.option == "parts") {
      finding.value = "largest";
    }
  }
  return findings;
}

void addMapToJson(const MappedCloud& mapped, Json& json) {
  json["input_points"] = mapped.cloud.data->points.size();
  json["vertices"] = mapped.cloud.surface().input_of_vertex.size();
  json["mesh_triangles"] = mapped.mesh.triangles.cols();
  json["mesh_self_intersections"] = mapped.cloud.surface().self_intersections.size();
  addToJson(mapped.map.distortion, json);
  json["embedding_distortion"] = nullptr;
  if (mapped.cloud.surface().sphere.cols() > 0) {
    addToJson(mapped.map.before, json["embedding_distortion"]);
  }
}

void printMap(const MappedCloud& mapped, Console& console) {
  const SphereMap& map = mapped.map;
  console.entry("input points", std::to_string(mapped.cloud.data->points.size()));
  console.entry("vertices", std::to_string(mapped.cloud.surface().input_of_vertex.size()));
  console.entry("mesh",
                std::to_string(mapped.mesh.triangles.cols()) + " triangles, " +
                    counted(mapped.cloud.surface().self_intersections.size(), "self-intersection"));
  const MapDistortion* before = mapped.cloud.surface().sphere.cols() > 0 ? &map.before : nullptr;
  console.entry("flipped on sphere",
                std::to_string(map.distortion.flipped_triangles) +
                    (before != nullptr
                         ? " (embedding: " + std::to_string(before->flipped_triangles) + ")"
                         : ""));
  console.entry("angle distortion",
                listed(map.distortion.angle, before != nullptr ? &before->angle : nullptr));
  console.entry("area distortion",
                listed(map.distortion.area, before != nullptr ? &before->area : nullptr));
}

}  // namespace spherical_param::tools
