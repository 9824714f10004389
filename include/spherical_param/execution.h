#pragma once

#include <cstddef>
#include <functional>
#include <optional>

namespace spherical_param {

/// \addtogroup types
/// @{

/// How far a computation is, as reported to Execution::progress.
struct Progress {
  /// Of reconstruct(): "neighbors", "graph", "outliers", "parts", "consolidation", "openings",
  /// "embedding", "triangulation", "optimization", "smoothing" or "quality".
  const char* stage;
  /// Fraction of the stage's current loop, in [0, 1]. A stage may have several loops, one after the
  /// other.
  double fraction;
  std::size_t part = 0;   ///< the part that is meshed, from 0
  std::size_t parts = 1;  ///< number of parts that are meshed
};

/// How a computation is run. Only the time limit has an influence on the result.
struct Execution {
  int threads = 0;  ///< OpenMP threads; 0: as many as OpenMP would use; [0, 1024]
  /// Called every second or more often during long work, from the calling thread only. Returning
  /// false ends the work with Cancelled. May be empty. The paper's own stages (qhull, and a
  /// tolerance for the multilevel embedding) and smoothing may take longer between two calls.
  std::function<bool(const Progress&)> progress = {};
  /// Wall time after which the work ends with the best mesh so far [s]; [0, 1e9]. Unset: none. It
  /// ends the optimisation; what comes before is not cut short. Parts share it in proportion to
  /// their points; with smoothing, the optimisation before it has half of what is left. Where it
  /// ended the work, handles are not told from folds. The same limit may give another mesh on
  /// another machine.
  std::optional<double> time_limit = {};
};

/// @}

}  // namespace spherical_param
