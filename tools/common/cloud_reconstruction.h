#pragma once

#include "common/console.h"
#include "common/mesh_view.h"
#include "common/outlier_removal.h"
#include "common/point_data.h"
#include "common/reconstruction_options.h"

#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::tools {

using Reconstruction = pcl::SphericalParamReconstruction<pcl::PointXYZ>;

/// The cloud of a file and the mesh that was made of it.
struct CloudReconstruction {
  PointData data;                          ///< all of the file
  std::optional<OutlierRemoval> outliers;  ///< none: they were not looked for
  Reconstruction reconstruction;           ///< its indices are those of `data`
  std::vector<StageTime> stages;           ///< that of reading first

  const Result& result() const { return reconstruction.getResult(); }
};

/// Names of stages for Console::plan(), and how long they take compared with each other.
using StagePlan = std::vector<std::pair<std::string, double>>;

/// The stages of reconstructCloud() and their shares of the time for a million points, in
/// hundredths of that of pcl_spherical_param_reconstruction.
StagePlan reconstructionStages(const ReconstructionSettings& settings);

/// Reads a cloud, leaves out outliers if that is wanted, and meshes the rest, with all stages on
/// the console. \throw UsageError, Failure
void reconstructCloud(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, CloudReconstruction& cloud);

/// What there is to be said about the cloud and its mesh, one sentence each.
std::vector<std::string> warningsOf(const CloudReconstruction& cloud);

/// Where the vertices are: smoothed, if that was asked for [unit of the file].
Positions vertexPositions(const CloudReconstruction& cloud);

/// The mesh that is written. Only points that are vertices are, so that every vertex of the file is
/// used. The cloud must outlive it.
MeshView meshOf(const CloudReconstruction& cloud);

/// The vertices on a sphere, 3 x v: that of the result, or another that outlives the view. They
/// keep their colours, but not the normals of the input, which mean nothing there.
MeshView sphereOf(const CloudReconstruction& cloud, const Positions& sphere);

}  // namespace spherical_param::tools
