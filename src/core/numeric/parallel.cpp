#include "parallel.h"

#include "spherical_param/errors.h"

#ifdef __linux__
#include <sched.h>
#endif
#ifndef _WIN32
#include <unistd.h>
#endif

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Maximum number of threads: more would exhaust the system.
constexpr int kMaxThreads = 1024;

thread_local std::size_t thread_number = 0;
thread_local bool does_task_of_team = false;

/// The number by which a forked process differs from its parent.
int processNumber() {
#ifdef _WIN32
  return 0;  // there is no fork
#else
  return getpid();
#endif
}

/// Sets the number of this thread for as long as it works on a loop.
class NumberInLoop {
public:
  explicit NumberInLoop(std::size_t number) : outer_(thread_number) { thread_number = number; }
  ~NumberInLoop() { thread_number = outer_; }
  NumberInLoop(const NumberInLoop&) = delete;
  NumberInLoop& operator=(const NumberInLoop&) = delete;

private:
  std::size_t outer_;
};

/// Threads that sleep until the thread that owns them has a loop. The owner works, too. It waits
/// for tasks that have begun, but not for threads to wake up: on a busy machine that can take
/// longer than the loop.
class Team {
public:
  Team() = default;
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  ~Team() {
    end();
    for (std::thread& thread : threads_)
      thread.join();
  }

  /// Ends the threads without waiting for them. The memory that they use stays allocated.
  void abandon() {
    end();
    for (std::thread& thread : threads_)
      thread.detach();
  }

  /// Whether this process started the threads. A forked one has their memory alone.
  bool isOfThisProcess() const { return process_ == processNumber(); }

  /// Does all tasks, with up to `helpers` threads beside the calling one.
  void run(std::size_t count, std::size_t helpers, const std::function<void(std::size_t)>& task) {
    try {
      while (threads_.size() < std::min(helpers, most_))
        threads_.emplace_back([this, number = threads_.size() + 1] { help(number); });
    } catch (const std::exception&) {  // no thread, or no memory for one
      most_ = threads_.size();
    }
    std::unique_lock lock(mutex_);
    count_ = count;
    task_ = &task;
    next_ = 1;  // the first is the caller's
    helpers_ = helpers;
    ++loop_;
    lock.unlock();
    has_changed_.notify_all();
    work(0);
    lock.lock();
    helpers_ = 0;
    is_idle_.wait(lock, [this] { return working_ == 0; });
    if (error_)
      std::rethrow_exception(std::exchange(error_, nullptr));
  }

private:
  void end() {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
    }
    has_changed_.notify_all();
  }

  /// Does tasks until there are no more.
  void work(std::size_t number) noexcept {
    const NumberInLoop number_in_loop(number);
    does_task_of_team = true;
    try {
      for (std::size_t i = number == 0 ? 0 : next_++; i < count_; i = next_++)
        (*task_)(i);
    } catch (...) {
      next_ = count_;
      const std::lock_guard lock(mutex_);
      if (!error_)
        error_ = std::current_exception();
    }
    does_task_of_team = false;
  }

  void help(std::size_t number) {
    std::unique_lock lock(mutex_);
    for (std::uint64_t last_loop = 0;;) {
      has_changed_.wait(lock,
                        [&] { return is_ending_ || (number <= helpers_ && loop_ != last_loop); });
      if (is_ending_)
        return;
      last_loop = loop_;
      ++working_;
      lock.unlock();
      work(number);
      lock.lock();
      if (--working_ == 0)
        is_idle_.notify_one();
    }
  }

  const int process_ = processNumber();
  std::size_t most_ = kMaxThreads;  ///< threads that the system grants
  std::vector<std::thread> threads_;
  std::atomic<std::size_t> next_{0};  ///< task to begin
  std::mutex mutex_;                  ///< guards what follows
  std::condition_variable has_changed_;
  std::condition_variable is_idle_;
  std::size_t count_ = 0;  ///< like the task, the same as long as threads work
  const std::function<void(std::size_t)>* task_ = nullptr;
  std::exception_ptr error_;
  std::uint64_t loop_ = 0;
  std::size_t helpers_ = 0;  ///< that may join the loop
  std::size_t working_ = 0;  ///< helpers that have joined it
  bool is_ending_ = false;
};

/// Does not destroy the team of a parent process: that would wait for threads that do not exist.
struct EndTeam {
  void operator()(Team* team) const {
#ifdef _WIN32
    team->abandon();  // no thread can end while another one destroys its thread_local objects
#else
    if (team->isOfThisProcess())
      std::default_delete<Team>()(team);
#endif
  }
};

/// The team of this thread, which ends with it.
thread_local std::unique_ptr<Team, EndTeam> own_team;

}  // namespace

int processorCount() {
#ifdef __linux__
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0)
    return CPU_COUNT(&allowed);
#endif
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void checkThreads(int requested) {
  if (requested < 0 || requested > kMaxThreads)
    throw InvalidInput("threads = " + std::to_string(requested) +
                       " is out of range; use 0 (all) to " + std::to_string(kMaxThreads));
}

int threadCount(int requested, std::size_t items, std::size_t threshold) {
  checkThreads(requested);
  if (items < threshold)
    return 1;
  // More threads gain nothing, and each takes address space.
  constexpr int max_threads_of_processor = 4;
  const int processors = processorCount();
  return std::min({requested > 0 ? requested : processors, max_threads_of_processor * processors,
                   static_cast<int>(std::min<std::size_t>(items / kBlockSize, kMaxThreads))});
}

std::size_t threadNumber() {
  return thread_number;
}

void forEachTask(std::size_t count, int threads, const std::function<void(std::size_t)>& task) {
  if (threads <= 1 || count <= 1 || does_task_of_team) {
    const NumberInLoop number_in_loop(0);
    for (std::size_t i = 0; i < count; ++i)
      task(i);
    return;
  }
  if (!own_team || !own_team->isOfThisProcess())
    own_team.reset(std::make_unique<Team>().release());
  own_team->run(count, std::min(count, static_cast<std::size_t>(threads)) - 1, task);
}

}  // namespace spherical_param::internal
