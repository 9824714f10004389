#include "common/job_scheduler.h"

#include <algorithm>
#include <utility>

namespace spherical_param::tools {

JobScheduler::JobScheduler(const JobLimits& limits, std::size_t jobs, Need need)
    : limits_(limits), jobs_(jobs), need_(std::move(need)) {
  limits_.jobs = std::max<std::size_t>(1, limits_.jobs);
  limits_.processors = std::max<std::size_t>(1, limits_.processors);
}

bool JobScheduler::fits(const Job& job) const {
  if (running_ == 0) {
    return true;
  }
  // One that runs although it needs more than there is has no company, whatever that needs.
  return memory_in_use_ <= limits_.memory && job.need <= limits_.memory - memory_in_use_;
}

std::size_t JobScheduler::threadsOf(const Job& job) const {
  const std::size_t at_a_time = std::min(limits_.jobs, running_ + waiting());
  const std::size_t even = limits_.processors / std::max<std::size_t>(1, at_a_time);
  const double part = limits_.memory == 0
                          ? 1.0
                          : static_cast<double>(job.need) / static_cast<double>(limits_.memory);
  const auto by_memory =
      static_cast<std::size_t>(std::min(1.0, part) * static_cast<double>(limits_.processors));
  return std::max({std::size_t{1}, even, by_memory});
}

std::optional<JobScheduler::Start> JobScheduler::next() {
  if (running_ >= limits_.jobs) {
    return std::nullopt;
  }
  // Besides the first, as many as may pass it.
  for (std::size_t place = 0; place <= limits_.jobs; ++place) {
    if (place == waiting_.size()) {
      if (seen_ == jobs_) {
        return std::nullopt;
      }
      waiting_.push_back({seen_, need_(seen_)});
      ++seen_;
    }
    const Job job = waiting_[place];
    if (!fits(job)) {
      if (passed_first_ >= limits_.jobs) {
        return std::nullopt;
      }
      continue;
    }
    const Start start = {job.number, threadsOf(job)};
    passed_first_ = place == 0 ? 0 : passed_first_ + 1;
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(place));
    needs_[job.number] = job.need;
    ++running_;
    memory_in_use_ += job.need;
    return start;
  }
  return std::nullopt;
}

void JobScheduler::putBack(std::size_t job) {
  waiting_.push_front({job, needs_.at(job)});
  finished(job);
}

void JobScheduler::finished(std::size_t job) {
  const auto found = needs_.find(job);
  memory_in_use_ -= found->second;
  --running_;
  needs_.erase(found);
}

}  // namespace spherical_param::tools
