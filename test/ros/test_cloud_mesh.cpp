// Meshes of clouds are those of the core: fields, layouts, precision and errors are what is added.

#include "ros_clouds.h"
#include "spherical_param_ros/cloud_mesh.h"

#include "spherical_param/reconstruct.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

namespace spherical_param_ros {
namespace {

using spherical_param::Positions;
using test::ellipsoid;
using test::setPoint;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Outcome meshed(const pcl::PCLPointCloud2& cloud, const Settings& settings = {}) {
  Outcome outcome = meshCloud(cloud, settings, {});
  EXPECT_EQ(outcome.status, Status::Done) << outcome.message;
  return outcome;
}

using Record = std::vector<std::uint8_t>;

Record record(const pcl::PCLPointCloud2& cloud, std::size_t i) {
  const auto begin = cloud.data.begin() + static_cast<std::ptrdiff_t>(i * cloud.point_step);
  return {begin, begin + cloud.point_step};
}

/// The coordinates that records begin with.
template <typename Scalar>
Positions positionsOf(const pcl::PCLPointCloud2& cloud) {
  Positions positions(3, cloud.width);
  for (std::uint32_t i = 0; i < cloud.width; ++i) {
    Eigen::Matrix<Scalar, 3, 1> position;
    std::memcpy(position.data(), record(cloud, i).data(), sizeof(position));
    positions.col(i) = position.template cast<double>();
  }
  return positions;
}

/// The outcome has the core's mesh, to the bit, with moved vertices in the precision of the cloud,
/// and all other fields of the points.
template <typename Scalar>
void expectCoresMesh(const Outcome& outcome, const pcl::PCLPointCloud2& cloud,
                     const Settings& settings = {}) {
  const auto result = spherical_param::reconstruct(positionsOf<Scalar>(cloud), settings.options);
  const spherical_param::JoinedMesh core = spherical_param::joined(result);
  const Positions vertices = core.points.cast<Scalar>().template cast<double>();
  const Mesh& mesh = *outcome.mesh;
  EXPECT_EQ(positionsOf<Scalar>(mesh.cloud), vertices);
  EXPECT_EQ(mesh.vertices, vertices);
  EXPECT_EQ(mesh.triangles, core.triangles);
  for (std::size_t v = 0; v < core.input_of_vertex.size(); ++v) {
    Record expected = record(cloud, static_cast<std::size_t>(core.input_of_vertex[v]));
    const Record found = record(mesh.cloud, v);
    std::copy_n(found.begin(), 3 * sizeof(Scalar), expected.begin());
    EXPECT_EQ(found, expected);
  }
  EXPECT_EQ(outcome.message, result.verdict);
  EXPECT_EQ(outcome.has_faults, spherical_param::hasFault(result.findings));
  EXPECT_EQ(outcome.warnings.size(), result.findings.size());
}

TEST(RosCloudMesh, KeepsHeaderFieldsAndColoursOfDistinctFinitePoints) {
  pcl::PCLPointCloud2 cloud = ellipsoid(300);
  setPoint(cloud, 7, kNan, 0.0, 0.0);
  std::copy_n(cloud.data.begin(), 12, cloud.data.begin() + 20 * cloud.point_step);
  for (const bool has_alpha : {false, true}) {
    cloud.fields[4].name = has_alpha ? "rgba" : "rgb";
    cloud.fields[4].datatype = has_alpha ? pcl::PCLPointField::UINT32 : pcl::PCLPointField::FLOAT32;
    const Outcome outcome = meshed(cloud);
    EXPECT_EQ(outcome.points, 300U);
    EXPECT_GT(outcome.seconds, 0.0);
    const Mesh& mesh = *outcome.mesh;
    EXPECT_EQ(mesh.cloud.header.frame_id, "scanner");
    EXPECT_EQ(mesh.cloud.header.stamp, 1234567U);
    EXPECT_EQ(mesh.cloud.fields.size(), 5U);
    ASSERT_EQ(mesh.cloud.width, 298U);
    ASSERT_EQ(mesh.colors.size(), 298U);
    std::size_t vertex = 0;
    for (std::size_t i = 0; i < 300; ++i) {
      if (i == 7 || i == 20)
        continue;
      const Record bytes = record(cloud, i);
      const std::uint8_t alpha = has_alpha ? bytes[19] : std::uint8_t{255};
      EXPECT_EQ(mesh.colors[vertex],
                (std::array<std::uint8_t, 4>{bytes[18], bytes[17], bytes[16], alpha}));
      ++vertex;
    }
    expectCoresMesh<float>(outcome, cloud);
  }
}

TEST(RosCloudMesh, OrganizedCloudsWithPaddedRowsAreRead) {
  const pcl::PCLPointCloud2 flat = ellipsoid(200);
  pcl::PCLPointCloud2 padded = flat;
  padded.width = 20;
  padded.height = 10;
  padded.row_step = 20 * padded.point_step + 13;
  padded.data.assign(std::size_t{10} * padded.row_step, 0xff);
  for (std::ptrdiff_t row = 0; row < 10; ++row)
    std::copy_n(flat.data.begin() + row * 400, 400, padded.data.begin() + row * 413);
  Settings settings;
  settings.max_points = 200;
  const Outcome outcome = meshed(padded, settings);
  EXPECT_EQ(outcome.mesh->cloud.data, flat.data);
  expectCoresMesh<float>(outcome, flat);
}

// UTM coordinates, which single precision would put on a grid of half a metre, without colours.
TEST(RosCloudMesh, DoublePrecisionKeepsItsDigits) {
  const Positions points =
      positionsOf<float>(ellipsoid(300)).colwise() + Eigen::Vector3d(500000.0, -4649776.25, 212.5);
  pcl::PCLPointCloud2 cloud = ellipsoid(300);
  cloud.point_step = 25;
  cloud.row_step = 25 * cloud.width;
  cloud.data.assign(cloud.row_step, 0);
  cloud.fields.resize(3);
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    cloud.fields[axis] = test::field(std::string(1, static_cast<char>('x' + axis)), 8 * axis,
                                     pcl::PCLPointField::FLOAT64);
    for (std::uint32_t i = 0; i < cloud.width; ++i)
      test::put(cloud, i, 8 * axis, points(axis, i));
  }
  Settings settings;
  settings.options.smoothing = 5;
  settings.max_points = 0;  // no limit
  const Outcome outcome = meshed(cloud, settings);
  EXPECT_TRUE(outcome.mesh->colors.empty());
  expectCoresMesh<double>(outcome, cloud, settings);
}

TEST(RosCloudMesh, OptionsHoldAndAllSurfacesAreOneMesh) {
  // A bowl, a small ellipsoid beside it, and a stray point.
  pcl::PCLPointCloud2 cloud = ellipsoid(1501);
  const Positions small = positionsOf<float>(ellipsoid(501));
  for (std::uint32_t i = 0; i < 500; ++i)
    setPoint(cloud, i, small(0, i) + 6.0, small(1, i), small(2, i));
  setPoint(cloud, 500, 0.0, 50.0, 0.0);
  Settings each;
  each.options.surface = spherical_param::SurfaceMode::Open;
  each.options.smoothing = 3;
  Settings sphere;
  sphere.options.topology = spherical_param::TopologyMode::Sphere;
  for (const auto& [settings, has_faults] : {std::pair(each, false), std::pair(sphere, true)}) {
    const Outcome outcome = meshed(cloud, settings);
    EXPECT_EQ(outcome.has_faults, has_faults) << outcome.message;
    EXPECT_EQ(outcome.mesh->colors.size(), outcome.mesh->cloud.width);
    expectCoresMesh<float>(outcome, cloud, settings);
  }
}

TEST(RosCloudMesh, TheWorkEndsWhenItIsNoLongerWanted) {
  for (const int wanted : {0, 1, 2, 20}) {
    int asked = 0;
    const Outcome ended = meshCloud(ellipsoid(1500), {}, [&] { return asked++ < wanted; });
    EXPECT_EQ(ended.status, Status::Cancelled);
    EXPECT_EQ(ended.mesh, nullptr);
    EXPECT_EQ(asked, wanted + 1);
  }
}

// The sensor is at the origin.
TEST(RosCloudMesh, SurfacesFaceTheSensorOrAsTheNormalsOfThePointsDo) {
  pcl::PCLPointCloud2 cloud = ellipsoid(400);
  for (std::uint32_t i = 0; i < 400; ++i)
    setPoint(cloud, i, i % 20 - 9.5, i / 20 - 9.5, 5.0 + 0.01 * (i % 7));
  for (const bool has_normals : {false, true}) {
    if (has_normals) {  // away from the sensor
      cloud.fields[3] = test::field("normal_z", 12);
      for (std::uint32_t i = 0; i < 400; ++i) {
        test::put(cloud, i, 12, 1.0F);
        test::put(cloud, i, 16, 0.0F);
      }
      cloud.fields.push_back(test::field("normal_x", 16));
      cloud.fields.push_back(test::field("normal_y", 16));
    }
    const Outcome outcome = meshed(cloud);
    const Eigen::Matrix3d corners =
        outcome.mesh->vertices(Eigen::all, outcome.mesh->triangles.col(0));
    EXPECT_EQ(corners.determinant() > 0.0, has_normals);
  }
}

TEST(RosCloudMesh, BadCloudsAreAnsweredWithCauseAndRemedy) {
  using Change = std::function<void(pcl::PCLPointCloud2&)>;
  const std::vector<std::pair<std::string, Change>> cases = {
      {"empty", [](auto& c) { c = pcl::PCLPointCloud2(); }},
      {"4 distinct", [](auto& c) { c = ellipsoid(3); }},
      {"no field 'z'", [](auto& c) { c.fields.erase(c.fields.begin() + 2); }},
      {"is an integer", [](auto& c) { c.fields[1].datatype = pcl::PCLPointField::UINT32; }},
      {"ends after byte 21 ", [](auto& c) { c.fields[0].offset = 17; }},
      {"point_step is 20", [](auto& c) { c.fields[0].offset = 0xffffffff; }},
      {"bytes of data", [](auto& c) { c.data.resize(c.data.size() - 1); }},
      {"row_step", [](auto& c) { c.width = 101; }},
      {"row_step", [](auto& c) { c.point_step = 0; }},
      {"bytes of data", [](auto& c) { c.height = 30000; }},
      {"max_points", [](auto& c) { c.width = c.height = 0xffffffff; }},
      {"big-endian", [](auto& c) { c.is_bigendian = 1; }},
  };
  for (const auto& [cause, change] : cases) {
    pcl::PCLPointCloud2 cloud = ellipsoid(100);
    change(cloud);
    const Outcome outcome = meshCloud(cloud, {}, {});
    EXPECT_EQ(outcome.status, Status::Failed) << cause;
    EXPECT_EQ(outcome.mesh, nullptr);
    // The size is reported even of a cloud that is refused because of it.
    EXPECT_EQ(outcome.points, std::size_t{cloud.width} * cloud.height);
    EXPECT_NE(outcome.message.find(cause), std::string::npos) << cause << ": " << outcome.message;
    EXPECT_NE(outcome.message.find("; "), std::string::npos) << outcome.message;
  }
}

}  // namespace
}  // namespace spherical_param_ros
