#pragma once

#include "common/point_data.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::tools {

using Triangle = std::array<std::int32_t, 3>;  ///< counter-clockwise from outside

/// An image on a mesh. The first two scalars of the mesh are the place in the image: u to the
/// right, v up.
struct MeshTexture {
  std::string image_name;  ///< beside the mesh
  std::string png;         ///< the image, as a file
  bool repeats_u = false;  ///< its left side continues its right side
};

/// A mesh to be written. Points and triangles are not copied: they must outlive it.
class MeshView {
public:
  /// A mesh as it is.
  MeshView(const TriangleMesh& mesh)
      : data_(&mesh.vertices), vertex_count_(mesh.vertices.points.size()),
        triangle_count_(mesh.triangles.size()),
        corners_(mesh.triangles.empty() ? nullptr : mesh.triangles.front().data()),
        has_normals_(!mesh.vertices.normals.empty()) {}

  /// Triangles over all points; without any, a plain cloud.
  MeshView(const PointData& data, const Triangles& triangles)
      : data_(&data), vertex_count_(data.points.size()),
        triangle_count_(static_cast<std::size_t>(triangles.cols())), corners_(triangles.data()),
        has_normals_(!data.normals.empty()) {}

  /// Triangles over some of the points.
  ///
  /// \param indices of the vertices in `data`; the triangles have their places in here.
  MeshView(const PointData& data, const std::vector<int>& indices, const Triangles& triangles)
      : data_(&data), indices_(&indices), vertex_count_(indices.size()),
        triangle_count_(static_cast<std::size_t>(triangles.cols())), corners_(triangles.data()),
        has_normals_(!data.normals.empty()) {}

  /// Gives the vertices other positions.
  ///
  /// \param places 3 x vertices.
  void moveTo(const Positions& places) { places_ = &places; }
  /// Gives it a texture, which must outlive it.
  void cover(const MeshTexture& texture) { texture_ = &texture; }
  void leaveOutNormals() { has_normals_ = false; }
  /// Subtracts an offset from all points.
  void shiftBy(const Point& offset) { offset_ = offset; }
  /// Marks vertices that are not points of the cloud.
  ///
  /// \param marks 1 for each that was added, else 0; empty if none was.
  void markAdded(std::vector<std::uint8_t> marks) { added_ = std::move(marks); }

  std::size_t vertexCount() const { return vertex_count_; }
  /// Of an image, of which the vertices are the pixels; 1: of none.
  std::size_t rows() const { return indices_ == nullptr ? data_->rows : 1; }
  std::size_t triangleCount() const { return triangle_count_; }
  bool hasNormals() const { return has_normals_; }
  bool hasColors() const { return !data_->colors.empty(); }
  bool hasAlpha() const { return data_->has_alpha; }
  /// Number of colour channels; 0 without colours.
  std::size_t channelCount() const { return !hasColors() ? 0 : hasAlpha() ? 4 : 3; }
  const std::vector<Scalar>& scalars() const { return data_->scalars; }
  const MeshTexture* texture() const { return texture_; }
  bool hasAdded() const { return !added_.empty(); }

  Point point(std::size_t vertex) const {
    Point point{};
    if (places_ == nullptr) {
      point = data_->points[index(vertex)];
    } else {
      Eigen::Map<Eigen::Vector3d>(point.data()) = places_->col(static_cast<Eigen::Index>(vertex));
    }
    return {point[0] - offset_[0], point[1] - offset_[1], point[2] - offset_[2]};
  }
  double scalar(const Scalar& of, std::size_t vertex) const { return of.values[index(vertex)]; }
  const Normal& normal(std::size_t vertex) const { return data_->normals[index(vertex)]; }
  const Color& color(std::size_t vertex) const { return data_->colors[index(vertex)]; }
  std::uint8_t added(std::size_t vertex) const { return added_[vertex]; }
  Triangle triangle(std::size_t t) const {
    const std::int32_t* const corners = corners_ + 3 * t;
    return {corners[0], corners[1], corners[2]};
  }

private:
  std::size_t index(std::size_t vertex) const {
    return indices_ == nullptr ? vertex : static_cast<std::size_t>((*indices_)[vertex]);
  }

  const PointData* data_;
  const std::vector<int>* indices_ = nullptr;
  const Positions* places_ = nullptr;
  const MeshTexture* texture_ = nullptr;
  Point offset_{};
  std::size_t vertex_count_;
  std::size_t triangle_count_;
  const std::int32_t* corners_;
  bool has_normals_;
  std::vector<std::uint8_t> added_;
};

}  // namespace spherical_param::tools
