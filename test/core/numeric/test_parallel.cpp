#include "parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

namespace spherical_param::internal {
namespace {

using Block = std::array<std::size_t, 3>;  ///< number, begin, end

/// The blocks that the work is called for, by their numbers.
std::vector<Block> blocksOf(std::size_t count, int threads, const FractionReport& report) {
  std::vector<Block> blocks((count + kBlockSize - 1) / kBlockSize);
  forEachBlock(count, threads, report, [&](std::size_t block, std::size_t begin, std::size_t end) {
    blocks[block] = {block, begin, end};
  });
  return blocks;
}

TEST(Parallel, ReportsChangeNoBlock) {
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, kBlockSize, kReportedItems, kReportedItems + 1,
        3 * kReportedItems - 1, 40 * kReportedItems + 7, 100 * kReportedItems})
    for (const int threads : {1, 3}) {
      std::vector<Block> expected;
      for (std::size_t begin = 0; begin < count; begin += kBlockSize)
        expected.push_back({expected.size(), begin, std::min(count, begin + kBlockSize)});
      EXPECT_EQ(blocksOf(count, threads, {}), expected);
      EXPECT_EQ(blocksOf(count, threads, [](double) {}), expected);
    }
}

TEST(Parallel, ReportsAreFewAndRiseToOne) {
  const std::thread::id caller = std::this_thread::get_id();
  for (const std::size_t chunks : {std::size_t{1}, std::size_t{3}, std::size_t{30}, std::size_t{31},
                                   std::size_t{100}, std::size_t{1000}}) {
    std::vector<double> fractions{0.0};
    blocksOf(chunks * kReportedItems, 3, [&](double fraction) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      EXPECT_GT(fraction, fractions.back());
      fractions.push_back(fraction);
    });
    EXPECT_EQ(fractions.back(), 1.0);
    const std::size_t reports = fractions.size() - 1;
    EXPECT_GE(reports, std::min<std::size_t>(chunks, 30));
    EXPECT_LE(reports, std::min<std::size_t>(chunks, kMaxReports));
  }
}

TEST(Parallel, AnExceptionOfAReportEndsTheWork) {
  std::atomic<std::size_t> done{0};
  const auto report = [](double fraction) {
    if (fraction > 0.3)
      throw std::runtime_error("enough");
  };
  EXPECT_THROW(
      forEachItem(5 * kReportedItems, 3, report, [&](std::size_t, std::size_t) { ++done; }),
      std::runtime_error);
  EXPECT_EQ(done, 2 * kReportedItems);
}

TEST(Parallel, ExceptionsOfTheWorkArePassedOn) {
  for (const int threads : {1, 3}) {
    EXPECT_THROW(forEachItem(100 * kBlockSize, threads,
                             [](std::size_t, std::size_t i) {
                               if (i == 7 * kBlockSize || i == 70 * kBlockSize)
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
    forEachItem(3 * kBlockSize, threads, [&](std::size_t, std::size_t) { ++done; });
    EXPECT_EQ(done, 3 * kBlockSize);
  }
}

}  // namespace
}  // namespace spherical_param::internal
