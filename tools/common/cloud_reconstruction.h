#pragma once

#include "common/console.h"
#include "common/mesh_view.h"
#include "common/point_data.h"
#include "common/reconstruction_options.h"
#include "spherical_param/reconstruct.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// The cloud of a file and what was made of it. Points are numbered as in the file, from 0.
struct CloudReconstruction {
  /// All of the file; never null.
  std::shared_ptr<const PointData> data = std::make_shared<PointData>();
  Result result;
  std::vector<StageTime> stages;  ///< the first is that of reading
  Point offset{};                 ///< to be subtracted from coordinates that are written

  /// The only surface, of tools that make one.
  const Surface& surface() const { return result.surface(); }
};

/// Reads a cloud and meshes it, with all stages on the console. \throw UsageError, Failure
void reconstructCloud(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, CloudReconstruction& cloud);

/// \throw Failure if a mesh has no map to one sphere: it is in pieces, or has handles.
void requireMap(const std::string& name, const Surface& surface);

/// \throw Failure if a surface of the file, or the largest one, has no embedding.
void requireSpheres(const std::string& path, const CloudReconstruction& cloud, bool of_all);

/// What was left out of a cloud and why, or "nothing".
std::string leftOut(const CloudReconstruction& cloud);

/// What was read, the verdict and what was left out.
Summary summaryOf(const std::string& path, const CloudReconstruction& cloud);

/// The size of a mesh in words.
std::string meshSize(std::size_t vertices, Eigen::Index triangles);

/// The mesh of a surface, or of all, to write, without points that are not vertices. Both must
/// outlive it.
MeshView meshOf(const CloudReconstruction& cloud, const Surface& surface);
MeshView meshOf(const CloudReconstruction& cloud, const JoinedMesh& joined);

/// The vertices of a mesh on a sphere, 3 x v: its own, or another. All must outlive the view. They
/// keep their colours, but not the normals of the input, which mean nothing there.
MeshView sphereOf(const CloudReconstruction& cloud, const std::vector<Index>& input_of_vertex,
                  const Triangles& triangles, const Positions& sphere);

}  // namespace spherical_param::tools
