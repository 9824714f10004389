// Many reconstructions at the same time, each of which must answer what it answers alone. Through
// the core; with SPHERICAL_PARAM_TORTURE_PCL also through objects of the PCL class.
//
//   torture_threads [--quick] [--seed N]

#include "arguments.h"
#include "mixed_jobs.h"
#include "torture_row.h"

#include <atomic>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

#ifdef SPHERICAL_PARAM_TORTURE_PCL
#include "pcl_calls.h"
#endif

namespace {

using torture::Job;

constexpr std::size_t kThreads = 8;

class CoreCalls {
public:
  static constexpr const char* kName = "through the core";
  static torture::JobLimits limits(bool quick) {
    torture::JobLimits limits;
    limits.most = quick ? 150 : 400;
#ifdef SPHERICAL_PARAM_TORTURE_PCL
    limits.large_every = quick ? 0 : 50;  // with OpenMP, in this build
#endif
    return limits;
  }
  torture::Answer operator()(const Job& job) {
    return torture::answer(job);
  }
};

#ifdef SPHERICAL_PARAM_TORTURE_PCL
class PclCalls : public torture::PclObject {
public:
  static constexpr const char* kName = "through objects of the PCL class";
  static torture::JobLimits limits(bool quick) {
    torture::JobLimits limits;
    limits.most = quick ? 300 : 1500;
    limits.with_invalid = false;  // the class prints what is wrong
    limits.large_every = quick ? 0 : 50;
    return limits;
  }
};
#endif

/// \return the program's exit code
template <typename Calls>
int compare(const torture::Arguments& arguments, std::size_t calls_of_thread) {
  const torture::JobLimits limits = Calls::limits(arguments.quick);
  const std::size_t count = kThreads * calls_of_thread;
  std::vector<Job> jobs(count);
  std::vector<std::string> alone(count);
  std::size_t wrong = 0;
  std::size_t refused = 0;
  Calls calls;
  for (std::size_t i = 0; i < count; ++i) {
    jobs[i] = torture::makeJob(arguments.seed, i, limits);
    torture::Answer answer = calls(jobs[i]);
    refused += jobs[i].is_valid ? 0 : 1;
    if (!answer.is_right) {
      ++wrong;
      std::printf("job %zu, alone: not the right kind of answer\n", i);
    }
    alone[i] = std::move(answer.bytes);
  }

  std::atomic<std::size_t> ready{0};
  std::vector<std::vector<std::size_t>> different(kThreads);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      Calls calls_of_this;
      // All begin at once.
      ++ready;
      while (ready < kThreads)
        std::this_thread::yield();
      for (std::size_t i = t * calls_of_thread; i < (t + 1) * calls_of_thread; ++i)
        if (calls_of_this(jobs[i]).bytes != alone[i])
          different[t].push_back(i);
    });
  for (std::thread& thread : threads)
    thread.join();
  std::size_t differences = 0;
  for (const std::vector<std::size_t>& of_thread : different)
    for (const std::size_t i : of_thread) {
      ++differences;
      std::printf("job %zu: together with others, other bytes than alone\n", i);
    }

#ifdef __SANITIZE_THREAD__
  const std::string sanitizer = ", with the thread sanitizer";
#else
  const std::string sanitizer;
#endif
  torture::Row row;
  row.part = "threads";
  row.load = std::to_string(kThreads) + " threads x " + std::to_string(calls_of_thread) +
             " reconstructions " + Calls::kName + ", same bytes as alone" + sanitizer;
  row.tried = count;
  row.injected = refused;
  row.found = wrong + differences;
  return torture::print(row);
}

}  // namespace

int main(int argc, char** argv) {
  const auto arguments = torture::parse(argc, argv);
  if (!arguments)
    return 2;
  const std::size_t calls_of_thread = arguments->quick ? 8 : 200;
  int code = compare<CoreCalls>(*arguments, calls_of_thread);
#ifdef SPHERICAL_PARAM_TORTURE_PCL
  code |= compare<PclCalls>(*arguments, calls_of_thread);
#endif
  return code;
}
