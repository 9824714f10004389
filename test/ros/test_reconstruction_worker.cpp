// Clouds that come faster than they can be meshed. Where the order of events matters, a stand-in
// for the reconstruction ends when the test lets it.

#include "ros_clouds.h"
#include "spherical_param_ros/reconstruction_worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <stdexcept>

namespace spherical_param_ros {
namespace {

using Cloud = ReconstructionWorker::Cloud;
using Numbers = std::vector<int>;

Cloud cloudNumber(int number) {
  auto cloud = std::make_shared<pcl::PCLPointCloud2>();
  cloud->header.seq = static_cast<std::uint32_t>(number);
  return cloud;
}

Cloud ellipsoid(std::uint32_t points) {
  return std::make_shared<pcl::PCLPointCloud2>(test::ellipsoid(points));
}

/// A stand-in for the reconstruction that holds each cloud until it is let through or cancelled. It
/// records which clouds were begun and how they ended.
class Gate {
public:
  ReconstructionWorker::Mesher mesher() {
    return [this](const pcl::PCLPointCloud2& cloud, const Settings&,
                  const std::function<bool()>& is_wanted) { return mesh(cloud, is_wanted); };
  }

  /// Submits a cloud with this number. The exceptions of its handler must not end the worker.
  void submit(ReconstructionWorker& worker, int number) {
    worker.submit(cloudNumber(number), [this, number](const Outcome& outcome) {
      const std::lock_guard<std::mutex> lock(mutex_);
      (outcome.status == Status::Done ? done_ : others_).push_back(number);
      throw std::runtime_error("nobody is there");
    });
  }

  void letThrough(int count) {
    const std::lock_guard<std::mutex> lock(mutex_);
    passes_ += count;
    changed_.notify_all();
  }

  /// Waits until `count` clouds were begun, cloud `number` last.
  void waitForBegin(std::size_t count, int number) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return begun_.size() >= count && begun_.back() == number; });
  }

  Numbers begun() const { return copyOf(begun_); }
  Numbers done() const { return copyOf(done_); }
  Numbers others() const { return copyOf(others_); }

private:
  Outcome mesh(const pcl::PCLPointCloud2& cloud, const std::function<bool()>& is_wanted) {
    std::unique_lock<std::mutex> lock(mutex_);
    begun_.push_back(static_cast<int>(cloud.header.seq));
    changed_.notify_all();
    Outcome outcome;
    outcome.status = Status::Cancelled;
    while (passes_ == 0) {
      lock.unlock();
      const bool wanted = is_wanted();
      lock.lock();
      if (!wanted)
        return outcome;
      changed_.wait_for(lock, std::chrono::milliseconds(1));
    }
    --passes_;
    outcome.status = Status::Done;
    return outcome;
  }

  Numbers copyOf(const Numbers& numbers) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return numbers;
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int passes_ = 0;
  Numbers begun_;
  Numbers done_;
  Numbers others_;
};

/// Calls from a thread of its own.
std::future<Outcome> call(ReconstructionWorker& worker, int number) {
  return std::async(std::launch::async,
                    [&worker, number] { return worker.process(cloudNumber(number)); });
}

void waitForQueued(const ReconstructionWorker& worker, std::size_t count) {
  while (worker.state().waiting < count)
    std::this_thread::yield();
}

void waitUntilIdle(const ReconstructionWorker& worker) {
  for (WorkerState s = worker.state(); s.is_working || s.waiting > 0; s = worker.state())
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

Settings queueOf(std::size_t depth) {
  Settings settings;
  settings.queue_depth = depth;
  settings.cancel_running = false;
  return settings;
}

TEST(ConcurrencyReconstructionWorker, DropsTheOldestAndNeverGrows) {
  Gate gate;
  ReconstructionWorker worker(queueOf(3), gate.mesher());
  gate.submit(worker, 0);
  gate.waitForBegin(1, 0);
  for (int i = 1; i <= 100; ++i) {
    gate.submit(worker, i);
    EXPECT_LE(worker.state().waiting, 3U);
  }
  // A smaller queue holds at once.
  worker.setSettings(queueOf(2));
  EXPECT_EQ(worker.state().waiting, 2U);
  gate.letThrough(3);
  waitUntilIdle(worker);
  EXPECT_EQ(gate.done(), (Numbers{0, 99, 100}));
  EXPECT_EQ(gate.others().size(), 98U);
}

TEST(ConcurrencyReconstructionWorker, NewerCloudCancelsTheRunningOneButNotForEver) {
  Settings settings;
  settings.max_cancellations = 2;
  Gate gate;
  ReconstructionWorker worker(settings, gate.mesher());
  // Each cloud arrives while the one before it is worked on.
  gate.submit(worker, 0);
  for (int i = 0; i < 9; ++i) {
    gate.waitForBegin(static_cast<std::size_t>(i + 1), i);
    gate.submit(worker, i + 1);
    if (i % 3 == 2)
      gate.letThrough(1);
  }
  gate.waitForBegin(10, 9);
  EXPECT_EQ(gate.others(), (Numbers{0, 1, 3, 4, 6, 7}));
  gate.letThrough(1);
  waitUntilIdle(worker);
  EXPECT_EQ(gate.done(), (Numbers{2, 5, 8, 9}));
}

TEST(ConcurrencyReconstructionWorker, RequestsTakeTurnsAndAreNeitherDroppedNorCancelled) {
  Settings settings = queueOf(2);
  settings.cancel_running = true;
  Gate gate;
  ReconstructionWorker worker(settings, gate.mesher());
  std::vector<std::future<Outcome>> requests;
  requests.push_back(call(worker, 50));
  gate.waitForBegin(1, 50);
  for (int i = 1; i <= 11; ++i)
    gate.submit(worker, i);
  for (int i = 0; i < 2; ++i)
    requests.push_back(call(worker, 50));
  waitForQueued(worker, 4);
  gate.letThrough(5);
  for (std::future<Outcome>& request : requests)
    EXPECT_EQ(request.get().status, Status::Done);
  waitUntilIdle(worker);
  EXPECT_EQ(gate.begun(), (Numbers{50, 10, 50, 11, 50}));
  EXPECT_EQ(gate.done(), (Numbers{10, 11}));
  EXPECT_EQ(gate.others().size(), 9U);
}

TEST(ConcurrencyReconstructionWorker, TooManyRequestsAreRefusedAtOnce) {
  constexpr std::size_t most = ReconstructionWorker::max_requests;
  Gate gate;
  ReconstructionWorker worker({}, gate.mesher());
  std::vector<std::future<Outcome>> requests;
  requests.push_back(call(worker, 0));
  gate.waitForBegin(1, 0);
  for (std::size_t i = 0; i < most; ++i)
    requests.push_back(call(worker, 1));
  waitForQueued(worker, most);
  const Outcome refused = worker.process(cloudNumber(2));
  EXPECT_EQ(refused.status, Status::Refused);
  EXPECT_EQ(refused.message, "too many requests wait; ask again later");
  gate.letThrough(1 + static_cast<int>(most));
  for (std::future<Outcome>& request : requests)
    EXPECT_EQ(request.get().status, Status::Done);
}

TEST(ConcurrencyReconstructionWorker, StopAnswersAllThatWait) {
  Gate gate;
  ReconstructionWorker worker(queueOf(5), gate.mesher());
  for (int i = 0; i < 4; ++i)
    gate.submit(worker, i);
  gate.waitForBegin(1, 0);
  std::future<Outcome> answer = call(worker, 9);
  waitForQueued(worker, 4);
  worker.stop();
  EXPECT_EQ(answer.get().status, Status::Dropped);
  EXPECT_EQ(gate.others().size(), 4U);
  EXPECT_EQ(worker.process(cloudNumber(1)).status, Status::Refused);
  gate.submit(worker, 1);
  EXPECT_EQ(gate.others().size(), 5U);
}

// All together, with the real reconstruction: a stream from two threads, requests from two more.
TEST(ConcurrencyReconstructionWorker, EachCloudIsAnsweredOnceUnderLoad) {
  Settings settings;
  settings.options.threads = 1;
  settings.queue_depth = 2;
  ReconstructionWorker worker(settings);
  std::atomic<int> answers = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 2; ++t) {
    threads.emplace_back([&] {
      for (std::uint32_t i = 0; i < 20; ++i)
        worker.submit(ellipsoid(4 + 30 * i), [&answers](const Outcome&) { ++answers; });
    });
    threads.emplace_back([&worker] {
      for (int i = 0; i < 5; ++i)
        EXPECT_EQ(worker.process(ellipsoid(i == 2 ? 3 : 50)).status,
                  i == 2 ? Status::Failed : Status::Done);
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  waitUntilIdle(worker);
  EXPECT_EQ(answers, 40);
  EXPECT_EQ(worker.state().last.value().status, Status::Done);
  EXPECT_EQ(worker.state().last.value().mesh, nullptr);
}

}  // namespace
}  // namespace spherical_param_ros
