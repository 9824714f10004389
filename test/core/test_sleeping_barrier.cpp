#include "core/sleeping_barrier.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace spherical_param::internal {
namespace {

// Each thread writes its own counter and, behind the barrier, reads all others: with a barrier that
// let one pass too early the counters would differ.
TEST(SleepingBarrier, ConcurrentThreadsSeeEachOthersWorkOfEveryRound) {
  constexpr int team = 4;
  constexpr int rounds = 2000;
  SleepingBarrier barrier(team);
  std::vector<int> counters(team, 0);
  std::vector<int> wrong(team, 0);
  std::vector<std::thread> threads;
  for (std::size_t self = 0; self < team; ++self)
    threads.emplace_back([&, self] {
      for (int round = 1; round <= rounds; ++round) {
        counters[self] = round;
        barrier.wait();
        for (const int counter : counters)
          wrong[self] += counter == round ? 0 : 1;
        barrier.wait();
      }
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(wrong, std::vector<int>(team, 0));
}

TEST(SleepingBarrier, OneThreadDoesNotWait) {
  SleepingBarrier barrier(1);
  barrier.wait();
  barrier.wait();
}

}  // namespace
}  // namespace spherical_param::internal
