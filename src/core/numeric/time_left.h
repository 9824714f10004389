#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

namespace spherical_param::internal {

/// The time left of a limit that starts at construction.
class TimeLeft {
public:
  /// \param limit [s]; unset: no limit.
  explicit TimeLeft(std::optional<double> limit) : limit_(limit) {}

  /// \param kept reserve for later work [s].
  /// \return [s], at least 0; unset: no limit.
  std::optional<double> operator()(double kept = 0.0) const {
    if (!limit_)
      return std::nullopt;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
    return std::max(0.0, *limit_ - passed.count() - kept);
  }

private:
  std::optional<double> limit_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace spherical_param::internal
