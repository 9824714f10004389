#pragma once

#include "peer.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace spherical_param::benchmark {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// For average spacings, as in the examples of CGAL's manual.
constexpr unsigned cgal_spacing_neighbors = 6;

inline std::vector<Kernel::Point_3> toCgal(const Points& points) {
  std::vector<Kernel::Point_3> converted;
  converted.reserve(points.size());
  for (const tools::Point& point : points) {
    converted.emplace_back(point[0], point[1], point[2]);
  }
  return converted;
}

/// The mesh in single precision. It must hold no removed elements, which would shift the indices.
inline tools::TriangleMesh fromCgal(const SurfaceMesh& surface) {
  tools::TriangleMesh mesh;
  mesh.vertices.points.reserve(surface.number_of_vertices());
  for (const auto vertex : surface.vertices()) {
    const Kernel::Point_3& point = surface.point(vertex);
    mesh.vertices.points.push_back(tools::toPoint({point.x(), point.y(), point.z()}));
  }
  mesh.triangles.reserve(surface.number_of_faces());
  for (const auto face : surface.faces()) {
    std::array<std::int32_t, 3> triangle{};
    std::size_t corner = 0;
    for (const auto vertex : surface.vertices_around_face(surface.halfedge(face))) {
      triangle.at(corner++) = static_cast<std::int32_t>(vertex.idx());
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace spherical_param::benchmark
