#include "ordered_points.h"

#include "parallel.h"
#include "power_of_two.h"
#include "radix_sort.h"
#include "space_filling_curve.h"
#include "spherical_param/errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <tuple>

namespace spherical_param::internal {
namespace {

/// Indices have 32 bits; a mesh has four times as many edge ends as points.
constexpr Eigen::Index kMaxPoints = Eigen::Index{1} << 30;
/// Largest exponent of the scaled coordinates: 2^1000 is finite.
constexpr int kMaxExponent = 1000;
/// Areas and volumes of larger clouds leave the range of double.
constexpr double kMaxCoordinate = 1e100;

struct Place {
  std::uint64_t key;  ///< on the curve
  Index index;        ///< of the input point
};

/// All points along the curve; those in one cell of it by their indices.
std::vector<Place> sortedPlaces(const Positions& points, const MortonCurve& curve, int threads) {
  std::vector<Place> places(static_cast<std::size_t>(points.cols()));
  forEachBlock(places.size(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      places[i] = {curve.key(points.col(static_cast<Eigen::Index>(i))), static_cast<Index>(i)};
  });
  radixSort(places);
  return places;
}

/// Fills input_of_node, and for each input point the first one at its position. Equal points lie in
/// one cell of the curve.
///
/// \param places all points; those of each cell are put into another order.
void mergeDuplicates(const Positions& points, std::vector<Place>& places, OrderedPoints& result) {
  const auto coordinates = [&](Index i) {
    return std::tuple(points(0, i), points(1, i), points(2, i));
  };
  std::vector<Index>& first_of_input = result.distinct.vertex_of_input;
  first_of_input.resize(places.size());
  std::iota(first_of_input.begin(), first_of_input.end(), Index{0});
  std::vector<Index>& input_of_node = result.input_of_node;
  input_of_node.reserve(places.size());
  for (std::size_t begin = 0; begin < places.size();) {
    std::size_t end = begin + 1;
    while (end < places.size() && places[end].key == places[begin].key)
      ++end;
    const auto of_cell = static_cast<std::ptrdiff_t>(input_of_node.size());
    if (end - begin > 1)
      std::sort(places.begin() + static_cast<std::ptrdiff_t>(begin),
                places.begin() + static_cast<std::ptrdiff_t>(end),
                [&](const Place& a, const Place& b) {
                  return std::tuple(coordinates(a.index), a.index) <
                         std::tuple(coordinates(b.index), b.index);
                });
    for (std::size_t i = begin; i < end; ++i) {
      const Index input = places[i].index;
      if (i > begin && coordinates(input) == coordinates(input_of_node.back()))
        first_of_input[static_cast<std::size_t>(input)] = input_of_node.back();
      else
        input_of_node.push_back(input);
    }
    std::sort(input_of_node.begin() + of_cell, input_of_node.end());
    begin = end;
  }
}

/// Numbers the distinct positions by their first input points.
///
/// \param distinct vertex_of_input holds the first input point of each, and then its vertex.
void numberVertices(DistinctPoints& distinct) {
  std::vector<Index>& vertex_of_input = distinct.vertex_of_input;
  for (std::size_t i = 0; i < vertex_of_input.size(); ++i) {
    const auto first = static_cast<std::size_t>(vertex_of_input[i]);
    if (first == i) {
      vertex_of_input[i] = static_cast<Index>(distinct.input_of_vertex.size());
      distinct.input_of_vertex.push_back(static_cast<Index>(i));
    } else {
      vertex_of_input[i] = vertex_of_input[first];  // which comes before
    }
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
  // An axis along which nothing differs may be so far away that it would not stay finite.
  int largest = 0;
  std::frexp(low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff(), &largest);
  result.exponent = std::max(exponentOfExtent(low, high), largest - kMaxExponent);
  const PowerOfTwo scaled(-result.exponent);
  std::vector<Place> places = sortedPlaces(points, MortonCurve(low, high), threads);

  mergeDuplicates(points, places, result);
  places = {};
  numberVertices(result.distinct);
  const std::vector<Index>& vertex_of_input = result.distinct.vertex_of_input;
  const std::vector<Index>& input_of_node = result.input_of_node;
  result.vertex_of_node.resize(input_of_node.size());
  result.points.resize(3, static_cast<Eigen::Index>(input_of_node.size()));
  forEachBlock(input_of_node.size(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      const Index input = input_of_node[node];
      result.vertex_of_node[node] = vertex_of_input[static_cast<std::size_t>(input)];
      result.points.col(static_cast<Eigen::Index>(node)) = scaled(points.col(input));
    }
  });
  return result;
}

std::vector<Index> nodesOfInput(const OrderedPoints& nodes) {
  std::vector<Index> node_of_vertex(nodes.vertex_of_node.size());
  for (std::size_t node = 0; node < node_of_vertex.size(); ++node)
    node_of_vertex[static_cast<std::size_t>(nodes.vertex_of_node[node])] = static_cast<Index>(node);
  std::vector<Index> result(nodes.distinct.vertex_of_input.size());
  std::transform(nodes.distinct.vertex_of_input.begin(), nodes.distinct.vertex_of_input.end(),
                 result.begin(),
                 [&](Index vertex) { return node_of_vertex[static_cast<std::size_t>(vertex)]; });
  return result;
}

void checkFinite(const std::string& function, const Positions& points) {
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (!points.col(i).allFinite())
      throw InvalidInput(function + ": point " + std::to_string(i) +
                         " is not finite; remove such points first");
}

OrderedPoints orderCheckedPoints(const Positions& points, int threads) {
  if (points.cols() > kMaxPoints)
    throw InvalidInput("reconstruct: " + std::to_string(points.cols()) +
                       " points are more than 2^30; split or downsample the cloud");
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (!points.col(i).allFinite())
      throw InvalidInput("reconstruct: point " + std::to_string(i) +
                         " is not finite; remove such points first");
    if (points.col(i).cwiseAbs().maxCoeff() > kMaxCoordinate)
      throw InvalidInput("reconstruct: a coordinate is beyond 1e100; scale the points down");
  }
  OrderedPoints nodes = orderPoints(points, threads);
  const std::size_t count = nodes.input_of_node.size();
  if (count < 4)
    throw InvalidInput("reconstruct: at least 4 distinct finite points are needed, but there are " +
                       std::to_string(count));
  return nodes;
}

}  // namespace spherical_param::internal
