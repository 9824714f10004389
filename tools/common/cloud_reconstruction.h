#pragma once

#include "common/console.h"
#include "common/mesh_view.h"
#include "common/point_data.h"
#include "common/reconstruction_options.h"
#include "parts.h"
#include "spherical_param/reconstruct.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// Points of a file that do not belong to the surface of the others.
struct OutlierRemoval {
  std::optional<double> threshold;  ///< of the scores, if there are any
  std::vector<Index> points;        ///< numbers in the file, ascending
};

/// The cloud of a file and the mesh that was made of it. Points are numbered as in the file, from
/// 0.
struct CloudReconstruction {
  /// All of the file; never null.
  std::shared_ptr<const PointData> data = std::make_shared<PointData>();
  std::size_t ignored = 0;                 ///< points with coordinates that are not finite
  std::optional<OutlierRemoval> outliers;  ///< nothing: they were not looked for
  std::optional<Parts> parts;              ///< nothing: they were not looked for
  std::vector<Index> meshed;               ///< points that were meshed, ascending
  Surface result;                           ///< its input points are `meshed`
  std::vector<Index> point_of_vertex;      ///< the point of each vertex
  std::vector<StageTime> stages;           ///< that of reading first
};

/// Reads a cloud, leaves out outliers and all but the largest part if that is wanted, and meshes
/// the rest, with all stages on the console. \throw UsageError, Failure
void reconstructCloud(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, CloudReconstruction& cloud);

/// A cloud whose parts were meshed each by itself.
struct PartsReconstruction {
  CloudReconstruction cloud;               ///< what comes before the meshes; without one
  std::vector<CloudReconstruction> parts;  ///< those that could be meshed, the largest first
  /// Of the parts that could not, one sentence each; their points are among those left out.
  std::vector<std::string> failures;
};

/// The same for PartsMode::Each. \throw UsageError, Failure; also if no part could be meshed.
void reconstructParts(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, PartsReconstruction& result);

/// Progress of the library on the console: each stage begins when the one before ends.
class StageProgress {
public:
  explicit StageProgress(Console& console) : console_(console) {}
  /// Ends the last stage.
  void finish();
  bool operator()(const Progress& progress);

private:
  Console& console_;
  std::string stage_;
};

/// What was left out of a cloud and why, or "nothing".
std::string leftOut(const CloudReconstruction& cloud, std::size_t duplicates, std::size_t merged);
/// The same of a cloud with one mesh, or none yet.
std::string leftOut(const CloudReconstruction& cloud);

/// The positions of the vertices: consolidated and smoothed, if that was asked for [unit of the
/// file].
Positions vertexPositions(const CloudReconstruction& cloud);

/// The mesh that is written. Points that are no vertices are left out. The cloud must outlive it.
MeshView meshOf(const CloudReconstruction& cloud);

/// The surfaces of all parts as one mesh.
class JoinedMesh {
public:
  explicit JoinedMesh(const std::vector<CloudReconstruction>& parts);
  /// This must outlive the view.
  MeshView view() const;

private:
  std::shared_ptr<const PointData> data_;
  std::vector<Index> point_of_vertex_;
  Triangles triangles_;
  Positions places_;  ///< empty if no points were moved
};

/// The vertices on a sphere, 3 x v: that of the result, or another that outlives the view. They
/// keep their colours, but not the normals of the input, which mean nothing there.
MeshView sphereOf(const CloudReconstruction& cloud, const Positions& sphere);

}  // namespace spherical_param::tools
