#include "sample_elimination.h"

#include "rows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>

namespace spherical_param::tools {
namespace {

using Eigen::Vector3d;
using internal::Indexed;

/// Yuksel 2015, section 3: factor (beta) and exponent (gamma) of the least radius that counts.
constexpr double radius_factor = 0.65;
constexpr double radius_exponent = 1.5;

/// Points sorted by the cells of a grid of cubes.
class CellGrid {
public:
  /// \param size of a cell.
  CellGrid(const Positions& points, double size) {
    const Vector3d low = points.rowwise().minCoeff();
    const double extent = (points.rowwise().maxCoeff() - low).maxCoeff();
    // A cell has 21 bits for each axis, and neighbours on either side.
    size = std::max(size, extent / (1U << 20U));
    std::vector<std::pair<std::uint64_t, Index>> items;
    for (Index i = 0; i < points.cols(); ++i) {
      const Vector3d place = (points.col(i) - low) / size;
      std::uint64_t key = 0;
      for (const double coordinate : place) {
        key = key << bits | (static_cast<std::uint64_t>(coordinate) + 1);
      }
      items.emplace_back(key, i);
    }
    std::sort(items.begin(), items.end());
    for (const auto& [key, index] : items) {
      order_.push_back(index);
      keys_.push_back(key);
    }
  }

  /// The points, cell by cell.
  const Indexed<Index>& order() const { return order_; }

  /// Calls visit(j) for the places in order() in the cell of place i and those around it.
  template <typename Visit>
  void forEachAround(Index i, const Visit& visit) const {
    constexpr std::uint64_t one_x = std::uint64_t{1} << (2 * bits);
    constexpr std::uint64_t one_y = std::uint64_t{1} << bits;
    for (std::uint64_t x = 0; x < 3; ++x) {
      for (std::uint64_t y = 0; y < 3; ++y) {
        // Three cells along z follow each other.
        const std::uint64_t middle = keys_[i] + (x - 1) * one_x + (y - 1) * one_y;
        auto key = std::lower_bound(keys_.begin(), keys_.end(), middle - 1);
        for (; key != keys_.end() && *key <= middle + 1; ++key) {
          visit(static_cast<Index>(key - keys_.begin()));
        }
      }
    }
  }

private:
  static constexpr unsigned bits = 21;

  Indexed<Index> order_;         ///< points
  Indexed<std::uint64_t> keys_;  ///< of the cell of order_[i], ascending
};

}  // namespace

std::vector<Index> eliminateSamples(const Positions& points, std::size_t count, double area) {
  const double remaining = static_cast<double>(count);
  // The largest radius of disks of which this number fits on the area, and the least that counts.
  const double most = std::sqrt(area / (2.0 * std::sqrt(3.0) * remaining));
  const double least =
      most * radius_factor *
      (1.0 - std::pow(remaining / static_cast<double>(points.cols()), radius_exponent));
  const CellGrid grid(points, 2.0 * most);
  const Positions sorted_points = points(Eigen::all, grid.order());
  /// Calls visit(j, weight of the pair) for the samples that are near sample i.
  const auto for_each_near = [&](Index i, const auto& visit) {
    const Vector3d point = sorted_points.col(i);
    grid.forEachAround(i, [&](Index j) {
      const double square = (sorted_points.col(j) - point).squaredNorm();
      if (square >= 4.0 * most * most || j == i) {
        return;
      }
      const double fraction = 1.0 - std::max(std::sqrt(square), 2.0 * least) / (2.0 * most);
      const double second = fraction * fraction;
      const double fourth = second * second;
      visit(j, fourth * fourth);
    });
  };

  Indexed<double> weights(grid.order().size());
  const auto sum_up = [&](Index i) {
    double sum = 0.0;
    for_each_near(i, [&](Index, double weight) { sum += weight; });
    weights[i] = sum;
  };
  internal::forEachIndex(weights.size(), internal::threadCount(0, weights.size()), {}, sum_up);
  // The heaviest on top, of equal ones the first. Weights only fall: an entry with more than the
  // weight of its sample goes back.
  const auto entry_of = [&](Index i) { return std::pair(weights[i], -i); };
  std::vector<std::pair<double, Index>> entries;
  entries.reserve(weights.size());
  for (Index i = 0; i < weights.count(); ++i) {
    entries.push_back(entry_of(i));
  }
  std::priority_queue heap(std::less<>(), std::move(entries));
  Indexed<char> is_left(weights.size(), 1);
  for (std::size_t left = weights.size(); left > count;) {
    const auto [weight, negative] = heap.top();
    heap.pop();
    if (weight > weights[-negative]) {
      heap.push(entry_of(-negative));
      continue;
    }
    is_left[-negative] = 0;
    --left;
    for_each_near(-negative, [&](Index j, double by) { weights[j] -= by; });
  }
  std::vector<Index> result;
  for (Index i = 0; i < weights.count(); ++i) {
    if (is_left[i] != 0) {
      result.push_back(grid.order()[i]);
    }
  }
  return result;
}

}  // namespace spherical_param::tools
