// Pairs of points, which pcl_spherical_param_morph reads, of two clouds.

#include "common/cloud_reconstruction.h"
#include "common/errors.h"
#include "common/point_pairs.h"
#include "fuzz_file.h"

#include <pcl/PolygonMesh.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace {

using namespace spherical_param::tools;
using torture::require;

/// A cloud on a sphere, one point of it twice and one not finite: these are no vertices of their
/// own.
struct Meshed {
  explicit Meshed(int count) {
    for (int i = 0; i < count; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / count;
      const double radius = std::sqrt(1.0 - z * z);
      cloud.data.addPoint({radius * std::cos(2.4 * i), radius * std::sin(2.4 * i), z});
    }
    cloud.data.points.push_back(cloud.data.points.front());
    cloud.data.points.push_back({std::nanf(""), 0.0F, 0.0F});
    auto points = pcl::PointCloud<pcl::PointXYZ>::Ptr(new pcl::PointCloud<pcl::PointXYZ>);
    for (const Point& point : cloud.data.points) {
      points->push_back(pcl::PointXYZ(point[0], point[1], point[2]));
    }
    cloud.reconstruction.setInputCloud(points);
    pcl::PolygonMesh mesh;
    cloud.reconstruction.reconstruct(mesh);
    require(!mesh.polygons.empty(), "a sphere is meshed");
  }

  CloudReconstruction cloud;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static torture::FuzzFile file(".txt");
  static const Meshed first(60);
  static const Meshed second(40);
  file.fill(bytes, size);
  try {
    for (const FilePair& pair : readPointPairs(file.path(), first.cloud, second.cloud)) {
      require(pair.line > 0, "a pair has its line");
      for (std::size_t side = 0; side < 2; ++side) {
        const CloudReconstruction& cloud = (side == 0 ? first : second).cloud;
        const auto points = static_cast<int>(cloud.data.points.size());
        require(pair.points[side] >= 0 && pair.points[side] < points, "the point is one");
        require(pair.vertices[side] >= -1 &&
                    pair.vertices[side] <
                        static_cast<int>(cloud.reconstruction.getVertexIndices().size()),
                "the vertex is one, or none");
      }
    }
  } catch (const ToolError& error) {
    require(!error.remedy().empty(), "a refusal has its remedy");
  }
  return 0;
}
