#include "ordered_points.h"

#include "power_of_two.h"
#include "radix_sort.h"
#include "space_filling_curve.h"
#include "spherical_param/errors.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace spherical_param::internal {
namespace {

/// Fills input_of_node. Returns the first input point at the position of each. Equal points lie in
/// one cell of the curve.
///
/// \param places all points; those of each cell are reordered.
Indexed<Index> mergeDuplicates(const Positions& points, Indexed<Place>& places,
                               Indexed<Index>& input_of_node) {
  const auto coordinates = [&](Index i) {
    return std::tuple(points(0, i), points(1, i), points(2, i));
  };
  Indexed<Index> first_of_input(places.size());
  input_of_node.reserve(places.size());
  for (auto begin = places.begin(); begin != places.end();) {
    const auto end = std::find_if(begin + 1, places.end(),
                                  [&](const Place& place) { return place.key != begin->key; });
    if (end - begin > 1)
      std::sort(begin, end, [&](const Place& a, const Place& b) {
        return std::tuple(coordinates(a.index), a.index) <
               std::tuple(coordinates(b.index), b.index);
      });
    const auto of_cell = static_cast<std::ptrdiff_t>(input_of_node.size());
    for (auto place = begin; place != end; ++place) {
      const Index input = place->index;
      if (place == begin || coordinates(input) != coordinates(input_of_node.back()))
        input_of_node.push_back(input);
      first_of_input[input] = input_of_node.back();
    }
    std::sort(input_of_node.begin() + of_cell, input_of_node.end());
    begin = end;
  }
  return first_of_input;
}

/// Numbers the distinct positions by their first input points.
void numberVertices(const Indexed<Index>& first_of_input, OrderedPoints& result) {
  result.vertex_of_input.reserve(first_of_input.size());
  for (const Index i : indicesOf(first_of_input)) {
    const Index first = first_of_input[i];
    result.vertex_of_input.push_back(first == i ? result.input_of_vertex.count()
                                                : result.vertex_of_input[first]);
    if (first == i)
      result.input_of_vertex.push_back(i);
  }
}

}  // namespace

OrderedPoints orderPoints(const Positions& points, int threads) {
  const auto n = static_cast<std::size_t>(points.cols());
  OrderedPoints result;
  if (n == 0)
    return result;
  threads = threadCount(threads, n);
  const Eigen::Vector3d low = points.rowwise().minCoeff();
  const Eigen::Vector3d high = points.rowwise().maxCoeff();
  // An axis along which all points are equal may be so far from 0 that scaling overflows: at most
  // 2^1000 stays.
  int largest = 0;
  std::frexp(low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff(), &largest);
  result.exponent = std::max(exponentOfExtent(low, high), largest - 1000);
  const MortonCurve curve(low, high);
  Indexed<Place> places =
      sortedPlaces(n, threads, [&](Index i) { return curve.key(points.col(i)); });
  numberVertices(mergeDuplicates(points, places, result.input_of_node), result);
  places = {};
  const std::size_t count = result.input_of_node.size();
  result.vertex_of_node.resize(count);
  result.points.resize(3, static_cast<Eigen::Index>(count));
  forEachIndex(count, threads, {}, [&](Index node) {
    const Index input = result.input_of_node[node];
    result.vertex_of_node[node] = result.vertex_of_input[input];
    result.points.col(node) = timesPowerOfTwo(points.col(input), -result.exponent);
  });
  return result;
}

Indexed<Index> nodesOfInput(const OrderedPoints& nodes) {
  Indexed<Index> node_of_vertex(nodes.vertex_of_node.size());
  for (const Index node : indicesOf(node_of_vertex))
    node_of_vertex[nodes.vertex_of_node[node]] = node;
  Indexed<Index> result(nodes.vertex_of_input.size());
  for (const Index input : indicesOf(result))
    result[input] = node_of_vertex[nodes.vertex_of_input[input]];
  return result;
}

void checkFinite(const std::string& function, const Positions& points) {
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (!points.col(i).allFinite())
      throw InvalidInput(function + ": point " + std::to_string(i) +
                         " is not finite; remove such points first");
}

OrderedPoints orderCheckedPoints(const Positions& points, int threads) {
  // Indices have 32 bits; a mesh has four times as many edge ends as points.
  if (points.cols() > Eigen::Index{1} << 30)
    throw InvalidInput("reconstruct: " + std::to_string(points.cols()) +
                       " points are more than 2^30; split or downsample the cloud");
  checkFinite("reconstruct", points);
  // Areas and volumes of larger clouds are beyond the range of double.
  if (points.size() > 0 && points.cwiseAbs().maxCoeff() > 1e100)
    throw InvalidInput("reconstruct: a coordinate is beyond 1e100; scale the points down");
  OrderedPoints nodes = orderPoints(points, threads);
  const std::size_t count = nodes.input_of_node.size();
  if (count < 4)
    throw InvalidInput("reconstruct: at least 4 distinct finite points are needed, but there are " +
                       std::to_string(count));
  return nodes;
}

}  // namespace spherical_param::internal
