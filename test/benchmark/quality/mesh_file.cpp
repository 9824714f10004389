#include "mesh_file.h"

#include "common/errors.h"
#include "common/file_formats.h"
#include "common/input_file.h"
#include "common/text.h"
#include "library_output.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>
#include <pcl/PolygonMesh.h>
#include <pcl/io/ply_io.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <vector>

namespace spherical_param::benchmark {
namespace {

using namespace spherical_param::tools;

template <typename Number>
double load(const std::uint8_t* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

/// A coordinate of all points. PCL's own conversion would round double to float.
Eigen::RowVectorXd coordinate(const std::string& path, const pcl::PCLPointCloud2& cloud,
                              const std::string& name) {
  const auto field =
      std::find_if(cloud.fields.begin(), cloud.fields.end(),
                   [&](const pcl::PCLPointField& candidate) { return candidate.name == name; });
  if (field == cloud.fields.end() || (field->datatype != pcl::PCLPointField::FLOAT32 &&
                                      field->datatype != pcl::PCLPointField::FLOAT64))
    failContent(path, "its vertices have no real coordinate " + name);
  const bool wide = field->datatype == pcl::PCLPointField::FLOAT64;
  Eigen::RowVectorXd values(
      static_cast<Eigen::Index>(cloud.data.size() / std::max<std::size_t>(1, cloud.point_step)));
  const std::uint8_t* bytes = cloud.data.data() + field->offset;
  for (double& value : values) {
    value = wide ? load<double>(bytes) : load<float>(bytes);
    bytes += cloud.point_step;
  }
  return values;
}

Triangles trianglesOf(const std::string& path, const std::vector<pcl::Vertices>& polygons,
                      Eigen::Index vertices) {
  std::vector<std::array<Index, 3>> triangles;
  for (const pcl::Vertices& polygon : polygons) {
    const auto& corners = polygon.vertices;
    for (const auto corner : corners)
      if (static_cast<Eigen::Index>(corner) < 0 || static_cast<Eigen::Index>(corner) >= vertices)
        failContent(path, "a triangle names vertex " + std::to_string(corner) + ", but there are " +
                              std::to_string(vertices));
    for (std::size_t k = 2; k < corners.size(); ++k)
      triangles.push_back({static_cast<Index>(corners[0]), static_cast<Index>(corners[k - 1]),
                           static_cast<Index>(corners[k])});
  }
  if (triangles.empty())
    failContent(path, "it has no triangles");
  return Eigen::Map<const Triangles>(triangles.front().data(), 3,
                                     static_cast<Eigen::Index>(triangles.size()));
}

}  // namespace

Mesh readMesh(const std::string& path) {
  if (formatOf(path) != FileFormat::Ply)
    throw UsageError(inQuotes(path) + " does not end in .ply", "give meshes as PLY files");
  checkInputFile(path);
  pcl::PolygonMesh polygons;
  std::string trouble;
  {
    const LibraryOutputSilencer silencer;
    try {
      if (pcl::PLYReader().read(path, polygons) < 0)
        trouble = "it is broken or not complete";
    } catch (const std::exception& error) {
      trouble = std::string("it is broken: ") + error.what();
    }
  }
  if (!trouble.empty())
    failContent(path, trouble);
  Mesh mesh;
  const pcl::PCLPointCloud2& cloud = polygons.cloud;
  const Eigen::RowVectorXd x = coordinate(path, cloud, "x");
  mesh.points.resize(3, x.size());
  mesh.points << x, coordinate(path, cloud, "y"), coordinate(path, cloud, "z");
  if (!mesh.points.allFinite())
    failContent(path, "it has a coordinate that is not finite");
  mesh.triangles = trianglesOf(path, polygons.polygons, mesh.points.cols());
  return mesh;
}

}  // namespace spherical_param::benchmark
