#include "sample_elimination.h"

#include "bit_mixing.h"
#include "parallel.h"
#include "radix_sort.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace spherical_param::internal {
namespace {

using Eigen::Vector3d;

/// Yuksel 2015, section 3: the exponent of the weight, and what limits that of pairs that are very
/// close.
constexpr double kBeta = 0.65;
constexpr double kGamma = 1.5;

/// Points sorted by the cells of a grid of cubes, which are found by hashing.
class CellGrid {
public:
  /// \param size of a cell.
  CellGrid(const Positions& points, double size) {
    const Vector3d low = points.rowwise().minCoeff();
    const double extent = (points.rowwise().maxCoeff() - low).maxCoeff();
    // A cell has 21 bits for each axis, and neighbours on either side.
    size = std::max(size, extent / (1U << 20U));
    std::vector<Item> items(static_cast<std::size_t>(points.cols()));
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Vector3d place = (points.col(static_cast<Eigen::Index>(i)) - low) / size;
      std::uint64_t key = 0;
      for (int axis = 0; axis < 3; ++axis)
        key = key << kBits | (static_cast<std::uint64_t>(place[axis]) + 1);
      items[i] = {key, static_cast<Index>(i)};
    }
    radixSort(items);
    for (const Item& item : items) {
      if (cells_.empty() || keys_.back() != item.key)
        cells_.push_back(static_cast<Index>(order_.size()));
      order_.push_back(item.index);
      keys_.push_back(item.key);
    }
    std::size_t slots = 16;
    while (slots < 2 * cells_.size())
      slots *= 2;
    table_.assign(slots, -1);
    for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
      std::size_t slot = slotOf(keys_[static_cast<std::size_t>(cells_[cell])]);
      while (table_[slot] >= 0)
        slot = (slot + 1) & (slots - 1);
      table_[slot] = static_cast<Index>(cell);
    }
    cells_.push_back(static_cast<Index>(order_.size()));
  }

  /// The points, cell by cell.
  const std::vector<Index>& order() const { return order_; }

  /// Calls visit(begin, end) for the ranges of order() in the cell of place i and those around it.
  template <typename Visit>
  void forEachCellAround(std::size_t i, const Visit& visit) const {
    constexpr std::uint64_t one_x = std::uint64_t{1} << (2 * kBits);
    constexpr std::uint64_t one_y = std::uint64_t{1} << kBits;
    std::uint64_t x = keys_[i] - one_x - one_y - 1;
    for (int dx = 0; dx < 3; ++dx, x += one_x) {
      std::uint64_t y = x;
      for (int dy = 0; dy < 3; ++dy, y += one_y)
        for (std::uint64_t key = y; key < y + 3; ++key)
          for (std::size_t slot = slotOf(key); table_[slot] >= 0;
               slot = (slot + 1) & (table_.size() - 1)) {
            const auto cell = static_cast<std::size_t>(table_[slot]);
            const auto begin = static_cast<std::size_t>(cells_[cell]);
            if (keys_[begin] != key)
              continue;
            visit(begin, static_cast<std::size_t>(cells_[cell + 1]));
            break;
          }
    }
  }

private:
  struct Item {
    std::uint64_t key;
    Index index;
  };
  static constexpr unsigned kBits = 21;

  std::size_t slotOf(std::uint64_t key) const { return splitmix64(key) & (table_.size() - 1); }

  std::vector<Index> order_;         ///< points
  std::vector<std::uint64_t> keys_;  ///< of the cell of order_[i]
  std::vector<Index> cells_;         ///< where each begins in order_, and its end
  std::vector<Index> table_;         ///< cells by the hash of their key; -1: none
};

/// Samples by their weight, the heaviest on top; of equal ones the first.
class Heap {
public:
  explicit Heap(std::vector<double> weights)
      : weights_(std::move(weights)), heap_(weights_.size()), place_(weights_.size()) {
    for (std::size_t i = 0; i < heap_.size(); ++i)
      put(i, static_cast<Index>(i));
    for (std::size_t i = heap_.size() / 2; i-- > 0;)
      sink(i);
  }

  std::size_t size() const { return heap_.size(); }
  bool has(std::size_t sample) const { return place_[sample] >= 0; }

  std::size_t takeTop() {
    const auto top = static_cast<std::size_t>(heap_.front());
    place_[top] = -1;
    const Index last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) {
      put(0, last);
      sink(0);
    }
    return top;
  }

  void lighten(std::size_t sample, double by) {
    weights_[sample] -= by;
    sink(static_cast<std::size_t>(place_[sample]));
  }

private:
  bool isHeavier(Index a, Index b) const {
    const double weight_a = weights_[static_cast<std::size_t>(a)];
    const double weight_b = weights_[static_cast<std::size_t>(b)];
    return weight_a != weight_b ? weight_a > weight_b : a < b;
  }
  void put(std::size_t place, Index sample) {
    heap_[place] = sample;
    place_[static_cast<std::size_t>(sample)] = static_cast<Index>(place);
  }
  void sink(std::size_t place) {
    const Index sample = heap_[place];
    for (std::size_t child = 2 * place + 1; child < heap_.size(); child = 2 * place + 1) {
      if (child + 1 < heap_.size() && isHeavier(heap_[child + 1], heap_[child]))
        ++child;
      if (!isHeavier(heap_[child], sample))
        break;
      put(place, heap_[child]);
      place = child;
    }
    put(place, sample);
  }

  std::vector<double> weights_;
  std::vector<Index> heap_;
  std::vector<Index> place_;  ///< in heap_; -1: taken
};

}  // namespace

std::vector<Index> eliminateSamples(const Positions& points, const Positions& normals,
                                    std::size_t count, double area, int threads) {
  const auto n = static_cast<std::size_t>(points.cols());
  // The largest radius of disks of which this number fits on the area, and the least that counts.
  const double most = std::sqrt(area / (2.0 * std::sqrt(3.0) * static_cast<double>(count)));
  const double least =
      most * kBeta * (1.0 - std::pow(static_cast<double>(count) / static_cast<double>(n), kGamma));
  const CellGrid grid(points, 2.0 * most);
  Positions sorted_points(3, points.cols());
  Positions sorted_normals(3, points.cols());
  for (std::size_t i = 0; i < n; ++i) {
    sorted_points.col(static_cast<Eigen::Index>(i)) = points.col(grid.order()[i]);
    sorted_normals.col(static_cast<Eigen::Index>(i)) = normals.col(grid.order()[i]);
  }
  /// Calls visit(j, weight of the pair) for the samples that are near sample i.
  const auto for_each_near = [&](std::size_t i, const auto& visit) {
    const Vector3d point = sorted_points.col(static_cast<Eigen::Index>(i));
    const Vector3d normal = sorted_normals.col(static_cast<Eigen::Index>(i));
    grid.forEachCellAround(i, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        const auto column = static_cast<Eigen::Index>(j);
        const double square = (sorted_points.col(column) - point).squaredNorm();
        if (square >= 4.0 * most * most || j == i || sorted_normals.col(column).dot(normal) < 0.0)
          continue;
        const double fraction = 1.0 - std::max(std::sqrt(square), 2.0 * least) / (2.0 * most);
        const double second = fraction * fraction;
        const double fourth = second * second;
        visit(j, fourth * fourth);
      }
    });
  };

  std::vector<double> weights(n);
  forEachItem(n, threadCount(threads, n), [&](std::size_t, std::size_t i) {
    double sum = 0.0;
    for_each_near(i, [&](std::size_t, double weight) { sum += weight; });
    weights[i] = sum;
  });
  Heap heap(std::move(weights));
  while (heap.size() > count) {
    const std::size_t top = heap.takeTop();
    for_each_near(top, [&](std::size_t j, double weight) {
      if (heap.has(j))
        heap.lighten(j, weight);
    });
  }
  std::vector<Index> result;
  result.reserve(count);
  for (std::size_t i = 0; i < n; ++i)
    if (heap.has(i))
      result.push_back(grid.order()[i]);
  return result;
}

}  // namespace spherical_param::internal
