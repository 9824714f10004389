#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>

namespace spherical_param {

/// \addtogroup types
/// @{

/// How far a computation is, as reported to Execution::progress.
struct Progress {
  /// Of reconstruct(): "view", "neighbors", "graph", "outliers", "parts", "consolidation",
  /// "openings", "embedding", "triangulation", "optimization", "smoothing", "cleaning", "fill" or
  /// "quality".
  const char* stage;
  /// Fraction of the stage's current loop, in [0, 1]. A stage may run several loops, and comes back
  /// where a part is meshed in another way.
  double fraction;
  std::size_t part = 0;   ///< the part at hand, from 0
  std::size_t parts = 1;  ///< number of parts that are meshed
  /// Estimate of the fraction of all the work of reconstruct(), in [0, 1]; it never falls.
  double done = 0.0;
  /// What the part is, if it is no plain surface, and what is done with it: said once, and empty
  /// otherwise. Valid during the call.
  std::string_view remark = {};
};

/// How a computation is run. Only the time limit affects the result.
struct Execution {
  int threads = 0;  ///< 0: one for each processor; [0, 1024]
  /// Called at least every second during long work, from the calling thread only; may be empty.
  /// Returning false ends the work with Cancelled. The convex hull of Method::Paper, a tolerance
  /// and smoothing may take longer between two calls.
  std::function<bool(const Progress&)> progress = {};
  /// Wall time after which the work ends with the best mesh so far [s]; [0, 1e9]. Unset: no limit.
  /// The first mesh of each part is finished, however long that takes; 0: the work ends with it.
  /// Parts share the limit in proportion to their points; before smoothing, the optimisation gets
  /// half of the remaining time, before FillMode::Smooth four fifths. If it ends the work, no
  /// other way to mesh a part is tried. The mesh then depends on the machine.
  std::optional<double> time_limit = {};
};

/// @}

}  // namespace spherical_param
