#include "sample_elimination.h"

#include "bit_mixing.h"
#include "index_loops.h"
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
    std::vector<Item> items;
    items.reserve(columnCount(points));
    for (Index i = 0; i < points.cols(); ++i) {
      const Vector3d place = (points.col(i) - low) / size;
      std::uint64_t key = 0;
      for (const double coordinate : place)
        key = key << kBits | (static_cast<std::uint64_t>(coordinate) + 1);
      items.push_back({key, i});
    }
    radixSort(items);
    for (const Item& item : items) {
      if (cells_.empty() || keys_.back() != item.key)
        cells_.push_back(indexCount(order_));
      order_.push_back(item.index);
      keys_.push_back(item.key);
    }
    std::size_t slots = 16;
    while (slots < 2 * cells_.size())
      slots *= 2;
    table_.assign(slots, -1);
    for (Index cell = 0; cell < indexCount(cells_); ++cell) {
      std::size_t slot = slotOf(keys_[cells_[cell]]);
      while (table_[slot] >= 0)
        slot = (slot + 1) & (slots - 1);
      table_[slot] = cell;
    }
    cells_.push_back(indexCount(order_));
  }

  /// The points, cell by cell.
  const std::vector<Index>& order() const { return order_; }

  /// Calls visit(begin, end) for the ranges of order() in the cell of place i and those around it.
  template <typename Visit>
  void forEachCellAround(Index i, const Visit& visit) const {
    constexpr std::uint64_t one_x = std::uint64_t{1} << (2 * kBits);
    constexpr std::uint64_t one_y = std::uint64_t{1} << kBits;
    std::uint64_t x = keys_[i] - one_x - one_y - 1;
    for (int dx = 0; dx < 3; ++dx, x += one_x) {
      std::uint64_t y = x;
      for (int dy = 0; dy < 3; ++dy, y += one_y)
        for (std::uint64_t key = y; key < y + 3; ++key)
          for (std::size_t slot = slotOf(key); table_[slot] >= 0;
               slot = (slot + 1) & (table_.size() - 1)) {
            const Index cell = table_[slot];
            if (keys_[cells_[cell]] != key)
              continue;
            visit(cells_[cell], cells_[cell + 1]);
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

  std::vector<Index> order_;     ///< points
  Indexed<std::uint64_t> keys_;  ///< of the cell of order_[i]
  Indexed<Index> cells_;         ///< where each begins in order_, and its end
  std::vector<Index> table_;     ///< cells by the hash of their key; -1: none
};

/// Samples by their weight, the heaviest on top; of equal ones the first.
class Heap {
public:
  explicit Heap(Indexed<double> weights)
      : weights_(std::move(weights)), heap_(weights_.size()), place_(weights_.size()) {
    for (Index i = 0; i < indexCount(heap_); ++i)
      put(i, i);
    for (Index i = indexCount(heap_) / 2; i-- > 0;)
      sink(i);
  }

  std::size_t size() const { return heap_.size(); }
  bool has(Index sample) const { return place_[sample] >= 0; }

  Index takeTop() {
    const Index top = heap_.front();
    place_[top] = -1;
    const Index last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) {
      put(0, last);
      sink(0);
    }
    return top;
  }

  void lighten(Index sample, double by) {
    weights_[sample] -= by;
    sink(place_[sample]);
  }

private:
  bool isHeavier(Index a, Index b) const {
    return weights_[a] != weights_[b] ? weights_[a] > weights_[b] : a < b;
  }
  void put(Index place, Index sample) {
    heap_[place] = sample;
    place_[sample] = place;
  }
  void sink(Index place) {
    const Index sample = heap_[place];
    for (Index child = 2 * place + 1; child < indexCount(heap_); child = 2 * place + 1) {
      if (child + 1 < indexCount(heap_) && isHeavier(heap_[child + 1], heap_[child]))
        ++child;
      if (!isHeavier(heap_[child], sample))
        break;
      put(place, heap_[child]);
      place = child;
    }
    put(place, sample);
  }

  Indexed<double> weights_;
  Indexed<Index> heap_;
  Indexed<Index> place_;  ///< in heap_; -1: taken
};

}  // namespace

std::vector<Index> eliminateSamples(const Positions& points, const Positions& normals,
                                    std::size_t count, double area, int threads) {
  const double remaining = static_cast<double>(count);
  // The largest radius of disks of which this number fits on the area, and the least that counts.
  const double most = std::sqrt(area / (2.0 * std::sqrt(3.0) * remaining));
  const double least =
      most * kBeta * (1.0 - std::pow(remaining / static_cast<double>(points.cols()), kGamma));
  const CellGrid grid(points, 2.0 * most);
  const Positions sorted_points = columnsOf(points, grid.order());
  const Positions sorted_normals = columnsOf(normals, grid.order());
  /// Calls visit(j, weight of the pair) for the samples that are near sample i.
  const auto for_each_near = [&](Index i, const auto& visit) {
    const Vector3d point = sorted_points.col(i);
    const Vector3d normal = sorted_normals.col(i);
    grid.forEachCellAround(i, [&](Index begin, Index end) {
      for (Index j = begin; j < end; ++j) {
        const double square = (sorted_points.col(j) - point).squaredNorm();
        if (square >= 4.0 * most * most || j == i || sorted_normals.col(j).dot(normal) < 0.0)
          continue;
        const double fraction = 1.0 - std::max(std::sqrt(square), 2.0 * least) / (2.0 * most);
        const double second = fraction * fraction;
        const double fourth = second * second;
        visit(j, fourth * fourth);
      }
    });
  };

  Indexed<double> weights(columnCount(points));
  forEachIndex(weights.size(), threads, [&](Index i) {
    double sum = 0.0;
    for_each_near(i, [&](Index, double weight) { sum += weight; });
    weights[i] = sum;
  });
  Heap heap(std::move(weights));
  while (heap.size() > count) {
    for_each_near(heap.takeTop(), [&](Index j, double weight) {
      if (heap.has(j))
        heap.lighten(j, weight);
    });
  }
  std::vector<Index> result;
  result.reserve(count);
  for (Index i = 0; i < points.cols(); ++i)
    if (heap.has(i))
      result.push_back(entry(grid.order(), i));
  return result;
}

}  // namespace spherical_param::internal
