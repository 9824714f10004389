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

/// Maximum number of threads: more would exhaust the system.
inline constexpr int kMaxThreads = 1024;
/// Items of a block. Work is distributed and summed by block: the same bits for any number of
/// threads.
inline constexpr std::size_t kBlockSize = 512;
/// Below this many items a parallel region for much work costs more than it gains.
inline constexpr std::size_t kParallelThreshold = 4096;
/// The same for one short pass over the items: on a busy machine a region may wait for a
/// descheduled thread longer than many passes take.
inline constexpr std::size_t kShortPassThreshold = 50000;

/// Minimum number of items between reports: each parallel region waits for its slowest thread.
inline constexpr std::size_t kReportedItems = 256 * kBlockSize;
/// Approximate maximum of reports of a loop.
inline constexpr std::size_t kMaxReports = 32;

/// \throw InvalidInput if a number of threads is out of range.
inline void checkThreads(int requested) {
  if (requested < 0 || requested > kMaxThreads)
    throw InvalidInput("threads = " + std::to_string(requested) +
                       " is out of range; use 0 (all) to " + std::to_string(kMaxThreads));
}

/// Number of threads that pays for a number of items.
///
/// \param requested 0: as many as OpenMP would use.
/// \param threshold minimum number of items for several threads.
/// \throw InvalidInput if `requested` is out of range.
inline int threadCount(int requested, [[maybe_unused]] std::size_t items,
                       [[maybe_unused]] std::size_t threshold) {
  checkThreads(requested);
#ifdef _OPENMP
  if (items >= threshold)
    // OpenMP ends the process if it cannot start a thread; more threads than this gain nothing.
    return std::min({requested > 0 ? requested : omp_get_max_threads(), 4 * omp_get_num_procs(),
                     static_cast<int>(std::min<std::size_t>(items / kBlockSize, kMaxThreads))});
#endif
  return 1;
}

/// Carries an exception, such as std::bad_alloc, out of a parallel region: leaving the region by
/// itself would end the program, even on one thread.
class ExceptionCarrier {
public:
  /// Runs a part of the work, unless another part has thrown.
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

  /// Rethrows the exception of a part. Call it after the region.
  void rethrow() const {
    if (error_)
      std::rethrow_exception(error_);
  }

private:
  std::atomic<bool> has_failed_{false};
  std::exception_ptr error_;
};

/// Calls work(block, begin, end) for the blocks of [0, count), on several threads. An exception
/// ends the work; blocks already begun are finished.
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

/// The same with reports: in a few dozen parallel regions, with the same blocks.
///
/// \param items_per_report minimum; lower for items that take long.
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
/// \param report receives the fraction done, as in forEachBlock().
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

/// Calls work(thread, i) for each i in [0, count), where thread < threads: long tasks. The calling
/// thread is number 0 and runs the first task. An exception ends the work; tasks already begun are
/// finished.
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
