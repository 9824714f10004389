#pragma once

#include "common/console.h"
#include "common/mesh_view.h"
#include "common/point_data.h"
#include "common/reconstruction_options.h"
#include "spherical_param/reconstruct.h"

#include <cstddef>
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
  PointData data;                          ///< all of the file
  std::size_t ignored = 0;                 ///< points with coordinates that are not finite
  std::optional<OutlierRemoval> outliers;  ///< nothing: they were not looked for
  std::vector<Index> meshed;               ///< points that were meshed, ascending
  Result result;                           ///< its input points are `meshed`
  std::vector<Index> point_of_vertex;      ///< the point of each vertex
  std::vector<StageTime> stages;           ///< that of reading first
};

/// Reads a cloud, leaves out outliers if that is wanted, and meshes the rest, with all stages on
/// the console. \throw UsageError, Failure
void reconstructCloud(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, CloudReconstruction& cloud);

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

/// The warnings on the cloud and its mesh, one sentence each.
std::vector<std::string> warningsOf(const CloudReconstruction& cloud);

/// The positions of the vertices: smoothed, if that was asked for [unit of the file].
Positions vertexPositions(const CloudReconstruction& cloud);

/// The mesh that is written. Points that are no vertices are left out. The cloud must outlive it.
MeshView meshOf(const CloudReconstruction& cloud);

/// The vertices on a sphere, 3 x v: that of the result, or another that outlives the view. They
/// keep their colours, but not the normals of the input, which mean nothing there.
MeshView sphereOf(const CloudReconstruction& cloud, const Positions& sphere);

}  // namespace spherical_param::tools
