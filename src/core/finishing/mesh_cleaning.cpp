#include "mesh_cleaning.h"

#include "indexed.h"
#include "intersection_removal.h"

#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Whether triangles may be left out of a mesh however few of them intersect.
bool mayOpen(const Options& options, const PartMesh& mesh) {
  return mayLeaveOutTriangles(options) &&
         (mesh.openings.isOpen() || options.intersections == IntersectionMode::Remove);
}

/// Leaves out the triangles that intersect, and what hangs on them, unless these are more than
/// `most`. Returns how many intersect.
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
  return options.intersections != IntersectionMode::Keep && options.method == Method::Default;
}

bool mayLeaveOutTriangles(const Options& options) {
  return removesIntersections(options) && options.surface != SurfaceMode::Closed;
}

bool mayLeaveOutTriangles(const Options& options, const PartMesh& mesh) {
  return mayOpen(options, mesh) || (mayLeaveOutTriangles(options) && !mesh.isUsable());
}

void cleanMesh(const Positions& points, const Options& options, const Execution& execution,
               PartMesh& mesh) {
  // Beyond these fractions of the surface, it is a tangle, which is left as it is.
  constexpr double max_vertices = 0.002;
  constexpr double max_vertices_of_closed = 0.001;
  constexpr double max_triangles = 0.01;
  constexpr double max_intersecting = 0.1;
  constexpr double max_cleared = 0.25;
  const bool clears = options.method == Method::Default && !mesh.optimization.is_out_of_time;
  const bool removes = clears && removesIntersections(options);
  const Positions& positions = mesh.isSmoothed() ? mesh.smoothed : points;
  const std::size_t triangles = mesh.mesh.surfaceCount();
  const auto find = [&](std::size_t most) {
    const std::vector<Index> surface = mesh.mesh.surface();
    IntersectingPairs found =
        findPairsUpTo(most, positions, mesh.mesh.surfaceTriangles(), execution);
    for (auto& [t, u] : found.pairs)
      for (Index* const of : {&t, &u})
        *of = surface[static_cast<std::size_t>(*of)];
    return found;
  };
  const std::size_t most = clears ? fractionOf(max_cleared, triangles) : 1;
  // Those of a closed mesh on its points are known from the optimisation.
  IntersectingPairs& found = mesh.intersecting;
  if (mesh.openings.isOpen() || mesh.isSmoothed() || (clears && found.is_sample))
    found = find(most);
  if (!found.pairs.empty() && !found.is_sample && clears) {
    const bool is_open = mayOpen(options, mesh);
    const double max_lost = is_open ? max_vertices : removes ? max_vertices_of_closed : 0.0;
    const Removal limit{fractionOf(max_lost, columnCount(points)),
                        is_open ? fractionOf(max_triangles, triangles) : 0};
    mesh.left_out_triangles =
        clearIntersections(positions, found.pairs, limit, mesh.mesh).triangles;
    found = find(most);
    if (!found.pairs.empty() && mayLeaveOutTriangles(options, mesh))
      if (const auto left_out = leaveOutUpTo(fractionOf(max_intersecting, triangles),
                                             columnCount(points), found.pairs, mesh.mesh)) {
        mesh.left_out_triangles += *left_out;
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
