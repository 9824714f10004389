#pragma once

#include "spherical_param/errors.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

namespace spherical_param::internal {

/// Told the share of some work that is done, in [0, 1], from the calling thread and outside of
/// parallel regions: it may throw to end the work. May be empty.
using ShareReport = std::function<void(double)>;

/// Throws Cancelled in the name of a function where its callback answers false.
///
/// \param progress must outlive the report; may be empty.
inline ShareReport cancellable(const std::function<bool(double)>& progress, const char* function) {
  if (!progress)
    return {};
  return [&progress, function](double share) {
    if (!progress(share))
      throw Cancelled(std::string(function) + ": cancelled by the progress callback");
  };
}

/// The report of a part of the work, which is the share from `begin` to `end` of it.
inline ShareReport partOf(const ShareReport& report, double begin, double end) {
  if (!report)
    return {};
  return [report, begin, end](double share) { report(begin + (end - begin) * share); };
}

inline void tell(const ShareReport& report, double share) {
  if (report)
    report(share);
}

}  // namespace spherical_param::internal
