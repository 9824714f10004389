#pragma once

#include "progress.h"
#include "spherical_param/errors.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <string>
#include <vector>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace spherical_param::internal {

/// More would exhaust the system before they could work.
inline constexpr int kMaxThreads = 1024;
/// Items of a block. Work is handed out, and sums are formed, block by block: the same bits for any
/// number of threads.
inline constexpr std::size_t kBlockSize = 512;
/// Below this many items a parallel region for much work costs more than it gains.
inline constexpr std::size_t kParallelThreshold = 4096;
/// The same for one short pass over the items: on a busy machine a region may have to wait for a
/// thread that does not run, which takes as long as many such passes.
inline constexpr std::size_t kShortPassThreshold = 50000;

/// Least number of items between reports: regions that follow each other wait for their slowest
/// thread once more each.
inline constexpr std::size_t kReportedItems = 256 * kBlockSize;
/// Approximate maximum of reports of a loop.
inline constexpr std::size_t kMaxReports = 32;

/// \throw InvalidInput if a number of threads is out of range.
inline void checkThreads(int requested) {
  if (requested < 0 || requested > kMaxThreads)
    throw InvalidInput("threads = " + std::to_string(requested) +
                       " is out of range; use 0 (all) to " + std::to_string(kMaxThreads));
}

/// The threads that are worth having for this number of items.
///
/// \param requested 0: as many as OpenMP would use.
/// \param threshold the least number of items for several threads.
/// \throw InvalidInput if `requested` is out of range.
inline int threadCount(int requested, [[maybe_unused]] std::size_t items,
                       [[maybe_unused]] std::size_t threshold) {
  checkThreads(requested);
#ifdef _OPENMP
  if (items >= threshold)
    // OpenMP ends the process if it cannot start a thread; more than this gain nothing anyway.
    return std::min({requested > 0 ? requested : omp_get_max_threads(), 4 * omp_get_num_procs(),
                     static_cast<int>(std::min<std::size_t>(items / kBlockSize, kMaxThreads))});
#endif
  return 1;
}

/// Carries an exception, such as that there is no memory, out of a parallel region: one that left
/// it by itself would end the program, even where there is but one thread.
class ExceptionCarrier {
public:
  /// Does a part of the work, unless another part has thrown.
  template <typename Work>
  void run(const Work& work) {
    if (has_failed_.load(std::memory_order_relaxed))
      return;
    try {
      work();
    } catch (...) {
      if (!has_failed_.exchange(true))
        error_ = std::current_exception();
    }
  }

  /// Throws what one of the parts has thrown. To be called after the region.
  void rethrow() const {
    if (error_)
      std::rethrow_exception(error_);
  }

private:
  std::atomic<bool> has_failed_{false};
  std::exception_ptr error_;
};

/// Calls work(block, begin, end) for the blocks of [0, count), on several threads. What one of them
/// throws ends the work; blocks that others have begun are done.
template <typename Work>
void forEachBlock(std::size_t count, [[maybe_unused]] int threads, const Work& work) {
  const auto blocks = static_cast<std::ptrdiff_t>((count + kBlockSize - 1) / kBlockSize);
  ExceptionCarrier carrier;
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1) if (threads > 1)
#endif
  for (std::ptrdiff_t b = 0; b < blocks; ++b) {
    const auto block = static_cast<std::size_t>(b);
    carrier.run(
        [&] { work(block, block * kBlockSize, std::min(count, (block + 1) * kBlockSize)); });
  }
  carrier.rethrow();
}

/// The same in a few dozen parallel regions, if there is a report to make
/// after each: the blocks and their numbers are those of one region.
///
/// \param items_per_report at least: fewer where an item takes long.
template <typename Work>
void forEachBlock(std::size_t count, int threads, const FractionReport& report, const Work& work,
                  std::size_t items_per_report = kReportedItems) {
  const std::size_t blocks = count / kMaxReports / kBlockSize + 1;
  const std::size_t most = report ? std::max(items_per_report, blocks * kBlockSize) : count;
  for (std::size_t first = 0; first < count; first += most) {
    const std::size_t size = std::min(most, count - first);
    forEachBlock(size, threads, [&](std::size_t block, std::size_t begin, std::size_t end) {
      work(first / kBlockSize + block, first + begin, first + end);
    });
    reportFraction(report, static_cast<double>(first + size) / static_cast<double>(count));
  }
}

/// Calls work(thread, i) for each i in [0, count), where thread < threads.
///
/// \param report called with the fraction that is done, as by forEachBlock().
template <typename Work>
void forEachItem(std::size_t count, int threads, const FractionReport& report, const Work& work) {
  forEachBlock(count, threads, report, [&](std::size_t, std::size_t begin, std::size_t end) {
#ifdef _OPENMP
    const auto thread = static_cast<std::size_t>(omp_get_thread_num());
#else
    const std::size_t thread = 0;
#endif
    for (std::size_t i = begin; i < end; ++i)
      work(thread, i);
  });
}

template <typename Work>
void forEachItem(std::size_t count, int threads, const Work& work) {
  forEachItem(count, threads, {}, work);
}

/// Calls work(thread, i) for each i in [0, count), where thread < threads, each a long task of its
/// own. The calling thread is number 0 and has the first task. What one throws ends the work; tasks
/// that others have begun are done.
template <typename Work>
void forEachTask(std::size_t count, [[maybe_unused]] int threads, const Work& work) {
  ExceptionCarrier carrier;
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static, 1) if (threads > 1)
#endif
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(count); ++i) {
#ifdef _OPENMP
    const auto thread = static_cast<std::size_t>(omp_get_thread_num());
#else
    const std::size_t thread = 0;
#endif
    carrier.run([&] { work(thread, static_cast<std::size_t>(i)); });
  }
  carrier.rethrow();
}

/// The sum of term(begin, end) over the blocks of [0, count), in their order.
template <typename Value, typename Term>
Value sumOfBlocks(std::size_t count, int threads, const Value& zero, const Term& term,
                  const FractionReport& report = {}) {
  std::vector<Value> sums((count + kBlockSize - 1) / kBlockSize, zero);
  forEachBlock(count, threads, report, [&](std::size_t block, std::size_t begin, std::size_t end) {
    sums[block] = term(begin, end);
  });
  Value total = zero;
  for (const Value& sum : sums)
    total += sum;
  return total;
}

}  // namespace spherical_param::internal
