#pragma once

#include "edge_weights.h"
#include "graph.h"
#include "parallel.h"
#include "spherical_param/types.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Entries of a row that are evaluated together.
inline constexpr int kLanes = 4;
/// Four doubles a point, so that cache lines do not split points; the last is 0.
using PaddedPositions = Eigen::Matrix<double, 4, Eigen::Dynamic>;

/// How a weight depends on its factor f and the length d on the sphere. \see EdgeWeightLaw
enum class WeightRule {
  Fixed,   ///< f
  Linear,  ///< f d
  Power,   ///< (f d)^q
};

/// The rows of a graph in an order in which neighbours are near in memory. Rows are padded to
/// groups of kLanes entries with the node itself.
struct Rows {
  std::vector<Index> node_of_row;    ///< original node; empty: the row itself
  std::vector<std::size_t> offsets;  ///< multiples of kLanes
  std::vector<Index> neighbors;      ///< as rows
  std::vector<double> factors;       ///< of EdgeWeightLaw; padding has 0
  double power = 1.0;                ///< of EdgeWeightLaw

  Index size() const { return static_cast<Index>(offsets.size()) - 1; }
};

/// \param node_of_row the nodes in the order of the rows.
inline Rows makeRows(const Graph& graph, std::vector<Index> node_of_row,
                     const EdgeWeightLaw& weights) {
  Rows rows;
  rows.power = weights.power();
  rows.node_of_row = std::move(node_of_row);
  const std::size_t n = graph.size();
  std::vector<Index> row_of_node(n);
  for (std::size_t row = 0; row < n; ++row)
    row_of_node[static_cast<std::size_t>(rows.node_of_row[row])] = static_cast<Index>(row);
  const auto node_at = [&](std::size_t row) {
    return static_cast<std::size_t>(rows.node_of_row[row]);
  };
  rows.offsets.reserve(n + 1);
  rows.offsets.push_back(0);
  for (std::size_t row = 0; row < n; ++row) {
    const std::size_t i = node_at(row);
    const std::size_t entries = graph.offsets[i + 1] - graph.offsets[i];
    rows.offsets.push_back(rows.offsets.back() + (entries + kLanes - 1) / kLanes * kLanes);
  }
  rows.neighbors.reserve(rows.offsets.back());
  rows.factors.reserve(rows.offsets.back());
  for (std::size_t row = 0; row < n; ++row) {
    const std::size_t i = node_at(row);
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      rows.neighbors.push_back(row_of_node[static_cast<std::size_t>(graph.neighbors[e])]);
      rows.factors.push_back(weights.factor(graph.lengths[e]));
    }
    rows.neighbors.resize(rows.offsets[row + 1], static_cast<Index>(row));
    rows.factors.resize(rows.offsets[row + 1], 0.0);
  }
  return rows;
}

/// Rows in the order of the nodes, made on several threads.
inline Rows makeRows(const Graph& graph, const EdgeWeightLaw& weights, int threads) {
  Rows rows;
  rows.power = weights.power();
  const std::size_t n = graph.size();
  rows.offsets.resize(n + 1);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t entries = graph.offsets[i + 1] - graph.offsets[i];
    rows.offsets[i + 1] = rows.offsets[i] + (entries + kLanes - 1) / kLanes * kLanes;
  }
  rows.neighbors.resize(rows.offsets.back());
  rows.factors.resize(rows.offsets.back());
  forEachBlock(n, threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::size_t place = rows.offsets[i];
      for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e, ++place) {
        rows.neighbors[place] = graph.neighbors[e];
        rows.factors[place] = weights.factor(graph.lengths[e]);
      }
      for (; place < rows.offsets[i + 1]; ++place)
        rows.neighbors[place] = static_cast<Index>(i);
    }
  });
  return rows;
}

/// One value for each of kLanes entries.
using Lanes = Eigen::Array<double, kLanes, 1>;

/// Sum of the lanes in an order that does not depend on the instruction set.
inline double total(const Lanes& lanes) {
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

/// Tangential part of the Laplacian of a row (Zwicker and Gotsman 2004, equations 1 and 2), weights
/// normalised to sum 1.
template <WeightRule Rule>
Eigen::Vector3d tangentialLaplacian(const Rows& rows, const PaddedPositions& u, Index row) {
  const Eigen::Vector3d center = u.col(row).head<3>();
  const double* positions = u.data();
  const Index* neighbors = rows.neighbors.data();
  Lanes sum_x = Lanes::Zero();
  Lanes sum_y = Lanes::Zero();
  Lanes sum_z = Lanes::Zero();
  Lanes sum_weights = Lanes::Zero();
  const auto i = static_cast<std::size_t>(row);
  const std::size_t end = rows.offsets[i + 1];
  for (std::size_t e = rows.offsets[i]; e < end; e += kLanes) {
    const double* const a = positions + 4 * static_cast<std::size_t>(neighbors[e]);
    const double* const b = positions + 4 * static_cast<std::size_t>(neighbors[e + 1]);
    const double* const c = positions + 4 * static_cast<std::size_t>(neighbors[e + 2]);
    const double* const d = positions + 4 * static_cast<std::size_t>(neighbors[e + 3]);
    const Lanes x = Lanes(a[0], b[0], c[0], d[0]) - center[0];
    const Lanes y = Lanes(a[1], b[1], c[1], d[1]) - center[1];
    const Lanes z = Lanes(a[2], b[2], c[2], d[2]) - center[2];
    Lanes weights = Eigen::Map<const Lanes>(rows.factors.data() + e);
    if constexpr (Rule != WeightRule::Fixed) {
      weights *= (x * x + y * y + z * z).sqrt();
      if constexpr (Rule == WeightRule::Power)
        for (double& weight : weights)
          weight = std::pow(weight, rows.power);
    }
    sum_x += weights * x;
    sum_y += weights * y;
    sum_z += weights * z;
    sum_weights += weights;
  }
  const double weight_sum = total(sum_weights);
  if (!(weight_sum > 0.0))
    return Eigen::Vector3d::Zero();  // all neighbours are at the same place
  const Eigen::Vector3d laplacian =
      Eigen::Vector3d(total(sum_x), total(sum_y), total(sum_z)) / weight_sum;
  return laplacian - laplacian.dot(center) * center;
}

/// Calls visit(std::integral_constant<WeightRule, rule>()) with the rule of the rows, for loops
/// that are compiled for one rule.
template <typename Visit>
void visitRule(const Rows& rows, const Visit& visit) {
  if (rows.power == 0.0)
    visit(std::integral_constant<WeightRule, WeightRule::Fixed>());
  else if (rows.power == 1.0)
    visit(std::integral_constant<WeightRule, WeightRule::Linear>());
  else
    visit(std::integral_constant<WeightRule, WeightRule::Power>());
}

}  // namespace spherical_param::internal
