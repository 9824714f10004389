#pragma once

#include "progress.h"
#include "spherical_param/result.h"
#include "time_left.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Fraction of the remaining time that the optimisation leaves for the fill.
inline constexpr double kTimeForFill = 0.2;

/// Times the stages, reports their beginning and end, and divides the time limit among parts and
/// stages. Stages before the first mesh of a part have no limit.
class StageClock {
public:
  /// \param user how the caller wants the work done; must outlive the clock.
  explicit StageClock(const Execution& user) : user_(user), left_(user.time_limit) {
    execution_.threads = user.threads;
    if (user.progress)
      execution_.progress = [this](const Progress& progress) {
        return user_.progress(
            {stage_, progress.fraction, part_, parts_, done(progress.fraction), remark_});
      };
  }
  StageClock(const StageClock& other) = delete;  // execution() points here
  StageClock& operator=(const StageClock& other) = delete;

  /// Execution for the stages: without a time limit; progress is reported for the current stage.
  const Execution& execution() const { return execution_; }
  /// The same, with the time that remains as its limit.
  Execution limited() const {
    Execution execution = execution_;
    execution.time_limit = remaining();
    return execution;
  }

  /// Begins a stage; the one before ends.
  void begin(const char* stage) {
    end();
    stage_ = stage;
    begin_ = Clock::now();
    report(0.0);
  }

  /// Reports a remark on the part. \see Progress::remark
  void remark(std::string_view text) {
    remark_ = text;
    report(0.0);
    remark_ = {};
  }

  /// Keeps a fraction of the remaining time for the stages after the next call.
  void keep(double fraction) {
    kept_ = 0.0;
    kept_ = fraction * remaining().value_or(0.0);
  }

  /// Begins a part.
  ///
  /// \param fraction        of the remaining points, and so of the remaining time.
  /// \param points_fraction of all points.
  void beginPart(std::size_t part, std::size_t parts, double fraction, double points_fraction) {
    before_ += part > 0 ? fraction_ : 0.0;
    part_ = part;
    parts_ = parts;
    fraction_ = points_fraction;
    kept_ = 0.0;
    std::optional<double> limit = left_();
    if (limit)
      *limit *= fraction;
    part_left_ = TimeLeft(limit);
    part_begin_ = Clock::now();
  }

  /// Ends the time of the part, which then gets its first mesh.
  void endPart() { part_left_ = TimeLeft(0.0); }

  /// The part's fraction of the points of all parts.
  double pointsFraction() const { return fraction_; }
  /// Time left for the part [s], without what is kept and a reserve for the check of the mesh: half
  /// of the time that neighbours and graph took.
  std::optional<double> remaining() const {
    double kept = kept_;
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
    end();
    return std::move(times_);
  }

private:
  using Clock = std::chrono::steady_clock;

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

  /// \see Progress::done. The fractions of the work are typical ones.
  double done(double fraction) {
    struct Row {
      std::string_view stage;
      double end;
    };
    static constexpr Row rows[] = {
        {"view", 0.09},          {"neighbors", 0.15},    {"graph", 0.28},     {"outliers", 0.31},
        {"parts", kBeforeParts}, {"consolidation", 0.4}, {"openings", 0.55},  {"embedding", 0.62},
        {"triangulation", 0.63}, {"optimization", 0.93}, {"smoothing", 0.95}, {"cleaning", 0.97},
        {"fill", 0.98},          {"quality", 1.0}};
    double begin = 0.0;
    for (const Row& row : rows) {
      if (row.stage == stage_) {
        const double all = begin + (row.end - begin) * fraction;
        const double in_parts = (1.0 - kBeforeParts) * before_ + (all - kBeforeParts) * fraction_;
        done_ = std::max(done_, all <= kBeforeParts ? all : kBeforeParts + in_parts);
      }
      begin = row.end;
    }
    return done_;
  }

  void report(double fraction) const { reportFraction(reportOf(execution_, stage_), fraction); }

  const Execution& user_;
  Execution execution_;
  TimeLeft left_;
  std::optional<TimeLeft> part_left_;
  double fraction_ = 1.0;
  const char* stage_ = nullptr;
  double kept_ = 0.0;  ///< [s]
  Clock::time_point begin_;
  Clock::time_point part_begin_ = Clock::now();
  std::size_t part_ = 0;
  std::size_t parts_ = 1;
  std::vector<StageTime> times_;
  static constexpr double kBeforeParts = 0.33;  ///< fraction of the work before the first part
  double before_ = 0.0;                         ///< fraction of the points in earlier parts
  double done_ = 0.0;
  std::string_view remark_;  ///< empty except during remark()
};

}  // namespace spherical_param::internal
