#include "retries.h"

#include "judgement.h"

#include <string>

namespace spherical_param::internal {
namespace {

/// Neighbours of each point in the graph of a retry, fewer than the default: far ones join sheets.
constexpr int kFewNeighbors = 8;

/// Self-intersections for each triangle up to which retries are worth it even if the cloud does not
/// look like a closed surface.
constexpr double kMaxIntersections = 0.001;

}  // namespace

Plan planOf(int run, const Options& options) {
  Plan plan{"as asked", options};
  // The smoothed points get an optimisation of their own.
  if (options.smoothing.steps > 0)
    plan.options.optimization.finish_on_points = false;
  if (run == 0)
    return plan;
  if (options.graph.method == GraphMethod::LocalDelaunay) {
    if (run == 1) {
      plan.description = "one star is enough";
      plan.options.graph.agreement = StarAgreement::Either;
      return plan;
    }
    if (run == 2) {
      plan.description = std::to_string(kFewNeighbors) + " nearest neighbours";
      plan.options.graph.method = GraphMethod::NearestNeighbors;
      plan.options.graph.k = kFewNeighbors;
      return plan;
    }
    run -= 2;
  }
  if (run == 2) {
    plan.description = "radial start";
    plan.options.embedding.method = EmbeddingMethod::Iterative;
    plan.options.embedding.exponent = 3.0;
    plan.options.embedding.max_iterations = 0;
    return plan;
  }
  plan.options.seed += static_cast<std::uint32_t>(run);
  plan.description = "seed " + std::to_string(plan.options.seed);
  return plan;
}

bool Candidate::isGood() const {
  const OptimizationReport& report = optimization.report;
  return intersections() == 0 ||
         (!isSmoothed() && report.noise_steps > 0 && report.smoothed_self_intersections == 0);
}

void BestOfRuns::add(const std::string& description, Candidate candidate, double seconds) {
  const bool is_better = runs.empty() || candidate.badness() < mesh.badness();
  runs.push_back({description, candidate.intersections(), candidate.optimization.report.energy,
                  seconds, false});
  if (!is_better)
    return;
  if (runs.size() > 1 && !first_graph)
    first_graph = std::move(mesh.graph);
  mesh = std::move(candidate);
  for (RunReport& report : runs)
    report.chosen = &report == &runs.back();
}

bool isWorthRetrying(const Positions& points, const Candidate& mesh, const OpenSurface& surface,
                     const Options& options) {
  if (options.optimization.method != OptimizationMethod::Full || options.retries == 0 ||
      mesh.isGood())
    return false;
  const auto triangles = static_cast<double>(mesh.triangles().cols());
  if (static_cast<double>(mesh.intersections()) <= kMaxIntersections * triangles)
    return true;
  const std::size_t boundaries = surface.isOpen() ? 1 : 0;
  const SurfaceDiagnosis diagnosis =
      diagnose(points, surfaceOf(points, surface, mesh), boundaries, mesh.graph, options);
  return diagnosis.looksClosedGenus0() || (boundaries > 0 && diagnosis.kind == SurfaceKind::Open);
}

}  // namespace spherical_param::internal
