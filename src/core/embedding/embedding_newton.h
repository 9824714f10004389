#pragma once

#include "embedding_energy.h"
#include "laplacian_cycle.h"
#include "spherical_param/types.h"

#include <functional>
#include <vector>

namespace spherical_param::internal {

struct NewtonOptions {
  int max_iterations = 100;
  double tolerance = 0.0;           ///< mean length of the tangential Laplacian [radius]
  double relative_tolerance = 1.0;  ///< the same in units of each node's mean edge
  /// Whether the work is given up because the embedding collapses; may be empty.
  std::function<bool(const Positions&)> collapses;
  /// Called with (iteration, residual) before each step; throws to end the work.
  std::function<void(int, double)> progress;
};

struct NewtonReport {
  int iterations = 0;
  int linear_iterations = 0;      ///< conjugate gradient steps
  std::vector<double> residuals;  ///< absolute, before each step and at the end
};

/// Lowers the energy of an embedding by Newton's method on the product of spheres, with a line
/// search: steps in the tangent planes, then back to the sphere. Ends if both residuals reach their
/// tolerances, if rounding leaves no step that lowers energy or residual, or if the embedding
/// collapses.
NewtonReport minimizeByNewton(const EmbeddingEnergy& energy, LaplacianCycle& preconditioner,
                              const NewtonOptions& options, Positions& directions);

}  // namespace spherical_param::internal
