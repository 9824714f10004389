#include "common/mesh_writer.h"

#include "common/record_writer.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace spherical_param::tools {
namespace {

/// Points that single precision moves by more than this part of their extent need double: a cloud
/// far from its origin. One near it moves by a tenth of that.
constexpr double kMaxRounding = 1e-6;

/// Finds whether single precision would move points too far.
class RoundingCheck {
public:
  void add(const Eigen::Vector3d& point) {
    if (!point.allFinite()) {
      return;
    }
    box_.extend(point);
    rounding_ =
        std::max(rounding_, (point - point.cast<float>().cast<double>()).cwiseAbs().maxCoeff());
  }
  bool needsDouble() const {
    return !box_.isEmpty() && rounding_ > kMaxRounding * box_.diagonal().norm();
  }

private:
  Eigen::AlignedBox3d box_;
  double rounding_ = 0.0;
};

bool needsDouble(const MeshView& mesh) {
  RoundingCheck check;
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    check.add(Eigen::Vector3d(mesh.point(i).data()));
  }
  return check.needsDouble();
}

}  // namespace

Positions asWritten(const Positions& points) {
  RoundingCheck check;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    check.add(points.col(i));
  }
  if (check.needsDouble()) {
    return points;
  }
  return points.cast<float>().cast<double>();
}

void writeMesh(OutputFile& file, const MeshView& mesh, FileFormat format, Encoding encoding,
               const FileProgress& progress) {
  RecordWriter writer(file, needsDouble(mesh), progress);
  const auto write = format->write_mesh != nullptr ? format->write_mesh : format->write_cloud;
  write(writer, mesh, encoding);
  writer.finish();
}

}  // namespace spherical_param::tools
