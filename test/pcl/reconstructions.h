#pragma once

#include "clouds.h"
#include "spherical_param/reconstruct.h"

#include <pcl/surface/spherical_param_reconstruction.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <string>

/// What the tests of SphericalParamReconstruction share.
namespace test {

using pcl::Indices;
using pcl::PointXYZ;
using spherical_param::Options;
using spherical_param::Surface;
using spherical_param::Triangles;
using Cloud = pcl::PointCloud<PointXYZ>;
using Reconstruction = pcl::SphericalParamReconstruction<PointXYZ>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// 0 ... count - 1 in a random order that is the same in each run.
inline Indices shuffledIndices(int count) {
  Indices indices(static_cast<std::size_t>(count));
  std::iota(indices.begin(), indices.end(), 0);
  std::shuffle(indices.begin(), indices.end(), std::mt19937(7));
  return indices;
}

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

inline Polygons meshed(const Cloud::Ptr& cloud) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  return meshed(reconstruction);
}

/// A cloud with a skipped point of each kind, a repeated position, and indices with repetitions.
struct HardCase {
  HardCase() {
    (*cloud)[0].x = kNan;
    (*cloud)[7].y = -kInfinity;
    (*cloud)[8].z = kInfinity;
    (*cloud)[20] = (*cloud)[30];
    indices = shuffledIndices(350);
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
  EXPECT_TRUE(reconstruction.getMovedPoints()->empty());
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
