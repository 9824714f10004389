#pragma once

#include "common/cloud_reconstruction.h"
#include "common/command_line.h"
#include "common/console.h"
#include "common/json_report.h"
#include "common/point_data.h"
#include "common/reconstruction_options.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/mesh_topology.h"

#include <string>
#include <vector>

namespace spherical_param::tools {

/// What the tools that use the map to the sphere have in common: how they come to it.
struct ProductSettings {
  /// \param topology of the mesh by default. With TopologyMode::Sphere handles are none by default,
  ///                 so that a mesh of -topology scan has a map as well.
  explicit ProductSettings(TopologyMode topology, SphereMapOptions of_map = {});

  SphereMapOptions map;  ///< without `progress`; with the threads of the reconstruction
  ReconstructionSettings reconstruction;
};

/// The options of the reconstruction, then those of the map.
OptionTable productOptions(ProductSettings& settings);

/// Fits them to one surface, and refuses options that would change nothing. \throw UsageError
void parseProductOptions(const CommandLine& command_line, ProductSettings& settings);

/// A cloud, its mesh, and the map of that to the sphere.
struct MappedCloud {
  CloudReconstruction cloud;  ///< with the stage "map" as the last, and options that the tool takes
  std::vector<Color> colors;  ///< of the vertices of the mesh, or none if the cloud has no colours
  SphereMap map;              ///< of the mesh

  const Positions& points() const { return cloud.surface().points; }
  const Triangles& triangles() const { return cloud.surface().triangles; }
};

/// Reads a cloud, meshes it and maps the mesh to the sphere, with all stages on the console.
/// \throw UsageError, Failure
void mapCloud(const std::string& path, const ProductSettings& settings, Console& console,
              MappedCloud& mapped);

/// The surface of the mesh with its map.
SphereSurface surfaceOf(const MappedCloud& mapped, SurfaceFit fit, int threads);
extern const Names<SurfaceFit> fit_names;

/// Colours at places of the mesh, between those of the corners: 4 x n, in 0 ... 255, plus `start`;
/// empty without colours.
Eigen::Matrix4Xd colorsAt(const MappedCloud& mapped, const std::vector<SphereLocation>& places,
                          double start);
/// Colours without the fractions of their channels.
std::vector<Color> truncated(const Eigen::Matrix4Xd& colors);

/// Adds the size of the mesh and the faults of the map: `input_points`, `vertices`,
/// `mesh_triangles`, `mesh_self_intersections`, `flipped_triangles`, `angle_distortion`,
/// `area_distortion`, `mean_angle_difference_degrees`, `stretch_efficiency`, and the same of the
/// embedding as `embedding_distortion`, null without one.
void addMapToJson(const MappedCloud& mapped, Json& json);
/// Adds `closed`, `manifold`, `oriented`, `components` and `genus`.
void addToJson(const MeshTopology& topology, Json& json);

}  // namespace spherical_param::tools
