#pragma once

#include "spherical_param_ros/cloud_mesh.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

namespace spherical_param_ros {

/// What a worker does, and its last result.
struct WorkerState {
  bool is_working = false;
  std::size_t waiting = 0;      ///< number of clouds in the queue, and of requests that wait
  std::optional<Outcome> last;  ///< of the last cloud that was done or failed, without its mesh
};

/// Meshes clouds one after the other in a thread of its own.
///
/// Clouds of a stream (submit()) wait in a queue of Settings::queue_depth. A full queue drops its
/// oldest cloud, so that submit() never waits and the newest cloud is never lost. With
/// Settings::cancel_running a newer cloud cancels the work on the current one, but at most
/// Settings::max_cancellations times in a row: a fast stream still gets at least every
/// (max_cancellations + 1)th mesh. The last cloud of a stream is always answered.
///
/// Requests (process()) block the caller until they are answered. They are neither dropped nor
/// cancelled; beyond max_requests they are refused at once. Requests and clouds of the stream take
/// turns, so that neither starves.
class ReconstructionWorker {
public:
  using Cloud = std::shared_ptr<const pcl::PCLPointCloud2>;
  /// Called once for each cloud of the stream, from the worker's thread; for a dropped cloud from
  /// the thread that submits the newer one. Its exceptions are ignored.
  using Handler = std::function<void(const Outcome&)>;
  /// meshCloud(), or a stand-in for tests, which must not throw either.
  using Mesher = std::function<Outcome(const pcl::PCLPointCloud2& cloud, const Settings& settings,
                                       const std::function<bool()>& is_wanted)>;

  static constexpr std::size_t max_requests = 8;

  explicit ReconstructionWorker(const Settings& settings = {}, Mesher mesher = meshCloud);
  /// As stop().
  ~ReconstructionWorker();

  ReconstructionWorker(const ReconstructionWorker&) = delete;
  ReconstructionWorker& operator=(const ReconstructionWorker&) = delete;

  /// Takes a cloud of a stream.
  void submit(const Cloud& cloud, Handler handler);

  /// Meshes a cloud while the caller waits.
  Outcome process(const Cloud& cloud);

  /// Takes effect with the next cloud; a smaller queue at once.
  void setSettings(const Settings& settings);
  Settings settings() const;

  WorkerState state() const;

  /// Cancels the current work and drops waiting clouds. Later clouds are refused. Returns when all
  /// handlers have returned.
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
  /// Takes the oldest clouds beyond the queue's depth out of the queue.
  Jobs shorten();
  bool isWanted(bool is_request);
  static void answer(const Job& job, const Outcome& outcome);
  static void answerAll(const Jobs& jobs, Status status, const char* message);

  const Mesher mesher_;
  mutable std::mutex mutex_;  ///< guards all below but the thread
  std::condition_variable work_or_stop_;
  Settings settings_;
  Jobs stream_;
  Jobs requests_;
  WorkerState state_;
  bool is_newer_there_ = false;  ///< a cloud arrived since the running one began
  int cancellations_in_a_row_ = 0;
  bool is_request_next_ = true;  ///< where both wait
  bool is_stopped_ = false;
  std::thread thread_;
};

}  // namespace spherical_param_ros
