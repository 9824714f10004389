#include "warnings.h"

#include <array>
#include <cstdio>
#include <string>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Above this fraction of edges beyond the graph's 2-ring the mesh is not to be trusted. Unfolded
/// embeddings of closed surfaces have 0.0005 and less, folded limbs 0.003 and more, the filled hole
/// of a bowl of some thousand points 0.002. Measured on local Delaunay neighbourhoods.
constexpr double kMaxEdgesOutside = 0.001;
/// A fraction of the points that deserves a warning.
constexpr double kManyPoints = 0.01;

std::string percent(double fraction) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f %%", 100.0 * fraction);
  return text.data();
}

}  // namespace

std::vector<std::string> warningsOf(const Options& options, const Result& result) {
  std::vector<std::string> warnings;
  const auto warn = [&](const std::string& text) { warnings.push_back(text); };
  if (result.duplicates() > 0)
    warn(std::to_string(result.duplicates()) +
         " points repeat an earlier point exactly; each place became one vertex.");
  if (!result.outliers.empty())
    warn(std::to_string(result.outliers.size()) +
         (result.outliers.size() == 1 ? " point looks like an outlier"
                                      : " points look like outliers") +
         ", far from any surface, and became spikes of the mesh; leave them out (outliers auto).");
  if (result.graph.components > 1)
    warn("The neighbour graph was in " + std::to_string(result.graph.components) +
         " pieces, joined by their shortest bridges: the cloud may show several objects, or "
         "parts farther apart than their points; mesh each by itself (parts each), or the largest "
         "alone (parts largest), if it does.");
  const auto vertices = static_cast<double>(result.vertexCount());
  if (static_cast<double>(result.graph.without_tangent_plane.size()) > kManyPoints * vertices)
    warn(std::to_string(result.graph.without_tangent_plane.size()) +
         " points have no trustworthy tangent plane: the cloud is too coarse or too noisy there, "
         "and the mesh may be folded.");
  if (static_cast<double>(result.graph.uncertified) > kManyPoints * vertices)
    warn(
        std::to_string(result.graph.uncertified) +
        " points may have neighbours that were not found: the cloud is open or very uneven there.");
  if (result.embedding.fallback_start)
    warn("The embedding collapsed to one place; the mesh comes from a start without iteration and "
         "is likely to be folded.");
  else if (result.embedding.added_barrier)
    warn("The embedding collapsed until it was held by a barrier: the cloud is too coarse for its "
         "shape, or has wide gaps.");
  else if (result.embedding.stop_reason == StopReason::IterationLimit)
    warn("The embedding has not converged within the limit of iterations.");
  else if (result.embedding.stop_reason == StopReason::Stagnated)
    warn("The embedding has not converged: its residual no longer changes.");
  if (static_cast<double>(result.triangulation.coincident) > kManyPoints * vertices)
    warn(std::to_string(result.triangulation.coincident) +
         " points coincide with others on the sphere: long thin parts shrink below the "
         "rounding of numbers there, and their mesh is arbitrary.");
  if (!result.diagnosis.looksClosedGenus0())
    warn(result.diagnosis.summary +
         (result.isClosed() ? " The mesh is a closed surface without handles even so." : ""));
  if (result.diagnosis.edges_outside_graph > kMaxEdgesOutside &&
      options.optimization.method == OptimizationMethod::None)
    warn(percent(result.diagnosis.edges_outside_graph) +
         " of the mesh's edges join points that are not near each other in the cloud: the "
         "embedding is folded" +
         (result.embedding.stop_reason == StopReason::Unfinished ? " (a tolerance may unfold it)"
                                                                 : "") +
         ", or the cloud is not a closed surface without holes through it.");
  if (result.optimization.noise_steps > 0 && result.smoothed.cols() == 0)
    warn("The cloud is noisy: the mesh was optimised on smoothed positions of its points; "
         "smoothing gives a surface without the noise.");
  if (result.optimization.is_out_of_time)
    warn("The time limit ended the optimisation early: this is the best mesh so far; more time may "
         "make it better.");
  if (!result.self_intersections.empty())
    warn(std::to_string(result.self_intersections.size()) + " pairs of triangles intersect" +
         (result.smoothed.cols() > 0 ? " (" + std::to_string(result.smoothing.self_intersections) +
                                           " on the smoothed points)"
                                     : std::string()) +
         ".");
  return warnings;
}

}  // namespace spherical_param::internal
