#include "common/cloud_reconstruction.h"

#include "common/cloud_reader.h"
#include "common/errors.h"
#include "common/text.h"

#include <pcl/point_cloud.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace spherical_param::tools {
namespace {

/// Neighbour lists take memory before anything else fails: an absurd k is told first.
void checkMemory(const ReconstructionSettings& settings, std::size_t points) {
  constexpr std::uint64_t entry_limit = std::uint64_t{1} << 31;
  const std::uint64_t neighbors = std::min(
      static_cast<std::uint64_t>(neighborsToSearch(settings.options)), std::uint64_t{points});
  if (neighbors * points > entry_limit) {
    throw Failure("option -k: " + std::to_string(neighbors) + " neighbours of each of " +
                      std::to_string(points) + " points do not fit into memory",
                  "leave -k out, its default will do");
  }
}

/// Looks for outliers.
OutlierRemoval removeOutliers(const ReconstructionSettings& settings, const PointData& data) {
  OutlierRemoval removal = findOutlierPoints(data.points, settings.outlier_method,
                                             *settings.outlier_sigma, settings.options.threads);
  // Without outliers, the library itself says what the points lack.
  if (removal.kept_positions < 4 && !removal.indices.empty()) {
    throw Failure("option -outliers: " + std::to_string(removal.indices.size()) + " of " +
                      std::to_string(data.points.size()) +
                      " points are outliers, and the rest cannot be meshed",
                  "give -outliers a larger number");
  }
  return removal;
}

/// Runs the library on the points that are no outliers, with its stages on the console.
void reconstruct(const std::string& path, const ReconstructionSettings& settings,
                 const PointData& data, const std::optional<OutlierRemoval>& outliers,
                 Reconstruction& reconstruction, Console& console) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->reserve(data.points.size());
  for (const Point& point : data.points) {
    cloud->emplace_back(point[0], point[1], point[2]);
  }
  cloud->is_dense = false;

  const Options& options = settings.options;
  reconstruction.setOptions(options);
  std::string stage;
  std::string detail;
  reconstruction.setProgressCallback([&](const Progress& progress) {
    if (stage != progress.stage) {
      stage = progress.stage;
      detail.clear();
      console.begin(stage);
    }
    if (progress.residual > 0.0) {
      detail = (progress.iteration > 0 ? "iteration " + std::to_string(progress.iteration) + ", "
                                       : std::string()) +
               "residual " + formatted(progress.residual, 3);
    }
    if (progress.fraction < 1.0) {
      console.update(progress.fraction, detail);
    } else {
      // The last that the multilevel solver told may be the residual of a coarser level.
      console.end(isIterative(options) ? detail : "");
    }
    return true;
  });

  reconstruction.setInputCloud(cloud);
  if (outliers) {
    // All indices are still those of the file.
    reconstruction.setIndices(pcl::IndicesPtr(new pcl::Indices(outliers->kept)));
  }
  reconstruction.reconstruct();
  reconstruction.setProgressCallback({});  // what it refers to ends here
  const std::string& message = reconstruction.getErrorMessage();
  if (!message.empty()) {
    throw libraryFailure("cannot mesh " + inQuotes(path), message,
                         "check that the file holds the cloud you mean");
  }
  if (reconstruction.getResult().triangles.cols() == 0) {
    throw Failure("cannot mesh " + inQuotes(path) + ": there is no result", kReportIt);
  }
}

/// Length of the diagonal of the bounding box of the finite points.
double diagonalOf(const std::vector<Point>& points) {
  Eigen::AlignedBox3d box;
  for (const Point& point : points) {
    const Eigen::Vector3d position = Eigen::Vector3f(point.data()).cast<double>();
    if (position.allFinite()) {
      box.extend(position);
    }
  }
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

}  // namespace

StagePlan reconstructionStages(const ReconstructionSettings& settings) {
  StagePlan stages = {{"read", 1.0}};
  if (settings.outlier_sigma) {
    stages.emplace_back("outliers", 20.0);
  }
  stages.insert(stages.end(), {{"neighbors", 19.0},
                               {"graph", 18.0},
                               {"embedding", 18.0},
                               {"triangulation", 3.0},
                               {"optimization", 36.0}});
  if (settings.options.smoothing_steps > 0) {
    stages.emplace_back("smoothing", 10.0);
  }
  stages.emplace_back("check", 3.0);
  return stages;
}

void reconstructCloud(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, CloudReconstruction& cloud) {
  console.begin("read");
  cloud.data = readCloud(path, [&console](double share) { console.update(share, ""); });
  const std::size_t count = cloud.data.points.size();
  cloud.stages.push_back({"read", console.end(std::to_string(count) + " points")});

  checkMemory(settings, count);
  if (settings.outlier_sigma) {
    console.begin("outliers");
    cloud.outliers = removeOutliers(settings, cloud.data);
    cloud.stages.push_back(
        {"outliers", console.end(counted(cloud.outliers->indices.size(), "point") + " left out")});
  }
  reconstruct(path, settings, cloud.data, cloud.outliers, cloud.reconstruction, console);
  const std::vector<StageTime>& stages = cloud.result().stages;
  cloud.stages.insert(cloud.stages.end(), stages.begin(), stages.end());
}

std::vector<std::string> warningsOf(const CloudReconstruction& cloud) {
  std::vector<std::string> warnings;
  // Single precision alone changes a cloud near its origin by less than a tenth of that.
  constexpr double harmless_rounding = 1e-6;
  if (cloud.data.rounding > harmless_rounding * diagonalOf(cloud.data.points)) {
    warnings.push_back("Coordinates were rounded to single precision, by up to " +
                       formatted(cloud.data.rounding, 3) +
                       ": points may have moved or merged; subtract a common offset first.");
  }
  const std::size_t ignored = cloud.reconstruction.getIgnoredPointCount();
  if (ignored > 0) {
    warnings.push_back(std::to_string(ignored) + " points were left out, because their coordinates "
                                                 "are not finite numbers in single precision.");
  }
  const std::vector<std::string>& further = cloud.result().warnings;
  warnings.insert(warnings.end(), further.begin(), further.end());
  return warnings;
}

Positions vertexPositions(const CloudReconstruction& cloud) {
  if (cloud.result().smoothed.cols() > 0) {
    return cloud.result().smoothed;
  }
  const pcl::Indices& indices = cloud.reconstruction.getVertexIndices();
  Positions positions(3, static_cast<Eigen::Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const Point& point = cloud.data.points[static_cast<std::size_t>(indices[i])];
    positions.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3f(point.data()).cast<double>();
  }
  return positions;
}

MeshView meshOf(const CloudReconstruction& cloud) {
  const Result& result = cloud.result();
  MeshView mesh(cloud.data, cloud.reconstruction.getVertexIndices(), result.triangles);
  if (result.smoothed.cols() > 0) {
    mesh.moveTo(result.smoothed);
  }
  return mesh;
}

MeshView sphereOf(const CloudReconstruction& cloud, const Positions& sphere) {
  MeshView view(cloud.data, cloud.reconstruction.getVertexIndices(), cloud.result().triangles);
  view.leaveOutNormals();
  view.moveTo(sphere);
  return view;
}

}  // namespace spherical_param::tools
