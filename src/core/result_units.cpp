#include "result_units.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Gives the result, computed on scaled points, the unit of the input.
void scaleBack(int exponent, Surface& result) {
  const auto scale = [exponent](double& value, int power = 1) {
    value = std::ldexp(value, power * exponent);
  };
  const auto scale_all = [exponent](auto& values, int power = 1) {
    values = values.unaryExpr([=](double x) { return std::ldexp(x, power * exponent); }).eval();
  };
  scale(result.measures.volume, 3);
  scale(result.measures.area, 2);
  scale(result.measures.mean_edge_length);
  scale_all(result.measures.box_min);
  scale_all(result.measures.box_max);
  scale_all(result.measures.centroid);
  scale_all(result.measures.inertia, 5);
  if (result.smoothed.cols() > 0) {
    scale_all(result.smoothed);
    scale(result.smoothing.max_displacement);
    scale(result.smoothing.mean_displacement);
    scale(result.smoothing.rms_displacement);
    scale(result.smoothing.volume_before, 3);
    scale(result.smoothing.volume_after, 3);
  }
  for (Opening& opening : result.openings) {
    scale(opening.boundary_length);
    scale(opening.area, 2);
    scale(opening.spacing);
    scale(opening.width);
    scale_all(opening.center);
  }
  for (CollapsedHandle& handle : result.diagnosis.handles) {
    scale(handle.size);
    scale_all(handle.center);
  }
  for (PartBridge& bridge : result.diagnosis.bridges) {
    scale(bridge.gap);
    scale(bridge.spacing);
    scale_all(bridge.center);
  }
}

/// Gives the result, computed on nodes, the numbers of the vertices.
void renumber(const std::vector<Index>& vertex_of_node, Surface& result) {
  const auto vertex = [&](Index node) { return vertex_of_node[static_cast<std::size_t>(node)]; };
  const auto renumber_all = [&](std::vector<Index>& nodes) {
    std::transform(nodes.begin(), nodes.end(), nodes.begin(), vertex);
    std::sort(nodes.begin(), nodes.end());
  };
  const auto permute = [&](Positions& of_nodes) {
    Positions of_vertices(3, of_nodes.cols());
    for (Eigen::Index node = 0; node < of_nodes.cols(); ++node)
      of_vertices.col(vertex(static_cast<Index>(node))) = of_nodes.col(node);
    of_nodes = std::move(of_vertices);
  };
  result.triangles = result.triangles.unaryExpr(vertex);
  permute(result.sphere);
  permute(result.smoothed);
  std::transform(result.history.vertices.begin(), result.history.vertices.end(),
                 result.history.vertices.begin(), vertex);
  std::vector<double> of_vertices(result.vertex_residuals.size());
  for (std::size_t node = 0; node < of_vertices.size(); ++node)
    of_vertices[static_cast<std::size_t>(vertex_of_node[node])] = result.vertex_residuals[node];
  result.vertex_residuals = std::move(of_vertices);
  const auto renumber_loop = [&](std::vector<Index>& loop) {
    std::transform(loop.begin(), loop.end(), loop.begin(), vertex);
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  };
  for (Opening& opening : result.openings)
    renumber_loop(opening.loop);
  for (std::vector<Index>& loop : result.boundary)
    renumber_loop(loop);
  std::sort(result.boundary.begin(), result.boundary.end(), [](const auto& a, const auto& b) {
    return a.size() != b.size() ? a.size() > b.size() : a < b;
  });
  renumber_all(result.outliers);
  for (CollapsedHandle& handle : result.diagnosis.handles)
    renumber_all(handle.vertices);
  for (PartBridge& bridge : result.diagnosis.bridges)
    renumber_all(bridge.vertices);
}

}  // namespace

void toInput(OrderedPoints& nodes, Surface& result) {
  scaleBack(nodes.exponent, result);
  renumber(nodes.vertex_of_node, result);
  result.vertex_of_input = std::move(nodes.distinct.vertex_of_input);
  result.input_of_vertex = std::move(nodes.distinct.input_of_vertex);
  for (Index& vertex : result.outliers)
    vertex = result.input_of_vertex[static_cast<std::size_t>(vertex)];
}

void toInput(Consolidation& consolidation, Surface& result) {
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  // Those that came to one place are one vertex.
  result.consolidated = consolidation.points(Eigen::all, result.input_of_vertex);
  result.consolidation = consolidation.report;
  result.consolidation.merged += result.vertex_of_input.size() - result.input_of_vertex.size();
  std::vector<Index> vertex_of_input = std::move(consolidation.point_of_input);
  std::vector<Index> first_of_point(result.vertex_of_input.size(), -1);
  for (std::size_t i = 0; i < vertex_of_input.size(); ++i) {
    Index& first = first_of_point[at(vertex_of_input[i])];
    if (first < 0)
      first = static_cast<Index>(i);
    vertex_of_input[i] = result.vertex_of_input[at(vertex_of_input[i])];
  }
  const auto to_first = [&](Index& point) { point = first_of_point[at(point)]; };
  std::for_each(result.input_of_vertex.begin(), result.input_of_vertex.end(), to_first);
  std::for_each(result.outliers.begin(), result.outliers.end(), to_first);
  result.vertex_of_input = std::move(vertex_of_input);
}

}  // namespace spherical_param::internal
