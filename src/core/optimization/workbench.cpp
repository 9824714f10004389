#include "workbench.h"

#include "optimization_constants.h"
#include "spherical_param/self_intersection.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {

Workbench::Workbench(const Positions& points, SphereMesh start, const Graph& graph,
                     const OptimizationOptions& options, const Execution& execution)
    : report(reportOf(execution, "optimization")),
      openings(options.openings != nullptr ? std::optional(*options.openings) : std::nullopt),
      mesh(points, std::move(start), graph, execution.threads, openings ? &*openings : nullptr,
           report),
      flips(mesh), ruins(mesh, flips, options.seed), local(mesh),
      has_no_time_(execution.time_limit == 0.0), time_left_(execution.time_limit) {
  namespace tuned = optimization_constants;
  const auto of_part =
      static_cast<std::size_t>(options.fraction * static_cast<double>(tuned::kMaxWork));
  max_work_ = std::min(tuned::kMaxWorkOfPoint * (1000 + columnCount(points)),
                       std::max(of_part, tuned::kMinWork) + columnCount(points));
  renewWork();
}

void Workbench::reportItem(std::size_t item, std::size_t items, std::size_t between_reports) const {
  if (item % between_reports == 0)
    reportFraction(report, static_cast<double>(item) / static_cast<double>(items));
}

IntersectingPairs Workbench::findIntersections() {
  const std::size_t most = isOutOfTime()
                               ? mostOfUsable(static_cast<std::size_t>(mesh.mesh().size()))
                               : max_work_ / optimization_constants::kMinUntangled;
  // With more of them, a search among all triangles is faster.
  constexpr std::size_t min_untouched = 8;
  const std::vector<Index> touched = mesh.takeTouched();
  bool is_known = !known_.is_sample && min_untouched * touched.size() < mesh.mesh().slotCount();
  if (is_known) {
    updateIntersections(mesh, touched, known_);
    is_known = countTriangles(known_.pairs) <= most;
  }
  if (!is_known)
    known_ = internal::findIntersections(mesh, most, report);
  return known_;
}

bool Workbench::isOutOfTime() {
  log.is_out_of_time = log.is_out_of_time || time_left_() == 0.0;
  return log.is_out_of_time;
}

bool Workbench::mayRepair(double fraction) {
  return work() < first_work_ + fractionOf(fraction, max_work_) && !isOutOfTime();
}

void Workbench::renewWork() {
  first_work_ = work();
  local.limitWork(max_work_);
}

bool Workbench::tryPart(const std::vector<Index>& seeds, std::size_t size,
                        const RuinAndRecreate::Accept& accept) {
  if (!mayRepair())
    return false;
  const std::vector<Index> part = ruins.spread(seeds, size);
  log.recreated += part.size();
  return ruins.recreate(part, accept);
}

}  // namespace spherical_param::internal
