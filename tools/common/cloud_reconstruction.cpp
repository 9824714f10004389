#include "common/cloud_reconstruction.h"

#include "common/cloud_reader.h"
#include "common/errors.h"
#include "common/text.h"
#include "outliers.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <optional>
#include <string_view>
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

/// The points that are not among the others; both ascending.
std::vector<Index> without(const std::vector<Index>& points, const std::vector<Index>& others) {
  std::vector<Index> rest;
  std::set_difference(points.begin(), points.end(), others.begin(), others.end(),
                      std::back_inserter(rest));
  return rest;
}

/// How the library works, with its progress as that of the console's stage. All but its last step
/// is the search for neighbours.
Execution executionOf(const ReconstructionSettings& settings, Console& console) {
  Execution execution = settings.options;
  execution.progress = [&console](const Progress& progress) {
    console.update((std::string_view(progress.stage) == "neighbors" ? 0.0 : 0.5) +
                   0.5 * progress.fraction);
    return true;
  };
  return execution;
}

/// Finds the points that are left out, by their positions in the list of meshed points.
OutlierRemoval outliersOf(const Positions& points, const ReconstructionSettings& settings,
                          const Execution& execution) {
  OutlierRemoval found;
  if (settings.outliers->sigma) {
    OutlierOptions options;
    options.sigma = *settings.outliers->sigma;
    Outliers outliers = findOutliers(points, options, execution);
    found.threshold = outliers.threshold;
    found.points = std::move(outliers.indices);
  } else {
    found.points = findStrayPoints(points, execution).indices;
  }
  return found;
}

/// Takes the outliers out of the points that will be meshed.
void removeOutliers(const ReconstructionSettings& settings, Console& console,
                    CloudReconstruction& cloud) {
  cloud.outliers =
      outliersOf(positionsOf(*cloud.data, cloud.meshed), settings, executionOf(settings, console));
  std::vector<Index>& outliers = cloud.outliers->points;
  for (Index& i : outliers) {
    i = cloud.meshed[static_cast<std::size_t>(i)];
  }
  cloud.meshed = without(cloud.meshed, outliers);
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

std::string leftOut(const CloudReconstruction& cloud, std::size_t duplicates, std::size_t merged) {
  std::string text;
  const auto add = [&text](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) {
      text += (text.empty() ? "" : ", ") + counted(count, one, many);
    }
  };
  const std::size_t outliers = cloud.outliers ? cloud.outliers->points.size() : 0;
  add(duplicates, "duplicate", "duplicates");
  add(merged, "point merged into another", "points merged into others");
  add(cloud.ignored, "point that is not finite", "points that are not finite");
  add(outliers, "outlier", "outliers");
  add(cloud.data->points.size() - cloud.ignored - outliers - cloud.meshed.size(),
      "point in other parts", "points in other parts");
  return text.empty() ? "nothing" : text;
}

std::string leftOut(const CloudReconstruction& cloud) {
  return leftOut(cloud, cloud.result.duplicates(), cloud.result.consolidation.merged);
}

namespace {

/// Takes the points apart that will be meshed.
void findPartsOf(const ReconstructionSettings& settings, Console& console,
                 CloudReconstruction& cloud) {
  Parts parts = findParts(positionsOf(*cloud.data, cloud.meshed), settings.min_points,
                          executionOf(settings, console));
  const auto number = [&](Index& point) { point = cloud.meshed[static_cast<std::size_t>(point)]; };
  for (Part& part : parts.parts) {
    std::for_each(part.points.begin(), part.points.end(), number);
  }
  std::for_each(parts.left_out.begin(), parts.left_out.end(), number);
  cloud.parts = std::move(parts);
}

/// The same for the message of a failure; empty if nothing was left out.
std::string leftOutNote(const CloudReconstruction& cloud) {
  const std::string text = leftOut(cloud);
  return text == "nothing" ? "" : " (left out: " + text + ")";
}

/// Reads a cloud and finds what will be meshed of it.
void prepareCloud(const std::string& path, const ReconstructionSettings& settings, Console& console,
                  CloudReconstruction& cloud) {
  console.begin("read");
  cloud.data = std::make_shared<PointData>(
      readCloud(path, [&console](double fraction) { console.update(fraction); }));
  const std::size_t count = cloud.data->points.size();
  cloud.stages.push_back({"read", console.end(std::to_string(count) + " points")});
  cloud.meshed = finitePoints(*cloud.data);
  cloud.ignored = count - cloud.meshed.size();
  if (settings.outliers) {
    console.begin("outliers");
    runLibrary("cannot look for outliers in " + inQuotes(path), "leave -outliers out",
               [&] { removeOutliers(settings, console, cloud); });
    cloud.stages.push_back(
        {"outliers", console.end(counted(cloud.outliers->points.size(), "point") + " left out")});
  }
  if (settings.parts == PartsMode::All) {
    return;
  }
  console.begin("parts");
  runLibrary("cannot find the parts of " + inQuotes(path), "leave -parts out",
             [&] { findPartsOf(settings, console, cloud); });
  const std::size_t parts = cloud.parts->parts.size();
  cloud.stages.push_back(
      {"parts", console.end(counted(parts, "part") + ", " +
                            counted(cloud.parts->left_out.size(), "point") + " left out")});
  if (parts == 0) {
    throw Failure("no part of " + inQuotes(path) + leftOutNote(cloud) + " has " +
                      counted(static_cast<std::size_t>(settings.min_points), "point"),
                  "give a lower -min-points, or leave -parts out");
  }
}

/// What is left of the time limit of a whole run.
class TimeLeft {
public:
  explicit TimeLeft(const ReconstructionSettings& settings) : limit_(settings.options.time_limit) {}

  /// [s]; unset: there is no limit.
  std::optional<double> operator()() const {
    if (!limit_) {
      return std::nullopt;
    }
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
    return std::max(0.0, *limit_ - passed.count());
  }

private:
  std::optional<double> limit_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Meshes the points that were chosen. \throw InvalidInput, ComputeError
void meshChosen(const ReconstructionSettings& settings, std::optional<double> time_limit,
                StageProgress& progress, CloudReconstruction& cloud) {
  Options options = settings.options;
  options.time_limit = time_limit;
  options.progress = [&progress](const Progress& reported) { return progress(reported); };
  cloud.result = reconstruct(positionsOf(*cloud.data, cloud.meshed), options);
  progress.finish();
  cloud.stages.insert(cloud.stages.end(), cloud.result.stages.begin(), cloud.result.stages.end());
  cloud.point_of_vertex.reserve(cloud.result.vertexCount());
  for (const Index input : cloud.result.input_of_vertex) {
    cloud.point_of_vertex.push_back(cloud.meshed[static_cast<std::size_t>(input)]);
  }
}

}  // namespace

void reconstructCloud(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, CloudReconstruction& cloud) {
  const TimeLeft time_left(settings);
  prepareCloud(path, settings, console, cloud);
  if (cloud.parts) {
    cloud.meshed = cloud.parts->parts.front().points;
  }
  StageProgress progress(console);
  runLibrary("cannot mesh " + inQuotes(path) + leftOutNote(cloud),
             "check that the file holds the cloud you mean",
             [&] { meshChosen(settings, time_left(), progress, cloud); });
}

void reconstructParts(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, PartsReconstruction& result) {
  CloudReconstruction& cloud = result.cloud;
  const TimeLeft time_left(settings);
  prepareCloud(path, settings, console, cloud);
  std::vector<Part>& found = cloud.parts->parts;
  std::size_t points_left = 0;
  for (const Part& part : found) {
    points_left += part.points.size();
  }
  std::vector<Part> meshed;
  StageProgress progress(console);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::string name = "part " + std::to_string(i + 1) + " of " +
                             std::to_string(found.size()) + " (" +
                             counted(found[i].points.size(), "point") + ")";
    console.heading("\n" + name);
    CloudReconstruction part;
    part.data = cloud.data;
    part.meshed = found[i].points;
    // Each part has its share of the time.
    std::optional<double> time_limit = time_left();
    if (time_limit) {
      *time_limit *= static_cast<double>(part.meshed.size()) / static_cast<double>(points_left);
    }
    points_left -= part.meshed.size();
    try {
      runLibrary("cannot mesh " + name, "",
                 [&] { meshChosen(settings, time_limit, progress, part); });
    } catch (const Failure& failure) {
      progress.finish();
      result.failures.emplace_back(failure.what());
      cloud.parts->left_out.insert(cloud.parts->left_out.end(), part.meshed.begin(),
                                   part.meshed.end());
      continue;
    }
    result.parts.push_back(std::move(part));
    meshed.push_back(std::move(found[i]));
  }
  if (meshed.empty()) {
    throw Failure("no part of " + inQuotes(path) + " can be meshed; " + result.failures.front(),
                  "check that the file holds the cloud you mean");
  }
  found = std::move(meshed);
  std::vector<Index>& left_out = cloud.parts->left_out;
  std::sort(left_out.begin(), left_out.end());
  cloud.meshed = without(cloud.meshed, left_out);
}

Positions vertexPositions(const CloudReconstruction& cloud) {
  return cloud.result.moved().cols() > 0 ? cloud.result.moved()
                                         : positionsOf(*cloud.data, cloud.point_of_vertex);
}

MeshView meshOf(const CloudReconstruction& cloud) {
  MeshView mesh(*cloud.data, cloud.point_of_vertex, cloud.result.triangles);
  if (cloud.result.moved().cols() > 0) {
    mesh.moveTo(cloud.result.moved());
  }
  return mesh;
}

JoinedMesh::JoinedMesh(const std::vector<CloudReconstruction>& parts) {
  Eigen::Index triangles = 0;
  Eigen::Index places = 0;
  for (const CloudReconstruction& part : parts) {
    triangles += part.result.triangles.cols();
    places += part.result.moved().cols();
  }
  data_ = parts.front().data;
  triangles_.resize(3, triangles);
  places_.resize(3, places);
  triangles = 0;
  for (const CloudReconstruction& part : parts) {
    const Eigen::Index first = static_cast<Eigen::Index>(point_of_vertex_.size());
    const Surface& result = part.result;
    triangles_.middleCols(triangles, result.triangles.cols()) =
        result.triangles.array() + static_cast<Index>(first);
    triangles += result.triangles.cols();
    if (places > 0) {
      places_.middleCols(first, result.moved().cols()) = result.moved();
    }
    point_of_vertex_.insert(point_of_vertex_.end(), part.point_of_vertex.begin(),
                            part.point_of_vertex.end());
  }
}

MeshView JoinedMesh::view() const {
  MeshView mesh(*data_, point_of_vertex_, triangles_);
  if (places_.cols() > 0) {
    mesh.moveTo(places_);
  }
  return mesh;
}

MeshView sphereOf(const CloudReconstruction& cloud, const Positions& sphere) {
  MeshView view(*cloud.data, cloud.point_of_vertex, cloud.result.triangles);
  view.leaveOutNormals();
  view.moveTo(sphere);
  return view;
}

}  // namespace spherical_param::tools
