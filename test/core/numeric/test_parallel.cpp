#include "parallel.h"

#include "helpers.h"

#include <gtest/gtest.h>

#ifdef __linux__
#include <sys/resource.h>
#endif

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <new>
#include <stdexcept>

namespace spherical_param::internal {
namespace {

TEST(Parallel, BlocksComeOnceAndReportsAreFewAndRiseToOne) {
  using Block = std::array<std::size_t, 3>;  // number, begin, end
  const std::thread::id caller = std::this_thread::get_id();
  for (const std::size_t chunks : {0U, 1U, 30U, 31U, 1000U})
    for (const int threads : {1, 3}) {
      const std::size_t count = chunks * kReportedItems + chunks % 7;
      std::vector<Block> expected;
      for (std::size_t begin = 0; begin < count; begin += kBlockSize)
        expected.push_back({expected.size(), begin, std::min(count, begin + kBlockSize)});
      std::vector<double> fractions{0.0};
      const auto report = [&](double fraction) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        EXPECT_GT(fraction, fractions.back());
        fractions.push_back(fraction);
      };
      std::vector<Block> blocks(expected.size());
      forEachBlock(count, threads, report,
                   [&](std::size_t block, std::size_t begin, std::size_t end) {
                     blocks[block] = {block, begin, end};
                   });
      EXPECT_EQ(blocks, expected);
      EXPECT_EQ(fractions.back(), count > 0 ? 1.0 : 0.0);
      EXPECT_GE(fractions.size(), 1 + std::min<std::size_t>(chunks, 30));
      EXPECT_LE(fractions.size(), 1 + kMaxReports);
    }
}

TEST(Parallel, ExceptionsOfTheWorkArePassedOn) {
  for (const int threads : {1, 3}) {
    EXPECT_THROW(forEachIndex(100 * kBlockSize, threads, {},
                              [](Index i) {
                                if (i == Index{7 * kBlockSize} || i == Index{70 * kBlockSize})
                                  throw std::bad_alloc();
                              }),
                 std::bad_alloc);
    EXPECT_THROW(forEachTask(7, threads,
                             [](std::size_t i) {
                               if (i >= 2)
                                 throw std::runtime_error("enough");
                             }),
                 std::runtime_error);
    // And the next one works.
    std::atomic<std::size_t> done{0};
    forEachIndex(3 * kBlockSize, threads, {}, [&](Index) { ++done; });
    EXPECT_EQ(done, 3 * kBlockSize);
  }
}

/// Threads that do the tasks of a loop, each of which waits for the others.
std::size_t threadsUsed(std::size_t threads) {
  std::mutex mutex;
  std::condition_variable has_come;
  std::set<std::thread::id> used;
  forEachTask(threads, static_cast<int>(threads), [&](std::size_t) {
    std::unique_lock lock(mutex);
    used.insert(std::this_thread::get_id());
    has_come.notify_all();
    has_come.wait_for(lock, std::chrono::seconds(60), [&] { return used.size() == threads; });
  });
  return used.size();
}

#ifdef __linux__
std::size_t threadsOfProcess() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

TEST(Parallel, ThreadsAreStartedOnceAndEndWithTheirOwner) {
  const std::size_t before = threadsOfProcess();
  std::thread([before] {
    const std::size_t own = before + 1;
    EXPECT_EQ(threadsUsed(1), 1U);
    EXPECT_EQ(threadsOfProcess(), own);
    for (int round = 0; round < 3; ++round) {
      EXPECT_EQ(threadsUsed(3), 3U);
      EXPECT_EQ(threadsOfProcess(), own + 2);
    }
    EXPECT_EQ(threadsUsed(2), 2U);
    EXPECT_EQ(threadsOfProcess(), own + 2);
  }).join();
  EXPECT_EQ(threadsOfProcess(), before);
}
#endif

TEST(Parallel, ALoopInATaskOfAnotherHasOneThread) {
  std::atomic<std::size_t> done{0};
  forEachTask(32, 3, [&](std::size_t) {
    const std::thread::id thread = std::this_thread::get_id();
    const std::size_t number = threadNumber();
    EXPECT_LT(number, 3U);
    forEachIndex(3 * kBlockSize, 2, {}, [&](Index) {
      EXPECT_EQ(threadNumber(), 0U);
      EXPECT_EQ(std::this_thread::get_id(), thread);
      ++done;
    });
    EXPECT_EQ(threadNumber(), number);
  });
  EXPECT_EQ(done, 32 * 3 * kBlockSize);
}

#ifndef _WIN32  // has no fork
TEST(ParallelDeathTest, AForkedProcessStartsThreadsOfItsOwnAndEnds) {
  EXPECT_EQ(threadsUsed(3), 3U);
  // Test programs fork for this; both ends must come.
  EXPECT_EXIT(std::_Exit(threadsUsed(3) == 3 ? 0 : 1), testing::ExitedWithCode(0), "");
#ifndef SPHERICAL_PARAM_SANITIZED  // they look for leaks in a process without its threads
  EXPECT_EXIT(std::exit(0), testing::ExitedWithCode(0), "");
#endif
}
#endif

#if defined(__linux__) && !defined(SPHERICAL_PARAM_SANITIZED)
TEST(ParallelDeathTest, WhereThreadsCannotBeStartedFewerDoTheWork) {
  // A hundred stacks need more address space.
  const auto limited = [] {
    const rlimit limit = {200U << 20U, 200U << 20U};
    setrlimit(RLIMIT_AS, &limit);
    std::atomic<std::size_t> done{0};
    forEachTask(1000, 500, [&](std::size_t) { ++done; });
    return done == 1000 && threadsOfProcess() < 100;
  };
  EXPECT_EXIT(std::_Exit(limited() ? 0 : 1), testing::ExitedWithCode(0), "");
}
#endif

}  // namespace
}  // namespace spherical_param::internal
