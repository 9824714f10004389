#include "result_units.h"

#include "power_of_two.h"
#include "spherical_param/result_fields.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Gives numbers that were computed on scaled points the unit of the input.
struct Scaling {
  int exponent;

  template <typename Value>
  void operator()(const ResultField&, Value&) const {}

  void operator()(const ResultField& field, double& value) const {
    value = std::ldexp(value, field.power * exponent);
  }

  template <int Rows, int Cols>
  void operator()(const ResultField& field, Eigen::Matrix<double, Rows, Cols>& values) const {
    if (field.power != 0)
      values = timesPowerOfTwo(values, field.power * exponent);
  }
};

/// Gives indices other numbers: number i is the i-th of `numbers`; -1 stays.
void renumber(const std::vector<Index>& numbers, std::vector<Index>& indices) {
  for (Index& index : indices)
    index = index < 0 ? index : numbers[static_cast<std::size_t>(index)];
}

/// Leaves the nodes without triangles out of the vertices.
void dropUnused(OrderedPoints& nodes, Surface& surface) {
  const std::vector<Index> unused = std::exchange(surface.topology.unused_vertices, {});
  if (unused.empty())
    return;
  Indexed<Index> number(nodes.input_of_vertex.size(), 0);
  for (const Index node : unused)
    number[nodes.vertex_of_node[node]] = -1;
  Indexed<Index> input_of_vertex;
  for (const Index v : indicesOf(number))
    if (number[v] == 0) {
      number[v] = input_of_vertex.count();
      input_of_vertex.push_back(nodes.input_of_vertex[v]);
    }
  nodes.input_of_vertex = std::move(input_of_vertex);
  renumber(number, nodes.vertex_of_input);
  renumber(number, nodes.vertex_of_node);
}

/// Gives indices and arrays that were computed on nodes the numbers of the vertices.
struct Renumbering {
  const Indexed<Index>& vertex_of_node;  ///< -1: the node is no vertex
  std::size_t vertices;

  template <typename Value>
  void operator()(const ResultField&, Value&) const {}

  void operator()(const ResultField&, Triangles& triangles) const {
    triangles = triangles.unaryExpr([this](Index node) { return vertex_of_node[node]; }).eval();
  }

  void operator()(const ResultField& field, Positions& columns) const {
    if (field.kind != FieldKind::PerVertex || columns.cols() == 0)
      return;
    Positions of_vertices(3, static_cast<Eigen::Index>(vertices));
    for (Eigen::Index node = 0; node < columns.cols(); ++node)
      if (vertex_of_node[node] >= 0)
        of_vertices.col(vertex_of_node[node]) = columns.col(node);
    columns = std::move(of_vertices);
  }

  void operator()(const ResultField& field, std::vector<double>& values) const {
    if (field.kind != FieldKind::PerVertex || values.empty())
      return;
    Indexed<double> of_vertices(vertices);
    for (std::size_t node = 0; node < values.size(); ++node)
      if (vertex_of_node[node] >= 0)
        of_vertices[vertex_of_node[node]] = values[node];
    values = std::move(of_vertices);
  }

  void operator()(const ResultField& field, std::vector<Index>& nodes) const {
    const bool is_loop = field.kind == FieldKind::Loops;
    const bool is_set = field.kind == FieldKind::Vertices;
    if (!is_loop && !is_set && field.kind != FieldKind::VertexList)
      return;
    renumber(vertex_of_node, nodes);
    nodes.erase(std::remove(nodes.begin(), nodes.end(), -1), nodes.end());
    if (is_loop)
      std::rotate(nodes.begin(), std::min_element(nodes.begin(), nodes.end()), nodes.end());
    else if (is_set)
      std::sort(nodes.begin(), nodes.end());
  }

  void operator()(const ResultField& field, std::vector<std::vector<Index>>& loops) const {
    for (std::vector<Index>& loop : loops)
      (*this)(field, loop);
    std::sort(loops.begin(), loops.end(), [](const auto& a, const auto& b) {
      return a.size() != b.size() ? a.size() > b.size() : a < b;
    });
  }
};

}  // namespace

void toInput(OrderedPoints& nodes, Surface& result) {
  dropUnused(nodes, result);
  // Added nodes are behind the others.
  for (std::size_t v = nodes.vertex_of_node.size(); v < result.input_of_vertex.size(); ++v) {
    const Index nearest = nodes.vertex_of_node[result.input_of_vertex[v]];
    nodes.vertex_of_node.push_back(nodes.input_of_vertex.count());
    nodes.input_of_vertex.push_back(nodes.input_of_vertex[nearest]);
  }
  const Renumbering renumbering{nodes.vertex_of_node, nodes.input_of_vertex.size()};
  visitValues(result, Scaling{nodes.exponent});
  visitValues(result, renumbering);
  renumbering({"outliers", "", 0, FieldKind::Vertices}, result.outliers);
  result.vertex_of_input = std::move(nodes.vertex_of_input);
  result.input_of_vertex = std::move(nodes.input_of_vertex);
  renumber(result.input_of_vertex, result.outliers);
}

void toInput(Consolidation& consolidation, Surface& result) {
  result.consolidation = consolidation.report;
  // Only points with a vertex count. Points that came to one place are one vertex.
  Index merged = 0;
  for (std::size_t point = 0; point < result.vertex_of_input.size(); ++point)
    if (result.vertex_of_input[point] >= 0)
      merged += consolidation.distinct_at[point];
  result.consolidation->merged =
      static_cast<std::size_t>(merged) + result.added_vertices - result.input_of_vertex.size();
  Indexed<Index> first_of_point(result.vertex_of_input.size(), -1);
  Index input = 0;
  for (const Index point : consolidation.point_of_input) {
    if (first_of_point[point] < 0)
      first_of_point[point] = input;
    ++input;
  }
  renumber(first_of_point, result.input_of_vertex);
  renumber(first_of_point, result.outliers);
  renumber(result.vertex_of_input, consolidation.point_of_input);
  result.vertex_of_input = std::move(consolidation.point_of_input);
}

void toCloud(const Positions& points, const std::vector<Index>& inputs, Surface& surface,
             std::vector<Index>& unmeshed) {
  // The unit of nodes has rounded denormal numbers.
  if (!surface.consolidation && !surface.smoothing)
    for (std::size_t v = 0; v < surface.vertexCount() - surface.added_vertices; ++v)
      surface.points.col(static_cast<Eigen::Index>(v)) = points.col(surface.input_of_vertex[v]);
  renumber(inputs, surface.input_of_vertex);
  renumber(inputs, surface.outliers);
  std::vector<Index> vertices;
  for (std::size_t i = 0; i < inputs.size(); ++i)
    if (surface.vertex_of_input[i] >= 0) {
      surface.inputs.push_back(inputs[i]);
      vertices.push_back(surface.vertex_of_input[i]);
    } else {
      unmeshed.push_back(inputs[i]);
    }
  surface.vertex_of_input = std::move(vertices);
}

}  // namespace spherical_param::internal
