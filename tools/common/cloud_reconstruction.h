#pragma once

#include "common/console.h"
#include "common/mesh_view.h"
#include "common/point_data.h"
#include "common/reconstruction_options.h"
#include "spherical_param/reconstruct.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// The cloud of a file and what was made of it. Points are numbered as in the file, from 0.
struct CloudReconstruction {
  /// All of the file; never null.
  std::shared_ptr<const PointData> data = std::make_shared<PointData>();
  Result result;
  std::vector<StageTime> stages;  ///< that of reading first
  Point offset{};                 ///< to be subtracted from coordinates that are written

  /// The only surface, of tools that make one.
  const Surface& surface() const { return result.surface(); }
};

/// Reads a cloud and meshes it, with all stages on the console. \throw UsageError, Failure
void reconstructCloud(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, CloudReconstruction& cloud);

/// \throw Failure if a surface of the file, or the largest one, has no map to one sphere
void requireSpheres(const std::string& path, const CloudReconstruction& cloud, bool of_all);

/// What was left out of a cloud and why, or "nothing".
std::string leftOut(const CloudReconstruction& cloud);

/// What was read, the verdict and what was left out.
Summary summaryOf(const std::string& path, const CloudReconstruction& cloud);

/// The size of a mesh in words.
std::string meshSize(std::size_t vertices, Eigen::Index triangles);

/// The positions of the vertices of a surface: consolidated and smoothed, if that was asked for
/// [unit of the file].
Positions vertexPositions(const CloudReconstruction& cloud, const Surface& surface);

/// The mesh of a surface to write, without points that are not vertices. Cloud and
/// surface must outlive it.
MeshView meshOf(const CloudReconstruction& cloud, const Surface& surface);

/// All surfaces of a cloud as one mesh.
class JoinedMesh {
public:
  /// \param is_sphere the vertices are on the sphere that all surfaces have.
  explicit JoinedMesh(const CloudReconstruction& cloud, bool is_sphere = false);
  /// This must outlive the view.
  MeshView view() const;

private:
  std::shared_ptr<const PointData> data_;
  std::vector<Index> point_of_vertex_;
  Triangles triangles_;
  bool is_sphere_;
  Positions places_;                 ///< empty if no points were moved
  std::vector<std::uint8_t> added_;  ///< marks of vertices; empty if none was added
};

/// The vertices on a sphere, 3 x v: that of the surface, or another that outlives the view. They
/// keep their colours, but not the normals of the input, which mean nothing there.
MeshView sphereOf(const CloudReconstruction& cloud, const Surface& surface,
                  const Positions& sphere);

}  // namespace spherical_param::tools
