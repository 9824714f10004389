#pragma once

#include "progress.h"
#include "spherical_param/errors.h"
#include "spherical_param/option_table.h"
#include "spherical_param/result.h"
#include "time_left.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// The time limit ended the work before there was a mesh.
class OutOfTime : public ComputeError {
public:
  explicit OutOfTime(double limit)
      : ComputeError("reconstruct: the time limit of " + textOf(limit) +
                     " s ended the work before there was a mesh; allow more time") {}
};

/// Times the stages, reports their beginning and end, and shares the time limit between parts. At
/// the limit it ends the work before a mesh with OutOfTime, unless the limit is 0.
class StageClock {
public:
  /// \param user how the caller wants the work done; must outlive the clock.
  explicit StageClock(const Execution& user) : user_(user), left_(user.time_limit) {
    execution_.threads = user.threads;
    if (user.progress || isLimited())
      execution_.progress = [this](const Progress& progress) {
        // So that small clouds have a mesh whatever the limit [s].
        constexpr double grace = 0.15;
        if (isLimited() && !has_mesh_ && left_(-grace) == 0.0)
          throw OutOfTime(*user_.time_limit);
        return !user_.progress || user_.progress({stage_, progress.fraction, part_, parts_});
      };
  }
  StageClock(const StageClock& other) = delete;  // execution() points here
  StageClock& operator=(const StageClock& other) = delete;

  /// Execution for the stages: without a time limit; progress is reported for the current stage.
  const Execution& execution() const { return execution_; }

  /// Begins a stage; the one before ends.
  void begin(const char* stage) {
    end();
    stage_ = stage;
    begin_ = Clock::now();
    report(0.0);
  }

  /// Notes whether the part has a mesh: then the limit no longer ends its work with OutOfTime.
  void noteMesh(bool has_mesh = true) { has_mesh_ = has_mesh; }

  /// Begins a part. \param fraction of the remaining points, and so of the remaining time. \param
  /// points_fraction of all points.
  void beginPart(std::size_t part, std::size_t parts, double fraction, double points_fraction) {
    part_ = part;
    parts_ = parts;
    has_mesh_ = false;
    fraction_ = points_fraction;
    std::optional<double> limit = left_();
    if (limit)
      *limit *= fraction;
    part_left_ = TimeLeft(limit);
    part_begin_ = Clock::now();
  }

  /// The part's share of the points of all parts.
  double share() const { return fraction_; }
  /// Time left for the part [s], minus a reserve for the check of the mesh: half of the time until
  /// the embedding, more than it takes.
  std::optional<double> remaining() const {
    double kept = 0.0;
    for (const StageTime& time : times_)
      if (time.name == "neighbors" || time.name == "graph")
        kept += fraction_ * time.seconds / 2.0;
    return part_left_ ? (*part_left_)(kept) : left_(kept);
  }

  /// Whether as much time is left for the part as it has taken.
  bool hasTimeAgain() const {
    const std::optional<double> left = remaining();
    const std::chrono::duration<double> taken = Clock::now() - part_begin_;
    return !left || *left > taken.count();
  }

  /// Ends the last stage. \return the time of each stage
  std::vector<StageTime> take() {
    noteMesh();
    end();
    return std::move(times_);
  }

private:
  using Clock = std::chrono::steady_clock;

  bool isLimited() const { return user_.time_limit && *user_.time_limit > 0.0; }

  void end() {
    if (stage_ == nullptr)
      return;
    const std::chrono::duration<double> seconds = Clock::now() - begin_;
    const auto known = std::find_if(times_.begin(), times_.end(),
                                    [&](const StageTime& other) { return other.name == stage_; });
    if (known == times_.end())
      times_.push_back({stage_, seconds.count()});
    else
      known->seconds += seconds.count();
    begin_ = Clock::now();  // the report may throw
    report(1.0);
    stage_ = nullptr;
  }

  void report(double fraction) const { reportFraction(reportOf(execution_, stage_), fraction); }

  const Execution& user_;
  Execution execution_;
  TimeLeft left_;
  std::optional<TimeLeft> part_left_;
  double fraction_ = 1.0;
  const char* stage_ = nullptr;
  bool has_mesh_ = false;  ///< of the part
  Clock::time_point begin_;
  Clock::time_point part_begin_ = Clock::now();
  std::size_t part_ = 0;
  std::size_t parts_ = 1;
  std::vector<StageTime> times_;
};

}  // namespace spherical_param::internal
