#include "mesh_cleaning.h"

#include "face_mesh.h"
#include "indexed.h"
#include "intersection_removal.h"

#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Pairs of triangles of the surface of a mesh that intersect, until more than a number do.
IntersectingPairs pairsUpTo(std::size_t most, const Positions& positions, const OpenMesh& open,
                            const Execution& execution) {
  const std::vector<Index> triangles = trianglesOfSurface(open);
  IntersectingPairs found =
      findPairsUpTo(most, positions, open.triangles(Eigen::all, triangles), execution);
  for (auto& pair : found.pairs)
    for (Index& t : pair)
      t = triangles[static_cast<std::size_t>(t)];
  return found;
}

/// Leaves out the triangles that intersect, if at most a number are left out with what hangs on
/// them. Returns how many intersect.
std::optional<std::size_t> leaveOutUpTo(std::size_t most, std::size_t vertices,
                                        const IntersectingTriangles& pairs, OpenMesh& open) {
  OpenMesh rest = open;
  const std::size_t left_out = leaveOutTangles(vertices, pairs, rest);
  if (surfaceCount(rest) + most < surfaceCount(open))
    return std::nullopt;
  open = std::move(rest);
  return left_out;
}

/// Makes the faces of the graph the mesh, without those that intersect. Returns how many do;
/// nothing, and the mesh as it was, if too few points are left.
std::optional<std::size_t> takeFaces(const Positions& points, const Execution& execution,
                                     MeshedCloud& mesh, OpenMesh& open) {
  constexpr std::size_t vertices_of = 3;
  std::optional<FaceMesh> faces = meshFaces(points, mesh.graph.graph, 0, execution);
  if (!faces)
    return std::nullopt;
  OpenMesh certain{std::move(faces->triangles), std::move(faces->is_filling)};
  const IntersectingPairs found = pairsUpTo(surfaceCount(certain), points, certain, execution);
  if (found.is_sample)
    return std::nullopt;
  const std::size_t left_out = leaveOutTangles(columnCount(points), found.pairs, certain);
  const Triangles surface = surfaceOf(certain);
  std::vector<Index> vertices(surface.data(), surface.data() + surface.size());
  sortUnique(vertices);
  if (vertices_of * vertices.size() < columnCount(points))
    return std::nullopt;
  open = std::move(certain);
  mesh.has_certain_triangles_only = true;
  mesh.embedding.directions.resize(3, 0);
  mesh.embedding.history = {};
  for (HandleLoop& handle : mesh.handles)
    handle.is_cut = true;
  return left_out;
}

}  // namespace

bool removesIntersections(const Options& options) {
  return options.intersections == IntersectionMode::Remove && options.method == Method::Default;
}

std::optional<std::size_t> cleanMesh(const Positions& points, bool is_open, const Options& options,
                                     const Execution& execution, MeshedCloud& mesh,
                                     OpenMesh& open) {
  // More of a surface is no spot, but a tangle.
  constexpr std::size_t vertices_of = 500;
  constexpr std::size_t triangles_of = 100;
  constexpr std::size_t tangle_of = 10;
  const bool removes = removesIntersections(options) && !mesh.optimization.report.is_out_of_time;
  const bool may_open = options.surface != SurfaceMode::Closed;
  const Positions& positions = mesh.isSmoothed() ? mesh.smoothed.points : points;
  const std::size_t triangles = surfaceCount(open);
  // The optimisation has left those of a closed mesh on its points. One of two may stay.
  IntersectingPairs found = mesh.optimization.intersecting;
  if (is_open || mesh.isSmoothed() || (removes && found.is_sample))
    found = pairsUpTo(removes ? 2 * triangles / tangle_of : 1, positions, open, execution);
  if (found.pairs.empty())
    return std::size_t{0};
  if (!removes)
    return std::nullopt;
  std::optional<std::size_t> left_out;
  if (!found.is_sample) {
    const Removal most{columnCount(points) / vertices_of, may_open ? triangles / triangles_of : 0};
    if (const auto removal = clearIntersections(positions, found.pairs, most, open))
      left_out = removal->triangles;
    else if (may_open)
      left_out = leaveOutUpTo(triangles / tangle_of, columnCount(points), found.pairs, open);
  }
  if (!left_out && may_open && !mesh.isSmoothed())
    left_out = takeFaces(points, execution, mesh, open);
  return left_out;
}

}  // namespace spherical_param::internal
