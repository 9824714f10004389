#include "result_units.h"

#include "power_of_two.h"
#include "spherical_param/result_fields.h"

#include <algorithm>
#include <array>
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

/// Gives indices other numbers: number i is the i-th of `numbers`.
void renumber(const std::vector<Index>& numbers, std::vector<Index>& indices) {
  for (Index& index : indices)
    index = numbers[static_cast<std::size_t>(index)];
}

/// Gives indices and arrays that were computed on nodes the numbers of the vertices.
struct Renumbering {
  const Indexed<Index>& vertex_of_node;

  template <typename Value>
  void operator()(const ResultField&, Value&) const {}

  void operator()(const ResultField&, Triangles& triangles) const {
    triangles = triangles.unaryExpr([this](Index node) { return vertex_of_node[node]; }).eval();
  }

  void operator()(const ResultField& field, Positions& columns) const {
    if (field.kind != FieldKind::PerVertex)
      return;
    Positions of_vertices(3, columns.cols());
    for (Eigen::Index node = 0; node < columns.cols(); ++node)
      of_vertices.col(vertex_of_node[node]) = columns.col(node);
    columns = std::move(of_vertices);
  }

  void operator()(const ResultField& field, std::vector<double>& values) const {
    if (field.kind != FieldKind::PerVertex)
      return;
    Indexed<double> of_vertices(values.size());
    for (std::size_t node = 0; node < values.size(); ++node)
      of_vertices[vertex_of_node[node]] = values[node];
    values = std::move(of_vertices);
  }

  void operator()(const ResultField& field, std::vector<Index>& nodes) const {
    const bool is_loop = field.kind == FieldKind::Loops;
    const bool is_set = field.kind == FieldKind::Vertices;
    if (!is_loop && !is_set && field.kind != FieldKind::VertexList)
      return;
    renumber(vertex_of_node, nodes);
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
  const Renumbering renumbering{nodes.vertex_of_node};
  visitValues(result, Scaling{nodes.exponent});
  visitValues(result, renumbering);
  renumbering({"outliers", "", 0, FieldKind::Vertices}, result.outliers);
  result.vertex_of_input = std::move(nodes.distinct.vertex_of_input);
  result.input_of_vertex = std::move(nodes.distinct.input_of_vertex);
  renumber(result.input_of_vertex, result.outliers);
}

void toInput(Consolidation& consolidation, Surface& result) {
  // Those that came to one place are one vertex.
  result.consolidated = consolidation.points(Eigen::all, result.input_of_vertex);
  result.consolidation = consolidation.report;
  result.consolidation.merged += result.vertex_of_input.size() - result.input_of_vertex.size();
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

void toCloud(const std::vector<Index>& inputs, Surface& surface) {
  renumber(inputs, surface.input_of_vertex);
  renumber(inputs, surface.outliers);
  surface.inputs = inputs;
}

}  // namespace spherical_param::internal
