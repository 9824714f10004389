#include "common/mesh_writer.h"

#include "common/record_writer.h"
#include "common/text.h"

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
  /// Of the middle, to a number that is as round as the extent allows.
  Point roundMiddle() const {
    const double step = std::pow(10.0, std::floor(std::log10(box_.diagonal().norm())));
    Point middle{};
    Eigen::Map<Eigen::Vector3d>(middle.data()) =
        (box_.center() / step).array().round().matrix() * step;
    return middle;
  }

private:
  Eigen::AlignedBox3d box_;
  double rounding_ = 0.0;
};

template <typename PointOf>
RoundingCheck checkOf(std::size_t count, const PointOf& point_of) {
  RoundingCheck check;
  for (std::size_t i = 0; i < count; ++i) {
    check.add(point_of(i));
  }
  return check;
}

RoundingCheck checkOf(const PointData& data) {
  return checkOf(data.points.size(), [&](std::size_t i) { return data.position(i); });
}

}  // namespace

bool needsDouble(const PointData& data) {
  return checkOf(data).needsDouble();
}

Point offsetFor(const PointData& data, FileFormat format, Encoding encoding) {
  if (format == nullptr || !format->has_single_precision || encoding == Encoding::Ascii) {
    return {};
  }
  const RoundingCheck check = checkOf(data);
  return check.needsDouble() ? check.roundMiddle() : Point{};
}

std::string notWritten(bool has_colors, const std::string& path, const Point& offset) {
  const FileFormat format = formatOf(path);
  std::string text;
  if (has_colors && format != nullptr && !format->has_colors) {
    text = "without colours";
  }
  if (offset != Point{}) {
    text += text.empty() ? "less " : ", less ";
    for (std::size_t d = 0; d < 3; ++d) {
      text += (d > 0 ? ", " : "") + formatted(offset[d], 15);
    }
  }
  return text.empty() ? "" : " (" + text + ")";
}

Positions asWritten(const Positions& points) {
  const auto point_of = [&](std::size_t i) { return points.col(static_cast<Eigen::Index>(i)); };
  if (checkOf(static_cast<std::size_t>(points.cols()), point_of).needsDouble()) {
    return points;
  }
  return points.cast<float>().cast<double>();
}

void writeMesh(OutputFile& file, const MeshView& mesh, FileFormat format, Encoding encoding,
               const FileProgress& progress) {
  const RoundingCheck check = checkOf(
      mesh.vertexCount(), [&](std::size_t i) { return Eigen::Vector3d(mesh.point(i).data()); });
  RecordWriter writer(file, check.needsDouble(), progress);
  const auto write = format->write_mesh != nullptr ? format->write_mesh : format->write_cloud;
  write(writer, mesh, encoding);
  writer.finish();
}

}  // namespace spherical_param::tools
