#pragma once

#include "peer.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <vector>

namespace spherical_param::benchmark {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// For average spacings, as in the examples of CGAL's manual.
constexpr unsigned kSpacingNeighbors = 6;

inline std::vector<Kernel::Point_3> toCgal(const Positions& points) {
  std::vector<Kernel::Point_3> converted;
  converted.reserve(static_cast<std::size_t>(points.cols()));
  for (const auto& point : points.colwise())
    converted.emplace_back(point.x(), point.y(), point.z());
  return converted;
}

/// It must hold no removed elements, which would shift the indices.
inline Mesh fromCgal(const SurfaceMesh& surface) {
  Mesh mesh{Positions(3, surface.number_of_vertices()), Triangles(3, surface.number_of_faces())};
  for (const auto vertex : surface.vertices()) {
    const Kernel::Point_3& point = surface.point(vertex);
    mesh.points.col(vertex.idx()) << point.x(), point.y(), point.z();
  }
  for (const auto face : surface.faces()) {
    int corner = 0;
    for (const auto vertex : surface.vertices_around_face(surface.halfedge(face)))
      mesh.triangles(corner++, face.idx()) = static_cast<Index>(vertex.idx());
  }
  return mesh;
}

PeerResult cgalAdvancingFront(const Positions& points);
PeerResult cgalAdvancingFrontFilled(const Positions& points);
PeerResult cgalPoisson(const Positions& points);
PeerResult cgalAlphaWrap(const Positions& points);

}  // namespace spherical_param::benchmark
