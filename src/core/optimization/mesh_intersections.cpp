#include "mesh_intersections.h"

#include "indexed.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::internal {

std::vector<std::array<Index, 2>> findIntersections(const EnergyMesh& mesh,
                                                    const FractionReport& report) {
  Triangles triangles = mesh.mesh().triangles();
  Indexed<Index> surface;  // slots, by the columns that are left
  for (Index t = 0; t < mesh.mesh().size(); ++t)
    if (!mesh.facet(t).isOpen()) {
      triangles.col(surface.count()) = triangles.col(t);
      surface.push_back(t);
    }
  triangles.conservativeResize(3, surface.count());
  Execution execution;
  execution.threads = mesh.threads();
  if (report)
    execution.progress = [&](const Progress& progress) {
      report(progress.fraction);
      return true;
    };
  auto pairs = findSelfIntersections(mesh.points(), triangles, execution);
  for (auto& [t, u] : pairs) {
    t = surface[t];
    u = surface[u];
  }
  return pairs;
}

}  // namespace spherical_param::internal
