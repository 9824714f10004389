#pragma once

#include "open_shapes.h"
#include "spherical_param/reconstruct.h"

#include <boost/multiprecision/cpp_int.hpp>
#include <boost/multiprecision/eigen.hpp>

#include <tuple>

/// What reconstruct() guarantees, decided in exact arithmetic and without the library.
namespace fuzz {

using namespace spherical_param;

using Place = std::tuple<double, double, double>;

/// The first point at each place; -0 is 0.
inline std::map<Place, Index> firstAtPlaces(const Positions& points) {
  std::map<Place, Index> first;
  for (Index i = 0; i < points.cols(); ++i)
    first.emplace(Place{points(0, i) + 0.0, points(1, i) + 0.0, points(2, i) + 0.0}, i);
  return first;
}

/// Whether finite points lie in one plane: in fractions of any size.
inline bool liesInPlane(const Positions& points) {
  using Exact = boost::multiprecision::number<boost::multiprecision::cpp_rational_backend,
                                              boost::multiprecision::et_off>;
  using Vector = Eigen::Matrix<Exact, 3, 1>;
  const Vector zero = Vector::Zero();
  const Vector origin = points.col(0).cast<Exact>();
  Vector direction = zero;
  Vector normal = zero;
  for (const auto& point : points.colwise()) {
    const Vector offset = point.cast<Exact>() - origin;
    if (direction == zero)
      direction = offset;
    else if (normal == zero)
      normal = direction.cross(offset);
    else if (normal.dot(offset) != 0)
      return false;
  }
  return true;
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
         (mayBeOpen(options) || !liesInPlane(finite));
}

/// Whether it must mesh them: without outliers, or in its parts, there may be nothing to mesh, and
/// open surfaces may be left out where they intersect themselves.
inline bool mustBeMeshed(const Positions& points, const Options& options) {
  return options.outliers == OutlierMode::None && options.parts == PartsMode::All &&
         !mayBeOpen(options) && canBeMeshed(points, options);
}

/// Whether lists are as types.h says: `count` lists of indices in [0, n).
inline bool areLists(const NeighborLists& lists, std::size_t count, std::size_t n) {
  const auto& [offsets, indices] = lists;
  return offsets.size() == count + 1 && offsets.front() == 0 && offsets.back() == indices.size() &&
         std::is_sorted(offsets.begin(), offsets.end()) &&
         std::all_of(indices.begin(), indices.end(),
                     [&](Index j) { return j >= 0 && static_cast<std::size_t>(j) < n; });
}

inline bool areUnitVectors(const Positions& directions) {
  return ((directions.colwise().norm().array() - 1.0).abs() < 1e-9).all();
}

/// Whether the volume, in long double, is negative by more than its rounding.
inline bool facesInward(const Positions& points, const Triangles& triangles) {
  using Vector = Eigen::Matrix<long double, 3, 1>;
  const Vector origin = points.col(0).cast<long double>();
  long double volume = 0.0L;
  long double size = 0.0L;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Vector {
      return points.col(triangles(k, t)).cast<long double>() - origin;
    };
    volume += corner(0).dot(corner(1).cross(corner(2)));
    size += corner(0).norm() * corner(1).norm() * corner(2).norm();
  }
  return volume < -1e-12L * size;
}

/// What a mesh lacks of the boundary, the pieces and the genus that are reported; empty if nothing.
inline std::string faultOfTopology(const Surface& result) {
  const auto n = static_cast<Index>(result.vertexCount());
  const auto boundary = test::loopsOf(result.triangles);
  if (!boundary)
    return "the boundary is not of loops that are apart";
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
  const auto pieces = static_cast<Index>(result.topology.components);
  if (static_cast<std::size_t>(loops) != result.boundary.size() || !result.topology.genus ||
      !test::isSurfaceOverAll(closed, n + loops, static_cast<Index>(*result.topology.genus),
                              pieces))
    return "the mesh is not a manifold with the boundary, the pieces and the genus that are "
           "reported";
  if (result.topology.closed != result.isClosed())
    return "the result's own checks do not agree";
  return "";
}

/// What a surface of some points of a cloud lacks of what is guaranteed; empty if it lacks nothing.
inline std::string faultOf(const Positions& cloud, const Options& options, const Surface& result) {
  const Positions points = cloud(Eigen::all, result.inputs);
  const std::size_t n = result.inputs.size();
  const std::map<Place, Index> first = firstAtPlaces(points);
  const std::size_t v = first.size();
  if (result.vertexCount() != v || result.duplicates() != n - v ||
      result.vertex_of_input.size() != n)
    return "not one vertex for each distinct point";
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = points.col(static_cast<Eigen::Index>(i));
    const auto vertex = static_cast<std::size_t>(result.vertex_of_input[i]);
    const auto expected =
        static_cast<std::size_t>(first.at({p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}));
    if (vertex >= v || result.input_of_vertex[vertex] != result.inputs[expected])
      return "the vertex of a point is not that of the first point at its place";
  }
  const auto count = static_cast<Eigen::Index>(v);
  const std::string fault = faultOfTopology(result);
  if (!fault.empty())
    return fault;
  const auto genus = static_cast<Index>(result.genus());
  const bool is_sphere = !mayBeOpen(options) && options.intersections == IntersectionMode::Keep;
  if (is_sphere && !result.isClosed())
    return "the mesh is open, and was to be closed";
  if (genus > 0 && options.handles == HandleMode::None)
    return "the mesh has handles that were to be cut";
  if (result.isClosed() && facesInward(cloud(Eigen::all, result.input_of_vertex), result.triangles))
    return "the triangles face inward";
  const bool has_sphere = result.sphere.cols() > 0;
  const bool has_details = options.details || options.topology == TopologyMode::Sphere;
  const bool must_have = has_details && genus == 0 && !result.has_certain_triangles_only;
  if ((has_sphere ? genus > 0 || result.sphere.cols() != count : must_have) ||
      !areUnitVectors(result.sphere))
    return "the embedding is not of unit vectors, or not of a sphere";
  if (!std::isfinite(result.measures.volume) || !std::isfinite(result.measures.area))
    return "the volume or the area is not finite";
  if (result.points.cols() != count || !result.points.allFinite())
    return "the points are not as many finite ones as vertices";
  if (options.smoothing == 0 && result.added_vertices == 0 &&
      result.points != cloud(Eigen::all, result.input_of_vertex))
    return "the points are not those of the input";
  return "";
}

/// What the lists of a result lack; empty if they lack nothing.
inline std::string faultOfLists(const Positions& points, const Options& options,
                                const Result& result) {
  const LeftOut& left_out = result.left_out;
  std::vector<int> times(static_cast<std::size_t>(points.cols()), 0);
  bool is_ascending = true;
  const auto count = [&](const std::vector<Index>& list) {
    is_ascending = is_ascending && std::is_sorted(list.begin(), list.end());
    for (const Index i : list)
      ++times.at(static_cast<std::size_t>(i));
  };
  for (const Surface& surface : result.surfaces)
    count(surface.inputs);
  for (const auto& list :
       {left_out.not_finite, left_out.outliers, left_out.other_parts, left_out.unmeshed})
    count(list);
  if (!is_ascending || std::any_of(times.begin(), times.end(), [](int t) { return t != 1; }))
    return "not every point is in one list, or a list is not ascending";
  if (static_cast<Eigen::Index>(left_out.not_finite.size()) !=
      points.cols() - finiteOf(points).cols())
    return "not all points that are not finite are listed";
  if (options.outliers == OutlierMode::None && !left_out.outliers.empty())
    return "outliers that were not to be looked for";
  if (options.parts == PartsMode::All && !left_out.other_parts.empty())
    return "other parts of a whole cloud";
  if (result.surfaces.empty() || (options.parts != PartsMode::Each && result.surfaces.size() > 1))
    return "not the number of surfaces";
  for (std::size_t i = 1; i < result.surfaces.size(); ++i)
    if (result.surfaces[i].inputs.size() > result.surfaces[i - 1].inputs.size())
      return "the surface of most points is not the first";
  for (const std::string& failure : result.failures)
    if (failure.find("please report") != std::string::npos)
      return failure;
  return "";
}

}  // namespace fuzz
