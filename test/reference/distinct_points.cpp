#include "reference/distinct_points.h"

#include "space_filling_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace spherical_param::reference {

OrderedPoints orderPoints(const Positions& points, int exponent) {
  OrderedPoints result;
  result.distinct = findDistinctPoints(points);
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
