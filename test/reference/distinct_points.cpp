#include "reference/distinct_points.h"

#include "space_filling_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace spherical_param::reference {

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
  const internal::MortonCurve curve(vertices.rowwise().minCoeff(), vertices.rowwise().maxCoeff());
  std::vector<std::pair<std::uint64_t, Index>> places;
  for (Index v = 0; v < vertices.cols(); ++v)
    places.emplace_back(curve.key(vertices.col(v)), v);
  std::sort(places.begin(), places.end());
  for (const auto& [key, v] : places)
    result.vertex_of_node.push_back(v);
  result.points = vertices(Eigen::all, result.vertex_of_node);
  return result;
}

}  // namespace spherical_param::reference
