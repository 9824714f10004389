#include "mesh_cleaning.h"

#include "indexed.h"
#include "intersection_removal.h"

#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Leaves out the triangles that intersect, if at most a number are left out with what hangs on
/// them. Returns how many intersect.
std::optional<std::size_t> leaveOutUpTo(std::size_t most, std::size_t vertices,
                                        const IntersectingTriangles& pairs, SphereMesh& mesh) {
  SphereMesh rest = mesh;
  const std::size_t left_out = leaveOutTangles(vertices, pairs, rest);
  if (rest.surfaceCount() + most < mesh.surfaceCount())
    return std::nullopt;
  mesh = std::move(rest);
  return left_out;
}

}  // namespace

bool removesIntersections(const Options& options) {
  return options.intersections == IntersectionMode::Remove && options.method == Method::Default;
}

void cleanMesh(const Positions& points, const Options& options, const Execution& execution,
               PartMesh& mesh) {
  // More of a surface is no spot, but a tangle.
  constexpr double max_vertices = 0.002;
  constexpr double max_triangles = 0.01;
  constexpr double max_intersecting = 0.1;
  const bool removes = removesIntersections(options) && !mesh.optimization.is_out_of_time;
  const bool may_open = options.surface != SurfaceMode::Closed;
  const Positions& positions = mesh.isSmoothed() ? mesh.smoothed : points;
  const std::size_t triangles = mesh.mesh.surfaceCount();
  // The optimisation has left those of a closed mesh on its points. One of two may stay.
  IntersectingPairs& found = mesh.intersecting;
  if (mesh.openings.isOpen() || mesh.isSmoothed() || (removes && found.is_sample))
    found = findPairsUpTo(removes ? fractionOf(2.0 * max_intersecting, triangles) : 1, positions,
                          mesh.mesh.triangles(), mesh.mesh.surface(), execution);
  if (!found.pairs.empty() && !found.is_sample && removes) {
    const Removal most{fractionOf(max_vertices, columnCount(points)),
                       may_open ? fractionOf(max_triangles, triangles) : 0};
    std::optional<std::size_t> left_out;
    if (const auto removal = clearIntersections(positions, found.pairs, most, mesh.mesh))
      left_out = removal->triangles;
    else if (may_open)
      left_out = leaveOutUpTo(fractionOf(max_intersecting, triangles), columnCount(points),
                              found.pairs, mesh.mesh);
    if (left_out) {
      mesh.left_out_triangles = *left_out;
      found = {};
    }
  }
  if (!found.pairs.empty())
    found =
        findPairsUpTo(mostOfUsable(triangles), positions, mesh.mesh.surfaceTriangles(), execution);
}

bool takeCertainFaces(const Positions& points, const SphereMesh& faces, const Execution& execution,
                      PartMesh& mesh) {
  constexpr double min_vertices = 1.0 / 3.0;
  mesh.mesh = faces;
  const IntersectingPairs found =
      findPairsUpTo(faces.surfaceCount(), points, faces.triangles(), faces.surface(), execution);
  if (found.is_sample)
    return false;
  mesh.left_out_triangles = leaveOutTangles(columnCount(points), found.pairs, mesh.mesh);
  mesh.has_certain_triangles_only = true;
  return static_cast<double>(mesh.mesh.surfaceVertexCount()) >=
         min_vertices * static_cast<double>(points.cols());
}

}  // namespace spherical_param::internal
