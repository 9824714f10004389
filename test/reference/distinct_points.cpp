#include "reference/distinct_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace spherical_param::reference {
namespace {

/// The bits of the three numbers of a cell in turns.
std::uint64_t mortonKey(const Eigen::Vector3d& cell) {
  std::uint64_t key = 0;
  for (unsigned bit = 0; bit < 21; ++bit)
    for (unsigned axis = 0; axis < 3; ++axis)
      key |= (static_cast<std::uint64_t>(cell[axis]) >> bit & 1U) << (3 * bit + axis);
  return key;
}

}  // namespace

OrderedPoints orderPoints(const Positions& points, int exponent) {
  OrderedPoints result;
  std::map<std::array<double, 3>, Index> vertex_at;
  for (Index i = 0; i < points.cols(); ++i) {
    // Zeros of both signs are equal.
    const std::array<double, 3> place = {points(0, i), points(1, i), points(2, i)};
    const auto [entry, is_new] =
        vertex_at.emplace(place, static_cast<Index>(result.distinct.input_of_vertex.size()));
    if (is_new)
      result.distinct.input_of_vertex.push_back(i);
    result.distinct.vertex_of_input.push_back(entry->second);
  }
  const Positions vertices =
      points(Eigen::all, result.distinct.input_of_vertex) * std::ldexp(1.0, -exponent);
  if (vertices.cols() == 0)
    return result;
  const Eigen::Vector3d low = vertices.rowwise().minCoeff();
  const double extent = (vertices.rowwise().maxCoeff() - low).maxCoeff();
  const double scale = extent > 0.0 ? 2097151.0 / extent : 0.0;
  std::vector<std::pair<std::uint64_t, Index>> places;
  for (Index v = 0; v < vertices.cols(); ++v)
    places.emplace_back(mortonKey((vertices.col(v) - low) * scale), v);
  std::sort(places.begin(), places.end());
  for (const auto& [key, v] : places)
    result.vertex_of_node.push_back(v);
  result.points = vertices(Eigen::all, result.vertex_of_node);
  return result;
}

}  // namespace spherical_param::reference
