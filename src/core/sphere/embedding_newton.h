#pragma once

#include "embedding_energy.h"
#include "laplacian_cycle.h"
#include "progress.h"
#include "spherical_param/result.h"

#include <functional>
#include <optional>
#include <vector>

namespace spherical_param::internal {

/// When the solution ends.
struct NewtonOptions {
  double relative_tolerance;        ///< of the relative residual, \see EmbeddingEnergy::Residual
  std::optional<double> tolerance;  ///< of the mean tangential Laplacian [radius]
  FractionReport report = {};       ///< called with 0 before each step
  /// Whether an embedding collapses, which ends the work; may be empty.
  std::function<bool(const Positions&)> collapses = nullptr;
};

/// Lowers the energy of an embedding by Newton's method on the product of spheres, with a line
/// search: steps in the tangent planes, then back to the sphere. Ends if both residuals reach their
/// tolerances, if rounding leaves no step that lowers energy or residual, or if the embedding
/// collapses.
///
/// \param report receives the numbers of iterations and the residual.
/// \return the absolute residuals before each step and at the end.
std::vector<double> minimizeByNewton(const EmbeddingEnergy& energy, LaplacianCycle& preconditioner,
                                     const NewtonOptions& options, Positions& directions,
                                     LevelReport& report);

}  // namespace spherical_param::internal
