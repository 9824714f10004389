#pragma once

#include "handle_shapes.h"

#include <pcl/PolygonMesh.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <gtest/gtest.h>

/// What the tests of the PCL classes share.
namespace test {

using pcl::Indices;
using pcl::PointXYZ;
using spherical_param::Options;
using spherical_param::Positions;
using spherical_param::Surface;
using spherical_param::Triangles;
using spherical_param::test::shuffledRange;
using Cloud = pcl::PointCloud<PointXYZ>;
using Reconstruction = pcl::SphericalParamReconstruction<PointXYZ>;
using Polygons = std::vector<pcl::Vertices>;

/// Half the axes of makeEllipsoid().
inline const Eigen::Vector3d kAxes(1.5, 1.1, 0.8);

/// Colours that change slowly.
inline std::array<double, 3> colorAt(const Eigen::Vector3f& point) {
  const Eigen::Vector3d color = 80.0 * point.cast<double>();
  return {127.0 + color.x(), 127.0 + color.y(), 127.0 + color.z()};
}

/// A cloud of points, with colours if they have some.
template <typename PointT = pcl::PointXYZ>
typename pcl::PointCloud<PointT>::Ptr makeCloud(const Positions& points) {
  typename pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  for (const auto p : points.colwise()) {
    PointT point{};
    point.x = static_cast<float>(p.x());
    point.y = static_cast<float>(p.y());
    point.z = static_cast<float>(p.z());
    if constexpr (pcl::traits::has_color<PointT>::value) {
      const std::array<double, 3> color = colorAt(point.getVector3fMap());
      point.r = static_cast<std::uint8_t>(color[0]);
      point.g = static_cast<std::uint8_t>(color[1]);
      point.b = static_cast<std::uint8_t>(color[2]);
      point.a = 7;
    }
    cloud->push_back(point);
  }
  cloud->header.seq = 12;
  cloud->header.stamp = 42;
  cloud->header.frame_id = "scanner";
  return cloud;
}

/// Points spread evenly over an ellipsoid, in the order of a spiral; the axes differ so that no two
/// distances are the same.
template <typename PointT = pcl::PointXYZ>
typename pcl::PointCloud<PointT>::Ptr makeEllipsoid(int count,
                                                    const Eigen::Vector3d& axes = kAxes) {
  return makeCloud<PointT>(axes.asDiagonal() * spherical_param::test::spiralSphere(count));
}

/// A torus around z, with twice as many rings as points in each.
inline Cloud::Ptr makeTorus(int around) {
  return makeCloud(spherical_param::test::torusCloud(2 * around, around));
}

inline Triangles trianglesOf(const Polygons& polygons) {
  Triangles triangles(3, static_cast<Eigen::Index>(polygons.size()));
  for (std::size_t t = 0; t < polygons.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangles(static_cast<Eigen::Index>(corner), static_cast<Eigen::Index>(t)) =
          polygons[t].vertices.at(corner);
  return triangles;
}

/// Whether the polygons are a closed mesh of genus 0 over all points.
inline bool isSphere(const Polygons& polygons, std::size_t points) {
  return spherical_param::test::isSphereOverAll(trianglesOf(polygons), static_cast<int>(points));
}

template <typename PointT>
pcl::PointCloud<PointT> cloudOf(const pcl::PCLPointCloud2& cloud) {
  pcl::PointCloud<PointT> points;
  pcl::fromPCLPointCloud2(cloud, points);
  return points;
}

/// Silences PCL, since many tests provoke failures.
class Silent : public testing::Test {
protected:
  void SetUp() override { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }
  void TearDown() override { pcl::console::setVerbosityLevel(pcl::console::L_INFO); }
};

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

inline pcl::IndicesPtr share(const Indices& indices) {
  return pcl::IndicesPtr(new Indices(indices));
}

inline Positions positionsOf(const Cloud& cloud, const Indices& indices) {
  return cloud.getMatrixXfMap(3, 4, 0)(Eigen::all, indices).cast<double>();
}

inline Polygons meshed(Reconstruction& reconstruction) {
  Polygons polygons;
  reconstruction.reconstruct(polygons);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  return polygons;
}

/// Of a cloud, perhaps with a search of the user.
inline Reconstruction reconstructionOf(const Cloud::Ptr& cloud, bool has_search = false) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  if (has_search)
    reconstruction.setSearchMethod(
        pcl::search::KdTree<PointXYZ>::Ptr(new pcl::search::KdTree<PointXYZ>));
  return reconstruction;
}

inline Polygons meshed(const Cloud::Ptr& cloud) {
  Reconstruction reconstruction = reconstructionOf(cloud);
  return meshed(reconstruction);
}

/// A cloud with a skipped point of each kind, a repeated position, and indices with repetitions.
struct HardCase {
  HardCase() {
    (*cloud)[0].x = kNan;
    (*cloud)[7].y = -kInfinity;
    (*cloud)[8].z = kInfinity;
    (*cloud)[20] = (*cloud)[30];
    indices = shuffledRange(350, 7);
    for (const pcl::index_t i : indices)
      if (i != 0 && i != 7 && i != 8)
        used.push_back(i);
    indices.insert(indices.end(), {3, 1, 4, 7});
  }
  /// The triangles of the core on the used points, as indices of the cloud.
  Triangles expected(const Options& options = {}) const {
    const Surface result =
        spherical_param::reconstruct(positionsOf(*cloud, used), options).surface();
    return result.triangles.unaryExpr([&](spherical_param::Index v) {
      return used[static_cast<std::size_t>(result.input_of_vertex[static_cast<std::size_t>(v)])];
    });
  }
  Cloud::Ptr cloud = makeEllipsoid(400);
  Indices indices;
  Indices used;  ///< without repetitions and points that are not finite
};

/// What a caller might reuse.
inline pcl::PolygonMesh staleMesh() {
  pcl::PolygonMesh mesh;
  pcl::toPCLPointCloud2(*makeEllipsoid(10), mesh.cloud);
  mesh.polygons.resize(5);
  mesh.header.frame_id = "stale";
  return mesh;
}

inline void expectNothingLeft(const Reconstruction& reconstruction, const pcl::PolygonMesh& mesh) {
  EXPECT_TRUE(mesh.polygons.empty() && mesh.cloud.data.empty());
  EXPECT_EQ(mesh.cloud.width + mesh.cloud.height, 0U);
  EXPECT_NE(reconstruction.getErrorMessage(), "");
  const spherical_param::Result& result = reconstruction.getResult();
  EXPECT_TRUE(result.surfaces.empty() && result.findings.empty() && result.verdict.empty());
  EXPECT_TRUE(reconstruction.getUsedIndices().empty());
  EXPECT_TRUE(reconstruction.getVertexIndices().empty());
  EXPECT_EQ(reconstruction.getIgnoredPointCount(), 0U);
  EXPECT_TRUE(reconstruction.getSphereCoordinates()->empty());
}

/// Expects that all overloads fail with a message that has these words, and leave nothing stale.
inline void expectFailure(Reconstruction& reconstruction, const std::string& words) {
  pcl::PolygonMesh mesh = staleMesh();
  reconstruction.reconstruct(mesh);
  expectNothingLeft(reconstruction, mesh);
  const std::string message = reconstruction.getErrorMessage();
  EXPECT_NE(message.find(words), std::string::npos) << words << ": " << message;
  Polygons polygons(5);
  reconstruction.reconstruct(polygons);
  EXPECT_TRUE(polygons.empty());
  EXPECT_EQ(reconstruction.getErrorMessage(), message);
  reconstruction.reconstruct();
  EXPECT_EQ(reconstruction.getErrorMessage(), message);
}

}  // namespace test
