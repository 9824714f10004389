#include "ros_clouds.h"
#include "spherical_param_ros/cloud_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param_ros {
namespace {

using test::ellipsoid;
using test::setPoint;

Outcome meshed(const pcl::PCLPointCloud2& cloud, const Settings& settings = {}) {
  return meshCloud(cloud, settings, {});
}

/// The record of a vertex, or of a point of the cloud.
std::vector<std::uint8_t> record(const pcl::PCLPointCloud2& cloud, std::size_t i) {
  const auto begin = cloud.data.begin() + static_cast<std::ptrdiff_t>(i * cloud.point_step);
  return {begin, begin + cloud.point_step};
}

/// The coordinates at the beginning of a record, in single precision.
std::array<double, 3> position(const pcl::PCLPointCloud2& cloud, std::size_t i) {
  std::array<float, 3> values = {};
  std::memcpy(values.data(), record(cloud, i).data(), sizeof(values));
  return {values[0], values[1], values[2]};
}

/// The coordinates of a cloud in double precision, moved.
pcl::PCLPointCloud2 inDoublePrecision(const pcl::PCLPointCloud2& single,
                                      const std::array<double, 3>& offset) {
  pcl::PCLPointCloud2 cloud = single;
  cloud.fields = {test::field("x", 1, pcl::PCLPointField::FLOAT64),
                  test::field("y", 9, pcl::PCLPointField::FLOAT64),
                  test::field("z", 17, pcl::PCLPointField::FLOAT64)};
  cloud.point_step = 25;
  cloud.row_step = 25 * cloud.width;
  cloud.data.assign(cloud.row_step, 0);
  for (std::size_t i = 0; i < cloud.width; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double value = position(single, i)[axis] + offset[axis];
      test::put(cloud, i, 1 + 8 * axis, &value, sizeof(value));
    }
  }
  return cloud;
}

/// Closed, manifold edges in both directions, V - E + F = 2, every vertex used; of one component,
/// since each component of a closed surface adds at most 2 to V - E + F (two spheres have 4).
void expectSphere(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> half_edges;
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_LT(triangle[i], mesh.vertices.size());
      used[triangle[i]] = true;
      ++half_edges[{triangle[i], triangle[(i + 1) % 3]}];
    }
  }
  for (const auto& entry : half_edges) {
    EXPECT_EQ(entry.second, 1);
    EXPECT_EQ(half_edges.count({entry.first.second, entry.first.first}), 1U);
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  EXPECT_EQ(mesh.vertices.size() + mesh.triangles.size(), half_edges.size() / 2 + 2);
}

TEST(RosCloudMesh, KeepsHeaderFieldsAndColours) {
  pcl::PCLPointCloud2 cloud = ellipsoid(300);
  // A duplicate and a point that is not finite: neither is a vertex.
  std::copy_n(cloud.data.begin(), 12, cloud.data.begin() + 7 * cloud.point_step);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  test::put(cloud, 20, 4, &nan, sizeof(nan));
  const Outcome outcome = meshed(cloud);
  ASSERT_EQ(outcome.status, Status::Done) << outcome.message;
  EXPECT_EQ(outcome.points, 300U);
  EXPECT_EQ(outcome.duplicates, 1U);
  EXPECT_EQ(outcome.ignored, 1U);
  EXPECT_TRUE(outcome.looks_closed) << outcome.message;
  const Mesh& mesh = *outcome.mesh;
  EXPECT_EQ(mesh.cloud.header.frame_id, "scanner");
  EXPECT_EQ(mesh.cloud.header.stamp, 1234567U);
  EXPECT_EQ(mesh.cloud.fields.size(), 5U);
  ASSERT_EQ(mesh.vertices.size(), 298U);
  ASSERT_EQ(mesh.cloud.width, 298U);
  ASSERT_EQ(mesh.colors.size(), 298U);
  std::size_t vertex = 0;
  for (std::uint32_t i = 0; i < 300; ++i) {
    if (i == 7 || i == 20)
      continue;
    EXPECT_EQ(record(mesh.cloud, vertex), record(cloud, i));
    EXPECT_EQ(mesh.colors[vertex],
              (std::array<std::uint8_t, 4>{77, static_cast<std::uint8_t>(i >> 8),
                                           static_cast<std::uint8_t>(i), 255}));
    EXPECT_EQ(mesh.vertices[vertex], position(cloud, i));
    ++vertex;
  }
  expectSphere(mesh);
}

TEST(RosCloudMesh, SmallestCloudsAreMeshed) {
  for (const std::uint32_t n : {4U, 5U, 6U, 7U, 20U}) {
    const Outcome outcome = meshed(ellipsoid(n));
    ASSERT_EQ(outcome.status, Status::Done) << outcome.message;
    EXPECT_EQ(outcome.mesh->vertices.size(), n);
    expectSphere(*outcome.mesh);
  }
}

TEST(RosCloudMesh, OrganizedCloudsWithPaddedRowsAreRead) {
  const pcl::PCLPointCloud2 flat = ellipsoid(200);
  pcl::PCLPointCloud2 padded = flat;
  padded.width = 20;
  padded.height = 10;
  padded.row_step = 20 * padded.point_step + 13;
  padded.data.assign(std::size_t{10} * padded.row_step, 0xff);
  for (std::size_t row = 0; row < 10; ++row)
    std::copy_n(flat.data.begin() + static_cast<std::ptrdiff_t>(row * 20 * flat.point_step),
                20 * flat.point_step,
                padded.data.begin() + static_cast<std::ptrdiff_t>(row * padded.row_step));
  const Outcome a = meshed(flat);
  const Outcome b = meshed(padded);
  ASSERT_EQ(b.status, Status::Done) << b.message;
  EXPECT_EQ(a.mesh->triangles, b.mesh->triangles);
  EXPECT_EQ(a.mesh->cloud.data, b.mesh->cloud.data);
}

TEST(RosCloudMesh, CoordinatesInDoublePrecisionAreRead) {
  const pcl::PCLPointCloud2 single = ellipsoid(100);
  const Outcome outcome = meshed(inDoublePrecision(single, {}));
  ASSERT_EQ(outcome.status, Status::Done) << outcome.message;
  EXPECT_EQ(outcome.mesh->triangles, meshed(single).mesh->triangles);
  EXPECT_TRUE(outcome.mesh->colors.empty());
}

// UTM coordinates: in single precision half a metre apart.
TEST(RosCloudMesh, GeoreferencedCloudsKeepTheirDigits) {
  const std::array<double, 3> offset = {500000.0, -4649776.25, 212.5};
  const pcl::PCLPointCloud2 near = ellipsoid(300);
  const pcl::PCLPointCloud2 far = inDoublePrecision(near, offset);
  for (const int smoothing : {0, 5}) {
    Settings settings;
    settings.options.smoothing.steps = smoothing;
    const Outcome outcome = meshed(far, settings);
    ASSERT_EQ(outcome.status, Status::Done) << outcome.message;
    EXPECT_TRUE(outcome.looks_closed) << outcome.message;
    expectSphere(*outcome.mesh);
    const Outcome expected = meshed(near, settings);
    ASSERT_EQ(outcome.mesh->vertices.size(), 300U);
    for (std::size_t i = 0; i < 300; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        // The smoothed points of the near cloud are rounded to single precision.
        EXPECT_NEAR(outcome.mesh->vertices[i][axis] - offset[axis],
                    expected.mesh->vertices[i][axis], smoothing == 0 ? 1e-9 : 1e-6);
        double value = 0.0;
        std::memcpy(&value, record(outcome.mesh->cloud, i).data() + 1 + 8 * axis, sizeof(value));
        EXPECT_EQ(value, outcome.mesh->vertices[i][axis]);
      }
    }
    if (smoothing == 0) {
      EXPECT_EQ(outcome.mesh->cloud.data, far.data);
    }
  }
}

TEST(RosCloudMesh, OptionsReachTheReconstruction) {
  const pcl::PCLPointCloud2 cloud = ellipsoid(500);
  Settings settings;
  settings.options.smoothing.steps = 20;
  const Outcome smoothed = meshed(cloud, settings);
  ASSERT_EQ(smoothed.status, Status::Done);
  EXPECT_NE(smoothed.mesh->vertices, meshed(cloud).mesh->vertices);
  // Coordinates and message agree.
  EXPECT_EQ(smoothed.mesh->vertices[9], position(smoothed.mesh->cloud, 9));
  settings = {};
  settings.options.embedding.damping = 2.0;
  const Outcome refused = meshed(cloud, settings);
  EXPECT_EQ(refused.status, Status::Failed);
  EXPECT_NE(refused.message.find("damping"), std::string::npos) << refused.message;
}

TEST(RosCloudMesh, OutliersAreLeftOut) {
  pcl::PCLPointCloud2 cloud = ellipsoid(500);
  setPoint(cloud, 100, 20.0F, 0.0F, 0.0F);
  Settings settings;
  settings.outliers = 4.0;
  const Outcome outcome = meshed(cloud, settings);
  ASSERT_EQ(outcome.status, Status::Done) << outcome.message;
  EXPECT_EQ(outcome.outliers, 1U);
  ASSERT_EQ(outcome.mesh->vertices.size(), 499U);
  EXPECT_EQ(record(outcome.mesh->cloud, 99), record(cloud, 99));
  EXPECT_EQ(record(outcome.mesh->cloud, 100), record(cloud, 101));
}

TEST(RosCloudMesh, BadCloudsAreAnsweredWithCauseAndRemedy) {
  using Change = std::function<void(pcl::PCLPointCloud2&)>;
  const std::vector<std::pair<std::string, Change>> cases = {
      {"empty", [](auto& c) { c = pcl::PCLPointCloud2(); }},
      {"empty", [](auto& c) { c.width = 0; }},
      {"4 distinct", [](auto& c) { c = ellipsoid(3); }},
      {"plane",
       [](auto& c) {
         for (std::uint32_t i = 0; i < c.width; ++i)
           setPoint(c, i, static_cast<float>(i % 10), static_cast<float>(i / 10), 1.0F);
       }},
      {"not finite",
       [](auto& c) {
         for (std::uint32_t i = 0; i < c.width; ++i)
           setPoint(c, i, std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
       }},
      {"no field 'z'", [](auto& c) { c.fields.erase(c.fields.begin() + 2); }},
      {"no field 'x'", [](auto& c) { c.fields.clear(); }},
      {"is an integer", [](auto& c) { c.fields[1].datatype = pcl::PCLPointField::UINT32; }},
      {"point_step is 20", [](auto& c) { c.fields[0].offset = 18; }},
      {"point_step is 20", [](auto& c) { c.fields[0].offset = 0xffffffff; }},
      {"bytes of data", [](auto& c) { c.data.resize(c.data.size() - 1); }},
      {"bytes of data", [](auto& c) { c.data.clear(); }},
      {"row_step", [](auto& c) { c.width = 101; }},
      {"row_step", [](auto& c) { c.point_step = 0; }},
      {"bytes of data", [](auto& c) { c.height = 30000; }},
      {"max_points", [](auto& c) { c.width = c.height = 0xffffffff; }},
      {"big-endian", [](auto& c) { c.is_bigendian = 1; }},
  };
  for (const auto& [cause, change] : cases) {
    pcl::PCLPointCloud2 cloud = ellipsoid(100);
    change(cloud);
    const Outcome outcome = meshed(cloud);
    EXPECT_EQ(outcome.status, Status::Failed) << cause;
    EXPECT_EQ(outcome.mesh, nullptr);
    // The size is reported even of a cloud that is refused because of it.
    EXPECT_EQ(outcome.points, std::size_t{cloud.width} * cloud.height);
    EXPECT_NE(outcome.message.find(cause), std::string::npos) << cause << ": " << outcome.message;
    EXPECT_NE(outcome.message.find("; "), std::string::npos) << outcome.message;
  }
}

TEST(RosCloudMesh, EndsWhenItIsNoLongerWanted) {
  const Outcome outcome = meshCloud(ellipsoid(100), {}, [] { return false; });
  EXPECT_EQ(outcome.status, Status::Cancelled);
  EXPECT_EQ(outcome.mesh, nullptr);
}

TEST(RosCloudMesh, EndsWhileOutliersAreLookedFor) {
  pcl::PCLPointCloud2 cloud = ellipsoid(3000);
  setPoint(cloud, 100, 20.0F, 0.0F, 0.0F);
  Settings settings;
  settings.outliers = 4.0;
  // Before the search, within it, and when the outliers are told from the others.
  for (int wanted = 0; wanted < 3; ++wanted) {
    int asked = 0;
    const Outcome outcome = meshCloud(cloud, settings, [&] { return asked++ < wanted; });
    EXPECT_EQ(outcome.status, Status::Cancelled);
    EXPECT_EQ(asked, wanted + 1);
    EXPECT_EQ(outcome.outliers, 0U);
  }
}

}  // namespace
}  // namespace spherical_param_ros
