#pragma once

#include "progress.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"
#include "time_left.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Times the stages and reports their beginning and end.
class StageClock {
public:
  /// \param options must outlive the clock.
  explicit StageClock(const Options& options) : options_(options) {}
  StageClock(const StageClock& other) = delete;  // optionsOfStages() points here
  StageClock& operator=(const StageClock& other) = delete;

  /// The options for the stages. Progress is reported as that of the stage that runs, whichever
  /// functions it calls.
  Options optionsOfStages() const {
    Options options = options_;
    if (options_.progress)
      options.progress = [this](const Progress& progress) {
        return options_.progress({stage_, progress.fraction});
      };
    return options;
  }

  /// Runs a stage and returns its outcome.
  template <typename Work>
  auto time(const char* stage, const Work& work) {
    stage_ = stage;
    reportFraction(reportOf(options_, stage), 0.0);
    const auto begin = std::chrono::steady_clock::now();
    auto outcome = work();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    add(stage, seconds.count());
    reportFraction(reportOf(options_, stage), 1.0);
    return outcome;
  }

  /// What is left of the time limit, without what is kept for the check of the mesh: half of the
  /// time until the embedding, which is more than it takes [s].
  std::optional<double> remaining() const {
    double kept = 0.0;
    for (const StageTime& time : times_)
      if (time.name == "neighbors" || time.name == "graph")
        kept += time.seconds / 2.0;
    return time_left_(kept);
  }

  std::vector<StageTime> take() { return std::move(times_); }

private:
  void add(const char* stage, double seconds) {
    const auto known = std::find_if(times_.begin(), times_.end(),
                                    [&](const StageTime& other) { return other.name == stage; });
    if (known == times_.end())
      times_.push_back({stage, seconds});
    else
      known->seconds += seconds;
  }

  const Options& options_;
  TimeLeft time_left_{options_.time_limit};
  const char* stage_ = "";
  std::vector<StageTime> times_;
};

}  // namespace spherical_param::internal
