#pragma once

#include "mixed_jobs.h"

#include <pcl/PolygonMesh.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>

namespace torture {

/// Makes jobs with one object of the PCL class.
class PclObject {
public:
  Answer operator()(const Job& job) {
    const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
    for (Eigen::Index i = 0; i < job.points.cols(); ++i) {
      const Eigen::Vector3f point = job.points.col(i).cast<float>();
      cloud->push_back(pcl::PointXYZ(point.x(), point.y(), point.z()));
    }
    reconstruction_.setInputCloud(cloud);
    reconstruction_.setOptions(job.options);
    pcl::PolygonMesh mesh;
    reconstruction_.reconstruct(mesh);
    const spherical_param::Result& result = reconstruction_.getResult();
    Bytes bytes;
    bytes.add(result);
    for (const pcl::Vertices& polygon : mesh.polygons)
      bytes.add(polygon.vertices);
    bytes.add(reconstruction_.getErrorMessage());
    const auto vertices = static_cast<Index>(result.vertexCount());
    return {bytes.take(),
            test::isSphereOverAll(result.triangles, vertices) && !mesh.polygons.empty()};
  }

private:
  pcl::SphericalParamReconstruction<pcl::PointXYZ> reconstruction_;
};

}  // namespace torture
