#include "spherical_param_ros/cloud_mesh.h"

#include "spherical_param/errors.h"
#include "spherical_param/reconstruct.h"

#include <pcl/PCLPointField.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <exception>
#include <new>

namespace spherical_param_ros {
namespace {

using spherical_param::InvalidInput;
using spherical_param::Positions;
using spherical_param::Result;

/// The size of a real number; 0 for integers.
std::size_t sizeOf(std::uint8_t datatype) {
  if (datatype == pcl::PCLPointField::FLOAT64)
    return sizeof(double);
  return datatype == pcl::PCLPointField::FLOAT32 ? sizeof(float) : 0;
}

const pcl::PCLPointField* findField(const pcl::PCLPointCloud2& cloud, const std::string& name) {
  for (const pcl::PCLPointField& field : cloud.fields)
    if (field.name == name)
      return &field;
  return nullptr;
}

/// Checks that the sizes and the fields of the message fit its data. \throw InvalidInput
void checkLayout(const pcl::PCLPointCloud2& cloud, std::size_t max_points) {
  const std::uint64_t points = std::uint64_t{cloud.width} * cloud.height;
  if (points == 0)
    throw InvalidInput("the cloud is empty; publish clouds of at least 4 points");
  if (max_points > 0 && points > max_points)
    throw InvalidInput("the cloud has " + std::to_string(points) +
                       " points, more than max_points, " + std::to_string(max_points) +
                       "; thin it out, or raise max_points");
  if (cloud.is_bigendian)
    throw InvalidInput("the cloud is big-endian; publish it with is_bigendian false");
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  if (cloud.point_step == 0 || cloud.row_step < row)
    throw InvalidInput("the cloud's row_step is " + std::to_string(cloud.row_step) +
                       ", but its width is " + std::to_string(cloud.width) +
                       " and its point_step " + std::to_string(cloud.point_step) +
                       "; set row_step to width * point_step");
  const std::uint64_t bytes = std::uint64_t{cloud.height - 1} * cloud.row_step + row;
  if (cloud.data.size() < bytes)
    throw InvalidInput("the cloud has " + std::to_string(cloud.data.size()) +
                       " bytes of data, but " + std::to_string(points) + " points need " +
                       std::to_string(bytes) +
                       "; send all of the data, or correct width and height");
  for (const char* name : {"x", "y", "z"}) {
    const pcl::PCLPointField* field = findField(cloud, name);
    if (!field)
      throw InvalidInput(std::string("the cloud has no field '") + name +
                         "'; publish one with x, y and z");
    const std::size_t size = sizeOf(field->datatype);
    if (size == 0)
      throw InvalidInput("the field '" + field->name +
                         "' is an integer; publish coordinates as FLOAT32 or FLOAT64");
    if (std::uint64_t{field->offset} + size > cloud.point_step)
      throw InvalidInput("the field '" + field->name + "' ends after byte " +
                         std::to_string(std::uint64_t{field->offset} + size) +
                         " of a point, but point_step is " + std::to_string(cloud.point_step) +
                         "; correct offset or point_step");
  }
}

/// The record of a point. Rows may end with padding.
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

/// One vector for each record, finite or not.
Positions vectorsOf(const pcl::PCLPointCloud2& cloud, const Axes& axes) {
  Positions points(3, static_cast<Eigen::Index>(std::size_t{cloud.width} * cloud.height));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const std::uint8_t* record = recordOf(cloud, static_cast<std::size_t>(i));
    points.col(i) << coordinate(record, *axes[0]), coordinate(record, *axes[1]),
        coordinate(record, *axes[2]);
  }
  return points;
}

/// The normals, if there are any, and the sensor, which is at the origin.
spherical_param::CloudInfo infoOf(const pcl::PCLPointCloud2& cloud, const Positions& points) {
  spherical_param::CloudInfo info;
  info.viewpoint = spherical_param::viewpointOf(points, Eigen::Vector3d::Zero(), cloud.height > 1);
  const Axes axes = {findField(cloud, "normal_x"), findField(cloud, "normal_y"),
                     findField(cloud, "normal_z")};
  if (std::all_of(axes.begin(), axes.end(), [&](const pcl::PCLPointField* field) {
        return field && sizeOf(field->datatype) > 0 &&
               std::uint64_t{field->offset} + sizeOf(field->datatype) <= cloud.point_step;
      }))
    info.normals = vectorsOf(cloud, axes);
  return info;
}

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
  for (std::size_t i = 0; i < mesh.cloud.width; ++i) {
    const std::uint8_t* bgra = recordOf(mesh.cloud, i) + field->offset;
    mesh.colors.push_back({bgra[2], bgra[1], bgra[0], has_alpha ? bgra[3] : std::uint8_t{255}});
  }
}

std::shared_ptr<const Mesh> makeMesh(const pcl::PCLPointCloud2& cloud, const Result& result) {
  const spherical_param::JoinedMesh joined = spherical_param::joined(result);
  const std::size_t vertices = joined.input_of_vertex.size();
  auto mesh = std::make_shared<Mesh>();
  pcl::PCLPointCloud2& kept = mesh->cloud;
  kept.header = cloud.header;
  kept.fields = cloud.fields;
  kept.is_bigendian = cloud.is_bigendian;
  kept.point_step = cloud.point_step;
  kept.height = 1;
  kept.width = static_cast<std::uint32_t>(vertices);
  kept.row_step = kept.width * kept.point_step;
  kept.is_dense = 1;
  kept.data.resize(vertices * kept.point_step);
  const Axes axes = axesOf(cloud);
  for (std::size_t v = 0; v < vertices; ++v) {
    std::uint8_t* record = kept.data.data() + v * kept.point_step;
    std::memcpy(record, recordOf(cloud, static_cast<std::size_t>(joined.input_of_vertex[v])),
                kept.point_step);
    for (std::size_t axis = 0; axis < 3; ++axis)
      setCoordinate(record, *axes[axis],
                    joined.points(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(v)));
  }
  mesh->vertices = vectorsOf(kept, axes);  // in the precision of the cloud
  mesh->triangles = joined.triangles;
  copyColors(cloud, *mesh);
  return mesh;
}

/// Puts verdict, warnings and faults of a result into the outcome.
void describe(const Result& result, Outcome& outcome) {
  outcome.warnings = result.failures;
  for (const spherical_param::Finding& finding : result.findings)
    outcome.warnings.push_back(finding.option.empty() ? finding.text
                                                      : finding.text + ": try " + finding.option +
                                                            " = " + finding.value);
  outcome.message = result.verdict;
  outcome.has_faults = !result.failures.empty() || spherical_param::hasFault(result.findings);
}

void reconstruct(const pcl::PCLPointCloud2& cloud, const Settings& settings,
                 const std::function<bool()>& is_wanted, Outcome& outcome) {
  outcome.points = std::size_t{cloud.width} * cloud.height;
  checkLayout(cloud, settings.max_points);
  spherical_param::Options options = settings.options;
  options.progress = [&](const spherical_param::Progress&) { return !is_wanted || is_wanted(); };
  const Positions points = vectorsOf(cloud, axesOf(cloud));
  const Result result = spherical_param::reconstruct(points, options, {}, infoOf(cloud, points));
  describe(result, outcome);
  outcome.mesh = makeMesh(cloud, result);
  outcome.status = Status::Done;
}

}  // namespace

const char* nameOf(Status status) {
  constexpr const char* names[] = {"done", "failed", "cancelled", "dropped", "refused"};
  return names[static_cast<std::size_t>(status)];
}

Outcome meshCloud(const pcl::PCLPointCloud2& cloud, const Settings& settings,
                  const std::function<bool()>& is_wanted) {
  const auto start = std::chrono::steady_clock::now();
  Outcome outcome;
  try {
    reconstruct(cloud, settings, is_wanted, outcome);
  } catch (const spherical_param::Cancelled&) {
    outcome.status = Status::Cancelled;
    outcome.message = "cancelled; send the cloud again";
  } catch (const std::bad_alloc&) {
    outcome.message = "out of memory; thin the cloud out, or lower max_points";
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
