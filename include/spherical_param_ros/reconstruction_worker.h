#pragma once

#include "spherical_param_ros/cloud_mesh.h"
#include "spherical_param_ros/parameters.h"

#include <pcl/PCLPointCloud2.h>

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace spherical_param_ros {

/// What a worker did so far. At any time
///   received = done + failed + cancelled + dropped + queued + (is_working ? 1 : 0),
/// where requests count from when they were let in.
struct Statistics {
  std::uint64_t received = 0;
  std::uint64_t done = 0;
  std::uint64_t failed = 0;
  std::uint64_t cancelled = 0;
  std::uint64_t dropped = 0;
  std::uint64_t refused = 0;  ///< requests that were not let in
  std::size_t queued = 0;
  bool is_working = false;
  /// Of the last cloud that was done or failed, without its mesh; `has_last` false: none was.
  Outcome last;
  bool has_last = false;
};

/// Meshes clouds one after the other in a thread of its own.
///
/// Clouds of a stream (submit()) wait in a queue of Settings::queue_depth, which pushes out its
/// oldest and never grows: submitting never waits, and the newest is never lost. With
/// Settings::cancel_running a newer cloud cancels the one that is worked on, but no more than
/// Settings::max_cancellations times in a row: a stream that is faster than the work still gets
/// every (max_cancellations + 1)th mesh at least. The last cloud of a stream is always answered.
///
/// Requests (process()) wait for their answer, which holds the caller back. They are neither
/// dropped nor cancelled; not more than max_requests wait, others are refused at once. Requests and
/// clouds of the stream take turns, so that neither starves.
class ReconstructionWorker {
public:
  using Cloud = std::shared_ptr<const pcl::PCLPointCloud2>;
  /// Called once for each cloud of the stream, from the worker's thread, or for one that is dropped
  /// from the thread that submits the newer one. What it throws is lost.
  using Handler = std::function<void(const Outcome&)>;
  /// meshCloud(), or what stands for it in a test.
  using Mesher = std::function<Outcome(const pcl::PCLPointCloud2& cloud, const Settings& settings,
                                       const std::function<bool()>& is_wanted)>;

  static constexpr std::size_t max_requests = 8;

  explicit ReconstructionWorker(const Settings& settings = {}, Mesher mesher = meshCloud);
  /// As stop().
  ~ReconstructionWorker();

  ReconstructionWorker(const ReconstructionWorker&) = delete;
  ReconstructionWorker& operator=(const ReconstructionWorker&) = delete;

  /// Takes a cloud of a stream. \return false if another one was dropped for it, or the worker is
  /// stopped: the stream is faster than the work.
  bool submit(const Cloud& cloud, Handler handler);

  /// Meshes a cloud while the caller waits.
  Outcome process(const Cloud& cloud);

  /// In force from the next cloud on; a smaller queue at once.
  void setSettings(const Settings& settings);
  Settings settings() const;

  Statistics statistics() const;

  /// Waits until there is nothing left to do.
  void waitUntilIdle();

  /// Cancels what is worked on and drops what waits. Later clouds are refused. Returns when no
  /// handler runs any more.
  void stop();

private:
  struct Job {
    Cloud cloud;
    Handler handler;
    bool is_request = false;
  };
  using Jobs = std::deque<Job>;

  void run();
  bool takeJob(std::unique_lock<std::mutex>& lock, Job& job);
  /// Moves the oldest clouds beyond the queue's depth into `dropped`.
  void shorten(Jobs& dropped);
  bool isWanted(bool is_request);
  void finish(const Job& job, const Outcome& outcome);
  static void answer(const Job& job, const Outcome& outcome);
  static void answerAll(const Jobs& jobs, Status status, const char* message);

  const Mesher mesher_;
  mutable std::mutex mutex_;  ///< guards all below but the thread
  std::condition_variable work_or_stop_;
  std::condition_variable idle_;
  Settings settings_;
  Jobs stream_;
  Jobs requests_;
  Statistics statistics_;
  bool is_newer_there_ = false;  ///< a cloud arrived since the running one began
  int cancellations_in_a_row_ = 0;
  bool is_request_next_ = true;  ///< where both wait
  bool is_answering_ = false;
  bool is_stopped_ = false;
  std::thread thread_;
};

}  // namespace spherical_param_ros
