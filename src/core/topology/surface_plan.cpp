#include "surface_plan.h"

#include "openings.h"
#include "progress.h"

#include <utility>

namespace spherical_param::internal {

SurfacePlan::SurfacePlan(const Positions& points, const Graph& graph, bool is_flat, double unit,
                         const Options& options, StageClock& clock)
    : points_(&points), graph_(&graph) {
  clock.begin("openings");
  const Execution& execution = clock.execution();
  const FractionReport report = reportOf(execution, "openings");
  const Indexed<double> spacing = nodeSpacings(graph, execution.threads);
  reportFraction(report, 0.1);
  rotation_.emplace(points, graph, spacing, execution.threads);
  reportFraction(report, 0.6);
  Openings openings = findOpenings(points, graph, spacing, *rotation_);
  openings_ = OpenSurface(points, graph, std::move(openings), is_flat, unit, options);
}

const SphereMesh* SurfacePlan::faces() {
  if (rotation_) {
    if (rotation_->hasOpposite(*graph_))
      rotation_->separateOpposite();
    faces_ = meshFaces(*points_, *graph_, *rotation_);
    rotation_.reset();
  }
  return faces_ ? &*faces_ : nullptr;
}

}  // namespace spherical_param::internal
