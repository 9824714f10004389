#include "spherical_param_ros/cloud_mesh.h"

#include "common/outlier_removal.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>
#include <utility>

namespace spherical_param_ros {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/// A cloud that cannot be used: the message is "cause; remedy".
class BadCloud : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

std::size_t sizeOf(std::uint8_t datatype) {
  switch (datatype) {
  case pcl::PCLPointField::FLOAT32:
    return sizeof(float);
  case pcl::PCLPointField::FLOAT64:
    return sizeof(double);
  default:
    return 0;
  }
}

const pcl::PCLPointField* findField(const pcl::PCLPointCloud2& cloud, const std::string& name) {
  for (const pcl::PCLPointField& field : cloud.fields)
    if (field.name == name)
      return &field;
  return nullptr;
}

/// Checks that all records are where the sizes of the message say. \throw BadCloud
void checkLayout(const pcl::PCLPointCloud2& cloud, std::size_t max_points) {
  const std::uint64_t points = std::uint64_t{cloud.width} * cloud.height;
  if (points == 0)
    throw BadCloud("the cloud is empty; publish clouds of at least 4 points");
  if (max_points > 0 && points > max_points)
    throw BadCloud("the cloud has " + std::to_string(points) + " points, more than max_points, " +
                   std::to_string(max_points) + "; thin it out (VoxelGrid), or raise max_points");
  if (cloud.is_bigendian)
    throw BadCloud("the cloud is big-endian; publish it with is_bigendian false");
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  if (cloud.point_step == 0 || cloud.row_step < row)
    throw BadCloud("the cloud's row_step is " + std::to_string(cloud.row_step) +
                   ", but its width is " + std::to_string(cloud.width) + " and its point_step " +
                   std::to_string(cloud.point_step) + "; set row_step to width * point_step");
  const std::uint64_t bytes = std::uint64_t{cloud.height - 1} * cloud.row_step + row;
  if (cloud.data.size() < bytes)
    throw BadCloud("the cloud has " + std::to_string(cloud.data.size()) + " bytes of data, but " +
                   std::to_string(points) + " points need " + std::to_string(bytes) +
                   "; send all of the data, or correct width and height");
  for (const char* name : {"x", "y", "z"}) {
    const pcl::PCLPointField* field = findField(cloud, name);
    if (!field)
      throw BadCloud(std::string("the cloud has no field '") + name +
                     "'; publish one with x, y and z");
    const std::size_t size = sizeOf(field->datatype);
    if (size == 0)
      throw BadCloud("the field '" + field->name +
                     "' is an integer; publish coordinates as FLOAT32 or FLOAT64");
    if (std::uint64_t{field->offset} + size > cloud.point_step)
      throw BadCloud("the field '" + field->name + "' ends after byte " +
                     std::to_string(std::uint64_t{field->offset} + size) +
                     " of a point, but point_step is " + std::to_string(cloud.point_step) +
                     "; correct offset or point_step");
  }
}

/// Where the record of a point begins. The rows may have bytes at their ends that belong to none.
const std::uint8_t* recordOf(const pcl::PCLPointCloud2& cloud, std::size_t point) {
  const std::size_t row = point / cloud.width;
  return cloud.data.data() + row * cloud.row_step + (point - row * cloud.width) * cloud.point_step;
}

double coordinate(const std::uint8_t* record, const pcl::PCLPointField& field) {
  if (field.datatype == pcl::PCLPointField::FLOAT64) {
    double value = 0.0;
    std::memcpy(&value, record + field.offset, sizeof(value));
    return value;
  }
  float value = 0.0F;
  std::memcpy(&value, record + field.offset, sizeof(value));
  return value;
}

void setCoordinate(std::uint8_t* record, const pcl::PCLPointField& field, double value) {
  if (field.datatype == pcl::PCLPointField::FLOAT64) {
    std::memcpy(record + field.offset, &value, sizeof(value));
    return;
  }
  const auto rounded = static_cast<float>(value);
  std::memcpy(record + field.offset, &rounded, sizeof(rounded));
}

using Axes = std::array<const pcl::PCLPointField*, 3>;

Axes axesOf(const pcl::PCLPointCloud2& cloud) {
  return {findField(cloud, "x"), findField(cloud, "y"), findField(cloud, "z")};
}

/// What is subtracted before coordinates in double precision become single ones: of each axis the
/// value nearest to 0 in the cloud's range. Without it georeferenced clouds would collapse, and
/// around the origin it is 0.
std::array<double, 3> originOf(const pcl::PCLPointCloud2& cloud, const Axes& axes) {
  const std::size_t count = std::size_t{cloud.width} * cloud.height;
  std::array<double, 3> origin = {};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axes[axis]->datatype != pcl::PCLPointField::FLOAT64)
      continue;
    double least = std::numeric_limits<double>::infinity();
    double greatest = -least;
    for (std::size_t i = 0; i < count; ++i) {
      const double value = coordinate(recordOf(cloud, i), *axes[axis]);
      if (std::isfinite(value)) {
        least = std::min(least, value);
        greatest = std::max(greatest, value);
      }
    }
    if (least <= greatest)
      origin[axis] = std::clamp(0.0, least, greatest);
  }
  return origin;
}

/// The coordinates from an origin on in PCL's type, with all other fields left behind.
Cloud::Ptr coordinatesOf(const pcl::PCLPointCloud2& cloud, const std::array<double, 3>& origin) {
  const Axes axes = axesOf(cloud);
  const std::size_t count = std::size_t{cloud.width} * cloud.height;
  Cloud::Ptr points(new Cloud);
  points->reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* record = recordOf(cloud, i);
    const auto from_origin = [&](std::size_t axis) {
      return static_cast<float>(coordinate(record, *axes[axis]) - origin[axis]);
    };
    points->emplace_back(from_origin(0), from_origin(1), from_origin(2));
  }
  points->is_dense = false;
  return points;
}

/// The points that are no outliers. \throw BadCloud, Unwanted
std::shared_ptr<pcl::Indices> withoutOutliers(const Cloud& cloud, const Settings& settings,
                                              const std::function<bool()>& is_wanted,
                                              Outcome& outcome) {
  using spherical_param::tools::findOutlierPoints;
  std::vector<spherical_param::tools::Point> points;
  points.reserve(cloud.size());
  for (const pcl::PointXYZ& point : cloud)
    points.push_back({point.x, point.y, point.z});
  const auto removal =
      findOutlierPoints(points,
                        settings.outlier_method == OutlierMethod::Paper
                            ? spherical_param::tools::OutlierMethod::Paper
                            : spherical_param::tools::OutlierMethod::Statistical,
                        *settings.outlier_sigma, settings.options.threads, is_wanted);
  outcome.outliers = removal.indices.size();
  if (removal.kept_positions < 4 && !removal.indices.empty())
    throw BadCloud(std::to_string(removal.indices.size()) + " of " + std::to_string(cloud.size()) +
                   " points are outliers, and the rest cannot be meshed; raise outliers");
  return std::make_shared<pcl::Indices>(removal.kept.begin(), removal.kept.end());
}

using Reconstruction = pcl::SphericalParamReconstruction<pcl::PointXYZ>;

/// PCL packs colours as blue, green, red, alpha, in an integer or in the bits of a float.
void copyColors(const pcl::PCLPointCloud2& cloud, Mesh& mesh) {
  const pcl::PCLPointField* field = findField(cloud, "rgba");
  const bool has_alpha = field != nullptr;
  if (!field)
    field = findField(cloud, "rgb");
  if (!field || std::uint64_t{field->offset} + 4 > cloud.point_step)
    return;
  if (field->datatype != pcl::PCLPointField::FLOAT32 &&
      field->datatype != pcl::PCLPointField::UINT32 && field->datatype != pcl::PCLPointField::INT32)
    return;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const std::uint8_t* bgra = recordOf(mesh.cloud, i) + field->offset;
    mesh.colors.push_back({bgra[2], bgra[1], bgra[0], has_alpha ? bgra[3] : std::uint8_t{255}});
  }
}

std::shared_ptr<const Mesh> makeMesh(const pcl::PCLPointCloud2& cloud,
                                     const Reconstruction& reconstruction,
                                     const std::array<double, 3>& origin) {
  const spherical_param::Result& result = reconstruction.getResult();
  const pcl::Indices& points = reconstruction.getVertexIndices();
  auto mesh = std::make_shared<Mesh>();
  pcl::PCLPointCloud2& kept = mesh->cloud;
  kept.header = cloud.header;
  kept.fields = cloud.fields;
  kept.is_bigendian = cloud.is_bigendian;
  kept.point_step = cloud.point_step;
  kept.height = 1;
  kept.width = static_cast<std::uint32_t>(points.size());
  kept.row_step = kept.width * kept.point_step;
  kept.is_dense = 1;
  kept.data.resize(points.size() * kept.point_step);

  const Axes axes = axesOf(cloud);
  mesh->vertices.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::uint8_t* record = kept.data.data() + i * kept.point_step;
    std::memcpy(record, recordOf(cloud, static_cast<std::size_t>(points[i])), kept.point_step);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (result.smoothed.cols() > 0)
        setCoordinate(record, *axes[axis],
                      origin[axis] + result.smoothed(static_cast<Eigen::Index>(axis),
                                                     static_cast<Eigen::Index>(i)));
      mesh->vertices[i][axis] = coordinate(record, *axes[axis]);
    }
  }
  mesh->triangles.reserve(static_cast<std::size_t>(result.triangles.cols()));
  for (Eigen::Index t = 0; t < result.triangles.cols(); ++t)
    mesh->triangles.push_back({static_cast<std::uint32_t>(result.triangles(0, t)),
                               static_cast<std::uint32_t>(result.triangles(1, t)),
                               static_cast<std::uint32_t>(result.triangles(2, t))});
  copyColors(cloud, *mesh);
  return mesh;
}

void reconstruct(const pcl::PCLPointCloud2& cloud, const Settings& settings,
                 const std::function<bool()>& is_wanted, Outcome& outcome) {
  outcome.points = std::size_t{cloud.width} * cloud.height;
  checkLayout(cloud, settings.max_points);
  if (is_wanted && !is_wanted())
    throw spherical_param::tools::Unwanted();
  Reconstruction reconstruction;
  reconstruction.setOptions(settings.options);
  const std::array<double, 3> origin = originOf(cloud, axesOf(cloud));
  const Cloud::Ptr points = coordinatesOf(cloud, origin);
  reconstruction.setInputCloud(points);
  if (settings.outlier_sigma)
    reconstruction.setIndices(withoutOutliers(*points, settings, is_wanted, outcome));
  bool cancelled = false;
  reconstruction.setProgressCallback([&](const spherical_param::Progress&) {
    cancelled = cancelled || (is_wanted && !is_wanted());
    return !cancelled;
  });
  reconstruction.reconstruct();
  outcome.ignored = reconstruction.getIgnoredPointCount();
  if (!reconstruction.getErrorMessage().empty()) {
    outcome.status = cancelled ? Status::Cancelled : Status::Failed;
    outcome.message = reconstruction.getErrorMessage();
    return;
  }
  const spherical_param::Result& result = reconstruction.getResult();
  outcome.mesh = makeMesh(cloud, reconstruction, origin);
  outcome.status = Status::Done;
  outcome.message = result.diagnosis.summary;
  outcome.looks_closed = result.diagnosis.looksClosedGenus0();
  outcome.warnings = result.warnings;
  outcome.duplicates = result.duplicates;
  outcome.self_intersections = result.self_intersections.size();
}

}  // namespace

const char* nameOf(Status status) {
  switch (status) {
  case Status::Done:
    return "done";
  case Status::Failed:
    return "failed";
  case Status::Cancelled:
    return "cancelled";
  case Status::Dropped:
    return "dropped";
  case Status::Refused:
    return "refused";
  }
  return "";
}

Outcome meshCloud(const pcl::PCLPointCloud2& cloud, const Settings& settings,
                  const std::function<bool()>& is_wanted) {
  const auto start = std::chrono::steady_clock::now();
  Outcome outcome;
  try {
    reconstruct(cloud, settings, is_wanted, outcome);
  } catch (const BadCloud& error) {
    outcome.message = error.what();
  } catch (const spherical_param::tools::Unwanted&) {
    outcome.status = Status::Cancelled;
    outcome.message = "cancelled; send the cloud again";
  } catch (const std::bad_alloc&) {
    outcome.message = "out of memory; thin the cloud out (VoxelGrid), or lower max_points";
  } catch (const std::exception& error) {
    outcome.message = error.what();
  }
  if (outcome.status != Status::Done) {
    outcome.mesh.reset();
    if (outcome.message.find("; ") == std::string::npos)
      outcome.message += "; check the scanner and the filters before this node";
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

}  // namespace spherical_param_ros
