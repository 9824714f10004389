#pragma once

#include "indexed.h"
#include "parallel.h"
#include "spherical_param/errors.h"
#include "spherical_param/types.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

namespace spherical_param::internal {

/// Checks that indices are in range and that a CornerTable can number the triangles.
inline void checkTriangles(const char* caller, const Triangles& triangles, Eigen::Index n) {
  constexpr Eigen::Index max_triangles = Eigen::Index{1} << 30;
  if (triangles.cols() > max_triangles)
    throw InvalidInput(std::string(caller) + ": " + std::to_string(triangles.cols()) +
                       " triangles are more than 2^30; split the mesh");
  if (triangles.cols() == 0 || (triangles.minCoeff() >= 0 && triangles.maxCoeff() < n))
    return;
  Eigen::Index i = 0;
  while (triangles.data()[i] >= 0 && triangles.data()[i] < n)
    ++i;
  throw InvalidInput(std::string(caller) + ": triangle " + std::to_string(i / 3) +
                     " names vertex " + std::to_string(triangles.data()[i]) + " of " +
                     std::to_string(n) + "; indices start at 0");
}

/// The corners of a triangle after and before corner k. A table is faster than a remainder.
inline Index nextCorner(Index k) {
  constexpr Index next[] = {1, 2, 0};
  return next[k];
}
inline Index previousCorner(Index k) {
  constexpr Index previous[] = {2, 0, 1};
  return previous[k];
}

/// Normal of a triangle, as long as twice its area.
inline Eigen::Vector3d areaNormal(const Positions& points, const Triangles& triangles,
                                  Eigen::Index t) {
  const Eigen::Vector3d a = points.col(triangles(0, t));
  return (points.col(triangles(1, t)) - a).cross(points.col(triangles(2, t)) - a);
}

/// Adjacency of arbitrary triangles: their corners, grouped by vertex; 28 bytes for each vertex of
/// a closed mesh.
class CornerTable {
public:
  /// \param triangles indices in [0, vertex_count), see checkTriangles().
  CornerTable(const Triangles& triangles, std::size_t vertex_count, int threads)
      : ends_(vertex_count + 1, 0),
        // Not a vector, which one thread would fill with zeros first.
        corners_(new std::uint32_t[static_cast<std::size_t>(triangles.size())]) {
    forEachCornerOfRange(triangles, threads, vertex_count,
                         [&](Index v, std::uint32_t) { ++ends_[v + 1]; });
    std::uint32_t begin = 0;
    for (std::uint32_t& end : ends_)
      begin += std::exchange(end, begin);
    // Now ends_[v + 1] is where the corners of v begin, and moves on to their end.
    forEachCornerOfRange(triangles, threads, vertex_count,
                         [&](Index v, std::uint32_t corner) { corners_[ends_[v + 1]++] = corner; });
  }

  std::size_t vertexCount() const { return ends_.size() - 1; }

  std::size_t countAt(Index v) const { return ends_[v + 1] - ends_[v]; }

  /// Calls visit(triangle, k) for the triangles with v as corner k, ascending.
  template <typename Visit>
  void forEachCorner(Index v, const Visit& visit) const {
    for (std::uint32_t i = ends_[v]; i < ends_[v + 1]; ++i)
      visit(static_cast<Index>(corners_[i] >> 2U), static_cast<Index>(corners_[i] & 3U));
  }

private:
  /// Calls work(vertex, corner) for all corners. Each thread visits all corners and works on those
  /// of its range of vertices, so the order at a vertex is that of the triangles.
  template <typename Work>
  static void forEachCornerOfRange(const Triangles& triangles, int threads,
                                   std::size_t vertex_count, const Work& work) {
    const auto parts = static_cast<std::size_t>(threads);
    forEachTask(parts, threads, [&](std::size_t r) {
      const auto begin = static_cast<Index>(vertex_count * r / parts);
      const auto end = static_cast<Index>(vertex_count * (r + 1) / parts);
      for (Eigen::Index t = 0; t < triangles.cols(); ++t)
        for (Eigen::Index k = 0; k < 3; ++k) {
          const Index v = triangles(k, t);
          if (v >= begin && v < end)
            work(v, static_cast<std::uint32_t>(4 * t + k));
        }
    });
  }

  Indexed<std::uint32_t> ends_;               // corners of v: [ends_[v], ends_[v + 1])
  std::unique_ptr<std::uint32_t[]> corners_;  // 4 * triangle + k
};

}  // namespace spherical_param::internal
