#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace spherical_param::internal {

/// Lets the threads of a parallel region wait for each other, and sleep while they do. OpenMP's own
/// barrier spins: on a machine with other work to do, a thread that waits then keeps the one it
/// waits for from running, which made short iterations many times slower.
class SleepingBarrier {
public:
  explicit SleepingBarrier(int threads) : threads_(threads) {}

  /// Returns when all threads have called it.
  void wait() {
    if (threads_ == 1)
      return;
    const std::uint32_t round = round_.load(std::memory_order_acquire);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (++arrived_ == threads_) {
        arrived_ = 0;
        round_.store(round + 1, std::memory_order_release);
      }
    }
    if (round_.load(std::memory_order_acquire) != round) {
      all_arrived_.notify_all();
      return;
    }
    // The others mostly arrive sooner than a thread can fall asleep and wake up.
    for (int spin = 0; spin < kSpins; ++spin)
      if (round_.load(std::memory_order_acquire) != round)
        return;
    std::unique_lock<std::mutex> lock(mutex_);
    all_arrived_.wait(lock, [&] { return round_.load(std::memory_order_acquire) != round; });
  }

private:
  static constexpr int kSpins = 20000;  ///< some 10 microseconds

  const int threads_;
  int arrived_ = 0;
  std::atomic<std::uint32_t> round_{0};
  std::mutex mutex_;
  std::condition_variable all_arrived_;
};

}  // namespace spherical_param::internal
