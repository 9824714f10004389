// What happens to clouds that come faster than they can be meshed. Where the order of events
// counts, what stands for the reconstruction ends when the test says so.

#include "ros_clouds.h"
#include "spherical_param_ros/reconstruction_worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace spherical_param_ros {
namespace {

using Cloud = ReconstructionWorker::Cloud;

/// A cloud with a number.
Cloud cloudNumber(int number) {
  auto cloud = std::make_shared<pcl::PCLPointCloud2>();
  cloud->header.seq = static_cast<std::uint32_t>(number);
  return cloud;
}

/// Stands for the reconstruction: holds each cloud until it is let through or cancelled.
class Gate {
public:
  Outcome mesh(const pcl::PCLPointCloud2& cloud, const std::function<bool()>& is_wanted) {
    std::unique_lock<std::mutex> lock(mutex_);
    begun_.push_back(static_cast<int>(cloud.header.seq));
    changed_.notify_all();
    Outcome outcome;
    while (passes_ == 0) {
      lock.unlock();
      const bool wanted = is_wanted();
      lock.lock();
      if (!wanted) {
        outcome.status = Status::Cancelled;
        return outcome;
      }
      changed_.wait_for(lock, std::chrono::milliseconds(1));
    }
    --passes_;
    outcome.status = Status::Done;
    return outcome;
  }

  void letThrough(int count) {
    const std::lock_guard<std::mutex> lock(mutex_);
    passes_ += count;
    changed_.notify_all();
  }

  /// Waits until so many clouds were begun, this one last.
  void waitForBegin(std::size_t count, int number) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return begun_.size() >= count && begun_.back() == number; });
  }

  std::vector<int> begun() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return begun_;
  }

private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int passes_ = 0;
  std::vector<int> begun_;
};

/// Notes what becomes of each cloud.
class Notes {
public:
  ReconstructionWorker::Handler of(int number) {
    return [this, number](const Outcome& outcome) {
      const std::lock_guard<std::mutex> lock(mutex_);
      (outcome.status == Status::Done ? done_ : others_).push_back(number);
    };
  }
  std::vector<int> done() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return done_;
  }
  std::vector<int> others() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return others_;
  }

private:
  std::mutex mutex_;
  std::vector<int> done_;
  std::vector<int> others_;
};

ReconstructionWorker::Mesher through(Gate& gate) {
  return [&gate](const pcl::PCLPointCloud2& cloud, const Settings&,
                 const std::function<bool()>& is_wanted) { return gate.mesh(cloud, is_wanted); };
}

void expectAllAccountedFor(const Statistics& s) {
  EXPECT_EQ(s.received,
            s.done + s.failed + s.cancelled + s.dropped + s.queued + (s.is_working ? 1U : 0U));
}

TEST(ConcurrencyReconstructionWorker, DropsTheOldestAndNeverGrows) {
  Settings settings;
  settings.queue_depth = 3;
  settings.cancel_running = false;
  Gate gate;
  Notes notes;
  ReconstructionWorker worker(settings, through(gate));
  worker.submit(cloudNumber(0), notes.of(0));
  gate.waitForBegin(1, 0);
  for (int i = 1; i <= 100; ++i) {
    EXPECT_EQ(worker.submit(cloudNumber(i), notes.of(i)), i <= 3);
    EXPECT_LE(worker.statistics().queued, 3U);
    expectAllAccountedFor(worker.statistics());
  }
  gate.letThrough(4);
  worker.waitUntilIdle();
  EXPECT_EQ(notes.done(), (std::vector<int>{0, 98, 99, 100}));
  EXPECT_EQ(notes.others().size(), 97U);
  const Statistics statistics = worker.statistics();
  EXPECT_EQ(statistics.received, 101U);
  EXPECT_EQ(statistics.done, 4U);
  EXPECT_EQ(statistics.dropped, 97U);
  EXPECT_FALSE(statistics.is_working);
}

TEST(ConcurrencyReconstructionWorker, NewerCloudCancelsTheRunningOne) {
  Gate gate;
  Notes notes;
  ReconstructionWorker worker({}, through(gate));
  worker.submit(cloudNumber(0), notes.of(0));
  gate.waitForBegin(1, 0);
  worker.submit(cloudNumber(1), notes.of(1));
  gate.waitForBegin(2, 1);
  EXPECT_EQ(notes.others(), std::vector<int>{0});
  gate.letThrough(1);
  worker.waitUntilIdle();
  EXPECT_EQ(notes.done(), std::vector<int>{1});
  EXPECT_EQ(worker.statistics().cancelled, 1U);
}

TEST(ConcurrencyReconstructionWorker, StreamThatIsFasterThanTheWorkStillGetsMeshes) {
  Settings settings;
  settings.max_cancellations = 2;
  Gate gate;
  Notes notes;
  ReconstructionWorker worker(settings, through(gate));
  // Each cloud arrives while the one before it is worked on.
  worker.submit(cloudNumber(0), notes.of(0));
  for (int i = 0; i < 9; ++i) {
    gate.waitForBegin(static_cast<std::size_t>(i + 1), i);
    worker.submit(cloudNumber(i + 1), notes.of(i + 1));
    if (i % 3 == 2)
      gate.letThrough(1);
  }
  gate.waitForBegin(10, 9);
  gate.letThrough(1);
  worker.waitUntilIdle();
  EXPECT_EQ(notes.done(), (std::vector<int>{2, 5, 8, 9}));
  EXPECT_EQ(worker.statistics().cancelled, 6U);
}

TEST(ConcurrencyReconstructionWorker, RunningOneIsLeftAloneIfSoWanted) {
  Settings settings;
  settings.cancel_running = false;
  Gate gate;
  Notes notes;
  ReconstructionWorker worker(settings, through(gate));
  worker.submit(cloudNumber(0), notes.of(0));
  gate.waitForBegin(1, 0);
  worker.submit(cloudNumber(1), notes.of(1));
  gate.letThrough(2);
  worker.waitUntilIdle();
  EXPECT_EQ(notes.done(), (std::vector<int>{0, 1}));
  EXPECT_EQ(worker.statistics().cancelled, 0U);
}

TEST(ConcurrencyReconstructionWorker, RequestsAreNeitherDroppedNorCancelled) {
  Gate gate;
  Notes notes;
  ReconstructionWorker worker({}, through(gate));
  Outcome answer;
  std::thread caller([&] { answer = worker.process(cloudNumber(7)); });
  gate.waitForBegin(1, 7);
  for (int i = 10; i < 20; ++i)
    worker.submit(cloudNumber(i), notes.of(i));
  gate.letThrough(2);
  caller.join();
  worker.waitUntilIdle();
  EXPECT_EQ(answer.status, Status::Done);
  EXPECT_EQ(notes.done(), std::vector<int>{19});
  EXPECT_EQ(worker.statistics().dropped, 9U);
}

TEST(ConcurrencyReconstructionWorker, RequestsAndStreamTakeTurns) {
  Settings settings;
  settings.queue_depth = 2;
  settings.cancel_running = false;
  Gate gate;
  Notes notes;
  ReconstructionWorker worker(settings, through(gate));
  worker.submit(cloudNumber(0), notes.of(0));
  gate.waitForBegin(1, 0);
  worker.submit(cloudNumber(1), notes.of(1));
  worker.submit(cloudNumber(2), notes.of(2));
  std::vector<std::thread> callers;
  for (int i = 0; i < 2; ++i)
    callers.emplace_back([&worker] { worker.process(cloudNumber(50)); });
  while (worker.statistics().queued < 4)
    std::this_thread::yield();
  gate.letThrough(5);
  for (std::thread& caller : callers)
    caller.join();
  worker.waitUntilIdle();
  EXPECT_EQ(gate.begun(), (std::vector<int>{0, 50, 1, 50, 2}));
}

TEST(ConcurrencyReconstructionWorker, TooManyRequestsAreRefusedAtOnce) {
  Gate gate;
  ReconstructionWorker worker({}, through(gate));
  std::vector<std::thread> callers;
  callers.emplace_back([&worker] { worker.process(cloudNumber(0)); });
  gate.waitForBegin(1, 0);
  for (std::size_t i = 0; i < ReconstructionWorker::max_requests; ++i)
    callers.emplace_back([&worker] { worker.process(cloudNumber(1)); });
  while (worker.statistics().queued < ReconstructionWorker::max_requests)
    std::this_thread::yield();
  const Outcome refused = worker.process(cloudNumber(2));
  EXPECT_EQ(refused.status, Status::Refused);
  EXPECT_NE(refused.message.find("; "), std::string::npos);
  gate.letThrough(1 + static_cast<int>(ReconstructionWorker::max_requests));
  for (std::thread& caller : callers)
    caller.join();
  EXPECT_EQ(worker.statistics().refused, 1U);
  EXPECT_EQ(worker.statistics().done, 1 + ReconstructionWorker::max_requests);
}

TEST(ConcurrencyReconstructionWorker, StopAnswersAllThatWait) {
  Settings settings;
  settings.queue_depth = 5;
  settings.cancel_running = false;
  Gate gate;
  Notes notes;
  ReconstructionWorker worker(settings, through(gate));
  for (int i = 0; i < 4; ++i)
    worker.submit(cloudNumber(i), notes.of(i));
  Outcome answer;
  std::thread caller([&] { answer = worker.process(cloudNumber(9)); });
  while (worker.statistics().queued + (worker.statistics().is_working ? 1 : 0) < 5)
    std::this_thread::yield();
  worker.stop();
  caller.join();
  EXPECT_NE(answer.status, Status::Done);
  EXPECT_EQ(notes.others().size(), 4U);
  EXPECT_EQ(worker.process(cloudNumber(1)).status, Status::Refused);
  EXPECT_FALSE(worker.submit(cloudNumber(1), notes.of(1)));
  expectAllAccountedFor(worker.statistics());
}

TEST(ConcurrencyReconstructionWorker, StopEndsTheWaitForIdleness) {
  // Where stop() comes before the worker has taken the cloud that is waited for.
  for (int i = 0; i < 500; ++i) {
    Gate gate;
    Notes notes;
    ReconstructionWorker worker({}, through(gate));
    std::atomic<bool> is_submitted{false};
    std::thread waiter([&] {
      while (!is_submitted)
        std::this_thread::yield();
      worker.waitUntilIdle();
    });
    worker.submit(cloudNumber(i), notes.of(i));
    is_submitted = true;
    std::this_thread::yield();
    worker.stop();
    waiter.join();
    EXPECT_EQ(notes.others(), std::vector<int>{i});
  }
}

TEST(ConcurrencyReconstructionWorker, SurvivesWhateverIsThrown) {
  ReconstructionWorker worker(
      {}, [](const pcl::PCLPointCloud2&, const Settings&, const std::function<bool()>&) -> Outcome {
        throw std::runtime_error("no luck");
      });
  worker.submit(cloudNumber(0), [](const Outcome&) { throw 1; });
  worker.waitUntilIdle();
  EXPECT_EQ(worker.process(cloudNumber(1)).message, "no luck");
  EXPECT_EQ(worker.statistics().failed, 2U);
}

TEST(ConcurrencyReconstructionWorker, SettingsHoldFromTheNextCloudOn) {
  ReconstructionWorker worker(
      {}, [](const pcl::PCLPointCloud2&, const Settings& settings, const std::function<bool()>&) {
        Outcome outcome;
        outcome.status = Status::Done;
        outcome.message = std::to_string(settings.options.embedding.starts);
        return outcome;
      });
  Settings settings;
  settings.options.embedding.starts = 7;
  EXPECT_EQ(worker.process(cloudNumber(0)).message, "2");
  worker.setSettings(settings);
  EXPECT_EQ(worker.process(cloudNumber(0)).message, "7");
  EXPECT_EQ(worker.settings().options.embedding.starts, 7);
}

// All together, with the real reconstruction: a stream from two threads, requests from two more.
TEST(ConcurrencyReconstructionWorker, EverythingIsAccountedForUnderLoad) {
  Settings settings;
  settings.options.threads = 1;
  settings.queue_depth = 2;
  ReconstructionWorker worker(settings);
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < 2; ++t) {
    threads.emplace_back([&worker, t] {
      for (std::uint32_t i = 0; i < 20; ++i)
        worker.submit(std::make_shared<pcl::PCLPointCloud2>(test::ellipsoid(4 + 30 * i + t)), {});
    });
    threads.emplace_back([&worker, t] {
      for (std::uint32_t i = 0; i < 5; ++i) {
        const Outcome outcome = worker.process(
            std::make_shared<pcl::PCLPointCloud2>(test::ellipsoid(i == 2 ? 3 : 50 + t)));
        EXPECT_EQ(outcome.status, i == 2 ? Status::Failed : Status::Done) << outcome.message;
      }
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  worker.waitUntilIdle();
  const Statistics statistics = worker.statistics();
  EXPECT_EQ(statistics.received, 50U);
  EXPECT_EQ(statistics.queued, 0U);
  EXPECT_EQ(statistics.failed, 2U);
  EXPECT_GE(statistics.done, 9U);
  EXPECT_TRUE(statistics.has_last);
  expectAllAccountedFor(statistics);
}

TEST(ConcurrencyReconstructionWorker, RealReconstructionIsCancelled) {
  Settings settings;
  settings.options.threads = 1;
  settings.options.embedding.method = spherical_param::EmbeddingMethod::Iterative;
  settings.options.embedding.max_iterations = 1000000000;
  settings.options.embedding.stagnation_window = 0;
  settings.options.embedding.tolerance = 0.0;
  ReconstructionWorker worker(settings);
  // Would take weeks.
  worker.submit(std::make_shared<pcl::PCLPointCloud2>(test::ellipsoid(1000)), {});
  while (!worker.statistics().is_working)
    std::this_thread::yield();
  worker.setSettings({});
  Notes notes;
  worker.submit(std::make_shared<pcl::PCLPointCloud2>(test::ellipsoid(100)), notes.of(1));
  worker.waitUntilIdle();
  EXPECT_EQ(notes.done(), std::vector<int>{1});
  EXPECT_EQ(worker.statistics().cancelled, 1U);
}

}  // namespace
}  // namespace spherical_param_ros
