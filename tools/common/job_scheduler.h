#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>

namespace spherical_param::tools {

/// What jobs may take together.
struct JobLimits {
  std::size_t jobs = 1;        ///< that run at a time, at least 1
  std::size_t processors = 1;  ///< to be shared by those that run, at least 1
  std::uint64_t memory = 0;    ///< that those that run need together [bytes]
};

/// Decides which of many jobs starts when. The needs of those that run are never more than the
/// memory, but for a job that needs more by itself: it runs alone.
///
/// Jobs start in their order; one that does not fit is passed by those close behind it, but not by
/// more than there are jobs at a time: small jobs must not keep a large one waiting until they are
/// all done.
class JobScheduler {
public:
  struct Start {
    std::size_t job = 0;
    std::size_t threads = 1;
  };
  /// Tells the memory of a job [bytes]. Asked once for each, and not long before it may start.
  using Need = std::function<std::uint64_t(std::size_t)>;

  /// \param jobs their number.
  JobScheduler(const JobLimits& limits, std::size_t jobs, Need need);

  /// The next job that may start now, which then counts as running; none if it has to wait for the
  /// end of another, or if there is none left.
  std::optional<Start> next();
  void finished(std::size_t job);
  /// Takes back what next() told: the job could not be started and is the next again.
  void putBack(std::size_t job);

  std::size_t waiting() const { return waiting_.size() + jobs_ - seen_; }
  std::size_t running() const { return running_; }
  /// What the running jobs need together [bytes].
  std::uint64_t memoryInUse() const { return memory_in_use_; }

private:
  /// A job whose need is known.
  struct Job {
    std::size_t number = 0;
    std::uint64_t need = 0;
  };

  bool fits(const Job& job) const;
  /// Threads are shared by those that could run at a time; a job that takes a larger part of the
  /// memory, and so keeps others waiting, has the same part of the processors.
  std::size_t threadsOf(const Job& job) const;

  JobLimits limits_;
  std::size_t jobs_;
  Need need_;
  std::size_t seen_ = 0;     ///< the first of the jobs that are not in `waiting_` yet
  std::deque<Job> waiting_;  ///< those that are looked at
  std::map<std::size_t, std::uint64_t> needs_;  ///< of the running jobs
  std::size_t passed_first_ = 0;                ///< how often the first that waits was passed
  std::size_t running_ = 0;
  std::uint64_t memory_in_use_ = 0;
};

}  // namespace spherical_param::tools
