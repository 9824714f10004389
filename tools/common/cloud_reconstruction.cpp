#include "common/cloud_reconstruction.h"

#include "common/cloud_reader.h"
#include "common/errors.h"
#include "common/text.h"
#include "spherical_param/outliers.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace spherical_param::tools {
namespace {

Positions positionsOf(const PointData& data, const std::vector<Index>& points) {
  Positions positions(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) =
        data.position(static_cast<std::size_t>(points[i]));
  }
  return positions;
}

std::vector<Index> finitePoints(const PointData& data) {
  std::vector<Index> finite;
  finite.reserve(data.points.size());
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    if (data.position(i).allFinite()) {
      finite.push_back(static_cast<Index>(i));
    }
  }
  return finite;
}

/// Finds the points that are left out, by their positions in the list of meshed points.
OutlierRemoval outliersOf(const Positions& points, const ReconstructionSettings& settings) {
  OutlierRemoval found;
  if (settings.outliers->sigma) {
    OutlierOptions options;
    options.sigma = *settings.outliers->sigma;
    Outliers outliers = findOutliers(points, options, settings.options);
    found.threshold = outliers.threshold;
    found.points = std::move(outliers.indices);
  } else {
    for (const StrayPoint& stray : findStrayPoints(points, settings.options)) {
      found.points.push_back(stray.point);
    }
  }
  return found;
}

/// Takes the outliers out of the points that will be meshed.
void removeOutliers(const ReconstructionSettings& settings, CloudReconstruction& cloud) {
  cloud.outliers = outliersOf(positionsOf(cloud.data, cloud.meshed), settings);
  std::vector<Index>& outliers = cloud.outliers->points;
  for (Index& i : outliers) {
    i = cloud.meshed[static_cast<std::size_t>(i)];
  }
  std::vector<Index> rest;
  std::set_difference(cloud.meshed.begin(), cloud.meshed.end(), outliers.begin(), outliers.end(),
                      std::back_inserter(rest));
  cloud.meshed = std::move(rest);
}

}  // namespace

bool StageProgress::operator()(const Progress& progress) {
  if (stage_ != progress.stage) {
    finish();
    stage_ = progress.stage;
    console_.begin(stage_);
  }
  console_.update(progress.fraction);
  return true;
}

void StageProgress::finish() {
  if (!stage_.empty()) {
    console_.end("");
    stage_.clear();
  }
}

void reconstructCloud(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, CloudReconstruction& cloud) {
  console.begin("read");
  cloud.data = readCloud(path, [&console](double fraction) { console.update(fraction); });
  const std::size_t count = cloud.data.points.size();
  cloud.stages.push_back({"read", console.end(std::to_string(count) + " points")});
  cloud.meshed = finitePoints(cloud.data);
  cloud.ignored = count - cloud.meshed.size();
  if (settings.outliers) {
    console.begin("outliers");
    runLibrary("cannot look for outliers in " + inQuotes(path), "leave -outliers out",
               [&] { removeOutliers(settings, cloud); });
    cloud.stages.push_back(
        {"outliers", console.end(counted(cloud.outliers->points.size(), "point") + " left out")});
  }

  StageProgress progress(console);
  Options options = settings.options;
  options.progress = [&progress](const Progress& reported) { return progress(reported); };
  std::string left_out;
  if (cloud.ignored > 0) {
    left_out += " (without " + counted(cloud.ignored, "point") + " that are not finite)";
  }
  if (cloud.outliers && !cloud.outliers->points.empty()) {
    left_out += " (without " + counted(cloud.outliers->points.size(), "outlier") + ")";
  }
  runLibrary("cannot mesh " + inQuotes(path) + left_out,
             "check that the file holds the cloud you mean",
             [&] { cloud.result = reconstruct(positionsOf(cloud.data, cloud.meshed), options); });
  progress.finish();
  cloud.stages.insert(cloud.stages.end(), cloud.result.stages.begin(), cloud.result.stages.end());
  cloud.point_of_vertex.reserve(cloud.result.vertexCount());
  for (const Index input : cloud.result.input_of_vertex) {
    cloud.point_of_vertex.push_back(cloud.meshed[static_cast<std::size_t>(input)]);
  }
}

std::vector<std::string> warningsOf(const CloudReconstruction& cloud) {
  std::vector<std::string> warnings;
  if (cloud.ignored > 0) {
    warnings.push_back(counted(cloud.ignored, "point") + (cloud.ignored == 1 ? " was" : " were") +
                       " left out: the coordinates are not finite.");
  }
  const std::vector<std::string>& further = cloud.result.warnings;
  warnings.insert(warnings.end(), further.begin(), further.end());
  return warnings;
}

Positions vertexPositions(const CloudReconstruction& cloud) {
  return cloud.result.smoothed.cols() > 0 ? cloud.result.smoothed
                                          : positionsOf(cloud.data, cloud.point_of_vertex);
}

MeshView meshOf(const CloudReconstruction& cloud) {
  MeshView mesh(cloud.data, cloud.point_of_vertex, cloud.result.triangles);
  if (cloud.result.smoothed.cols() > 0) {
    mesh.moveTo(cloud.result.smoothed);
  }
  return mesh;
}

MeshView sphereOf(const CloudReconstruction& cloud, const Positions& sphere) {
  MeshView view(cloud.data, cloud.point_of_vertex, cloud.result.triangles);
  view.leaveOutNormals();
  view.moveTo(sphere);
  return view;
}

}  // namespace spherical_param::tools
