#pragma once

#include "exact_predicates.h"
#include "fuzz_input.h"
#include "open_shapes.h"
#include "spherical_param/reconstruct.h"

#include <tuple>

/// What reconstruct() guarantees, decided without its stages.
namespace fuzz {

using internal::areCoplanar;
using internal::volumeSign;

using Place = std::tuple<double, double, double>;

/// The first point at each place; -0 is 0.
inline std::map<Place, Index> firstAtPlaces(const Positions& points) {
  std::map<Place, Index> first;
  for (Index i = 0; i < points.cols(); ++i)
    first.emplace(Place{points(0, i) + 0.0, points(1, i) + 0.0, points(2, i) + 0.0}, i);
  return first;
}

inline Positions finiteOf(const Positions& points) {
  return test::pointsWhere(points, [](const Eigen::Vector3d& p) { return p.allFinite(); });
}

/// Whether meshes may have openings.
inline bool mayBeOpen(const Options& options) {
  return options.surface != SurfaceMode::Closed && options.method == Method::Default;
}

/// Whether reconstruct() may mesh points; it must reject all others. Open surfaces may be flat.
inline bool canBeMeshed(const Positions& points, const Options& options) {
  const Positions finite = finiteOf(points);
  return (finite.array().abs() <= 1e100).all() && firstAtPlaces(finite).size() >= 4 &&
         (mayBeOpen(options) || !areCoplanar(finite));
}

/// Whether it must mesh them: without outliers, or in its parts, there may be nothing to mesh, and
/// open surfaces may be left out where they intersect themselves.
inline bool mustBeMeshed(const Positions& points, const Options& options) {
  return options.outliers == OutlierMode::None && options.parts == PartsMode::All &&
         !mayBeOpen(options) && canBeMeshed(points, options);
}

/// Requires that a mesh has the boundary, the pieces and the genus that are reported.
inline void requireTopology(const Surface& result) {
  const auto n = static_cast<Index>(result.vertexCount());
  const auto boundary = test::loopsOf(result.triangles);
  require(boundary.has_value(), "boundary loops are apart");
  // With a cone over each boundary loop it is closed.
  Index loops = 0;
  std::vector<Index> corners(result.triangles.data(),
                             result.triangles.data() + result.triangles.size());
  for (const std::vector<Index>& loop : *boundary) {
    for (std::size_t i = 0; i < loop.size(); ++i)
      corners.insert(corners.end(), {loop[(i + 1) % loop.size()], loop[i], n + loops});
    ++loops;
  }
  const Triangles closed =
      Eigen::Map<const Triangles>(corners.data(), 3, static_cast<Eigen::Index>(corners.size() / 3));
  require(static_cast<std::size_t>(loops) == result.boundary.size() && result.topology.genus &&
              test::isSurfaceOverAll(closed, n + loops, static_cast<Index>(*result.topology.genus),
                                     static_cast<Index>(result.topology.components)),
          "the mesh is a manifold with the boundary, the pieces and the genus that are reported");
  require(result.topology.closed == result.isClosed(), "the result's own checks agree");
}

/// Requires of a surface of some points of a cloud what is guaranteed.
inline void requireGuarantees(const Positions& cloud, const Options& options,
                              const Surface& result) {
  const Positions points = cloud(Eigen::all, result.inputs);
  const std::size_t n = result.inputs.size();
  const std::map<Place, Index> first = firstAtPlaces(points);
  const std::size_t v = first.size();
  require(result.vertexCount() == v && result.duplicates() == n - v &&
              result.vertex_of_input.size() == n,
          "there is one vertex for each distinct point");
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = points.col(static_cast<Eigen::Index>(i));
    const auto vertex = static_cast<std::size_t>(result.vertex_of_input[i]);
    const auto expected =
        static_cast<std::size_t>(first.at({p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}));
    require(vertex < v && result.input_of_vertex[vertex] == result.inputs[expected],
            "the vertex of a point is that of the first point at its place");
  }
  requireTopology(result);
  const Positions vertices = cloud(Eigen::all, result.input_of_vertex);
  const auto genus = static_cast<Index>(result.genus());
  require(result.isClosed() || mayBeOpen(options) ||
              options.intersections != IntersectionMode::Keep,
          "a mesh that was to be closed is closed");
  require(genus == 0 || options.handles != HandleMode::None, "handles that were to be cut are cut");
  require(!result.isClosed() || volumeSign(vertices, result.triangles) >= 0,
          "triangles face outward");
  const auto count = static_cast<Eigen::Index>(v);
  const bool has_details = options.details || options.topology == TopologyMode::Sphere;
  require(areUnitVectors(result.sphere) &&
              (result.sphere.cols() > 0
                   ? genus == 0 && result.sphere.cols() == count
                   : !has_details || genus > 0 || result.has_certain_triangles_only),
          "a mesh without handles has an embedding of unit vectors");
  require(std::isfinite(result.measures.volume) && std::isfinite(result.measures.area),
          "volume and area are finite");
  require(result.points.cols() == count && result.points.allFinite(),
          "each vertex has a finite point");
  require(options.smoothing != 0 || result.added_vertices != 0 || result.points == vertices,
          "without smoothing, the points are those of the input");
}

/// Requires that every point is in one list of a result.
inline void requireLists(const Positions& points, const Options& options, const Result& result) {
  const LeftOut& left_out = result.left_out;
  std::vector<int> times(static_cast<std::size_t>(points.cols()), 0);
  const auto count = [&](const std::vector<Index>& list) {
    require(std::is_sorted(list.begin(), list.end()), "lists are ascending");
    for (const Index i : list)
      ++times.at(static_cast<std::size_t>(i));
  };
  for (const Surface& surface : result.surfaces)
    count(surface.inputs);
  for (const auto& list :
       {left_out.not_finite, left_out.outliers, left_out.other_parts, left_out.unmeshed})
    count(list);
  require(std::all_of(times.begin(), times.end(), [](int t) { return t == 1; }),
          "every point is in one list");
  require(static_cast<Eigen::Index>(left_out.not_finite.size()) ==
              points.cols() - finiteOf(points).cols(),
          "all points that are not finite are listed");
  require(options.outliers != OutlierMode::None || left_out.outliers.empty(),
          "outliers are left out on request alone");
  require(options.parts != PartsMode::All || left_out.other_parts.empty(),
          "a whole cloud has no other parts");
  require(!result.surfaces.empty() &&
              (options.parts == PartsMode::Each || result.surfaces.size() == 1),
          "there are as many surfaces as parts were asked for");
  for (std::size_t i = 1; i < result.surfaces.size(); ++i)
    require(result.surfaces[i].inputs.size() <= result.surfaces[i - 1].inputs.size(),
            "the surface of most points is the first");
  for (const std::string& failure : result.failures)
    require(failure.find("please report") == std::string::npos, "no part fails by a bug");
}

}  // namespace fuzz
