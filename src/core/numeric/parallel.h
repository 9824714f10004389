#pragma once

#include "progress.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace spherical_param::internal {

/// Items of a block. Work is distributed and summed by block: the same bits for any number of
/// threads.
inline constexpr std::size_t kBlockSize = 512;
/// Below this number of items several threads cost more than they gain.
inline constexpr std::size_t kParallelThreshold = 2048;

/// Minimum number of items between reports: each parallel region waits for its slowest thread.
inline constexpr std::size_t kReportedItems = 256 * kBlockSize;
/// Approximate maximum of reports of a loop.
inline constexpr std::size_t kMaxReports = 32;

/// Processors that this process may use.
int processorCount();

/// \throw InvalidInput if a number of threads is out of range.
void checkThreads(int requested);

/// Number of threads that are worth their start for a number of items.
///
/// \param requested 0: one for each processor.
/// \param threshold minimum number of items for several threads.
/// \throw InvalidInput if `requested` is out of range.
int threadCount(int requested, std::size_t items, std::size_t threshold = kParallelThreshold);

/// Calls task(i) for each i in [0, count), on several threads. The calling thread does the first.
/// An exception ends the work; tasks already begun are finished. A loop within a task of a loop
/// with several threads has one thread.
void forEachTask(std::size_t count, int threads, const std::function<void(std::size_t)>& task);

/// Number of the calling thread in the innermost loop that it works on, below the number of threads
/// of that loop; 0 in the thread that called it.
std::size_t threadNumber();

/// Calls work(block, begin, end) for the blocks of [0, count), on several threads. A report splits
/// the loop into a few dozen parallel regions, of the same blocks.
///
/// \param items_per_report minimum number of items; lower for slow items.
template <typename Work>
void forEachBlock(std::size_t count, int threads, const FractionReport& report, const Work& work,
                  std::size_t items_per_report = kReportedItems) {
  const std::size_t blocks = count / kMaxReports / kBlockSize + 1;
  const std::size_t most = report ? std::max(items_per_report, blocks * kBlockSize) : count;
  for (std::size_t first = 0; first < count; first += most) {
    const std::size_t size = std::min(most, count - first);
    const auto task = [&](std::size_t block) {
      const std::size_t begin = first + block * kBlockSize;
      work(begin / kBlockSize, begin, std::min(first + size, begin + kBlockSize));
    };
    forEachTask((size + kBlockSize - 1) / kBlockSize, threads, std::cref(task));
    reportFraction(report, static_cast<double>(first + size) / static_cast<double>(count));
  }
}

/// Calls work(memory, i) for each i in [0, count), on several threads. Each block has a memory.
template <typename Memory, typename Work>
void forEachIndex(std::size_t count, int threads, const FractionReport& report, const Work& work) {
  forEachBlock(count, threads, report, [&](std::size_t, std::size_t begin, std::size_t end) {
    Memory memory;
    for (std::size_t i = begin; i < end; ++i)
      work(memory, static_cast<Index>(i));
  });
}

/// Calls work(i) for each i in [0, count), on several threads.
template <typename Work>
void forEachIndex(std::size_t count, int threads, const FractionReport& report, const Work& work) {
  struct None {};
  forEachIndex<None>(count, threads, report, [&](const None&, Index i) { work(i); });
}

/// The sum of what add(i, sum) adds for i in [0, count), block by block, in their order.
template <typename Value, typename Add>
Value accumulate(std::size_t count, int threads, const Value& zero, const Add& add,
                 const FractionReport& report = {}) {
  std::vector<Value> sums((count + kBlockSize - 1) / kBlockSize, zero);
  forEachBlock(count, threads, report, [&](std::size_t block, std::size_t begin, std::size_t end) {
    Value sum = zero;
    for (std::size_t i = begin; i < end; ++i)
      add(static_cast<Index>(i), sum);
    sums[block] = sum;
  });
  Value total = zero;
  for (const Value& sum : sums)
    total += sum;
  return total;
}

/// What collect(begin, end, found) appends to `found` for the blocks of [0, count), in their order.
///
/// \param items_per_report as in forEachBlock().
template <typename T, typename Collect>
std::vector<T> collectBlocks(std::size_t count, int threads, const FractionReport& report,
                             const Collect& collect,
                             std::size_t items_per_report = kReportedItems) {
  std::vector<std::vector<T>> parts((count + kBlockSize - 1) / kBlockSize);
  forEachBlock(
      count, threads, report,
      [&](std::size_t block, std::size_t begin, std::size_t end) {
        collect(static_cast<Index>(begin), static_cast<Index>(end), parts[block]);
      },
      items_per_report);
  std::size_t found = 0;
  for (const std::vector<T>& part : parts)
    found += part.size();
  std::vector<T> all;
  all.reserve(found);
  for (const std::vector<T>& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace spherical_param::internal
