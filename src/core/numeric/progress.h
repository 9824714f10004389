#pragma once

#include "spherical_param/errors.h"
#include "spherical_param/execution.h"

#include <functional>
#include <string>

namespace spherical_param::internal {

/// Receives the fraction of a loop done so far, in [0, 1], from the calling thread, perhaps inside
/// a parallel region. It may throw to end the work. May be empty.
using FractionReport = std::function<void(double)>;

/// The report of a stage: passes the fraction to the progress callback; throws Cancelled if that
/// returns false.
///
/// \param execution must outlive the report.
inline FractionReport reportOf(const Execution& execution, const char* stage) {
  if (!execution.progress)
    return {};
  return [&execution, stage](double fraction) {
    if (!execution.progress({stage, fraction}))
      throw Cancelled(std::string(stage) + ": cancelled by the progress callback");
  };
}

inline void reportFraction(const FractionReport& report, double fraction) {
  if (report)
    report(fraction);
}

}  // namespace spherical_param::internal
