#pragma once

#include "progress.h"
#include "spherical_param/reconstruct.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Times the stages, all runs together, and reports their beginning and end.
class StageClock {
public:
  explicit StageClock(const Execution& execution) : execution_(execution) {}

  /// Runs a stage and returns its outcome.
  template <typename Work>
  auto time(const char* stage, const Work& work) {
    tell(reportOf(execution_, stage), 0.0);
    const auto begin = std::chrono::steady_clock::now();
    auto outcome = work();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    add(stage, seconds.count());
    tell(reportOf(execution_, stage), 1.0);
    return outcome;
  }

  std::vector<StageTime> take() { return std::move(times_); }

private:
  void add(const char* stage, double seconds) {
    const auto known = std::find_if(times_.begin(), times_.end(), [&](const StageTime& other) {
      return other.name == stage;
    });
    if (known == times_.end())
      times_.push_back({stage, seconds});
    else
      known->seconds += seconds;
  }

  const Execution& execution_;
  std::vector<StageTime> times_;
};

}  // namespace spherical_param::internal
