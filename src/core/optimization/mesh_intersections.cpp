#include "mesh_intersections.h"

#include "indexed.h"
#include "self_intersection_of_fans.h"

namespace spherical_param::internal {

std::vector<std::array<Index, 2>> findIntersections(const EnergyMesh& mesh,
                                                    const FractionReport& report) {
  Triangles triangles = mesh.mesh().triangles();
  Indexed<Index> surface;
  for (Index t = 0; t < mesh.mesh().size(); ++t)
    if (!mesh.facet(t).isOpen()) {
      triangles.col(static_cast<Index>(surface.size())) = triangles.col(t);
      surface.push_back(t);
    }
  triangles.conservativeResize(3, static_cast<Eigen::Index>(surface.size()));
  auto pairs = findSelfIntersections(mesh.points(), triangles, {}, mesh.threads(), report);
  for (auto& [t, u] : pairs) {
    t = surface[t];
    u = surface[u];
  }
  return pairs;
}

}  // namespace spherical_param::internal
