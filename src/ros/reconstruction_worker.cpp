#include "spherical_param_ros/reconstruction_worker.h"

#include <algorithm>
#include <future>
#include <utility>

namespace spherical_param_ros {
namespace {

Outcome withoutMesh(Status status, const char* message) {
  Outcome outcome;
  outcome.status = status;
  outcome.message = message;
  return outcome;
}

constexpr const char* kStopping = "the node is shutting down; start it again";

}  // namespace

ReconstructionWorker::ReconstructionWorker(const Settings& settings, Mesher mesher)
    : mesher_(std::move(mesher)), settings_(settings), thread_([this] { run(); }) {}

ReconstructionWorker::~ReconstructionWorker() {
  stop();
}

void ReconstructionWorker::submit(const Cloud& cloud, Handler handler) {
  Job job{cloud, std::move(handler), false};
  Jobs dropped;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_stopped_) {
      dropped.push_back(std::move(job));
    } else {
      stream_.push_back(std::move(job));
      is_newer_there_ = true;
      dropped = shorten();
    }
  }
  work_or_stop_.notify_one();
  answerAll(dropped, Status::Dropped, "a newer cloud took its place; publish more slowly");
}

Outcome ReconstructionWorker::process(const Cloud& cloud) {
  // Shared: the caller may be gone before the worker has left set_value().
  const auto promise = std::make_shared<std::promise<Outcome>>();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_stopped_)
      return withoutMesh(Status::Refused, kStopping);
    if (requests_.size() >= max_requests)
      return withoutMesh(Status::Refused, "too many requests wait; ask again later");
    requests_.push_back(
        {cloud, [promise](const Outcome& outcome) { promise->set_value(outcome); }, true});
  }
  work_or_stop_.notify_one();
  return promise->get_future().get();
}

void ReconstructionWorker::setSettings(const Settings& settings) {
  Jobs dropped;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    settings_ = settings;
    dropped = shorten();
  }
  answerAll(dropped, Status::Dropped, "the queue became shorter; raise queue_depth");
}

Settings ReconstructionWorker::settings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return settings_;
}

WorkerState ReconstructionWorker::state() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  WorkerState state = state_;
  state.waiting = stream_.size() + requests_.size();
  return state;
}

void ReconstructionWorker::stop() {
  Jobs dropped;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_stopped_ = true;
    dropped.swap(stream_);
    dropped.insert(dropped.end(), requests_.begin(), requests_.end());
    requests_.clear();
  }
  work_or_stop_.notify_all();
  answerAll(dropped, Status::Dropped, kStopping);
  if (thread_.joinable())
    thread_.join();
}

void ReconstructionWorker::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  Job job;
  while (takeJob(lock, job)) {
    const Settings settings = settings_;
    const bool is_request = job.is_request;
    lock.unlock();
    Outcome outcome =
        mesher_(*job.cloud, settings, [this, is_request] { return isWanted(is_request); });
    answer(job, outcome);
    // Frees cloud and mesh before the next ones come.
    job = Job();
    outcome.mesh.reset();
    lock.lock();
    state_.is_working = false;
    if (outcome.status == Status::Cancelled) {
      ++cancellations_in_a_row_;
      continue;
    }
    if (!is_request)
      cancellations_in_a_row_ = 0;
    state_.last = outcome;
  }
}

bool ReconstructionWorker::takeJob(std::unique_lock<std::mutex>& lock, Job& job) {
  work_or_stop_.wait(lock,
                     [this] { return is_stopped_ || !stream_.empty() || !requests_.empty(); });
  if (is_stopped_)
    return false;
  const bool take_request = !requests_.empty() && (stream_.empty() || is_request_next_);
  Jobs& jobs = take_request ? requests_ : stream_;
  is_request_next_ = !take_request;
  job = std::move(jobs.front());
  jobs.pop_front();
  if (!take_request)
    is_newer_there_ = false;
  state_.is_working = true;
  return true;
}

ReconstructionWorker::Jobs ReconstructionWorker::shorten() {
  const std::size_t depth = std::max<std::size_t>(settings_.queue_depth, 1);
  Jobs dropped;
  while (stream_.size() > depth) {
    dropped.push_back(std::move(stream_.front()));
    stream_.pop_front();
  }
  return dropped;
}

bool ReconstructionWorker::isWanted(bool is_request) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (is_stopped_)
    return false;
  return is_request || !is_newer_there_ || !settings_.cancel_running ||
         cancellations_in_a_row_ >= settings_.max_cancellations;
}

void ReconstructionWorker::answer(const Job& job, const Outcome& outcome) {
  try {
    if (job.handler)
      job.handler(outcome);
  } catch (...) {  // NOLINT(bugprone-empty-catch): the next cloud must not suffer for it
  }
}

void ReconstructionWorker::answerAll(const Jobs& jobs, Status status, const char* message) {
  for (const Job& job : jobs)
    answer(job, withoutMesh(status, message));
}

}  // namespace spherical_param_ros
